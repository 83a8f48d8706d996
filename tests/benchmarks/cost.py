"""What a macro step of the demonstration loom costs under each master, with and without recording."""

from typing import Any

import figure_style
from children import Configurations, Task, children, in_turn, middle, spread
from own import ENGINES, Ours, Stepped, demo
from peers import Ecos, Fmpy, Libcosim, absent
from records import Notes, Row, Table, say
from texts import Figures, Find, only, parts, shown, table

NAME = "cost"
STEPS = 1440  # in a revolution
FMUS = 12  # of the loom
PLAIN, ISOLATED = "loomfmu stepping in Python", "loomfmu with isolated FMUs"
STEP = "step [us]"
COLUMNS = ("FMUs", "cores", "master", "recording", "step [us]", "spread [%]", "set-up [ms]", "repeats")
KINDS = {
    "full": {"repeats": 7, "turns": 4.0, "pinned": (False, True), "flavours": ("native", "live")},
    "quick": {"repeats": 3, "turns": 0.5, "pinned": (True,), "flavours": ("native",)},
    "tiny": {"repeats": 1, "turns": 0.05, "pinned": (False,), "flavours": ("native",)},
}


def configurations(flavour: str) -> Configurations:
    """Masters and their recordings, as `master, recording`."""
    source = demo()
    found: dict[str, tuple[Any, ...]] = {"loomfmu, HDF5": (Ours, source, flavour)}
    for name in ENGINES:
        found[f"loomfmu stepping in {name}, none"] = (Stepped, source, flavour, name)
    found[f"{ISOLATED}, none"] = (Stepped, demo(isolated=True), flavour, "Python")
    return found | {
        "libcosim, none": (Libcosim, source, flavour),
        "libcosim, in memory": (Libcosim, source, flavour, "series"),
        "libcosim, CSV": (Libcosim, source, flavour, "csv"),
        "ecos, none": (Ecos, source, flavour),
        "ecos, CSV": (Ecos, source, flavour, "csv"),
        "fmpy, in memory": (Fmpy, source, flavour),
    }


def measure(effort: str, notes: Notes) -> list[Table]:
    """Times in turn: for each kind of FMUs, on all cores and on one."""
    size: Any = KINDS[effort]
    rows = Table(NAME, COLUMNS)
    for name, why in absent():
        notes(name, why)
    for flavour in size["flavours"]:
        for pinned in size["pinned"]:
            cores = "one" if pinned else "all"
            say(f"{NAME}: {flavour} FMUs, {cores} of the cores")

            def fails(name: str, why: str, flavour: str = flavour, cores: str = cores) -> None:
                notes(f"{name}, {flavour} FMUs, cores: {cores}", why)

            with children(configurations(flavour), fails, pinned, inside=effort == "tiny") as asked:
                tasks = {name: _task(name, flavour, size) for name in asked}
                for name, found in in_turn(asked, tasks, fails).items():
                    master, recording = name.rsplit(", ", 1)
                    centre = middle(found)
                    rows.add(
                        flavour,
                        cores,
                        master,
                        recording,
                        1e6 * centre.turn / STEPS,
                        100.0 * spread(found),
                        1e3 * centre.set_up,
                        len(found),
                    )
    return [rows]


def _task(name: str, flavour: str, size: Any) -> Task:
    """Ours with native FMUs is timed over more revolutions; live and isolated FMUs and fmpy over fewer."""
    turns = size["turns"]
    if name.startswith("fmpy") or flavour == "live":
        turns *= 0.25
    elif name.startswith("loomfmu"):
        turns *= 0.25 if "isolated" in name else 4.0
    return Task(size["repeats"], STEPS, turns)


# ---- what is said of it


