"""Our native FMI 3.0 FMUs under our own master, given to a scene as files."""

from pathlib import Path

import numpy as np
import pytest
from masters import STEP, omsimulator_alone

from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing.built import file_of
from loomfmu.cosim.run import run
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.declaring.variables import variables_of
from loomfmu.fmi.native.platforms import host

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


def native3(name: str) -> Path:
    return file_of(COMPONENTS[name], "native", (host(),), 3)


@pytest.mark.usefixtures("natives")
def test_they_give_the_bits_of_fmi_2(tmp_path: Path) -> None:
    third = {f"{instance}.fmu": str(native3(name)) for instance, name in PARTS.items()}
    expected = run(scenes.parse(SCENE), output=tmp_path / "2.h5", flavour="native").trace
    result = run(scenes.parse(SCENE, overrides=third), output=tmp_path / "3.h5")
    assert {instance.fmu.fmi for instance in result.scene.instances.values()} == {3}
    assert set(result.trace) == set(expected)
    for signal in expected:
        np.testing.assert_array_equal(result.trace[signal], expected[signal], err_msg=signal)
    assert expected["dobby.pick"].dtype == result.trace["dobby.pick"].dtype == np.int32


@pytest.mark.usefixtures("natives")
@pytest.mark.parametrize("name", COMPONENTS)
def test_omsimulator_steps_each_of_them(name: str) -> None:
    # it takes the references in a ModelStructure for places in the list of variables, counted from 1
    component = COMPONENTS[name]()
    outputs = [
        each.name
        for each in variables_of(COMPONENTS[name])
        if each.causality == "output" and each.type is float
    ]
    found = omsimulator_alone(file_of(COMPONENTS[name], "native", (host(),), 3), outputs, 10)
    component.initialize(0.0)
    for step in range(10):
        component.step(step * STEP, STEP)
        for output in outputs:
            # the same code; it may sum its time in another order
            assert found[output][step] == pytest.approx(getattr(component, output), rel=1e-9, abs=1e-12)
