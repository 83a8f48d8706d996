"""How near the co-simulation comes to what the mathematics alone costs."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import c_programs
import numpy as np
from children import Task, Timing, children, in_turn, middle, spread
from own import ENGINES, Ours, Source, Stepped, demo
from records import Notes, Table, say
from scaling import WEFT
from texts import Find, error, parts, shown, table

import loomfmu

NAME = "limits"
STEPS = 1440  # in a revolution
SIZES: dict[str, tuple[int, float]] = {"full": (7, 8.0), "quick": (3, 2.0), "tiny": (1, 0.1)}
LOOP, HOST = "one C loop", "native FMUs under a plain C host"
WHOLE = "the loom as one FMU under a plain C host"
WITHOUT = "one C loop, without dampers"
STEP = "step [us]"
COLUMNS = ("what", "outputs", "step [us]", "spread [%]", "repeats", "largest difference [share]")


class InC:
    """A scene as a C program; `make` is `c_programs.loop`, `c_programs.host` or `c_programs.whole_fmu`."""

    def __init__(self, directory: Path, make: Any, source: Source):
        self.source = source
        self.program = make(source, directory)

    def time(self, steps: int, turns: float) -> Timing:
        """Seconds for a revolution. The program is compiled for one number of steps in it."""
        return Timing(0.0, self.program.seconds(round(steps * turns)) / turns)

    def path(self) -> Path:
        """The program's file."""
        return self.program.path

    def difference(self, steps: int, directory: Path) -> tuple[int, float]:
        """Number of outputs, and largest difference from those of the native FMUs under our master.

        The difference is a share of each output's largest value; 0 means that all bits are equal.
        """
        found = self.program.trace(steps)
        result = loomfmu.run(self.source.scene(steps), output=directory / "native.h5", flavour="native")
        largest = 0.0
        for name, values in found.items():
            ours = np.asarray(result.trace[name], dtype=float)
            away = np.max(np.abs(np.asarray(values, dtype=float) - ours))
            largest = max(largest, float(away / (np.max(np.abs(ours)) or 1.0)))
        return len(found), largest


def without_dampers(source: Source) -> Source:
    """The loom with its carriers fixed in their frames."""
    return replace(source, text=source.text.replace("dampers = true", "dampers = false"))


def measure(effort: str, notes: Notes) -> list[Table]:
    """All in turn, and how far each is from the native FMUs."""
    tiny = effort == "tiny"
    source = Source(WEFT.replace('record = ["weft.shaft_torque"]', "")) if tiny else demo()
    programs: dict[str, tuple[Any, ...]] = {
        LOOP: (InC, c_programs.loop, source),
        WHOLE: (InC, c_programs.whole_fmu, source),
        HOST: (InC, c_programs.host, source),
    }
    if not tiny:
        programs[WITHOUT] = (InC, c_programs.loop, without_dampers(source))
    masters: dict[str, tuple[Any, ...]] = {
        f"loomfmu stepping in {name}": (Stepped, source, "native", name) for name in ENGINES
    }
    masters["loomfmu, HDF5"] = (Ours, source, "native")
    rows = Table(NAME, COLUMNS)
    say(f"{NAME}: compiling")
    with children(programs, notes, inside=True) as built, children(masters, notes, inside=tiny) as asked:
        say(f"{NAME}: timing")
        repeats, turns = SIZES[effort]
        together = {**built, **asked}
        timings = in_turn(together, dict.fromkeys(together, Task(repeats, STEPS, turns)), notes)
        for name, found in timings.items():
            cells = (1e6 * middle(found).turn / STEPS, 100.0 * spread(found), len(found))
            outputs, difference = "all", ""  # of our own master
            if program := built.get(name):
                outputs, difference = program.ask("difference", STEPS, program.directory)
            rows.add(name, outputs, *cells, difference)
    return [rows]


# ---- what is said of it


_WHOLE = "One FMU of the whole loom is what `loomfmu export --fmu` writes, stepped by the same plain host."


def section(find: Find) -> str:
    """Each way beside the bare mathematics."""
    rows = find(NAME)
    least = next((row[STEP] for row in rows if row["what"] == LOOP), None)
    lines = []
    for row in rows:
        ratio = shown(row[STEP] / least) if least else ""
        away = error(row["largest difference [share]"]) or "is compared with"
        cells = [shown(row[key]) for key in ("outputs", STEP, "spread [%]", "repeats")]
        lines.append([row["what"], *cells, ratio, away])
    heads = ["what", "outputs", "us per step", "spread, %", "repeats", f"over {LOOP}", "largest difference"]
    return parts(
        f"The demonstration loom with {STEPS} steps in a revolution. The C loop is the translated components"
        " in one program, wired and stepped as our master does, compiled with the flags of the FMUs: what the"
        " mathematics costs without FMI. The plain host calls the native FMUs from C: what it costs with FMI"
        " and without our master. Every step writes all outputs to memory.",
        "The difference is the largest of any output at any sample of a revolution from that of the native"
        " FMUs under our master, as a share of the output's largest value; 0 means equal to the last bit.",
        _WHOLE if any(row["what"] == WHOLE for row in rows) else "",
        table(heads, lines),
    )
