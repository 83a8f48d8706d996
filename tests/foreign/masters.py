"""System packages and single FMUs in third-party masters. Each returns real outputs along the steps."""

import contextlib
import ctypes
import subprocess
import sys
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from numpy.typing import NDArray

from loomfmu.cosim.run import run
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.cosim.ssp import export as ssp
from loomfmu.fmi.native.platforms import host

DEMO = Path(__file__).parents[2] / "sims" / "wl680_3600.toml"
Signals = dict[str, NDArray[np.float64]]
Master = Callable[[Scene, Path], Signals]


def demo(steps: int, **changed: Any) -> Scene:
    """One revolution of the demonstration in 0.1 s: a step is a whole number of nanoseconds."""
    overrides = {key.replace("__", "."): value for key, value in changed.items()}
    return scenes.load(DEMO, {"revolutions": 1, "steps_per_revolution": steps} | overrides)


def ours(scene: Scene, directory: Path) -> Signals:
    """The recorded ones of a scene by our master, which has no delay on any wire."""
    trace = run(scene, output=directory / "ours.h5", flavour="native").trace
    return {signal: trace[signal] for signal in reals(scene) if signal in trace}


def reals(scene: Scene) -> list[str]:
    """All real outputs."""
    return [
        f"{name}.{port.name}"
        for name, instance in scene.instances.items()
        for port in instance.fmu.ports.values()
        if port.causality == "output" and port.kind == "Real"
    ]


def packed(scene: Scene, directory: Path, fmi: int = 2) -> Path:
    """The scene as a system package with native FMUs."""
    path = directory / f"{scene.name}.ssp"
    ssp.export(scene, path, "native", (host(),), fmi=fmi)
    return path


# ---- the masters; each runs the package of a scene


def libcosimpy() -> SimpleNamespace:
    """What the tests use of libcosim, which logs errors alone."""
    pytest.importorskip("libcosimpy", reason="libcosimpy is not installed")
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.ERROR)
    return SimpleNamespace(Execution=CosimExecution, Observer=CosimObserver, Slave=CosimLocalSlave)


def libcosim(scene: Scene, package: Path) -> Signals:
    """libcosim reads the package and the step in it."""
    cosim = libcosimpy()
    execution = cosim.Execution.from_ssp_file(str(package))
    observer = cosim.Observer.create_last_value()
    assert execution.add_observer(observer)
    indices = {info.name.decode(): info.index for info in execution.slave_infos()}
    ports = {name: instance.fmu.ports for name, instance in scene.instances.items()}
    rows = {signal: [] for signal in reals(scene)}
    for _ in range(scene.steps):
        assert execution.step(1)
        for signal, values in rows.items():
            name, variable = signal.split(".")
            values += observer.last_real_values(indices[name], [ports[name][variable].reference])
    return {signal: np.array(values) for signal, values in rows.items()}


def ecospy() -> ModuleType:
    """ecos; it is linked to a library that `pip install tbb4u` puts where the loader does not look."""
    with contextlib.suppress(ImportError, OSError):
        import tbb4u

        ctypes.CDLL(str(Path(tbb4u.__file__).with_name("libtbb.so.12")), ctypes.RTLD_GLOBAL)
    try:
        import ecospy
        from ecospy.lib import EcosLib
    except (ImportError, OSError) as error:
        pytest.skip(f"ecospy cannot be loaded: {error}")
    EcosLib.set_log_level("off")
    return ecospy


def ecos(scene: Scene, package: Path) -> Signals:
    """ecos reads the package, and takes the parameter sets of one name."""
    rows = {signal: [] for signal in reals(scene)}
    with ecospy().EcosSimulation(step_size=scene.step_size, ssp_path=str(package)) as simulation:
        assert simulation.init(parameter_set=ssp.SET_NAME)
        for _ in range(scene.steps):
            simulation.step(1)
            for signal, values in rows.items():
                values.append(simulation.get_real(signal.replace(".", "::")))
        simulation.terminate()
    return {signal: np.array(values) for signal, values in rows.items()}


