"""What the checkers of fmutool say of our native FMUs: nothing. Those of fmpy are in tests/native."""

import pytest
from masters import DEMO, check_by_fmutool

from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing.fmus import Fmu
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.ssp import export as ssp


@pytest.mark.few(4)
@pytest.mark.parametrize("name", COMPONENTS)
def test_fmutool_finds_no_fault(natives: dict[str, Fmu], name: str) -> None:
    check_by_fmutool(natives[name].path)


@pytest.mark.usefixtures("natives")
def test_a_package_holds_native_fmus_by_default() -> None:
    assert ssp.default_flavour(scenes.load(DEMO)) == "native"
