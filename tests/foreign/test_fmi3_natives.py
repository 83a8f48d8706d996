"""Our native FMI 3.0 FMUs under our own master, given to a scene as files."""

import ctypes
from pathlib import Path

import numpy as np
import pytest
from masters import oms_library

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

WEAKLY_COUPLED = 1  # oms_system_wc


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
def test_omsimulator_steps_each_of_them(tmp_path: Path, name: str) -> None:
    # it takes the references in a ModelStructure for places in the list of variables, counted from 1
    library = oms_library()
    path = native3(name)
    assert library.oms_setTempDirectory(str(tmp_path).encode()) == 0
    assert library.oms_newModel(b"model") == 0
    try:
        assert library.oms_addSystem(b"model.root", WEAKLY_COUPLED) == 0
        assert library.oms_addSubModel(b"model.root.one", str(path).encode()) == 0
        assert library.oms_setFixedStepSize(b"model.root", ctypes.c_double(1e-3)) == 0
        assert library.oms_setResultFile(b"model", b"", 1) == 0
        assert library.oms_instantiate(b"model") == library.oms_initialize(b"model") == 0
        assert library.oms_stepUntil(b"model", ctypes.c_double(9.5e-3)) == 0
        component = COMPONENTS[name]()
        component.initialize(0.0)
        time = 0.0
        for _ in range(10):
            component.step(time, 1e-3)
            time += 1e-3
        value = ctypes.c_double()
        for variable in variables_of(COMPONENTS[name]):
            if variable.causality == "output" and variable.type is float:
                cref = f"model.root.one.{variable.name}".encode()
                assert library.oms_getReal(cref, ctypes.byref(value)) == 0
                # the same code; it may sum its time in another order
                assert value.value == pytest.approx(getattr(component, variable.name), rel=1e-9, abs=1e-12)
    finally:
        assert library.oms_delete(b"model") == 0