def _isolation(rows: list[Row]) -> str:
    """What isolating one FMU adds to a step."""
    lines = []
    for isolated in rows:
        flavour, cores = isolated["FMUs"], isolated["cores"]
        plain = [row for row in only(rows, FMUs=flavour, cores=cores) if row["master"] == PLAIN]
        if isolated["master"] == ISOLATED and plain:
            steps = [row[STEP] for row in (*plain, isolated)]
            lines.append([flavour, cores, *map(shown, steps), shown((steps[1] - steps[0]) / FMUS)])
    if not lines:
        return ""
    heads = ["FMUs", "cores", "in one process", "each in its own", "one FMU isolated adds"]
    return (
        f"What isolation costs, in us per step: each of the {FMUS} FMUs runs in a process of its own, with"
        " which the master, in Python, exchanges values once a step. Nothing is recorded."
        f"\n\n{table(heads, lines)}"
    )


def section(find: Find) -> str:
    """The costs, and what the others cost beside the cheapest of ours."""
    rows = find(NAME)
    said = []
    for flavour, cores in dict.fromkeys((row["FMUs"], row["cores"]) for row in rows):
        group = [row for row in rows if (row["FMUs"], row["cores"]) == (flavour, cores)]
        where = "all cores" if cores == "all" else "one core"
        said.append(f"{flavour.capitalize()} FMUs, {where}:\n\n{_table(group)}")
    return parts(
        f"The demonstration loom, {STEPS} steps in a revolution. Set-up and steps are told apart:"
        " libcosim and ecos are timed in one call for all steps, in ours and in fmpy's one call the stepping"
        " within it. What is recorded are all outputs; libcosim cannot keep booleans in memory. The package"
        " is written before. Ours keeps its instances between runs and has its trace to open and to seal; the"
        " others unpack and load theirs in every set-up. On one core means that the process and all its"
        " threads are held to it.",
        "Our run to HDF5 leaves out the FMU of the shaft, which turns at a constant speed; stepping alone"
        " leaves out none. The last column is the ratio to the cheapest of ours that records as well, or"
        " records nothing as well.",
        *said,
        _isolation(rows),
    )


def _table(rows: list[Row]) -> str:
    heads = ["master", "recording", "us per step", "spread, %", "set-up, ms", "repeats", "ratio to ours"]
    lines = []
    for row in rows:
        ours = [
            each[STEP]
            for each in rows
            if each["master"].startswith("loomfmu")
            and (each["recording"] == "none") == (row["recording"] == "none")
        ]
        ratio = shown(row[STEP] / min(ours)) if ours else ""
        cells = [shown(row[key]) for key in (STEP, "spread [%]", "set-up [ms]", "repeats")]
        lines.append([row["master"], row["recording"], *cells, ratio])
    return table(heads, lines)


def figures(find: Find) -> Figures:
    """A panel for each kind of FMUs, a point for each master on all cores and on one.

    Points, not bars: their axis is logarithmic, where the length of a bar means nothing.
    """
    rows = find(NAME)

    def draw(figure: Any) -> None:
        kinds = list(dict.fromkeys(row["FMUs"] for row in rows))
        panels = figure.subplots(len(kinds), 1, squeeze=False)[:, 0]
        for panel, kind in zip(panels, kinds, strict=True):
            group = [row for row in rows if row["FMUs"] == kind]
            names = list(dict.fromkeys(f"{row['master']}, {row['recording']}" for row in group))
            for place, (cores, colour) in enumerate(
                (("all", figure_style.BLUE), ("one", figure_style.ORANGE))
            ):
                mine = [row for row in group if row["cores"] == cores]
                if not mine:
                    continue
                at = [names.index(f"{row['master']}, {row['recording']}") + 0.2 * place for row in mine]
                panel.plot([row[STEP] for row in mine], at, "o", color=colour, label=f"cores: {cores}")
            panel.set_yticks([n + 0.1 for n in range(len(names))], names)
            panel.invert_yaxis()
            panel.set_xscale("log")
            panel.set_xlabel(f"us per step, {kind} FMUs")
            panel.legend()

    return {"cost.png": ("Cost of a macro step of the demonstration loom", 9.0, draw)}
