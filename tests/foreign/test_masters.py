"""Our native FMUs under third-party masters, wired by a system package, against our own master."""

from pathlib import Path

import numpy as np
import pytest
from masters import MASTERS, demo, exported_again, libcosimpy, ours, packed

from loomfmu.cosim.importing.fmus import Fmu
from loomfmu.cosim.run import run
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.ssp import read as packages

ALONE = {"speed": "600 rpm", "follow_shaft": "false"}
CHAIN = """
duration = "0.1 s"
step = "0.1 ms"
[shaft]
speed = "600 rpm"
[weft]
[dobby]
[heald_1]
pattern = "10"
"""
# power of the step with which the delay of one step on each wire shows: inputs are carried over the step with
# the rates that are known, so what has two known rates is off by the third power, and so on down
ORDERS = {
    "heald_1.lift": 3,
    "heald_1.velocity": 2,
    "heald_1.acceleration": 1,
    "damper_1.displacement": 1,
    "belt.margin": 2,
}


@pytest.mark.few(1)
@pytest.mark.usefixtures("natives")
@pytest.mark.parametrize("master", MASTERS)
def test_mechanisms_at_their_own_speed_need_no_wire(tmp_path: Path, master: str) -> None:
    changed = {f"{name}.{key}": value for name in ("weft", "dobby", "belt") for key, value in ALONE.items()}
    scene = demo(1000, **changed)
    expected, found = ours(scene, tmp_path), MASTERS[master](scene, packed(scene, tmp_path))
    compared = [signal for signal in expected if signal.startswith(("weft.", "dobby."))]
    assert len(compared) > 10
    for signal in compared:
        scale = np.max(np.abs(expected[signal]))
        # times that are added up step by step are off by some 1e-13 of the whole
        np.testing.assert_allclose(
            found[signal], expected[signal][1:], rtol=0, atol=1e-12 * scale, err_msg=signal
        )


@pytest.mark.few(1)
@pytest.mark.usefixtures("natives")
@pytest.mark.parametrize("master", ["libcosim", "ecos", "OMSimulator"])
def test_a_wired_loom_converges_to_ours_with_the_step(tmp_path: Path, master: str) -> None:
    # fmpy's master is left out: it starts all wires at 0, which the springs of the dampers do not forget
    away: dict[str, list[float]] = {signal: [] for signal in ORDERS}
    for steps in (500, 1000):
        scene = demo(steps)
        expected, found = ours(scene, tmp_path), MASTERS[master](scene, packed(scene, tmp_path))
        for signal, errors in away.items():
            difference = np.abs(found[signal] - expected[signal][1:])[steps // 500 - 1 :: steps // 500]
            errors.append(float(np.max(difference)))
    for signal, (coarse, fine) in away.items():
        assert coarse / fine == pytest.approx(2.0 ** ORDERS[signal], rel=0.2), (signal, coarse, fine)


@pytest.mark.usefixtures("natives")
def test_a_package_that_omsimulator_writes_back_gives_the_same_run(tmp_path: Path) -> None:
    scene = scenes.parse(CHAIN, "chain")
    again = packages.load(exported_again(packed(scene, tmp_path), tmp_path))
    assert again.step == scene.step == 1e-4
    expected, found = ours(scene, tmp_path), run(again, output=tmp_path / "again.h5").trace
    assert len(expected) > 20
    for signal, values in expected.items():
        np.testing.assert_array_equal(found[signal], values, err_msg=signal)


def test_libcosim_loads_every_native_fmu(natives: dict[str, Fmu]) -> None:
    cosim, slaves = libcosimpy(), []
    execution = cosim.Execution.from_step_size(int(1e5))
    for name, fmu in natives.items():
        slaves.append(cosim.Slave(fmu_path=str(fmu.path), instance_name=name))
        index = execution.add_local_slave(slaves[-1])
        # FMI Library has parsed it; libcosim knows no enumerations
        known = [port for port in fmu.ports.values() if port.base_type != "Enumeration"]
        assert execution.num_slave_variables(index) == len(known)
    assert execution.step(10)
    assert execution.num_slaves() == len(natives)
