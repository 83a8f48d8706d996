"""FMUs of other makers: our results beside those of fmpy in equal steps, to the tolerance that they state."""

import importlib.util
import re
from collections.abc import Callable
from contextlib import redirect_stdout, suppress
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import fmpy
import numpy as np
from tools import difference

from loomfmu.cosim.importing import fmus
from loomfmu.cosim.importing.fmus import Fmu
from loomfmu.cosim.importing.ports import Port
from loomfmu.cosim.run import run
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.traces.reader import Trace

MOST = 1000  # steps
OFFERS = {"CS": "coSimulation", "ME": "modelExchange", "SE": "scheduledExecution"}
MAKERS = ("pythonfmu", "pythonfmu3")  # whose own examples are built


def made(directory: Path) -> list[Path]:
    """The examples of the packages that make FMUs of Python, where these are installed."""
    found = []
    for maker in MAKERS:
        spec = importlib.util.find_spec(maker)
        if spec is None or spec.origin is None:
            continue
        builder = importlib.import_module(f"{maker}.builder").FmuBuilder
        target = directory / maker
        target.mkdir(parents=True, exist_ok=True)
        for script in sorted((Path(spec.origin).parent / "tests" / "slaves").glob("*.py")):
            if "Slave)" in script.read_text():
                with redirect_stdout(StringIO()), suppress(FileNotFoundError):  # some want data beside them
                    found.append(Path(builder.build_FMU(script, dest=target)))
    return found


def about(path: Path) -> dict[str, str]:
    """What an FMU says of itself."""
    try:
        description = fmpy.read_model_description(str(path), validate=False)
    except Exception:  # which the trial will say
        return {}
    letters = [letter for letter, kind in OFFERS.items() if getattr(description, kind, None)]
    return {
        "maker": description.generationTool or "",
        "FMI": description.fmiVersion,
        "offers": " ".join(letters),
    }


def experiment(description: Any) -> tuple[float, int]:
    """The step and the number of steps: those of the default experiment, at most `MOST`."""
    said = description.defaultExperiment
    number: Callable[[str], float] = lambda name: float(getattr(said, name, None) or 0.0)  # noqa: E731
    end = number("stopTime") - number("startTime")
    end = end if 1e-9 < end < 1e9 else 1.0  # some state nonsense
    internal = getattr(description.coSimulation, "fixedInternalStepSize", None)
    step = number("stepSize") or float(internal or 0.0) or end / 500
    return step, max(1, min(round(end / step), MOST))


def our_run(path: Path, step: float, steps: int, directory: Path) -> tuple[Fmu, Trace]:
    """An FMU by itself in a scene of ours."""
    text = f'duration = {step * steps!r}\nstep = {step!r}\nrecord = ["one.*"]\n[one]\nfmu = "{path}"\n'
    scene = scenes.parse(text, "one")
    return scene.instances["one"].fmu, run(scene, output=directory / "ours.h5").trace


def fmpys_run(path: Path, fmu: Fmu, step: float, steps: int, outputs: list[str]) -> Any:
    """The same by fmpy, which ends an FMU that asks for it as we do."""
    return fmpy.simulate_fmu(
        str(path),
        validate=False,
        start_time=0.0,
        stop_time=step * steps,
        output_interval=step,
        output=outputs,
        relative_tolerance=fmu.tolerance,
        fmi_type="ModelExchange" if fmu.exchange else "CoSimulation",
        record_events=False,
    )


def column(rows: Any, port: Port) -> Any:
    """The values of a variable, or of an element of an array, in the result of fmpy."""
    if not port.array:
        return np.asarray(rows[port.own], float)
    places = re.findall(r"\d+", port.own.removeprefix(port.array))
    return np.asarray(rows[port.array], float)[:, *(int(each) - 1 for each in places)]


def compared(path: Path, say: Callable[[dict[str, Any]], None]) -> None:
    """Say what our run of an FMU comes to, then how far that of fmpy is from it."""
    fmus.load(path)
    step, steps = experiment(fmpy.read_model_description(str(path), validate=False))
    with TemporaryDirectory() as directory:
        fmu, trace = our_run(path, step, steps, Path(directory))
        ports = {each: port for each, port in fmu.ports.items() if f"one.{each}" in trace}
        say({"steps": len(trace.time) - 1, "signals": len(ports)})
        outputs = list(dict.fromkeys(port.array or port.own for port in ports.values()))
        rows = fmpys_run(path, fmu, step, steps, outputs)
        count = min(len(rows), len(trace.time))
        expected = {each: column(rows, port)[:count] for each, port in ports.items()}
        found = {each: np.asarray(trace[f"one.{each}"], float)[:count] for each in ports}
        say({"difference": difference(expected, found)})
