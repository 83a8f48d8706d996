"""What it takes until the first step: imports, the command, FMUs that are there and FMUs that are not."""

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
from records import Notes, Table, installed, say
from texts import Find, parts, shown, whole

from loomfmu.fmi.native import platforms

NAME = "start_up"
REPEATS = {"full": 7, "quick": 2, "tiny": 1}
MAIN = "import sys; from loomfmu.cli import main; sys.exit(main())"
IMPORT = "import loomfmu.cosim.run"  # what a run imports
LINE = re.compile(r"import time: +(\d+) \| +\d+ \| +(\S+)")
MOST = 12  # packages that are named
TRACE = "trace.h5"

BASE = "import of numpy, h5py and fmpy"
RUN, IN_PYTHON = "loomfmu run, native FMUs in the cache", "loomfmu.run in Python, native FMUs in the cache"
HERE, EVERYWHERE = "all native FMUs built for this platform", "all native FMUs built for all platforms"
RUN_BUILT = "loomfmu run, native FMUs built"
ONCE = (RUN_BUILT, HERE, EVERYWHERE)  # compilers take seconds to minutes
PATIENCE = 900.0  # s that a command may take

Command = Callable[[Path, int], tuple[list[str], dict[str, str]]]  # directory, turn -> command, environment


def _python(code: str, *arguments: str) -> Command:
    return lambda _directory, _turn: ([sys.executable, "-c", code, *arguments], {})


def _command(*words: str) -> list[str]:
    return [sys.executable, "-c", MAIN, *words]


def _run(native: bool, cold: bool) -> Command:
    def command(directory: Path, turn: int) -> tuple[list[str], dict[str, str]]:
        live = [] if native else ["--live"]
        cache = {"LOOMFMU_CACHE": str(directory / f"cache {native} {turn}")} if cold else {}
        return _command("run", str(DEMO), "--output", str(directory / TRACE), *live), cache

    return command


def _in_python(directory: Path, _turn: int) -> tuple[list[str], dict[str, str]]:
    code = "import sys, loomfmu; loomfmu.run(sys.argv[1], output=sys.argv[2])"
    return [sys.executable, "-c", code, str(DEMO), str(directory / TRACE)], {}


def _build(*options: str) -> Command:
    """All native FMUs, none of which is in the cache; the compiler has the system's libraries in its own."""

    def command(directory: Path, _turn: int) -> tuple[list[str], dict[str, str]]:
        output = directory / "built"
        words = _command("build", "--native", *options, "--output", str(output), "--force")
        return words, {"LOOMFMU_CACHE": str(directory / " ".join(["cache", *options]))}

    return command


COMMANDS: dict[str, Command] = {
    "python, doing nothing": _python("pass"),
    "import loomfmu": _python("import loomfmu"),
    BASE: _python("import numpy, h5py, fmpy"),
    "import of all that a run needs": _python(IMPORT),
    "loomfmu --help": _python(MAIN, "--help"),
    "loomfmu run, live FMUs in the cache": _run(native=False, cold=False),
    "loomfmu run, live FMUs built": _run(native=False, cold=True),
}
NATIVE: dict[str, Command] = {
    RUN: _run(native=True, cold=False),
    IN_PYTHON: _in_python,
    "loomfmu show of its trace": lambda directory, _turn: (_command("show", str(directory / TRACE)), {}),
    "loomfmu limit of the demo's speed": _python(
        MAIN, "limit", str(DEMO), "--vary", "shaft.speed=300rpm..900rpm"
    ),
    RUN_BUILT: _run(native=True, cold=True),
    HERE: _build("--platform", platforms.host()),
    EVERYWHERE: _build(),
}


def measure(effort: str, notes: Notes) -> list[Table]:
    """Each command in turn, in a process of its own; the imports of a run."""
    chosen = dict(COMMANDS)
    if effort == "tiny":
        chosen = {name: chosen[name] for name in list(chosen)[:4]}
    elif find_spec("ziglang"):
        chosen |= NATIVE
        for name in ONCE:
            notes(name, "timed once" if effort == "full" else "left out of a quick run")
            if effort == "quick":
                del chosen[name]
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
            if turn == 0 or name not in ONCE:
                times[name].append(_timed(command, directory, turn))
    return times


def _timed(command: Command, directory: Path, turn: int) -> float:
    words, environment = command(directory, turn)
    start = perf_counter()
    run = subprocess.run(
        words, env=installed() | environment, capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    duration = perf_counter() - start
    if run.returncode != 0:
        raise RuntimeError(f"{' '.join(words[3:])}: {run.stderr.strip()[-200:]}")
    return duration


def _imports() -> Table:
    """Time of the imports of a run, each package with all its modules, as `python -X importtime` tells it."""
    words = [sys.executable, "-X", "importtime", "-c", IMPORT]
    text = subprocess.run(words, env=installed(), capture_output=True, text=True, check=True).stderr
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
    rows = find(NAME)
    times = {row["what"]: row["time [ms]"] for row in rows}
    ratios = {
        name: shown(times[name] / times[BASE]) for name in (RUN, IN_PYTHON) if {name, BASE} <= set(times)
    }
    over = [f"- {name}: {ratio} times the {BASE}" for name, ratio in ratios.items()]
    return parts(
        "Each command in a process of its own; `loomfmu run` is the demonstration loom of three revolutions"
        " with its trace and its claims. Live FMUs are packed when they are built, native ones translated and"
        " compiled. Files in the cache are compared to the last byte before they are used, and `loomfmu show`"
        " checks the trace in a process of its own: the times contain it. Python keeps its bytecode, as of an"
        " installed package.",
        whole(rows),
        "\n".join(over),
        "What a run imports, by package with all its modules, as `python -X importtime` tells it:",
        whole(find("imports")),
    )
