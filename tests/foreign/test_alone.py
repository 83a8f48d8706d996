"""One of our FMUs by itself in third-party masters."""

import pytest
from masters import ALONE, STEP

from loomfmu.components import WeftInsertion
from loomfmu.cosim.importing.fmus import Fmu


@pytest.mark.few(2)
@pytest.mark.parametrize("master", ALONE)
def test_the_weft_runs_at_its_own_speed(natives: dict[str, Fmu], master: str) -> None:
    found = ALONE[master](natives["WeftInsertion"].path, ["travel", "velocity"], 100)
    weft = WeftInsertion()
    for step in range(100):
        assert weft.initialize((step + 1) * STEP) == 0
        # times that are added up step by step
        assert found["travel"][step] == pytest.approx(weft.travel, rel=1e-12, abs=1e-12)
        assert found["velocity"][step] == pytest.approx(weft.velocity, rel=1e-12, abs=1e-12)
