"""What third-party checkers say of our native FMUs: nothing."""

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from fmpy.validation import validate_fmu
from masters import DEMO

from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing.fmus import Fmu
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.ssp import export as ssp


@pytest.mark.parametrize("name", COMPONENTS)
def test_fmpy_finds_no_fault(natives: dict[str, Fmu], name: str) -> None:
    assert validate_fmu(str(natives[name].path)) == []


@pytest.mark.few(4)
@pytest.mark.parametrize("name", COMPONENTS)
def test_fmutool_finds_no_fault(natives: dict[str, Fmu], name: str) -> None:
    if find_spec("fmu_manipulation_toolbox") is None:
        pytest.skip("fmu-manipulation-toolbox is not installed")
    command = [Path(sys.executable).with_name("fmutool"), "-input", natives[name].path, "-check"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    said = done.stdout + done.stderr
    assert done.returncode == 0, said
    assert "This FMU seems to be compliant with FMI-2.0." in said
    assert "No semantic error against the FMI-2 standard." in said
    assert "WARNING" not in said and "ERROR" not in said, said


@pytest.mark.usefixtures("natives")
def test_a_package_holds_native_fmus_by_default() -> None:
    assert ssp.default_flavour(scenes.load(DEMO)) == "native"
