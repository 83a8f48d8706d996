"""A published number beside the computed one, and what becomes of it."""

import csv
from dataclasses import dataclass
from decimal import Decimal

from validation.calls import HERE
from validation.digits import number

with (HERE / "tables" / "criteria.csv").open(newline="", encoding="utf-8") as _file:
    CRITERIA = {row["criterion"]: row for row in csv.DictReader(_file)}
# The roles of a published number, each with its mark: one that a component computes, one that follows by a
# known factor from another, one that follows from others of its source, and one that was used
MARKS = {
    "computed": "",
    "derived": "\N{DOUBLE DAGGER}",
    "consistent": "\N{SECTION SIGN}",
    "used": "\N{DAGGER}",
}
# What becomes of a published number, as the summary counts it
OUTCOMES = {
    "computed": "computed by a component and met",
    "derived": f"derived from another number and met{MARKS['derived']}",
    "consistent": f"consistent within the source{MARKS['consistent']}",
    "inequality": "inequalities met",
    "used": f"met, but used{MARKS['used']}",
    "misprint": "misprints",
    "measured": "measurements not reproduced",
    "other": "other numbers not reproduced",
}


@dataclass(frozen=True)
class Published:
    """A published number, as it is printed, beside the computed one in the same unit.

    `digits` are the decimals of the computed one. `criterion` is a row of `tables/criteria.csv`, `role` a key
    of `MARKS`; `misprint` says that the printed number is known to be wrong.
    """

    printed: str
    computed: float
    digits: int
    criterion: str = "calculation"
    role: str = "computed"
    misprint: bool = False

    @property
    def difference(self) -> float:
        """By how much the computed number exceeds the published one, in percent of the latter."""
        return 100.0 * (self.computed - float(self.printed)) / abs(float(self.printed))

    @property
    def reproduced(self) -> bool:
        """Tells if the computed number stands for the published one."""
        bound, value = CRITERIA[self.criterion]["bound"], float(self.printed)
        if bound:
            return self.computed >= value if bound == "at least" else self.computed <= value
        unit = float(Decimal(1).scaleb(int(Decimal(self.printed).as_tuple().exponent)))
        share = float(CRITERIA[self.criterion]["share"])
        return abs(self.computed - value) <= max(share * abs(value), unit) * (1.0 + 1e-9)

    @property
    def outcome(self) -> str:
        """The key of `OUTCOMES`."""
        if self.reproduced:
            bounded = CRITERIA[self.criterion]["bound"] and self.role != "used"
            return "inequality" if bounded else self.role
        if self.misprint:
            return "misprint"
        return "measured" if self.criterion == "measurement" else "other"

    @property
    def cells(self) -> tuple[str, str, str]:
        """Published, with its mark, computed, difference in percent."""
        bound = CRITERIA[self.criterion]["bound"]
        published = f"{bound} {self.printed}".strip() + MARKS[self.role]
        return published, number(self.computed, self.digits), number(self.difference, 1, sign=True)

    @property
    def verdict(self) -> str:
        """Both values, where the number is not reproduced."""
        if self.reproduced:
            return ""
        what = "measured" if self.criterion == "measurement" else "published"
        published, computed, _difference = self.cells
        return f"{what} {published}, computed {computed}" + " (misprint, see Errata)" * self.misprint
