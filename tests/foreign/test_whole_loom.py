"""A whole loom as one FMU under third-party masters: the bits of our own run."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from fmpy.validation import validate_fmu
from masters import Signals, check_by_fmutool, demo, ecospy, libcosimpy, ours
from whole_fmus import Whole, exported

from loomfmu.cosim.importing.fmus import Fmu
from loomfmu.cosim.scenes import scene as scenes

STEPS = 1000  # in a revolution of 0.1 s: a step is a whole number of nanoseconds
LOOPED = Path(__file__).parents[2] / "sims" / "light_shaft.toml"  # whose loop is iterated inside
SPEED = {"shaft.speed": "600 rpm", "steps_per_revolution": STEPS, "revolutions": 1}
Stepped = Callable[[Path, list[str], dict[str, int]], Signals]


def libcosim(path: Path, signals: list[str], references: dict[str, int]) -> Signals:
    cosim = libcosimpy()
    execution = cosim.Execution.from_step_size(int(1e5))
    index = execution.add_local_slave(slave := cosim.Slave(fmu_path=str(path), instance_name="loom"))
    observer = cosim.Observer.create_last_value()
    assert slave and execution.add_observer(observer)
    rows = []
    for _ in range(STEPS):
        assert execution.step(1)
        rows.append(observer.last_real_values(index, [references[signal] for signal in signals]))
    return dict(zip(signals, np.array(rows).T, strict=True))


def ecos(path: Path, signals: list[str], _references: dict[str, int]) -> Signals:
    ecos, rows = ecospy(), []
    with ecos.EcosSimulationStructure() as structure:
        structure.add_model("loom", path)
        with ecos.EcosSimulation(step_size=1e-4, structure=structure) as simulation:
            assert simulation.init()
            for _ in range(STEPS):
                simulation.step(1)
                rows.append([simulation.get_real(f"loom::{signal}") for signal in signals])
            simulation.terminate()
    return dict(zip(signals, np.array(rows).T, strict=True))


@pytest.mark.few(1)
@pytest.mark.usefixtures("natives")
@pytest.mark.parametrize("master", [libcosim, ecos], ids=lambda master: master.__name__)
@pytest.mark.parametrize("looped", [False, True])
def test_it_gives_our_bits(tmp_path: Path, master: Stepped, looped: bool) -> None:
    scene = scenes.load(LOOPED, SPEED) if looped else demo(STEPS)
    one = Whole(exported(scene, tmp_path), tmp_path / "unpacked")
    expected = ours(scene, tmp_path)
    references = {signal: one.variables[signal].valueReference for signal in expected}
    found = master(one.path, list(expected), references)
    for signal, values in found.items():
        np.testing.assert_array_equal(values, expected[signal][1:], err_msg=signal)


@pytest.mark.slow
@pytest.mark.parametrize("fmi", [2, 3])
def test_checkers_find_no_fault(natives: dict[str, Fmu], tmp_path: Path, fmi: int) -> None:
    path = exported(demo(STEPS), tmp_path, fmi)
    assert validate_fmu(str(path)) == []
    check_by_fmutool(path, fmi)
