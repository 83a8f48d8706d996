"""The outcome of a claim: as text for people, and as a trace stores it."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from types import NoneType
from typing import Any, Self

from .. import units
from ..display import notebook
from ..display.printed import brief, digits
from ..errors import shown

HEADINGS = ("verdict", "claim", "signal", "worst", "bound", "distance", "error", "at", "note")
HOLDS, FAILS, UNDECIDED = "holds", "FAILS", "undecided"
SHED_OPENING = "smallest shed opening at the head"  # a claim whose bound is the height of the head
REED_DISTANCE = "smallest distance from the front limit"  # a claim on the reed while the head is in the shed

# what JSON makes of the types of the fields
JSON: dict[Any, tuple[type, ...]] = {
    str: (str,),
    bool: (bool,),
    int: (int,),
    int | None: (int, NoneType),
    float: (float, int, NoneType),
}


@dataclass(frozen=True, repr=False)
class Verdict:
    """The outcome of a claim; true if the claim holds, false if it fails or is undecided.

    `worst` is the value nearest to the bound or furthest beyond it, at `time` [s] and at the shaft angle
    `angle` [rad] of the `revolution`, counted from 1; without a shaft these two are NaN and None. `worst`
    and `bound` are in `unit`, which is SI unless a third-party FMU has its own; texts show them in
    `display_unit`, where "1" means `unit`. `sense` is 1 if the worst value must be at least the bound,
    -1 if at most, and 0 if the trace does not say. `error` estimates how far `worst` is off by the numbers
    alone, in the same unit; NaN where nothing was estimated, infinite where the note says why it is
    not known. Where the bound is that near, or the signal is not known in part of the run, the claim is not
    `decided`, and does not hold. `spread` is the part of the error that differs between resolutions,
    `between` what the curves between samples may be off by, and `unsettled` says, as the note does, that a
    longer run comes nearer to the bound; traces keep none of them.

    `loss` is the most that tolerances may take from the distance, and `deviation` the standard deviation that
    they give it, in `unit` and to first order; NaN where the scene has no tolerances, or the note says why.
    """

    claim: str
    signal: str
    holds: bool
    bound: float
    worst: float
    unit: str
    display_unit: str
    time: float
    angle: float
    revolution: int | None
    note: str = ""
    sense: int = 0
    error: float = math.nan
    decided: bool = True
    spread: float = field(default=math.nan, compare=False)
    unsettled: str = field(default="", compare=False)
    between: float = field(default=0.0, compare=False)
    loss: float = field(default=math.nan, compare=False)
    deviation: float = field(default=math.nan, compare=False)

    def __bool__(self) -> bool:
        return self.holds

    def __repr__(self) -> str:
        return f"<Verdict {self}>"

    def __str__(self) -> str:
        place = f" at {self.place}" if self.place else ""
        note = f" ({self.note})" if self.note else ""
        return (
            f"{self.word}: {self.claim} ({self.signal}), {self.shown_worst}{place},"
            f" bound {self.shown(self.bound)}{self.reason}{note}"
        )

    @property
    def reason(self) -> str:
        """The reason why it is undecided, as the end of a sentence; empty if the note says why."""
        if self.decided or not math.isfinite(self.worst) or self.error == math.inf:
            return ""
        known = math.isfinite(self.error)
        return f", numerical error {self.shown_error}" if known else ", numerical error unknown"

    @property
    def distance(self) -> float:
        """The distance of the worst value from the bound, in `unit`; negative on the wrong side of it.

        It is continuous across the bound, so a root of it is a limit. NaN where there is none: the claim has
        no value, or fails for another reason than its bound (the note says which), or the trace does not say
        which side is the right one. A claim that counts has whole steps. Where only the curve between two
        samples passes the bound, by no more than it may be off, the claim is undecided with a negative one.
        """
        distance = self.sense * (self.worst - self.bound) + 0.0  # not -0
        known = distance < 0.0 if self.decided else math.isfinite(self.error)
        return distance if self.sense and (self.holds or known) else math.nan

    @property
    def relative_distance(self) -> float:
        """The distance as a share of the bound; NaN for a bound of 0."""
        return self.distance / abs(self.bound) if self.bound else math.nan

    @property
    def away(self) -> float:
        """The distance as a number of bounds, or in `unit` for a bound of 0: what orders verdicts."""
        return self.relative_distance if self.bound else self.distance

    @property
    def word(self) -> str:
        """The outcome in one word."""
        return HOLDS if self.holds else FAILS if self.decided else UNDECIDED

    @property
    def row(self) -> tuple[str, ...]:
        """The verdict as a row of a table below `HEADINGS`."""
        worst, bound, distance = self.shown_worst, self.shown(self.bound), self.shown_distance
        place, error = self.place or "-", self.shown_error
        return self.word, self.claim, self.signal, worst, bound, distance, error, place, self.note

    @property
    def shown_distance(self) -> str:
        """The distance in short: as a share of the bound, or in its unit if the bound is 0."""
        if math.isfinite(self.relative_distance):
            share, error = 100.0 * self.relative_distance, 100.0 * self.error / abs(self.bound)
            return f"{brief(share, digits(share, error, 4), '+')} %"
        if not math.isfinite(self.distance):
            return "-"
        return self._in_unit(self.distance, self._digits(self.distance, 4), "+")

    @property
    def shown_error(self) -> str:
        """The numerical error in short, in the unit that people read; "-" where none was estimated."""
        if not math.isfinite(self.error):
            return "-"
        return self._in_unit(self.error, 1)

    def _repr_html_(self) -> str:
        return notebook.table(HEADINGS, [self.row])

    @property
    def place(self) -> str:
        """Time and shaft angle of the worst value as text; empty if there are none."""
        if not math.isfinite(self.time):
            return ""
        return place_text(self.time, self.angle, self.revolution)

    def displayed(self, value: float) -> float:
        """One of the verdict's values in its display unit."""
        if self.display_unit in ("1", self.unit):
            return value
        return value * units.unit(self.unit).factor / units.unit(self.display_unit).factor

    def shown(self, value: float, most: int = 7) -> str:
        """A value in the verdict's unit as text, with up to so many digits."""
        return self._in_unit(value, most) if math.isfinite(value) else "no value"

    @property
    def shown_worst(self) -> str:
        """The worst value as text, with the digits that its error allows."""
        return self.known(self.worst)

    def known(self, value: float) -> str:
        """A value that is as far off as the worst one, such as the distance, with the digits of its error."""
        return self.shown(value, self._digits(value))

    def _digits(self, value: float, most: int = 7) -> int:
        return digits(self.displayed(value), self.displayed(self.error), most)

    def _in_unit(self, value: float, figures: int, sign: str = "") -> str:
        number = brief(self.displayed(value), figures, sign)
        return number if self.label == "1" else f"{number} {self.label}"

    @property
    def label(self) -> str:
        """The unit shown beside the values."""
        return self.unit if self.display_unit == "1" else self.display_unit

    def as_dict(self) -> dict[str, Any]:
        """The verdict for JSON, null for what is not finite; `display` has the values in the display unit."""
        known = {field.name: getattr(self, field.name) for field in fields(self)}
        for name in ("display_unit", "spread", "unsettled", "between"):
            del known[name]
        for name in ("loss", "deviation"):
            if math.isnan(known[name]):
                del known[name]
        known |= {"distance": self.distance, "relative_distance": self.relative_distance}
        display = {name: self.displayed(known[name]) for name in ("bound", "worst", "distance", "error")}
        return _finite(known) | {"display": _finite(display) | {"unit": self.label}}

    @classmethod
    def of(cls, stored: dict[str, Any]) -> Self:
        """The verdict that `as_dict` made this of. Raises ValueError for what it cannot have made."""
        if not isinstance(stored, dict):
            raise ValueError(f"{shown(stored)} is not a JSON object")
        known = {each.name: stored[each.name] for each in fields(cls) if each.name in stored}
        for each in fields(cls):
            if each.name not in known and each.default is MISSING and each.name != "display_unit":
                raise ValueError(f"{each.name} is missing")
            if each.name in known and not isinstance(known[each.name], JSON[each.type]):
                raise ValueError(f"{each.name} = {shown(known[each.name])}")
        for name in ("bound", "worst", "time", "angle", "error"):
            if name in known:  # a trace of an earlier version has no errors
                known[name] = math.nan if known[name] is None else float(known[name])
        if not known.get("decided", True) and math.isnan(known.get("error", 0.0)):
            known["error"] = math.inf
        if "display" in stored:
            return cls(**known, display_unit=stored["display"]["unit"])
        # as version 0.1.0 stored them: SI values beside the unit that people read them in
        return cls(**(known | {"unit": units.si(known["unit"])}), display_unit=known["unit"])


