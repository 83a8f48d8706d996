"""Tools that cannot be installed from wheels on every machine. They were not run when this was written.

PyFMI comes as wheels for few versions of Python (conda has it for all); the OMSimulator package fetches its
binaries from elsewhere when it is installed.
"""

from pathlib import Path

import numpy as np
import pytest
from masters import demo, ours, packed

from loomfmu.components import WeftInsertion
from loomfmu.cosim.fmus import Fmu

SPEED = 20.0 * np.pi  # 600 rev/min


def test_pyfmi_runs_the_weft_at_its_own_speed(
    natives: dict[str, Fmu], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pyfmi = pytest.importorskip("pyfmi", reason="pyfmi is not installed: it has no wheel for this Python")
    monkeypatch.chdir(tmp_path)  # it writes its log and its result where it stands
    model = pyfmi.load_fmu(str(natives["WeftInsertion"].path), kind="CS")
    model.set("speed", SPEED)
    options = model.simulate_options()
    options["ncp"] = 1000
    found = model.simulate(start_time=0.0, final_time=0.1, options=options)
    weft = WeftInsertion(speed=SPEED)
    for time, travel in zip(found["time"], found["travel"], strict=True):
        assert weft.initialize(float(time)) == 0
        assert travel == pytest.approx(weft.travel, rel=1e-12, abs=1e-12)


@pytest.mark.usefixtures("natives")
def test_omsimulator_runs_the_package(tmp_path: Path) -> None:
    module = pytest.importorskip(
        "OMSimulator",
        reason="OMSimulator is not installed: its package fetches binaries when it is installed",
    )
    changed = {f"{name}.follow_shaft": "false" for name in ("weft", "dobby")}
    scene = demo(1000, **changed, weft__speed="600 rpm", dobby__speed="600 rpm")
    expected = ours(scene, tmp_path)
    simulator = module.OMSimulator()
    simulator.setTempDirectory(str(tmp_path))
    model, status = simulator.importFile(str(packed(scene, tmp_path)))
    assert status == 0
    simulator.setResultFile(model, "")
    assert simulator.instantiate(model) == 0 and simulator.initialize(model) == 0
    for row in range(1, scene.steps + 1):
        assert simulator.stepUntil(model, row * scene.step_size) == 0
        for signal in ("weft.travel", "dobby.lift_fraction"):
            value, status = simulator.getReal(f"{model}.{scene.name}.{signal}")
            assert status == 0 and value == pytest.approx(expected[signal][row], rel=1e-9, abs=1e-9)
    simulator.terminate(model)
