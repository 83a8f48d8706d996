"""A loom as a system package, made one FMU by fmucontainer of the FMU manipulation toolbox."""

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import fmpy
import numpy as np
import pytest

from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.ssp import export as ssp
from loomfmu.fmi.native.platforms import host

SCENE = """
duration = "0.1 s"
step = "0.1 ms"
record = ["weft.travel", "shaft.angle"]
[shaft]
[weft]
machine = "WL680-3600"
"""


@pytest.mark.skipif(
    find_spec("fmu_manipulation_toolbox") is None, reason="fmu-manipulation-toolbox is not installed"
)
@pytest.mark.usefixtures("natives")
def test_the_container_has_the_connectors_of_the_system(tmp_path: Path) -> None:
    package = tmp_path / "loom.ssp"
    ssp.export(scenes.parse(SCENE, "loom"), package, "native", (host(),), connectors=True)
    command = [
        Path(sys.executable).with_name("fmucontainer"),
        "-container",
        package.name,
        "-fmu-directory",
        ".",
    ]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    container = tmp_path / "loom.fmu"
    found = {each.name: each.causality for each in fmpy.read_model_description(container).modelVariables}
    assert found["shaft_speed"] == "parameter"
    assert {name for name, causality in found.items() if causality == "output"} == {
        *("shaft_angle", "shaft_velocity", "shaft_acceleration"),
        *("weft_travel", "weft_velocity", "weft_acceleration"),
    }
    rows = fmpy.simulate_fmu(
        container,
        stop_time=0.1,
        output_interval=1e-3,
        start_values={"shaft_speed": 60.0},
        output=["shaft_angle"],
    )
    # times are added up by the container's steps, a hundred thousandth of the run
    np.testing.assert_allclose(rows["shaft_angle"], 60.0 * rows["time"], rtol=1e-9, atol=1e-9)
