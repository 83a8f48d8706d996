"""What a row of a sweep costs: prepared or not, beside a C loop of its steps, on one process and on two."""

import os
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import c_programs
from own import DEMO, Source
from records import Notes, Row, Table, installed, say
from start_up import MAIN, PATIENCE
from texts import Find, parts, shown, whole

import loomfmu
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.scene import Scene

NAME = "sweeps"
ROWS = "sweeps_rows"
LOOP, SWEPT = "one C loop, the steps alone", "a row of `loomfmu sweep`, one process"
ANEW, PREPARED = "`loomfmu.evaluate`, read anew", "`loom.evaluate`, prepared"
STEPS = 180  # in the one revolution of a row
LENGTH = {"revolutions": 1, "steps_per_revolution": STEPS}
SIZES = {"full": (5000, 3), "quick": (2000, 2), "tiny": (16, 1)}  # rows, repeats
AT_ONCE = {"full": 400, "quick": 40, "tiny": 2}  # rows of the comparison in one process
FEW = 8  # rows of the sweep that tells the set-up
SWEEP = """
scene = "{scene}"
flavour = "native"
[set]
revolutions = 1
steps_per_revolution = {steps}
[grid]
"shaft.speed" = {{ from = "400 rev/min", to = "700 rev/min", count = {speeds} }}
"belt.guide_clearance" = {{ from = "0.1 mm", to = "1 mm", count = 4 }}
[traces]
failures = 0
sample = 0
"""


def measure(effort: str, notes: Notes) -> list[Table]:
    """Sweeps of many rows and of few, by the command, in turn."""
    rows, repeats = SIZES[effort]
    table = Table(NAME, ("processes", "rows", "rate [rows/s]", "spread [%]", "set-up [s]", "repeats"))
    missing = [name for name in ("loomfmu.sweeps", "pyarrow") if find_spec(name) is None]
    if missing:
        notes("sweeps", f"{missing[0]} is missing")
        return [table]
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    processes = [1, 2] if cores > 1 and effort != "tiny" else [1]
    if cores < 2:
        notes("a sweep on two processes", "there is one core")
    times: dict[tuple[int, int], list[float]] = {}
    with tempfile.TemporaryDirectory(prefix="loomfmu-") as directory:
        say(f"{NAME}: {rows} rows")
        _swept(Path(directory), FEW, 1)  # FMUs are built
        for _ in range(repeats):
            for count in processes:
                for size in (FEW, rows):
                    duration = _swept(Path(directory), size, count)
                    times.setdefault((count, size), []).append(duration)
    for count in processes:
        few, many = times[count, FEW], times[count, rows]
        rates = [(rows - FEW) / (long - short) for long, short in zip(many, few, strict=True)]
        rate = median(rates)
        spread = max(abs(each - rate) for each in rates) / rate
        table.add(count, rows, rate, 100.0 * spread, median(few) - FEW / rate, repeats)
    return [table, _rows(effort, repeats, table.rows[0]["rate [rows/s]"], notes)]


class Loop(Source):
    """The demonstration loom with the steps of a row, whatever number is asked for."""

    def scene(self, steps: int = STEPS, turns: float = 1.0) -> Scene:
        return super().scene(STEPS, turns)


def _rows(effort: str, repeats: int, rate: float, notes: Notes) -> Table:
    """A row in different ways, in turn: the same speeds for all, the C loop at the middle one."""
    table = Table(ROWS, ("what", "a row [ms]", "over the C loop", "repeats"))
    count = AT_ONCE[effort]
    scene = scenes.load(DEMO, LENGTH)
    loom = loomfmu.prepare(scene, flavour="native")
    ways: dict[str, Any] = {
        ANEW: lambda given: loomfmu.evaluate(scene, set=LENGTH | given, flavour="native", errors="near"),
        PREPARED: lambda given: loom.evaluate(given, errors="near"),  # as a sweep does
    }
    found: dict[str, list[float]] = {name: [] for name in (LOOP, *ways)}
    with tempfile.TemporaryDirectory(prefix="loomfmu-") as directory:
        try:
            source = Loop(DEMO.read_text(encoding="utf-8"), {"shaft.speed": "550 rpm"})
            program = c_programs.loop(source, Path(directory))
        except RuntimeError as error:
            notes(LOOP, str(error))
            return table
        for _ in range(max(5, repeats)):
            found[LOOP].append(median(program.seconds(STEPS) for _ in range(9)))
            for name, evaluate in ways.items():
                start = perf_counter()
                for number in range(count):
                    evaluate({"shaft.speed": f"{400.0 + 300.0 * number / count} rpm"})
                found[name].append((perf_counter() - start) / count)
    medians = {name: median(times) for name, times in found.items()} | {SWEPT: 1.0 / rate}
    for name, seconds in medians.items():
        table.add(name, 1e3 * seconds, seconds / medians[LOOP], len(found.get(name, ())) or repeats)
    return table


def _swept(directory: Path, rows: int, processes: int) -> float:
    """Seconds for a sweep of so many rows, from the command to its end."""
    path = directory / f"sweep_{rows}.toml"
    text = SWEEP.format(scene=DEMO.as_posix(), steps=STEPS, speeds=rows // 4)
    path.write_text(text, encoding="utf-8")
    words = [
        "sweep",
        str(path),
        "--processes",
        str(processes),
        "--output",
        str(directory / "out"),
        "--restart",
    ]
    start = perf_counter()
    run = subprocess.run(
        [sys.executable, "-c", MAIN, *words],
        env=installed(),
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
    )
    duration = perf_counter() - start
    if run.returncode not in (0, 1):  # 1: in some rows a claim fails
        raise RuntimeError(f"loomfmu sweep: {run.stderr.strip()[-300:]}")
    return duration


# ---- what is said of it


def section(find: Find) -> str:
    """Rows in a second."""
    rows = find(NAME)
    gain = ""
    if len(rows) == 2:
        one, two = ([row["rate [rows/s]"], _whole(row)] for row in rows)
        gain = (
            f"Of {rows[0]['rows']:.0f} rows two processes do {shown(two[0] / one[0])} times as many a second"
            f" as one; with the set-up they are done {shown(one[1] / two[1])} times as soon."
        )
    return parts(
        f"`loomfmu sweep` over speed and clearance of the demonstration loom: one revolution of {STEPS} steps"
        " in each row, judged in memory, native FMUs. The rate is that of many rows less few; the set-up is"
        " what the command takes beside them.",
        whole(rows),
        gain,
        "What a row costs, in milliseconds, beside the steps of all its FMUs as one C loop, which judges"
        " nothing. `loomfmu.prepare` does once what does not depend on values; `loomfmu.evaluate` does it for"
        " each row.",
        whole(find(ROWS)),
    )


def _whole(row: Row) -> float:
    """Seconds for all rows, the set-up included."""
    return float(row["set-up [s]"] + row["rows"] / row["rate [rows/s]"])
