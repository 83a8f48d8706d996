"""What it takes until the first step: imports, the command, FMUs that are there and FMUs that are not."""

import os
import re
import subprocess
import sys
import tempfile
from collections import defaultdict
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from time import perf_counter

from own import DEMO
from records import Notes, Table, say
from texts import Figures, Find, parts, whole

NAME = "start_up"
REPEATS = {"full": 7, "quick": 2, "tiny": 1}
MAIN = "import sys; from loomfmu.cli import main; sys.exit(main())"
IMPORT = "import loomfmu.cosim.run"  # what a run imports
LINE = re.compile(r"import time: +(\d+) \| +\d+ \| +(\S+)")
MOST = 12  # packages that are named

Command = Callable[[Path, int], tuple[list[str], dict[str, str]]]  # directory, turn -> command, environment


def _python(code: str, *arguments: str) -> Command:
    return lambda _directory, _turn: ([sys.executable, "-c", code, *arguments], {})


def _run(native: bool, cold: bool) -> Command:
    def command(directory: Path, turn: int) -> tuple[list[str], dict[str, str]]:
        words = ["run", str(DEMO), "--output", str(directory / "trace.h5"), *([] if native else ["--live"])]
        cache = {"LOOMFMU_CACHE": str(directory / f"cache {native} {turn}")} if cold else {}
        return [sys.executable, "-c", MAIN, *words], cache

    return command


COMMANDS: dict[str, Command] = {
    "python, doing nothing": _python("pass"),
    "import loomfmu": _python("import loomfmu"),
    "import of numpy, h5py and fmpy": _python("import numpy, h5py, fmpy"),
    "import of all that a run needs": _python(IMPORT),
    "loomfmu --help": _python(MAIN, "--help"),
    "loomfmu run, live FMUs in the cache": _run(native=False, cold=False),
    "loomfmu run, live FMUs built": _run(native=False, cold=True),
}
NATIVE: dict[str, Command] = {
    "loomfmu run, native FMUs in the cache": _run(native=True, cold=False),
    "loomfmu run, native FMUs built": _run(native=True, cold=True),
}
ONCE = "loomfmu run, native FMUs built"  # it takes a compiler half a minute


def measure(effort: str, notes: Notes) -> list[Table]:
    """Each command in turn, in a process of its own; the imports of a run."""
    chosen = dict(COMMANDS)
    if effort == "tiny":
        chosen = {name: chosen[name] for name in list(chosen)[:4]}
    elif find_spec("ziglang"):
        chosen |= NATIVE
        notes(ONCE, "timed once" if effort == "full" else "left out of a quick run")
        if effort == "quick":
            del chosen[ONCE]
    else:
        notes("native FMUs", "ziglang is not installed")
    table = Table(NAME, ("what", "time [ms]", "spread [%]", "repeats"))
    with tempfile.TemporaryDirectory(prefix="loomfmu-") as directory:
        for name, times in _in_turn(chosen, REPEATS[effort], Path(directory)).items():
            centre = median(times)
            spread = max(abs(time - centre) for time in times) / centre
            table.add(name, 1e3 * centre, 100.0 * spread, len(times))
    return [table, _imports()]


def _in_turn(commands: dict[str, Command], repeats: int, directory: Path) -> dict[str, list[float]]:
    times: dict[str, list[float]] = {name: [] for name in commands}
    for name, command in commands.items():  # caches of the disk are warm, FMUs are built
        if "built" not in name:
            _timed(command, directory, -1)
    for turn in range(repeats):
        say(f"{NAME}: round {turn + 1}")
        for name, command in commands.items():
            if turn == 0 or name != ONCE:
                times[name].append(_timed(command, directory, turn))
    return times


def _timed(command: Command, directory: Path, turn: int) -> float:
    words, environment = command(directory, turn)
    start = perf_counter()
    run = subprocess.run(words, env=os.environ | environment, capture_output=True, text=True, check=False)
    duration = perf_counter() - start
    if run.returncode != 0:
        raise RuntimeError(f"{' '.join(words[3:])}: {run.stderr.strip()[-200:]}")
    return duration


def _imports() -> Table:
    """Time of the imports of a run, each package with all its modules, as `python -X importtime` tells it."""
    words = [sys.executable, "-X", "importtime", "-c", IMPORT]
    text = subprocess.run(words, capture_output=True, text=True, check=True).stderr
    found: dict[str, list[int]] = defaultdict(list)
    for own, module in LINE.findall(text):
        name = module.split(".")[0]
        found["standard library" if name in sys.stdlib_module_names else name].append(int(own))
    table = Table("imports", ("package", "modules", "time [ms]"))
    ranked = sorted(found.items(), key=lambda item: -sum(item[1]))
    for name, times in ranked[:MOST]:
        table.add(name, len(times), 1e-3 * sum(times))
    others = [time for _name, times in ranked[MOST:] for time in times]
    if others:
        table.add("others", len(others), 1e-3 * sum(others))
    return table


# ---- what is said of it


def section(find: Find) -> str:
    """Times until the first step."""
    return parts(
        "Each command in a process of its own; `loomfmu run` is the demonstration loom of three revolutions"
        " with its trace and its claims. Live FMUs are packed when they are built, native ones translated and"
        " compiled.",
        whole(find(NAME)),
        "What a run imports, by package with all its modules, as `python -X importtime` tells it:",
        whole(find("imports")),
    )


def figures(find: Find) -> Figures:
    """None."""
    return {}
