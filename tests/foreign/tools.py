"""Our FMUs in third-party tools, and how far the results there are from those of our own runs."""

from collections.abc import Callable
from functools import partial
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from fmpy.validation import validate_fmu
from masters import ALONE, MASTERS, STEP, Signals, check_by_fmutool, demo, oms_library, ours, packed
from whole_fmus import exported

from loomfmu.components import COMPONENTS, WeftInsertion
from loomfmu.cosim.importing.built import file_of
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.instances import stem
from loomfmu.fmi.native.platforms import host

STEPS = 1000
WEFT = f"duration = {STEPS * STEP}\nstep = {STEP}\n[weft]\n"
CHAIN = f"""
revolutions = 1
steps_per_revolution = {STEPS}
record = ["shaft.*", "weft.*", "dobby.*", "heald_1.lift"]
[shaft]
speed = "600 rpm"
[weft]
machine = "WL680-3600"
[dobby]
[heald_1]
pattern = "10"
"""
FIRST = 2  # wires that start at 0 have handed over values after so many steps
DISTRIBUTIONS = {"fmpy": "FMPy", "libcosim": "libcosimpy", "ecos": "ecospy", "PyFMI": "PyFMI"}


def release(tool: str) -> str:
    """The version of a tool that is installed."""
    if tool == "OMSimulator":
        from ctypes import c_char_p

        ask = oms_library().oms_getVersion
        ask.restype = c_char_p
        return ask().decode().removeprefix("OMSimulator ").strip()
    return version(DISTRIBUTIONS.get(tool, tool))


def difference(expected: Signals, found: Signals) -> float:
    """The worst difference of a signal, by the largest value that the signal has."""
    assert expected
    worst = [
        np.max(np.abs(found[signal] - values)) / (np.max(np.abs(values)) or 1.0)
        for signal, values in expected.items()
    ]
    return float(np.max(worst))


def one(flavour: str, fmi: int, tool: str, directory: Path) -> float:
    """The weft insertion by itself."""
    path = file_of(WeftInsertion, flavour, (host(),), fmi)
    expected = ours(scenes.parse(WEFT, "weft"), directory)
    alike = {signal.partition(".")[2]: values[1:] for signal, values in expected.items()}
    return difference(alike, ALONE[tool](path, list(alike), STEPS))


def chain(fmi: int, tool: str, directory: Path) -> float:
    """A shaft that drives a weft insertion and, over a dobby, a heald frame: a system package."""
    scene = scenes.parse(CHAIN, "chain")
    expected = ours(scene, directory)
    found = MASTERS[tool](scene, packed(scene, directory, fmi))
    of_lift = {signal for signal in expected if signal.startswith("heald_1.")} - {"heald_1.lift"}  # its rates
    return difference(
        {signal: values[1 + FIRST :] for signal, values in expected.items() if signal not in of_lift},
        {signal: values[FIRST:] for signal, values in found.items()},
    )


def loom(fmi: int, tool: str, directory: Path) -> float:
    """The demo as one FMU."""
    scene = demo(STEPS)
    expected = {signal: values[1:] for signal, values in ours(scene, directory).items()}
    return difference(expected, ALONE[tool](exported(scene, directory, fmi), list(expected), STEPS))


CASES: dict[str, Callable[[str, Path], float]] = {
    "one FMU, live": partial(one, "live", 2),
    "one FMU, native": partial(one, "native", 2),
    "one FMU, native, FMI 3.0": partial(one, "native", 3),
    "package": partial(chain, 2),
    "package, FMI 3.0": partial(chain, 3),
    "whole loom": partial(loom, 2),
    "whole loom, FMI 3.0": partial(loom, 3),
}


LATE = (("libcosim", 500), ("libcosim", 1000), ("libcosim", 2000), ("ecos", 1000), ("OMSimulator", 1000))


def late(tool: str, steps: int) -> dict[str, float]:
    """The worst difference of each output of the demo as a package, over all instances of a mechanism."""
    scene = demo(steps)
    with TemporaryDirectory() as directory:
        expected = ours(scene, Path(directory))
        found = MASTERS[tool](scene, packed(scene, Path(directory)))
    worst: dict[str, float] = {}
    for signal, values in expected.items():
        owner, _, variable = signal.partition(".")
        name = f"{stem(owner)}.{variable}"
        worst[name] = max(worst.get(name, 0.0), difference({signal: values[1:]}, found))
    return worst


def tried(tool: str, case: str) -> float:
    """The worst difference of a tool in a case, by the largest value of the signal."""
    if case.startswith("package") and tool not in MASTERS:
        pytest.skip(f"{tool} does not read packages")
    with TemporaryDirectory() as directory:
        return CASES[case](tool, Path(directory))


# ---- checkers


def by_fmpy(path: Path, _fmi: int) -> None:
    """`validate_fmu` finds no fault."""
    found = validate_fmu(str(path))
    assert not found, found


CHECKERS = {"FMPy": by_fmpy, "fmu-manipulation-toolbox": check_by_fmutool}


def checked(checker: str, fmi: int) -> int:
    """The number of our native FMUs, a whole loom among them, in which a checker finds no fault."""
    with TemporaryDirectory() as directory:
        each = [file_of(component, "native", (host(),), fmi) for component in COMPONENTS.values()]
        for path in (*each, exported(demo(STEPS), Path(directory), fmi)):
            CHECKERS[checker](path, fmi)
        return len(each) + 1
