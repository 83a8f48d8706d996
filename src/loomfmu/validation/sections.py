"""What the report is made of: published numbers beside computed ones, rows of them, sections.

A number is shown with a fixed count of decimals. Before that it is cut to eight significant digits, and a
tie is rounded away from zero, so that the report does not depend on the last bits of a computation.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import ROUND_HALF_UP, Context, Decimal

# A computed number reproduces a published calculation if it lies within this share of it, a measurement
# within the other, or either within one unit of the last printed digit; a place on the shaft's circle, for
# which a share means nothing, within that unit alone.
CALCULATION = 0.02
MEASUREMENT = 0.05
USED = "\N{DAGGER}"  # marks a published number that was used to choose a value
# What a number that is met proves, each with its mark: the model, if a component or a design function of
# loomfmu computes it; a known factor, if it follows by one from a number that is used or counted elsewhere;
# or nothing but the source's own arithmetic
COMPUTED, DERIVED, CONSISTENT = "", "\N{DOUBLE DAGGER}", "\N{SECTION SIGN}"
MARKS = USED + DERIVED + CONSISTENT
# What becomes of a published number, as the summary counts it
OUTCOMES = {
    COMPUTED: "computed by a component and met",
    DERIVED: f"derived from another number and met{DERIVED}",
    CONSISTENT: f"consistent within the source{CONSISTENT}",
    "inequality": "inequalities met",
    USED: f"met, but used{USED}",
    "misprint": "misprints",
    "measured": "measurements not reproduced",
    "other": "other numbers not reproduced",
}

_EIGHT_DIGITS = Context(prec=8, rounding=ROUND_HALF_UP)


def number(value: float, digits: int, sign: bool = False) -> str:
    """A number with a fixed count of decimals, rounded alike on every machine.

    >>> number(0.1 + 0.2, 1), number(2.5 - 1e-13, 0), number(-1e-12, 3), number(1.25, 1, sign=True)
    ('0.3', '3', '0.000', '+1.3')
    """
    if not math.isfinite(value):
        raise ValueError(f"{value} has no place in the report")
    shown = rounded(value, digits)
    return f"{shown:+f}" if sign and shown != 0 else f"{shown:f}"


def rounded(value: float, digits: int) -> Decimal:
    """The decimal that stands for a number, zero without a sign."""
    cut = _EIGHT_DIGITS.create_decimal_from_float(value)
    shown = cut.quantize(Decimal(1).scaleb(-digits), rounding=ROUND_HALF_UP)
    return shown if shown != 0 else abs(shown)


def small(value: float, floor: float) -> str:
    """A small error with one digit, or that it is below a floor at which rounding shows.

    >>> small(3.21e-5, 1e-9), small(2e-13, 1e-9)
    ('3e-05', 'below 1e-09')
    """
    return f"{value:.0e}" if value >= floor else f"below {floor:.0e}"


@dataclass(frozen=True)
class Pair:
    """A published number, as it is printed, beside the computed one.

    `digits` are the decimals of the computed one; `place` says that it is a place on the shaft's circle,
    `misprint` that the printed number is known to be wrong, `used` that it was used to choose a value, so
    that meeting it proves nothing; `proves` is what meeting it proves otherwise; `sense` is "=" or, where the
    source gives a bound, ">=" or "<=".
    """

    published: str
    computed: float
    digits: int
    measured: bool = False
    place: bool = False
    misprint: bool = False
    used: bool = False
    sense: str = "="
    proves: str = COMPUTED

    @property
    def value(self) -> float:
        """The published number."""
        return float(self.published)

    @property
    def difference(self) -> float:
        """By how much the computed number exceeds the published one, in percent of the latter."""
        return 100.0 * (self.computed - self.value) / abs(self.value)

    @property
    def reproduced(self) -> bool:
        """Whether the computed number stands for the published one."""
        if self.sense == ">=":
            return self.computed >= self.value
        if self.sense == "<=":
            return self.computed <= self.value
        unit = float(Decimal(1).scaleb(int(Decimal(self.published).as_tuple().exponent)))
        share = MEASUREMENT if self.measured else CALCULATION
        if self.place:
            share = 0.0
        return abs(self.computed - self.value) <= max(share * abs(self.value), unit) * (1.0 + 1e-9)

    @property
    def outcome(self) -> str:
        """What becomes of it, a key of `OUTCOMES`."""
        if self.reproduced:
            return USED if self.used else self.proves if self.sense == "=" else "inequality"
        return "misprint" if self.misprint else "measured" if self.measured else "other"

    @property
    def shown(self) -> tuple[str, str, str]:
        """Published, with its mark, computed, difference in percent."""
        bound = {">=": "at least ", "<=": "at most ", "=": ""}[self.sense]
        published = bound + self.published + (USED if self.used else self.proves)
        return published, number(self.computed, self.digits), number(self.difference, 1, True)

    @property
    def verdict(self) -> str:
        """Both values, where the number is not reproduced."""
        if self.reproduced:
            return ""
        what = "measured" if self.measured else "published"
        why = " (misprint, see Errata)" if self.misprint else ""
        published, computed, _difference = self.shown
        return f"{what} {published}, computed {computed}{why}"


def consistent(
    published: str, computed: float, digits: int, *, place: bool = False, misprint: bool = False
) -> Pair:
    """A number that follows from others of its source, and tests no component."""
    return Pair(published, computed, digits, place=place, misprint=misprint, proves=CONSISTENT)


Cell = str | Pair


@dataclass(frozen=True)
class Row:
    """Cells of a row, and a remark on it."""

    cells: tuple[Cell, ...]
    remark: str = ""


@dataclass(frozen=True)
class Section:
    """A table with its title, an introduction, remarks after it, and its figures.

    With `split` every pair takes three columns, headed "published", "computed" and "difference, %";
    without it one cell holds all three. The first `labels` columns name a row. `figures` are names of
    image files and their captions.
    """

    title: str
    heads: tuple[str, ...]
    rows: tuple[Row, ...]
    intro: str = ""
    remarks: tuple[str, ...] = ()
    split: bool = True
    labels: int = 1
    figures: tuple[tuple[str, str], ...] = ()

    @property
    def pairs(self) -> list[Pair]:
        """Every published number of the table."""
        return [cell for row in self.rows for cell in row.cells if isinstance(cell, Pair)]

    def missed(self) -> Iterator[str]:
        """A line for each row with a number that is not reproduced: its label and both values."""
        for row in self.rows:
            label = ", ".join(str(cell) for cell in row.cells[: self.labels])
            verdicts = self._verdicts(row)
            if verdicts:
                yield f"{label}: {verdicts}"

    @property
    def _columns(self) -> list[int]:
        """The columns that hold pairs."""
        return [
            index
            for index in range(len(self.heads))
            if any(isinstance(row.cells[index], Pair) for row in self.rows)
        ]

    def markdown(self) -> str:
        """The section as text."""
        parts = [f"### {self.title}", self.intro]
        if self._columns and not self.split:
            parts.append("Each cell: published / computed / difference in percent.")
        parts.append(self._table())
        parts.append("\n".join(f"- {remark}" for remark in self.remarks))
        parts.extend(f"![{caption}](validation/{name})\n\n*{caption}.*" for name, caption in self.figures)
        return "\n\n".join(part for part in parts if part)

    def _table(self) -> str:
        heads: list[str] = []
        for index, head in enumerate(self.heads):
            if index in self._columns and self.split:
                prefix = f"{head}: " if head else ""
                heads += [f"{prefix}published", f"{prefix}computed", f"{prefix}difference, %"]
            else:
                heads.append(head)
        rows = [self._cells(row) for row in self.rows]
        if any(row[-1] for row in rows):
            heads.append("remark")
        else:
            rows = [row[:-1] for row in rows]
        lines = [heads, ["---"] * len(heads), *rows]
        return "\n".join("| " + " | ".join(line) + " |" for line in lines)

    def _cells(self, row: Row) -> list[str]:
        """Cells as text, the remark last."""
        columns = self._columns
        texts: list[str] = []
        for index, cell in enumerate(row.cells):
            if isinstance(cell, Pair):
                texts += cell.shown if self.split else [" / ".join(cell.shown)]
            else:
                texts += ["", cell, ""] if self.split and index in columns else [cell]
        return [*texts, self._remark(row)]

    def _remark(self, row: Row) -> str:
        """Remark on a row: its numbers that are not reproduced, then its own remark."""
        missed = self._verdicts(row)
        parts = [f"not reproduced: {missed}" if missed else "", row.remark]
        return "; ".join(part for part in parts if part)

    def _verdicts(self, row: Row) -> str:
        """Numbers of a row that are not reproduced, with both values."""
        return "; ".join(
            f"{head}: {cell.verdict}" if head else cell.verdict
            for head, cell in zip(self.heads, row.cells, strict=True)
            if isinstance(cell, Pair) and not cell.reproduced
        )


@dataclass(frozen=True)
class Chapter:
    """The sections of one source."""

    title: str
    intro: str
    sections: tuple[Section, ...]

    def markdown(self) -> str:
        """The chapter as text."""
        head = [f"## {self.title}"] + ([self.intro] if self.intro else [])
        return "\n\n".join([*head, *(section.markdown() for section in self.sections)])
