"""Work and precision: how long a revolution takes and how exact its results are, over the number of steps."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import figure_style
import numpy as np
from children import Asked, Configurations, Failed, Task, children, in_turn, middle, spread
from exact import REDUCTION, SIGNALS, STROKE, Loom
from numpy.typing import NDArray
from own import Judged, Ours, Signals, demo
from peers import Ecos, Fmpy, Libcosim, absent
from records import Notes, Row, Table, say
from texts import Figures, Find, error, items, parts, pivot, shown, table

from loomfmu import judge
from loomfmu.traces import Channel, Recording

NAME = "precision"
PLACES = 45  # of a revolution, at which signals are compared: every count of steps is a multiple
RATES = {"heald_1.lift": "heald_1.velocity", "damper_1.displacement": "damper_1.rate"}
MOTIONS = (
    "shaft.angle",
    "shaft.velocity",
    "shaft.acceleration",
    "heald_1.lift",
    "heald_1.velocity",
    "heald_1.acceleration",
)
NAMES = tuple(
    dict.fromkeys([*SIGNALS, *RATES.values(), *MOTIONS, "belt.lowest_margin", "damper_1.peak_load"])
)
COLUMNS = (
    "method",
    "steps per revolution",
    "time [ms/revolution]",
    "spread [%]",
    "repeats",
    "error of lowest margin [1]",
    "error of dwell [rad]",
    "error of peak load [share]",
    *(f"error of {signal} [share of largest]" for signal in SIGNALS),
    *(f"delay of {signal} [steps]" for signal in RATES),
)


@dataclass(frozen=True)
class Size:
    """How much is measured. `least` are the steps of a timed run: of ours native, of others, of slow ones."""

    steps: tuple[int, ...]
    repeats: int
    least: tuple[int, int, int]
    patient: int  # steps in a revolution from which a slow method is timed thrice only


SIZES = {
    "full": Size(tuple(45 * 2**power for power in range(9)), 7, (16384, 5760, 1440), 2880),
    "quick": Size((45, 180, 720), 2, (2880, 720, 180), 720),
    "tiny": Size((45,), 1, (45, 45, 45), 45),
}
SLOW = ("loomfmu, live FMUs", "fmpy")
CLAIMS = "loomfmu, native FMUs, claims alone"


TINY = ("loomfmu, native FMUs", CLAIMS, "ecos")  # what a first look is taken at


def methods() -> Configurations:
    """What is compared, each with its recording."""
    return {
        "loomfmu, live FMUs": (Ours, demo(), "live"),
        "loomfmu, native FMUs": (Ours, demo(), "native"),
        CLAIMS: (Judged, demo(judged=True), "native"),
        "libcosim": (Libcosim, demo(), "native", "series"),
        "ecos": (Ecos, demo(), "native", "csv"),
        "fmpy": (Fmpy, demo(), "native"),
    }


def measure(effort: str, notes: Notes) -> list[Table]:
    """Times in turn, errors once."""
    size, loom = SIZES[effort], Loom()
    found = Table(NAME, COLUMNS)
    for name, why in absent():
        notes(name, why)
    chosen = {name: made for name, made in methods().items() if effort != "tiny" or name in TINY}
    with children(chosen, notes, inside=effort == "tiny") as asked:
        for steps in size.steps:
            say(f"{NAME}: {steps} steps")
            tasks = {name: _task(name, size, steps, notes) for name in asked}
            timings = in_turn(asked, tasks, notes)
            for name, taken in timings.items():
                away = _errors(name, asked, steps, loom, notes)
                if away is None:
                    continue
                share = 100.0 * spread(taken)
                found.add(name, steps, 1e3 * middle(taken).turn, share, len(taken), *away)
    return [found, _references(loom)]


def _task(name: str, size: Size, steps: int, notes: Notes) -> Task:
    """How often a method is timed, with revolutions enough to be timed well."""
    slow = name in SLOW
    repeats = min(3, size.repeats) if slow and steps >= size.patient else size.repeats
    if repeats < size.repeats:
        notes(name, f"timed {repeats} times only from {size.patient} steps in a revolution on")
    native = name.startswith("loomfmu") and not slow
    turns = max(1, math.ceil(size.least[2 if slow else 0 if native else 1] / steps))
    return Task(repeats, steps, 1.0 + turns if name == CLAIMS else turns)


def _errors(name: str, asked: Asked, steps: int, loom: Loom, notes: Notes) -> list[float] | None:
    try:
        signals = asked[name].ask("signals", NAMES, steps)
    except Failed as error:
        notes(name, str(error))
        return None
    return errors(signals, loom, 1.0 / steps)


def errors(signals: Signals, loom: Loom, share: float) -> list[float]:
    """Errors of the results and of the signals, and by how many steps two of them come too late.

    Args:
        signals: samples of `NAMES` along their times, over a whole revolution, which the dwell is judged on;
            the others are compared in the first one
        share: share of a revolution that a step takes
    """
    time = signals["time"]
    turn = 2.0 * math.pi / loom.speed
    wanted = np.arange(1, PLACES + 1) * turn / PLACES
    places = np.unique(np.abs(time[:, np.newaxis] - wanted).argmin(axis=0))
    found = [
        abs(signals["belt.lowest_margin"][places[-1]] - loom.lowest_margin),
        abs(dwell(signals) - loom.dwell),
        abs(signals["damper_1.peak_load"][places[-1]] / loom.peak_load - 1.0),
    ]
    delays = []
    for signal in SIGNALS:
        exact = loom.along(signal, time[places])
        error = signals[signal][places] - exact
        found.append(float(np.max(np.abs(error)) / np.max(np.abs(exact))))
        if signal in RATES:
            delays.append(delay(error, signals[RATES[signal]][places]) / (share * turn))
    return [*map(float, found), *delays]


def delay(error: NDArray[np.float64], rate: NDArray[np.float64]) -> float:
    """The delay [s] that explains most of an error: f(t - d) = f(t) - d f'(t)."""
    return float(-np.dot(error, rate) / np.dot(rate, rate))


