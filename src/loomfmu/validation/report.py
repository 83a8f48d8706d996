"""The report: every chapter, what is reproduced, and the figures."""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from ..extras import installed
from ..files import check_target, starts_with, write_file
from . import (
    accuracy,
    arithmetic,
    attack,
    belt,
    cam,
    cyclograms,
    design,
    dwells,
    errata_dobby,
    errata_laws,
    errata_others,
    errata_weft,
    errors,
    findings,
    loads,
    lock,
    plots,
    productivity,
    reed,
    roller,
    rotor,
    warp,
    wrap,
)
from .sections import (
    CALCULATION,
    CONSISTENT,
    DERIVED,
    MEASUREMENT,
    OUTCOMES,
    USED,
    Chapter,
    Pair,
    Section,
    number,
)

NAME = "validation.md"
REPORT = starts_with("a report of loomfmu validate", b"# Validation\n")


def _share(value: float) -> str:
    return f"{number(100.0 * value, 0)} %"


INTRO = f"""# Validation

The published numbers that can be computed, table by table, beside what the components compute.
Written by `loomfmu validate`. Where a published number was used to choose a value, it is marked and
counted apart.

- A published calculation is met if the computed number is within {_share(CALCULATION)} of
  it, a measurement if within {_share(MEASUREMENT)}; either also if it differs by at most one unit of
  the last printed digit. For angles that mark a position, where a percentage means nothing, only that unit
  counts.
- Meeting a number does not always prove the same. Without a mark it was computed by a component or a design
  function. {DERIVED} marks a number that follows by a known factor, such as 1/mu or 1/sqrt(m), from one that
  was used or is counted elsewhere. {CONSISTENT} marks one that follows from others of its source, by
  arithmetic or by a fit: that tests no component. Inequalities are counted apart: many values meet a bound.
- {USED} marks a published number that was used to choose a value, a dimension or a law. Meeting it proves
  nothing. One that is not met in spite of that counts as not reproduced.
- Whatever is not reproduced is marked in the last column, with both values, and listed below.
- Published numbers are shown as printed, computed ones with more digits. The difference is computed minus
  published, in percent of the published number.
- "Misprint" means that the section Errata shows by calculation that the printed number is wrong.
- Left out are tables from which no printed number follows: prices (Korolev, Table 1.2), letters for
  functions (2.3), shares of faults (2.5), ranges of friction (3.2), and of Appendix 1 all but the weft used.
  Most figures of the sources are lost; where one is named, its numbers are given in the text."""


def chapters() -> tuple[Chapter, ...]:
    """The chapters of the sources."""
    return (
        belt.chapter(),
        wrap.chapter(),
        Chapter(
            "Rotary dobby (Korolev, thesis, Moscow 2014)",
            "Most of the source's curves are in figures that are lost.",
            (
                *arithmetic.sections(), cyclograms.section(), *rotor.sections(), dwells.section(),
                *loads.sections(), *cam.sections(), *lock.sections(), *warp.sections(),
                *productivity.sections(),
            ),
        ),
        reed.chapter(),
        roller.chapter(),
    )  # fmt: skip


def errata() -> Chapter:
    """The misprints of all sources."""
    return Chapter(
        "Errata",
        "The misprints and slips found in the sources, each with the calculation that shows it. The"
        " components use the corrected forms.",
        (
            *errata_weft.sections(),
            errata_laws.section(),
            *errata_dobby.sections(),
            *errata_others.sections(),
        ),
    )


def text() -> str:
    """The whole report."""
    of_sources = chapters()
    parts = [INTRO, _summary(of_sources), _missed(of_sources)]
    parts += [
        chapter.markdown()
        for chapter in (
            *of_sources, errata(), findings.chapter(), design.chapter(), accuracy.chapter(),
            errors.chapter(), attack.chapter(),
        )
    ]  # fmt: skip
    return "\n\n".join(parts) + "\n"


def write(directory: Path, overwrite: bool = False) -> list[Path]:
    """Write the report into a directory, and its figures beside it if the extra `plot` is installed.

    `overwrite` also replaces files that are neither such a report nor a picture. Raises LoomfmuError.
    """
    path = directory / NAME
    check_target(path, REPORT, overwrite=overwrite)
    figures = plots.write(directory / "validation", overwrite) if installed("plot") else []
    return [write_file(path, text().encode(), REPORT, overwrite=overwrite), *figures]


def _counts(pairs: list[Pair]) -> list[str]:
    """Counts of numbers, and of those with each outcome."""
    counts = Counter(pair.outcome for pair in pairs)
    return [str(len(pairs)), *(str(counts[outcome]) for outcome in OUTCOMES)]


def _summary(of_sources: tuple[Chapter, ...]) -> str:
    heads = ["source", "numbers", *OUTCOMES.values()]
    lines = [heads, ["---"] * len(heads)]
    everything: list[Pair] = []
    for chapter in of_sources:
        pairs = [pair for section in chapter.sections for pair in section.pairs]
        everything += pairs
        lines.append([chapter.title, *_counts(pairs)])
    lines.append(["all", *_counts(everything)])
    return "## Summary\n\n" + "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _missed(of_sources: tuple[Chapter, ...]) -> str:
    lines = ["## Not reproduced"]
    for chapter in of_sources:
        found = list(_missed_of(chapter.sections))
        if found:
            lines.append(f"**{chapter.title}**\n\n" + "\n".join(found))
    return "\n\n".join(lines)


def _missed_of(sections: tuple[Section, ...]) -> Iterator[str]:
    for section in sections:
        lines = [f"  - {line}" for line in section.missed()]
        if lines:
            yield "\n".join([f"- {section.title}", *lines])
