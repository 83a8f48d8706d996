"""How near the co-simulation comes to what the mathematics alone costs."""

from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any

import c_programs
import numpy as np
import vectorised
from children import Task, Timing, children, in_turn, middle, spread
from own import ENGINES, Ours, Source, Stepped, demo
from records import Notes, Table, say
from scaling import WEFT
from texts import Find, error, parts, shown, table, whole

import loomfmu

NAME = "limits"
STEPS = 1440  # in a revolution
BLOCK = 1440  # samples of a numpy array: it stays in the cache
SIZES: dict[str, tuple[int, float]] = {"full": (7, 8.0), "quick": (3, 2.0), "tiny": (1, 0.1)}
LOOP, HOST, NUMPY = "one C loop", "native FMUs under a plain C host", "numpy"
WHOLE = "the loom as one FMU under a plain C host"
WITHOUT = "one C loop, without dampers"
STEP = "step [us]"
COLUMNS = ("what", "outputs", "step [us]", "spread [%]", "repeats", "largest difference [share]")


class Compared:
    """What gives the outputs of a scene in another way than by our master."""

    source: Source

    def signals(self, steps: int) -> dict[str, Any]:
        """Outputs along the steps of a revolution."""
        raise NotImplementedError

    def difference(self, steps: int, directory: Path) -> tuple[int, float]:
        """Number of outputs, and largest difference from those of the native FMUs under our master.

        The difference is a share of each output's largest value; 0 means that all bits are equal.
        """
        found = self.signals(steps)
        result = loomfmu.run(self.source.scene(steps), output=directory / "native.h5", flavour="native")
        largest = 0.0
        for name, values in found.items():
            ours = np.asarray(result.trace[name], dtype=float)
            away = np.max(np.abs(np.asarray(values, dtype=float) - ours))
            largest = max(largest, float(away / (np.max(np.abs(ours)) or 1.0)))
        return len(found), largest


class InC(Compared):
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

    def signals(self, steps: int) -> dict[str, Any]:
        """Outputs along the steps of a revolution."""
        return self.program.trace(steps)


class InNumpy(Compared):
    """What of a scene can be done by numpy."""

    def __init__(self, directory: Path, source: Source):
        self.source = source

    def time(self, steps: int, turns: float) -> Timing:
        """Seconds for a revolution, in blocks of samples."""
        scene = self.source.scene(steps, min(1.0, BLOCK / steps))
        blocks = max(1, round(turns * steps / scene.steps))
        start = perf_counter()
        for _ in range(blocks):
            vectorised.run(scene)
        return Timing(0.0, (perf_counter() - start) * steps / (blocks * (scene.steps + 1)))

    def signals(self, steps: int) -> dict[str, Any]:
        """Outputs along the steps of a revolution."""
        return vectorised.run(self.source.scene(steps))


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
        NUMPY: (InNumpy, source),
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
            outputs, difference = _difference(together[name], name in built, notes)
            rows.add(name, outputs, *cells, difference)
    return [rows, _left_out(source)]


def _difference(asked: Any, compared: bool, notes: Notes) -> tuple[Any, Any]:
    """Outputs and difference of what is compared; our own master has none."""
    if not compared:
        return "all", ""
    return asked.ask("difference", STEPS, asked.directory)


def _left_out(source: Source) -> Table:
    """What numpy leaves out."""
    scene = source.scene(45)
    done = vectorised.run(scene)
    rows = Table("limits_left_out", ("instance", "component", "outputs that numpy leaves out"))
    for name, instance in scene.instances.items():
        ports = [port.name for port in instance.fmu.ports.values() if port.causality == "output"]
        left = [port for port in ports if f"{name}.{port}" not in done]
        if left:
            rows.add(name, instance.fmu.name, " ".join(left))
    return rows


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
        f"numpy computes all samples at once, in blocks of {BLOCK}, and only what follows from the shaft's"
        " angle by a formula. What has a memory cannot be written so (the carrier of a damper, what the belt"
        " monitor finds between samples), nor a search at each sample (the deflection of a buckled belt). It"
        f" leaves out:\n\n{whole(find('limits_left_out'))}",
    )
