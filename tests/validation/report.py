"""The report: every chapter, what is reproduced, and what is not."""

import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

from validation.calls import HERE, filled
from validation.published import OUTCOMES, Published
from validation.sections import Section, read, text


@dataclass(frozen=True)
class Chapter:
    """The sections of one subject; those of a `source` are counted in the summary."""

    title: str
    intro: str
    sections: tuple[Section, ...]
    source: bool

    def markdown(self) -> str:
        """The chapter as text."""
        head = [f"## {self.title}"] + ([self.intro] if self.intro else [])
        return "\n\n".join([*head, *(section.markdown() for section in self.sections)])

    @property
    def numbers(self) -> list[Published]:
        """Every published number of the chapter."""
        return [number for section in self.sections for number in section.numbers]


@cache
def chapters() -> tuple[Chapter, ...]:
    """The chapters, in the order of their files."""
    found = []
    for path in sorted((HERE / "report").glob("*.toml")):
        given = tomllib.loads(path.read_text(encoding="utf-8"))
        source = path.stem.partition("_")[2]
        sections = tuple(read(given.get("defaults", {}) | each, source) for each in given["section"])
        found.append(Chapter(given["title"], text(given.get("intro", "")), sections, given["source"]))
    return tuple(found)


def markdown() -> str:
    """The whole report."""
    sources = [chapter for chapter in chapters() if chapter.source]
    intro = filled((HERE / "report" / "introduction.md").read_text(encoding="utf-8")).strip()
    parts = [intro, _summary(sources), _missed(sources), *(chapter.markdown() for chapter in chapters())]
    return "\n\n".join(parts) + "\n"


def counts(numbers: list[Published]) -> list[str]:
    """Counts of numbers, and of those with each outcome."""
    found = Counter(number.outcome for number in numbers)
    return [str(len(numbers)), *(str(found[outcome]) for outcome in OUTCOMES)]


def _summary(sources: list[Chapter]) -> str:
    heads = ["source", "numbers", *OUTCOMES.values()]
    lines = [heads, ["---"] * len(heads)]
    lines += [[chapter.title, *counts(chapter.numbers)] for chapter in sources]
    lines.append(["all", *counts([number for chapter in sources for number in chapter.numbers])])
    return "## Summary\n\n" + "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _missed(sources: list[Chapter]) -> str:
    lines = ["## Not reproduced"]
    for chapter in sources:
        if found := list(_missed_of(chapter.sections)):
            lines.append(f"**{chapter.title}**\n\n" + "\n".join(found))
    return "\n\n".join(lines)


def _missed_of(sections: tuple[Section, ...]) -> Iterator[str]:
    for section in sections:
        if lines := [f"  - {line}" for line in section.missed()]:
            yield "\n".join([f"- {section.title}", *lines])
