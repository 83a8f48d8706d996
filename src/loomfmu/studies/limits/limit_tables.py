"""Limits as people read them: tables, sentences, CSV, pictures."""

import math
from collections.abc import Sequence
from pathlib import Path

from ...display import printed
from ...display.printed import say
from ...errors import LoomfmuError
from ...files import Kind, check_target, write_file
from ...report import pictures
from ..span import Span
from .results import (
    HEADINGS,
    SAME_EVERYWHERE,
    Boundary,
    Limits,
    boundary_headings,
    boundary_rows,
    conclusion,
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
        from .picture import draw

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
    say(*conclusion(found), "", _effort(found.runs, [found]))


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
