"""Our native FMI 3.0 FMUs under our own master, given to a scene as files."""

from pathlib import Path

import numpy as np
import pytest

from loomfmu.cosim import scene as scenes
from loomfmu.cosim.run import run
from loomfmu.fmi.native_builder import build_native, host_platform

PARTS = {"shaft": "MainShaft", "dobby": "DobbyDrive", "heald_1": "HealdFrame"}
SCENE = """
steps_per_revolution = 500
[shaft]
speed = "600 rpm"
ramp_duration = "0.05 s"
[dobby]
law = "sloped-line"
[heald_1]
pattern = "10"
"""


@pytest.mark.usefixtures("natives")
def test_they_give_the_bits_of_fmi_2(tmp_path: Path) -> None:
    for name in PARTS.values():
        build_native(name, tmp_path, (host_platform(),), 3)
    third = {f"{instance}.fmu": str(tmp_path / f"{name}.fmu") for instance, name in PARTS.items()}
    expected = run(scenes.parse(SCENE), output=tmp_path / "2.h5", flavour="native").trace
    result = run(scenes.parse(SCENE, overrides=third), output=tmp_path / "3.h5")
    assert {instance.fmu.fmi for instance in result.scene.instances.values()} == {3}
    assert set(result.trace) == set(expected)
    for signal in expected:
        np.testing.assert_array_equal(result.trace[signal], expected[signal], err_msg=signal)
    assert expected["dobby.pick"].dtype == result.trace["dobby.pick"].dtype == np.int32