def remarked(verdicts: Sequence[Verdict], remarks: Mapping[int, str]) -> tuple[Verdict, ...]:
    """Return verdicts with remarks on some of them, by their numbers counted from 0, after their notes."""
    notes = (filter(None, (each.note, remarks.get(number))) for number, each in enumerate(verdicts))
    return tuple(replace(each, note="; ".join(note)) for each, note in zip(verdicts, notes, strict=True))


def place_text(time: float, angle: float, revolution: int | None) -> str:
    """Return a time [s] and, where a shaft turns, its angle [rad] and the revolution, as people read them."""
    if revolution is None:
        return f"{time:.6g} s"
    return f"{time:.6g} s, {math.degrees(angle):.3f} deg, rev. {revolution}"


def _finite(values: dict[str, Any]) -> dict[str, Any]:
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in values.items()
    }


def outcome(verdicts: Iterable[Verdict]) -> str:
    """Return the outcome of all claims in a few words, such as "1 of 6 claims fails, 1 is undecided"."""
    words = [verdict.word for verdict in verdicts]
    failing, undecided = words.count(FAILS), words.count(UNDECIDED)
    parts = [f"{failing} of {len(words)} claims fail{'s' * (failing == 1)}"] * bool(failing)
    if undecided:
        of_all = "" if failing else f" of {len(words)} claims"
        parts.append(f"{undecided}{of_all} {'is' if undecided == 1 else 'are'} undecided")
    return ", ".join(parts)
