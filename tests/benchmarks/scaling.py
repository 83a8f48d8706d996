"""How the cost of a run grows: with its instances, with what it records, with its steps."""

import resource
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

import figure_style
import numpy as np
from children import Child, Failed, Inside, Task, children, in_turn, middle, spread
from own import Ours, Source, Stepped
from records import Notes, Table, say
from texts import Figures, Find, parts, whole

import loomfmu

NAME = "scaling"
STEPS = 360  # in a revolution
FRAMES = """
[shaft]
speed = "600 rev/min"
[dobby]
law = "sloped-sine"
"""
FRAME = '[heald_{number}]\npattern = "{pegs}"\n'
WEFT = """
record = ["weft.shaft_torque"]
[shaft]
speed = "600 rev/min"
[weft]
machine = "WL680-3600"
"""
# of each frame: one output, two, three, all six
RECORDED = (
    ["heald_*.warp_height"],
    ["heald_*.warp_height", "heald_*.inertia_force"],
    ["heald_*.warp_height", "heald_*.inertia_force", "heald_*.moving"],
    ["heald_*.*"],
)
KINDS = {
    "full": {
        "frames": (1, 2, 5, 10, 20, 50, 100, 200),
        "wide": 50,
        "repeats": 7,
        "turns": 34.0,
        "steps": (10**3, 10**4, 10**5, 10**6, 10**7),
    },
    "quick": {"frames": (1, 10, 50), "wide": 20, "repeats": 3, "turns": 12.0, "steps": (10**3, 10**4, 10**5)},
    "tiny": {"frames": (1, 2), "wide": 2, "repeats": 1, "turns": 0.2, "steps": (100, 200)},
}


def loom(frames: int, record: list[str] | None = None) -> Source:
    """A dobby with so many frames in plain weave."""
    head = "" if record is None else f"record = {record}\n".replace("'", '"')
    healds = [FRAME.format(number=n, pegs="10" if n % 2 else "01") for n in range(1, frames + 1)]
    return Source("".join([head, FRAMES, *healds]))


class Long:
    """One run of many steps, recorded: seconds, peak memory and size of its trace."""

    def __init__(self, directory: Path, flavour: str):
        self.directory, self.flavour, self.source = directory, flavour, Source(WEFT)
        self.run(STEPS)  # everything is loaded

    def run(self, steps: int) -> tuple[float, float, float]:
        """Seconds, bytes in memory at the most, bytes on disk."""
        scene = self.source.scene(STEPS, steps / STEPS)
        path = self.directory / "long.h5"
        start = perf_counter()
        loomfmu.run(scene, output=path, flavour=self.flavour)
        return perf_counter() - start, peak_memory(), path.stat().st_size


def peak_memory() -> float:
    """Most memory that this process had so far [B]; its own, not that of whoever started it."""
    try:
        lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
        return 1024.0 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))
    except (OSError, StopIteration):
        unit = 1 if sys.platform == "darwin" else 1024
        return float(unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)


def measure(effort: str, notes: Notes) -> list[Table]:
    """All three, and the straight lines through them."""
    size: Any = KINDS[effort]
    inside = effort == "tiny"
    tables = [_instances(size, inside, notes), _channels(size, inside, notes), _steps(size, inside, notes)]
    return [*tables, _lines(*tables)]


def _instances(size: Any, inside: bool, notes: Notes) -> Table:
    table = Table(
        "scaling_instances", ("instances", "recording", "step [us]", "spread [%]", "set-up [ms]", "repeats")
    )
    for frames in size["frames"]:
        say(f"{NAME}: {frames} frames")
        made = {"none": (Stepped, loom(frames), "native", "C"), "HDF5": (Ours, loom(frames), "native")}
        with children(made, notes, inside=inside) as asked:
            task = Task(size["repeats"], STEPS, size["turns"])
            for name, found in in_turn(asked, dict.fromkeys(asked, task), notes).items():
                table.add(frames + 2, name, *_cells(found))
    return table


def _channels(size: Any, inside: bool, notes: Notes) -> Table:
    table = Table("scaling_channels", ("channels", "step [us]", "spread [%]", "set-up [ms]", "repeats"))
    say(f"{NAME}: channels")
    sources = {len(loomfmu_channels(size["wide"], given)): loom(size["wide"], given) for given in RECORDED}
    made = {str(count): (Ours, source, "native") for count, source in sources.items()}
    with children(made, notes, inside=inside) as asked:
        task = Task(size["repeats"], STEPS, size["turns"])
        for name, found in in_turn(asked, dict.fromkeys(asked, task), notes).items():
            table.add(int(name), *_cells(found))
    return table