def dwell(signals: Signals) -> float:
    """Dwell of heald frame 1 as the claim finds it [rad], from samples of whatever master."""
    rates = dict(pairwise(MOTIONS))
    channels = []
    for column, name in enumerate(MOTIONS):
        instance, variable = name.split(".")
        rate = rates.get(name, "").removeprefix(f"{instance}.")
        rate = rate if variable != "acceleration" else ""
        channels.append(Channel(instance, variable, "1", "1", "", column, rate=rate or None))
    samples = np.column_stack([signals[name] for name in MOTIONS])
    recording = Recording("samples", channels, lambda _name, _variable: STROKE)
    none = np.empty((len(samples), 0), dtype=np.int32)
    recording.append(signals["time"], signals["shaft.angle"], samples, none)
    return judge(recording, kind="dwell", heald="heald_1", at_least=0.0).worst


def _references(loom: Loom) -> Table:
    """What the results are compared with."""
    found = Table("references", ("result", "unit", "value"))
    found.add("lowest margin", "1", loom.lowest_margin)
    found.add(f"dwell at a speed reduction of {REDUCTION:g}", "rad", loom.dwell)
    found.add("peak load of damper 1", "N", loom.peak_load)
    found.add(SPEED_OF, "rev/min", loom.speed * 30.0 / math.pi)
    return found


# ---- what is said of it

STEP, TIME = COLUMNS[1:3]
SPEED_OF = "speed of the shaft"
TARGETS = {
    "error of lowest margin [1]": 1e-6,
    "error of dwell [rad]": 1e-6,
    "error of peak load [share]": 1e-6,
    "error of damper_1.displacement [share of largest]": 1e-4,
}
COLOURS = {
    "loomfmu, live FMUs": figure_style.SKY,
    "loomfmu, native FMUs": figure_style.BLUE,
    CLAIMS: figure_style.GREEN,
    "libcosim": figure_style.ORANGE,
    "ecos": figure_style.RED,
    "fmpy": figure_style.PURPLE,
}