def fmpy_rows(scene: Scene, package: Path, steps: int) -> Any:
    """Rows by fmpy, which reads no parameters, and stamps each with the time before its step."""
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import Parameter, ParameterSet

    values = [
        Parameter(name=f"{name}.{instance.fmu.ports[variable].own}", type="Real", value=float(value))
        for name, instance in scene.instances.items()
        for variable, value in instance.values.items()
        if variable != "inputs_at_step_end"
    ]
    return simulate_ssp(
        str(package),
        stop_time=(steps - 0.5) * scene.step_size,
        step_size=scene.step_size,
        parameter_set=ParameterSet(parameters=values),
    )


def fmpy(scene: Scene, package: Path) -> Signals:
    rows = fmpy_rows(scene, package, scene.steps)
    return {signal: rows[signal] for signal in reals(scene)}


def oms_library() -> ctypes.CDLL:
    """OMSimulator's C functions, which its command and OMEdit call. Its Python classes go other ways."""
    module = pytest.importorskip(
        "OMSimulator", reason="OMSimulator is not installed: its package fetches binaries, or it is built"
    )
    folder = Path(module.__file__).parent
    places = (folder / "libOMSimulator.so", folder.parent / "libOMSimulator.so")
    return ctypes.CDLL(str(next(place for place in places if place.exists())))


def omsimulator(scene: Scene, package: Path) -> Signals:
    """OMSimulator imports the package, with its master, its step and its values."""
    library, model = oms_library(), ctypes.c_char_p()
    assert library.oms_setTempDirectory(str(package.parent).encode()) == 0
    assert library.oms_importFile(str(package).encode(), ctypes.byref(model)) == 0
    assert model.value is not None
    rows = {signal: [] for signal in reals(scene)}
    crefs = {signal: f"{model.value.decode()}.{scene.name}.{signal}".encode() for signal in rows}
    value = ctypes.c_double()
    assert library.oms_setResultFile(model, b"", 1) == 0
    assert library.oms_instantiate(model) == library.oms_initialize(model) == 0
    for step in range(1, scene.steps + 1):
        # it takes whole steps until it is there: half of one before, rounding decides nothing
        assert library.oms_stepUntil(model, ctypes.c_double((step - 0.5) * scene.step_size)) == 0
        for signal, values in rows.items():
            assert library.oms_getReal(crefs[signal], ctypes.byref(value)) == 0
            values.append(value.value)
    assert library.oms_terminate(model) == library.oms_delete(model) == 0
    return {signal: np.array(values) for signal, values in rows.items()}


def exported_again(package: Path, directory: Path) -> Path:
    """A package that OMSimulator has read and written."""
    library, model, path = oms_library(), ctypes.c_char_p(), directory / "again.ssp"
    assert library.oms_setTempDirectory(str(directory).encode()) == 0
    assert library.oms_importFile(str(package).encode(), ctypes.byref(model)) == 0
    assert library.oms_export(model, str(path).encode()) == library.oms_delete(model) == 0
    return path


MASTERS: dict[str, Master] = {"libcosim": libcosim, "ecos": ecos, "fmpy": fmpy, "OMSimulator": omsimulator}


# ---- the same, and PyFMI, with one FMU by itself

STEP = 1e-4  # [s], a whole number of nanoseconds
WEAKLY_COUPLED = 1  # oms_system_wc
Alone = Callable[[Path, Sequence[str], int], Signals]


def libcosim_alone(path: Path, signals: Sequence[str], steps: int) -> Signals:
    cosim = libcosimpy()
    described = read_model_description(str(path), validate=False)
    references = {each.name: each.valueReference for each in described.modelVariables}
    execution = cosim.Execution.from_step_size(round(1e9 * STEP))
    index = execution.add_local_slave(slave := cosim.Slave(fmu_path=str(path), instance_name="one"))
    observer = cosim.Observer.create_last_value()
    assert slave and execution.add_observer(observer)
    rows = []
    for _ in range(steps):
        assert execution.step(1)
        rows.append(observer.last_real_values(index, [references[signal] for signal in signals]))
    return dict(zip(signals, np.array(rows).T, strict=True))


