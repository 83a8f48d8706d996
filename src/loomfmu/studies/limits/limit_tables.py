"""Limits as people read them: tables, sentences, CSV, pictures."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...display import printed
from ...display.printed import say
from ...errors import LoomfmuError
from ...files import Kind, check_target, write_file
from ...report import pictures
from ...sweeps.varied import labelled
from ...traces.plotting import COLOURS, DASHES, HOLDS, HOLDS_LINE, figure, fixed_style
from ..span import Span
from .results import (
    HEADINGS,
    SAME_EVERYWHERE,
    Boundary,
    ClaimLimits,
    Limits,
    boundary_headings,
    boundary_rows,
    conclusion,
    proofs,
    rows,
    unsettled,
)

CSV_LIMITS = ("claim", "begins", "value", "low", "high", "error", "unit", "jumps")


def check(path: Path, inputs: Sequence[Path], overwrite: bool) -> None:
    """Refuse a file of limits that cannot be written. Raises LoomfmuError."""
    if path.suffix == ".csv":
        check_target(path, TABLE, inputs, overwrite)
    elif path.suffix in pictures.PICTURES:
        pictures.check(path, inputs, overwrite)
    else:
        raise LoomfmuError(f"{path}: use .csv for a table, or .svg, .png or .pdf for a picture")


def write(found: Limits | Boundary, path: Path, inputs: Sequence[Path], overwrite: bool) -> None:
    """Write limits as a table or a picture."""
    if path.suffix == ".csv":
        text = boundary_table(found) if isinstance(found, Boundary) else table(found)
        write_file(path, text.encode(), TABLE, inputs, overwrite)
    else:
        pictures.save(draw(found), path, found.title, inputs, overwrite)


def _is_table(path: Path) -> bool:
    with path.open(encoding="utf-8", errors="replace") as file:
        line = file.readline(2000).rstrip("\n")
    return line == ",".join(CSV_LIMITS) or line.endswith(",binding below,binding above")


TABLE = Kind("a table of limits", _is_table)


def show(found: Limits | Boundary) -> None:
    """Print limits."""
    if isinstance(found, Boundary):
        show_boundary(found)
    else:
        show_limits(found)


def show_limits(found: Limits) -> None:
    """Print the limits of one variable."""
    span = found.span
    say(f"{found.title}: {span.key} from {span.text} ({span.source})")
    table, at = rows(found), span.show(span.value)
    entries = [
        (f"{claim}:", f"holds {ranges}", f"({_remark(limits)}{own} at {at})")
        for claim, ranges, limits, own in table
    ]
    printed.show((*HEADINGS[:3], f"distance at {at}"), table, entries)
    say(*conclusion(found), "", *([*proofs(found), ""] if found.proved else []), _effort(found.runs, [found]))


def _remark(limits: str) -> str:
    """Return the remark on limits beside the range in which the claim holds."""
    return f"{limits}; " if "jumps" in limits or limits.startswith(SAME_EVERYWHERE) else ""


def _effort(runs: int, found: Sequence[Limits]) -> str:
    """Return how many runs it took, how far the limits may be off, and what may be missed."""
    span, resolution = found[0].span, found[0].span.show(found[0].resolution)
    every = [limit for row in found for each in row.claims for limit in each.limits]
    off = max((each for each in every if not each.jumps), key=lambda limit: limit.error, default=None)
    parts = [f"{runs} runs"]
    if off and math.isfinite(off.error):
        unit = "" if span.unit == "1" else f" {span.unit}"
        parts.append(f"numerical error of the limits up to {off.error / span.factor:.1g}{unit}")
    elif off:
        parts.append(f"numerical error of the limits unknown ({off.doubt or 'not estimated'})")
    if any(each.jumps for each in every):
        parts.append("that of jumps not estimated" if off else "numerical error of the jumps not estimated")
    return "; ".join((*parts, f"intervals narrower than {resolution} may be missed"))


def table(found: Limits) -> str:
    """All limits as CSV, in the unit that people read the variable in."""
    lines: list[Sequence[str]] = [CSV_LIMITS]
    for each in found.claims:
        for limit in each.limits:
            numbers = _numbers(found.span, limit.value, limit.low, limit.high, limit.error)
            lines.append((each.claim, limit.begins, *numbers, found.span.unit, str(limit.jumps).lower()))
    return printed.as_csv(lines)


# ---- two variables


def show_boundary(found: Boundary) -> None:
    """Print the limits of the first variable over the second."""
    first, second = found.first, found.second
    say(f"{found.title}: {first.key} from {first.text} ({first.source}),")
    say(f"at {len(found.values)} values of {second.key} from {second.text} ({second.source})")
    lines, headings = boundary_rows(found), boundary_headings(found)
    printed.show(
        headings, lines, [(f"{place} {second.unit}:", f"{ends};", binding) for place, ends, binding in lines]
    )
    if not any(each.depends for each in found.rows):
        say(
            f"No claim depends on {first.key} between {first.number(first.low)} and {first.show(first.high)}."
        )
    for place, row in zip(found.values, found.rows, strict=True):
        if sentence := next(unsettled(row), ""):
            say(f"With {second.key} = {second.show(place)}: {sentence[0].lower()}{sentence[1:]}")
            break  # the others are alike
    say(_effort(sum(each.runs for each in found.rows), found.rows))


def boundary_table(found: Boundary) -> str:
    """The ranges in which all claims hold as CSV."""
    first, second = found.first, found.second
    one = f"{first.key} [{first.unit}]"
    lines: list[Sequence[str]] = [
        (f"{second.key} [{second.unit}]", f"low {one}", f"high {one}", "binding below", "binding above")
    ]
    for value, limits in zip(found.values, found.rows, strict=True):
        for stretch in limits.ranges:
            ends = _numbers(first, stretch.low, stretch.high)
            lines.append((*_numbers(second, value), *ends, stretch.below, stretch.above))
    return printed.as_csv(lines)


def _numbers(span: Span, *values: float) -> list[str]:
    return [f"{value / span.factor:.13g}" for value in values]


SIZE = (8.0, 4.6)  # [in]
FARTHEST = 1.5  # times the bound: distances beyond that are cut off, so that all claims can be seen near 0


@fixed_style()
def draw(found: Limits | Boundary) -> Any:
    """A figure of matplotlib. Raises LoomfmuError if that is not installed."""
    drawn = figure(SIZE)
    axes = drawn.subplots()
    if isinstance(found, Boundary):
        _boundary(axes, found)
    else:
        _distances(axes, found)
    axes.set_title(found.title, fontsize=11)
    drawn.legend(loc="outside lower center", fontsize=8, ncols=2)
    return drawn


def _distances(axes: Any, found: Limits) -> None:
    span = found.span
    for stretch in found.ranges:
        axes.axvspan(stretch.low / span.factor, stretch.high / span.factor, color=HOLDS, zorder=0)
    lowest, highest = 0.0, 0.0
    for number, each in enumerate(found.claims):
        scale = _scale(each)
        x, y = (np.array(column) for column in zip(*each.points, strict=True))
        colour, dash = COLOURS[number % len(COLOURS)], DASHES[number // len(COLOURS) % len(DASHES)]
        axes.plot(x / span.factor, y / scale, dash, color=colour, label=each.claim)
        known = y[np.isfinite(y)] / scale
        lowest, highest = min([lowest, *known]), max([highest, *known])
        places = [limit.value / span.factor for limit in each.limits]
        axes.plot(places, np.zeros(len(places)), "o", color=colour, markersize=5)
    axes.axhline(0.0, color="black", linewidth=1)
    margin = 0.05 * (highest - lowest) or 1.0
    axes.set_ylim(max(lowest - margin, -FARTHEST), min(highest + margin, FARTHEST))
    axes.set_xlim(span.low / span.factor, span.high / span.factor)
    axes.axvline(span.value / span.factor, color="grey", linewidth=1, linestyle=":")
    axes.set_xlabel(labelled(span.key, span.unit))
    axes.set_ylabel("distance to the bound, as a share of it")
    axes.grid(color="#e8e8e8")


def _scale(each: ClaimLimits) -> float:
    """Return the scale of a distance: the bound, or the farthest distance if the bound is 0."""
    known = [abs(distance) for _value, distance in each.points if np.isfinite(distance)]
    return abs(each.verdict.bound) or max(known, default=0.0) or 1.0


def _boundary(axes: Any, found: Boundary) -> None:
    first, second = found.first, found.second
    at = np.array(found.values) / second.factor
    for number, each in enumerate(found.rows[0].claims):
        places = [
            (place, limit.value / first.factor)
            for place, limits in zip(at.tolist(), found.rows, strict=True)
            for limit in limits.claims[number].limits
        ]
        alone = all(len(limits.claims[number].limits) <= 1 for limits in found.rows)
        if places:
            axes.plot(
                *zip(*places, strict=True),
                "-o" if alone else "o",
                markersize=4,
                color=COLOURS[number % len(COLOURS)],
                label=f"limit: {each.claim}",
            )
    for place, limits in zip(at.tolist(), found.rows, strict=True):
        for stretch in limits.ranges:
            axes.vlines(
                place,
                stretch.low / first.factor,
                stretch.high / first.factor,
                color=HOLDS_LINE,
                linewidth=5,
                zorder=0,
            )
    axes.plot([], [], color=HOLDS_LINE, linewidth=5, label="all claims hold")
    axes.set_xlim(second.low / second.factor, second.high / second.factor)
    axes.set_ylim(first.low / first.factor, first.high / first.factor)
    axes.set_xlabel(labelled(second.key, second.unit))
    axes.set_ylabel(labelled(first.key, first.unit))
    axes.grid(color="#e8e8e8")
