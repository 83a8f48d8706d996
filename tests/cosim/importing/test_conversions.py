import pytest

from loomfmu.cosim.importing.conversions import Definition, stated
from loomfmu.cosim.importing.ports import Port
from loomfmu.errors import LoomfmuError
from loomfmu.units import UNITS

GRAVITY = Definition((0, 1, -2, 0, 0, 0, 0, 0), 9.81)


def test_a_unit_that_is_called_like_ours_but_defined_otherwise_is_never_read_as_ours() -> None:
    unit = stated("g", GRAVITY)
    assert unit is not None and unit.name not in UNITS
    port = Port("p", "Real", 1, "parameter", unit.name, unit.name, None, None, None, "", definition=GRAVITY)
    with pytest.raises(LoomfmuError, match=r"p.*kg"):
        port.value("0.5 kg", "motor.p")
    assert port.value(0.5, "motor.p") == 0.5
    ours = stated("m/s2", None)
    assert ours is not None
    assert unit.conversion(ours)(2.0) == pytest.approx(19.62)