def ecos_alone(path: Path, signals: Sequence[str], steps: int) -> Signals:
    tool, rows = ecospy(), []
    with tool.EcosSimulationStructure() as structure:
        structure.add_model("one", path)
        with tool.EcosSimulation(step_size=STEP, structure=structure) as simulation:
            assert simulation.init()
            for _ in range(steps):
                simulation.step(1)
                rows.append([simulation.get_real(f"one::{signal}") for signal in signals])
            simulation.terminate()
    return dict(zip(signals, np.array(rows).T, strict=True))


def fmpy_alone(path: Path, signals: Sequence[str], steps: int) -> Signals:
    rows = simulate_fmu(
        path, stop_time=steps * STEP, output_interval=STEP, output=list(signals), fmi_type="CoSimulation"
    )
    return {signal: rows[signal][1:] for signal in signals}


def omsimulator_alone(path: Path, signals: Sequence[str], steps: int) -> Signals:
    library, value = oms_library(), ctypes.c_double()
    assert library.oms_setTempDirectory(str(path.parent).encode()) == 0
    assert library.oms_newModel(b"model") == 0
    rows: dict[str, list[float]] = {signal: [] for signal in signals}
    try:
        assert library.oms_addSystem(b"model.root", WEAKLY_COUPLED) == 0
        assert library.oms_addSubModel(b"model.root.one", str(path).encode()) == 0
        assert library.oms_setFixedStepSize(b"model.root", ctypes.c_double(STEP)) == 0
        assert library.oms_setResultFile(b"model", b"", 1) == 0
        assert library.oms_instantiate(b"model") == library.oms_initialize(b"model") == 0
        for step in range(1, steps + 1):
            # it takes whole steps until it is there: half of one before, rounding decides nothing
            assert library.oms_stepUntil(b"model", ctypes.c_double((step - 0.5) * STEP)) == 0
            for signal, values in rows.items():
                assert library.oms_getReal(f"model.root.one.{signal}".encode(), ctypes.byref(value)) == 0
                values.append(value.value)
    finally:
        assert library.oms_delete(b"model") == 0
    return {signal: np.array(values) for signal, values in rows.items()}


def pyfmi_alone(path: Path, signals: Sequence[str], steps: int) -> Signals:
    pyfmi = pytest.importorskip("pyfmi", reason="PyFMI is not installed: it has no wheel for this Python")
    with contextlib.chdir(path.parent):  # it writes its log and its result where it stands
        model = pyfmi.load_fmu(str(path), kind="CS")
        options = model.simulate_options()
        options["ncp"] = steps
        found = model.simulate(start_time=0.0, final_time=steps * STEP, options=options)
        return {signal: np.array(found[signal])[1:] for signal in signals}


ALONE: dict[str, Alone] = {
    "libcosim": libcosim_alone,
    "ecos": ecos_alone,
    "fmpy": fmpy_alone,
    "OMSimulator": omsimulator_alone,
    "PyFMI": pyfmi_alone,
}


# ---- the checkers


def check_by_fmutool(path: Path, fmi: int = 2) -> None:
    """The checker of the FMU manipulation toolbox finds no fault in an FMU."""
    if find_spec("fmu_manipulation_toolbox") is None:
        pytest.skip("fmu-manipulation-toolbox is not installed")
    command = [Path(sys.executable).with_name("fmutool"), "-input", path, "-check"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    said = done.stdout + done.stderr
    assert done.returncode == 0, said
    assert f"This FMU seems to be compliant with FMI-{fmi}.0." in said
    assert "WARNING" not in said and "ERROR" not in said, said
    if fmi == 2:
        assert "No semantic error against the FMI-2 standard." in said
