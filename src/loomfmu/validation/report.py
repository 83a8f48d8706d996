"""The report: every chapter, what of it is reproduced, and the figures."""

from collections.abc import Iterator
from pathlib import Path

from ..files import check_target, starts_with, write_file
from . import (
    accuracy,
    belt,
    cam,
    design,
    errata_dobby,
    errata_laws,
    errata_others,
    errata_weft,
    findings,
    lock,
    plots,
    productivity,
    reed,
    roller,
    rotor,
    warp,
    wrap,
)
from .sections import CALCULATION, MEASUREMENT, Chapter, Pair, Section, number

NAME = "validation.md"
REPORT = starts_with("a report of loomfmu validate", b"# Validation\n")


def _share(value: float) -> str:
    return f"{number(100.0 * value, 0)} %"


INTRO = f"""# Validation

Every table and figure of the sources that has numbers to compute, beside what the components compute.
Written by `loomfmu validate`. Nothing was tuned to bring the two closer.

- A published calculation counts as reproduced if the computed number lies within
  {_share(CALCULATION)} of it, a measurement if within {_share(MEASUREMENT)}, and either if it is off by
  no more than one unit of the last printed digit. For places on the shaft's circle, of which a percentage
  means nothing, that unit alone counts.
- Of what is not reproduced the last column says so, with both values; and all of it is listed below.
- Published numbers are shown as they are printed, computed ones with more digits. The difference is that of
  the computed number from the published one, in percent of the latter.
- "Misprint" is what the section Errata shows by calculation.
- Left out are tables with nothing to compute: prices, energy, ratings by experts and the like (Korolev,
  Tables 1.2, 1.3, 2.1 to 2.5 and 3.2, and the rest of Appendix 1). Most figures of the sources are lost;
  where one is named, its numbers stand in the text."""


def chapters() -> tuple[Chapter, ...]:
    """The chapters of the sources."""
    return (
        belt.chapter(),
        wrap.chapter(),
        Chapter(
            "Rotary dobby (Korolev, thesis, Moscow 2014)",
            "Most of the source's curves stand in figures that are lost.",
            (
                *rotor.sections(), *cam.sections(), *lock.sections(), *warp.sections(),
                *productivity.sections(),
            ),
        ),
        reed.chapter(),
        roller.chapter(),
    )  # fmt: skip


def errata() -> Chapter:
    """All misprints."""
    return Chapter(
        "Errata",
        "Every misprint and slip that was found in the sources, with the calculation that shows it. The"
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
        for chapter in (*of_sources, errata(), findings.chapter(), design.chapter(), accuracy.chapter())
    ]
    return "\n\n".join(parts) + "\n"


def write(directory: Path, overwrite: bool = False) -> list[Path]:
    """Write the report into a directory, and its figures beside it if matplotlib is there.

    `overwrite` replaces what is neither such a report nor a picture. Raises LoomfmuError.
    """
    path = directory / NAME
    check_target(path, REPORT, overwrite=overwrite)
    figures = plots.write(directory / "validation", overwrite) if plots.available() else []
    return [write_file(path, text().encode(), REPORT, overwrite=overwrite), *figures]


def _counts(pairs: list[Pair]) -> list[str]:
    """How many numbers there are, are reproduced, are not, and are misprints of the source."""
    missed = [pair for pair in pairs if not pair.reproduced]
    slips = [pair for pair in missed if pair.misprint]
    measured = [pair for pair in missed if pair.measured]
    others = len(missed) - len(slips) - len(measured)
    counts = (len(pairs), len(pairs) - len(missed), len(slips), len(measured), others)
    return [str(count) for count in counts]


def _summary(of_sources: tuple[Chapter, ...]) -> str:
    heads = [
        "source",
        "numbers",
        "reproduced",
        "misprints",
        "measurements not met",
        "not reproduced otherwise",
    ]
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