def section(find: Find) -> str:
    """Work and precision in words and tables."""
    rows = find(NAME)
    references = {row["result"]: row for row in find("references")}
    exact = [[name, f"{row['value']:.6g}", shown(row["unit"])] for name, row in references.items()]
    errors_of = [column for column in COLUMNS if column.startswith("error of")]
    tables = [f"{head.capitalize()}:\n\n{pivot(rows, STEP, 'method', head, error)}" for head in errors_of]
    delays = [column for column in COLUMNS if column.startswith("delay of")]
    late = [f"{head.capitalize()}:\n\n{pivot(rows, STEP, 'method', head, _delay)}" for head in delays]
    return parts(
        "One revolution of the demonstration loom, at a speed at which a step of every count is a whole"
        " number of nanoseconds, as libcosim counts them. Errors are those from references in 50 digits: the"
        " belt and the heald from their closed forms, the dwell from its law. The damper is integrated by"
        f" scipy to 1e-14 m. Signals are compared at {PLACES} places of the revolution.",
        table(["reference", "value", "unit"], exact),
        "Each method records in the cheapest way it has: ours to HDF5, libcosim in memory, ecos to CSV, fmpy"
        " in memory. The one that judges the claims writes nothing and runs no more than these need. Times"
        " are those of a revolution without the set-up, with the judging where claims are judged.",
        f"Time to reach an error, in ms for a revolution:\n\n{_reached(rows)}",
        f"Time of a revolution, in ms:\n\n{pivot(rows, STEP, 'method', TIME)}",
        *tables,
        "A master that steps all FMUs at once hands every value on one step late, over each wire. Our FMUs"
        " carry their inputs over the step with the rates that they know; the errors above contain what is"
        " left. As a delay in steps, fitted to the error with the rate of the signal (negative: too early):",
        *late,
        items(
            "fmpy starts all wires at 0, which shows in its errors: a heald has its first place a step late,"
            " and the damper does not forget the push.",
            "The lowest margin and the peak load are found by the FMUs themselves, between the samples of"
            " their inputs, under any master; the dwell is found by our claim from the samples of each.",
            "Repeats and spreads (largest distance from the median) are in the table of values.",
        ),
    )


def _delay(value: Any) -> str:
    return "0" if abs(value) < 5e-4 else f"{value:.3f}"


def _reached(rows: list[Row]) -> str:
    """The least time in which each method comes below some errors, with the steps that it took."""
    heads = ["method", *(f"{head}: {error(target)}" for head, target in TARGETS.items())]
    lines = []
    for method in dict.fromkeys(row["method"] for row in rows):
        cells = [method]
        for head, target in TARGETS.items():
            good = [row for row in rows if row["method"] == method and row[head] <= target]
            best = min(good, key=lambda row: float(row[TIME]), default=None)
            cells.append(f"{shown(best[TIME])} ({shown(best[STEP])} steps)" if best else "not reached")
        lines.append(cells)
    return table(heads, lines)


def figures(find: Find) -> Figures:
    """Errors over time, one panel for each."""
    rows = find(NAME)
    heads = [column for column in COLUMNS if column.startswith("error of")]

    def draw(figure: Any) -> None:
        panels = figure.subplots(3, 2).flat
        for panel, head in zip(panels, heads, strict=True):
            for method in dict.fromkeys(row["method"] for row in rows):
                mine = [row for row in rows if row["method"] == method]
                times, errors_ = [row[TIME] for row in mine], [max(row[head], 1e-17) for row in mine]
                panel.loglog(times, errors_, ".-", color=COLOURS[method], label=method)
            panel.set_title(head.removeprefix("error of "), fontsize=10)
            panel.set_xlabel("time of a revolution, ms")
            panel.set_ylabel("error")
        handles, labels = panel.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2)

    return {
        "precision.png": ("Error over the time of a revolution; each point is a number of steps", 11.0, draw)
    }
