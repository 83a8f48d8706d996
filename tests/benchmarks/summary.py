"""The first page of the report: one picture, one table, what to choose when. All numbers come from tables."""

from typing import Any

import cost
import figure_style
import limits
import precision
import start_up
import sweep_runs
from records import Row
from texts import Figures, Find, error, items, only, parts, shown, table

PICTURE = "summary.png"
OURS, PLAIN, ISOLATED = "loomfmu", cost.PLAIN, cost.ISOLATED
ERROR, ENOUGH = next(iter(precision.TARGETS.items()))
JUDGED = ERROR.partition(" [")[0].removeprefix("error of ")
NATIVE = "loomfmu, native FMUs"


class Numbers:
    """What the tables hold, by what it is called there; None where it was not measured."""

    def __init__(self, find: Find):
        self.start = {row["what"]: row["time [ms]"] for row in find(start_up.NAME)}
        self.limits = {row["what"]: row[limits.STEP] for row in find(limits.NAME)}
        self.rows = {row["what"]: row["a row [ms]"] for row in find(sweep_runs.ROWS)}
        self.precision = find(precision.NAME)
        self.costs = find(cost.NAME)

    def step(self, flavour: str, master: str, recording: str) -> float | None:
        """A step of the loom [us], on all cores if that was measured."""
        found = only(self.costs, FMUs=flavour, master=master, recording=recording)
        best = only(found, cores="all") or found
        return best[0][cost.STEP] if best else None

    @property
    def isolation(self) -> float | None:
        """What isolating one FMU adds to a step [us]: a share of what isolating all of them adds."""
        isolated, plain = (self.step("native", name, "none") for name in (ISOLATED, PLAIN))
        return None if isolated is None or plain is None else (isolated - plain) / cost.FMUS

    def reached(self, method: str) -> Row | None:
        """The cheapest run of a method that comes below the error that is enough."""
        good = [row for row in only(self.precision, method=method) if row[ERROR] <= ENOUGH]
        return min(good, key=lambda row: float(row[precision.TIME]), default=None)


def section(find: Find) -> str:
    """What a user pays, and what to choose when."""
    numbers = Numbers(find)
    return parts(
        "The demonstration loom: twelve FMUs, native unless it says otherwise. All numbers are those of the"
        " sections below, which say how they were measured.",
        table(["what you pay", "time", "beside"], _paid(numbers)),
        "What to choose when:",
        items(*_choices(numbers)),
    )


def _paid(numbers: Numbers) -> list[list[str]]:
    """The lines of the table: what, its time, and that of something to compare it with."""
    base = numbers.start.get(start_up.BASE)
    run = numbers.start.get(start_up.RUN)
    loop = numbers.limits.get(limits.LOOP)
    recorded = numbers.step("native", OURS, "HDF5")
    row_loop = numbers.rows.get(sweep_runs.LOOP)
    one, swept = numbers.limits.get(limits.WHOLE), numbers.rows.get(sweep_runs.SWEPT)
    live = numbers.step("live", OURS, "HDF5")
    return [
        _line("`loomfmu run`: imports, three revolutions, verdicts", run, "ms", start_up.BASE, base),
        _line("a step, all outputs recorded", recorded, "us", *_other(numbers)),
        _line("a step, live FMUs (Python)", live, "us", "native FMUs", recorded),
        _line("a step of the loom as one FMU", one, "us", limits.LOOP, loop),
        _line("isolating one FMU, in addition to a step", numbers.isolation, "us", "a step", recorded),
        _line(f"a row of a sweep, {sweep_runs.STEPS} steps", swept, "ms", sweep_runs.LOOP, row_loop),
        *_errors(numbers),
    ]


def _line(what: str, value: float | None, unit: str, beside: str, other: float | None) -> list[str]:
    """A line of the table; what was not measured is named so."""
    if value is None:
        return [what, "not run", ""]
    if other is None:
        return [what, f"{shown(value)} {unit}", ""]
    ratio = f"{shown(value / other, 2)} times" if value > 0.8 * other else f"1/{shown(other / value, 2)} of"
    return [what, f"{shown(value)} {unit}", f"{ratio} {beside} ({shown(other)} {unit})"]


def _other(numbers: Numbers) -> tuple[str, float | None]:
    """The fastest master of others that records, and its step [us]."""
    names = dict.fromkeys((row["master"], row["recording"]) for row in numbers.costs)
    others = {
        f"{master}, {recording}": numbers.step("native", master, recording)
        for master, recording in names
        if recording != "none" and not master.startswith(OURS)
    }
    known = {name: value for name, value in others.items() if value is not None}
    fastest = min(known, key=lambda name: known[name], default="")
    return fastest, known.get(fastest)


