"""The report, written whole from the tables of the results: words and numbers cannot differ."""

from pathlib import Path
from types import ModuleType
from typing import Any

import belt_motion
import cost
import figure_style
import guard
import limits
import live_pages
import many_rows
import precision
import proving
import pruning
import scaling
import start_up
import summary
import sweep_runs
from records import read
from texts import Draw, Figures, Find, items, parts, table

from loomfmu.extras import installed

REPORT = "benchmarks.md"
FOLDER = "benchmarks"
# name -> title, module
BENCHMARKS: dict[str, tuple[str, ModuleType]] = {
    precision.NAME: ("Work and precision", precision),
    cost.NAME: ("Cost of a macro step", cost),
    scaling.NAME: ("Scaling", scaling),
    limits.NAME: ("How near to the limits", limits),
    belt_motion.NAME: ("The belt in motion", belt_motion),
    pruning.NAME: ("Running only what is requested", pruning),
    sweep_runs.NAME: ("Sweeps", sweep_runs),
    many_rows.NAME: ("Many rows at once", many_rows),
    start_up.NAME: ("Start-up", start_up),
    live_pages.NAME: ("The page in which the loom runs", live_pages),
    proving.NAME: ("Proofs", proving),
    guard.NAME: ("Guard", guard),
}
RUNS = (
    "benchmark",
    "effort",
    "duration [s]",
    "date",
    "commit",
    "CPU",
    "cores",
    "kernel",
    "Python",
    "packages",
)
NOTES = ("benchmark", "what", "why")

TITLE = "# Benchmarks"
HOW = """## How it was measured

Written whole by `make bench` from the tables in [benchmarks](benchmarks). One of them alone:
`python tests/benchmarks NAME...`, a short look: `--quick`, which writes to `build` instead.

Times are medians of repeats that were taken in turn, so that all see the same weather of the machine; each
configuration runs in a process of its own. The spread is the largest distance of any repeat from the median.
Compare ratios within one table, not times between machines."""


def text(results: Path) -> str:
    """The whole report from the tables below a directory."""

    find = _tables(results)
    sections = [_section(title, module, find) for title, module in BENCHMARKS.values()]
    head = parts("## In short", *_pictures(summary, find), summary.section(find))
    return parts(TITLE, head, HOW, _machine(find), *sections, _not_run(find)) + "\n"


def write(results: Path) -> list[Path]:
    """Write the report, and its figures if matplotlib is there; paths of what was written."""
    results.mkdir(parents=True, exist_ok=True)
    report = results / REPORT
    temporary = report.with_suffix(".partial")
    temporary.write_text(text(results), encoding="utf-8")
    temporary.replace(report)
    written = [report]
    if not installed("plot"):
        return written
    for module in (summary, *(module for _title, module in BENCHMARKS.values())):
        for name, (_caption, height, draw) in _figures(module, _tables(results)).items():
            written.append(results / FOLDER / name)
            _draw(height, draw, written[-1])
    return written


def _tables(results: Path) -> Find:
    return lambda name: read(results / FOLDER, name)


def _figures(module: Any, find: Find) -> Figures:
    """The figures of a benchmark that was run; most have none."""
    drawn = hasattr(module, "figures") and (module is summary or _was_run(module, find))
    found: Figures = module.figures(find) if drawn else {}
    return found


def _was_run(module: Any, find: Find) -> bool:
    return bool(find(module.NAME) or find(f"{module.NAME}_steps"))


def _section(title: str, module: Any, find: Find) -> str:
    said = module.section(find) if _was_run(module, find) else "*Not run.*"
    return parts(f"## {title}", said, *_pictures(module, find))


def _pictures(module: ModuleType, find: Find) -> list[str]:
    return [f"![{caption}]({FOLDER}/{name})" for name, (caption, _h, _d) in _figures(module, find).items()]


def _machine(find: Find) -> str:
    """The machine, once if all was run on the same one at the same commit."""
    runs = find("runs")
    if not runs:
        return "*Nothing was run.*"
    same = RUNS[3:]
    machines = list(dict.fromkeys(tuple(str(run[key]) for key in same) for run in runs))
    told = []
    for found in machines:
        mine = [run for run in runs if tuple(str(run[key]) for key in same) == found]
        names = ", ".join(
            f"{run['benchmark']} ({run['effort']}, {run['duration [s]']:.0f} s)" for run in mine
        )
        lines = [
            [key, value.removesuffix(".0") if key == "cores" else value]
            for key, value in zip(same, found, strict=True)
        ]
        told.append(table(["", ""], [*lines, ["benchmarks", names]]))
    return parts("## Machine", *told)


def _not_run(find: Find) -> str:
    """What was left out, and why."""
    notes = find("notes")
    done = {run["benchmark"] for run in find("runs")}
    lines = [f"{row['benchmark']}: {row['what']}: {row['why']}" for row in notes]
    lines += [f"{name}: not run" for name in BENCHMARKS if name not in done]
    return parts("## Not run, or run less", items(*lines) or "Everything was run.")


def _draw(height: float, draw: Draw, path: Path) -> None:
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(figure_style.STYLE):
        figure = Figure(figsize=(8.0, height), dpi=100, layout="constrained")
        draw(figure)
        figure.savefig(path, metadata={"Software": None})