def loomfmu_channels(frames: int, record: list[str]) -> list[str]:
    """What a run of that scene records, beside the motion of the shaft."""
    return loom(frames, record).scene().record


def _cells(found: list[Any]) -> tuple[float, float, float, int]:
    centre = middle(found)
    return 1e6 * centre.turn / STEPS, 100.0 * spread(found), 1e3 * centre.set_up, len(found)


def _steps(size: Any, inside: bool, notes: Notes) -> Table:
    """Runs of ever more steps, each in a process of its own that has done nothing else."""
    table = Table("scaling_steps", ("steps", "time [s]", "step [us]", "peak memory [MB]", "trace [MB]"))
    for steps in size["steps"]:
        say(f"{NAME}: {steps} steps")
        try:
            child = (Inside if inside else Child)(Long, "native")
        except Failed as error:
            notes(f"a run of {steps} steps", str(error))
            continue
        try:
            seconds, memory, disk = child.ask("run", steps)
            table.add(steps, seconds, 1e6 * seconds / steps, 1e-6 * memory, 1e-6 * disk)
        except Failed as error:
            notes(f"a run of {steps} steps", str(error))
        finally:
            child.close()
    return table


def _lines(instances: Table, channels: Table, steps: Table) -> Table:
    """Straight lines by least squares, weighted so that each point's share of its own value counts."""
    table = Table("scaling_lines", ("what", "unit", "at none", "for each", "largest deviation [%]"))
    for recording in ("none", "HDF5"):
        rows = [row for row in instances.rows if row["recording"] == recording]
        _line(table, f"step over instances, recording: {recording}", "us", rows, "instances", "step [us]")
    _line(table, "step over channels", "us", channels.rows, "channels", "step [us]")
    _line(table, "time over steps", "s", steps.rows, "steps", "time [s]")
    _line(table, "peak memory over steps", "MB", steps.rows, "steps", "peak memory [MB]")
    return table


def _line(table: Table, what: str, unit: str, rows: list[Any], x: str, y: str) -> None:
    if len(rows) < 2:
        return
    places, values = (np.array([float(row[key]) for row in rows]) for key in (x, y))
    slope, start = np.polyfit(places, values, 1, w=1.0 / np.abs(values))
    away = np.max(np.abs(start + slope * places - values) / np.abs(values))
    table.add(what, unit, float(start), float(slope), 100.0 * float(away))


# ---- what is said of it


def section(find: Find) -> str:
    """The three growths."""
    return parts(
        f"A dobby with heald frames in plain weave, native FMUs, {STEPS} steps in a revolution; the instances"
        " are the frames, the dobby and the shaft. Stepping alone runs them all; a run to HDF5 leaves out the"
        " shaft, and records all outputs of the frames.",
        whole(find("scaling_instances")),
        "Frames of the same loom, of which one, two, three or all outputs are recorded to HDF5:",
        whole(find("scaling_channels")),
        "Ever longer runs of shaft and weft insertion, recorded to HDF5, each in a process of its own. The"
        " time is that of the whole run with its set-up, the memory the most that the process ever had:",
        whole(find("scaling_steps")),
        "Straight lines by least squares of the deviations in percent, and the largest of these. Their slope"
        " is the cost of one more instance, channel or step:",
        whole(find("scaling_lines")),
    )


def figures(find: Find) -> Figures:
    """Step over instances, time and memory over steps."""
    instances, steps = find("scaling_instances"), find("scaling_steps")

    def draw(figure: Any) -> None:
        left, middle_, right = figure.subplots(1, 3)
        for recording, colour in (("none", figure_style.BLUE), ("HDF5", figure_style.ORANGE)):
            rows = [row for row in instances if row["recording"] == recording]
            x, y = [row["instances"] for row in rows], [row["step [us]"] for row in rows]
            left.loglog(x, y, "o-", color=colour, label=f"recording: {recording}")
        left.xaxis.set_minor_formatter(lambda _value, _place: "")
        left.set_xlabel("instances")
        left.set_ylabel("us per step")
        left.legend()
        counts = [row["steps"] for row in steps]
        middle_.loglog(counts, [row["time [s]"] for row in steps], "o-", color=figure_style.BLUE)
        middle_.yaxis.set_minor_formatter(lambda _value, _place: "")
        middle_.set_xlabel("steps")
        middle_.set_ylabel("time of a run, s")
        right.semilogx(counts, [row["peak memory [MB]"] for row in steps], "o-", color=figure_style.BLUE)
        right.set_ylim(0.0, 1.25 * max(row["peak memory [MB]"] for row in steps))
        right.set_xlabel("steps")
        right.set_ylabel("peak memory, MB")

    return {"scaling.png": ("Cost over instances; time and memory over steps", 3.6, draw)}