def _errors(numbers: Numbers) -> list[list[str]]:
    """A line: the time of a revolution at an error, beside the fastest of other masters."""
    mine = numbers.reached(NATIVE)
    if mine is None:
        return []
    methods = dict.fromkeys(row["method"] for row in numbers.precision)
    others = [row for name in methods if not name.startswith(OURS) and (row := numbers.reached(name))]
    best = min(others, key=lambda row: float(row[precision.TIME]), default=None)
    what = f"a revolution with the {JUDGED} within {error(ENOUGH)} ({shown(mine[precision.STEP])} steps)"
    beside = (best["method"], best[precision.TIME]) if best else ("", None)
    return [_line(what, mine[precision.TIME], "ms", *beside)]


def _choices(numbers: Numbers) -> list[str]:
    """One line for each purpose."""
    live, recorded = numbers.step("live", OURS, "HDF5"), numbers.step("native", OURS, "HDF5")
    slower = f", {shown(live / recorded, 2)} times slower" if live and recorded else ""
    alone, together = (numbers.rows.get(name) for name in (sweep_runs.ANEW, sweep_runs.PREPARED))
    saves = (
        f": {shown(alone / together, 2)} times faster than reading it for each" if alone and together else ""
    )
    isolated = f": {shown(numbers.isolation)} us a step for each" if numbers.isolation else ""
    return [
        "**One run, or a first look**: `loomfmu run`, with native FMUs, as it does by default.",
        f"**Many values of one scene**: `loomfmu sweep`, or `loomfmu.prepare` in Python{saves}.",
        "**Another tool**: `loomfmu export --fmu`, the whole loom as one FMU, wired inside without delay. A"
        " system package (`--ssp`) or single FMUs where you exchange mechanisms; their wires are a step late"
        " in most tools.",
        f"**A mechanism to debug**: live FMUs (`--live`){slower}.",
        f"**FMUs from others**: isolated, as they are by default{isolated}. With `isolated = false` once you"
        " trust them.",
        *_steps(numbers),
    ]


def _steps(numbers: Numbers) -> list[str]:
    mine = numbers.reached(NATIVE)
    if mine is None:
        return []
    steps, left = shown(mine[precision.STEP]), error(mine[ERROR])
    return [
        f"**How many steps**: {steps} in a revolution give the {JUDGED} within {left}. More make signals"
        " finer to look at; claims hardly need them."
    ]


# ---- the picture


def figures(find: Find) -> Figures:
    """What a step costs by way of running it, and error over time."""
    numbers = Numbers(find)
    ways = _ways(numbers)
    if not ways or not numbers.precision:
        return {}

    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.25))
        _draw_steps(left, ways)
        for method in precision.COLOURS:
            mine = only(numbers.precision, method=method)
            times, errors = [row[precision.TIME] for row in mine], [max(row[SHOWN], 1e-17) for row in mine]
            right.loglog(times, errors, ".-", color=precision.COLOURS[method], label=method)
        right.set_xlabel("time of a revolution, ms")
        right.set_title("error of the damper's displacement", fontsize=11)
        figure.legend(*right.get_legend_handles_labels(), loc="outside lower center", ncols=3)

    caption = "Left: what a step costs. Right: the error that a time buys; each point is a number of steps"
    return {PICTURE: (caption, 4.6, draw)}


SHOWN = "error of damper_1.displacement [share of largest]"


def _ways(numbers: Numbers) -> dict[str, tuple[float, str]]:
    """Ways to run a step: its time [us] and a colour."""
    others, colours = ("ecos", "CSV"), precision.COLOURS
    found = {
        "one C loop": (numbers.limits.get(limits.LOOP), figure_style.BLACK),
        "one FMU, C host": (numbers.limits.get(limits.WHOLE), figure_style.GREEN),
        "loomfmu, native": (numbers.step("native", OURS, "HDF5"), figure_style.BLUE),
        "loomfmu, isolated": (numbers.step("native", ISOLATED, "none"), figure_style.GREY),
        "loomfmu, live": (numbers.step("live", OURS, "HDF5"), figure_style.SKY),
        "ecos": (numbers.step("native", *others), colours["ecos"]),
        "libcosim": (numbers.step("native", "libcosim", "in memory"), colours["libcosim"]),
        "fmpy": (numbers.step("native", "fmpy", "in memory"), colours["fmpy"]),
    }
    return {name: (value, colour) for name, (value, colour) in found.items() if value is not None}


def _draw_steps(panel: Any, ways: dict[str, tuple[float, str]]) -> None:
    """A point for each way, its time beside it: bars would mean nothing on a logarithmic axis."""
    for place, (value, colour) in enumerate(ways.values()):
        panel.plot([value], [place], "o", color=colour, markersize=8)
        panel.annotate(shown(value, 2), (value, place), (9, 0), textcoords="offset points", va="center")
    panel.set_yticks(range(len(ways)), list(ways))
    panel.set_xscale("log")
    most, least = (choose(value for value, _ in ways.values()) for choose in (max, min))
    panel.set_xlim(0.5 * least, 8.0 * most)  # room for the numbers
    panel.margins(y=0.1)
    panel.invert_yaxis()
    panel.set_xlabel("us")
    panel.set_title("a step of the loom", fontsize=11)
