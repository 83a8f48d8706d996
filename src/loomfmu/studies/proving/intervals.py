"""Intervals for the check of a proof: the components' Python computes with them instead of numbers.

Their ends are rounded outwards; python-flint gives the functions. A comparison that intervals leave open is
decided both ways, one after the other, and the results are joined. The prover has none of this.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any

from flint import arb, ctx

MOST_WAYS, MOST_DECISIONS = 64, 12
Ends = tuple[float, float]
ALL: Ends = (-math.inf, math.inf)
NONE: Ends = (0.0, 0.0)


ctx.prec = 80  # bits: a function of an end is then off by less than the rounding of its result


class Unknown(Exception):
    """More ways than are tried, or a number that is not defined everywhere: nothing is known of the box."""


def _outwards(low: float, high: float) -> Ends:
    return (math.nextafter(low, -math.inf), math.nextafter(high, math.inf)) if low <= high else ALL


def _sum(a: Ends, b: Ends) -> Ends:
    """Add bounds: a sum that is 0, or has one that is, is exact."""
    if a == NONE or b == NONE:
        return b if a == NONE else a
    low, high = a[0] + b[0], a[1] + b[1]
    found = _outwards(low, high)
    return (low if low == 0.0 else found[0]), (high if high == 0.0 else found[1])


def _times(x: float, y: float) -> float:
    """Multiply bounds: an infinite one is no value, and a product of others is not 0."""
    if not x or not y:
        return 0.0
    return x * y or math.copysign(5e-324, x) * math.copysign(1.0, y)


def _product(a: Ends, b: Ends) -> Ends:
    for one, other in ((a, b), (b, a)):  # exact
        if one == (1.0, 1.0):
            return other
        if one == (-1.0, -1.0):
            return -other[1], -other[0]
    every = [_times(x, y) for x in a for y in b]
    low, high = min(every), max(every)
    low, high = (
        (low if low == 0.0 else math.nextafter(low, -math.inf)),
        (high if high == 0.0 else math.nextafter(high, math.inf)),
    )
    return (low, high) if not math.isnan(sum(every)) else ALL


def _inverse(a: Ends, not_zero: bool = False) -> Ends:
    if a[0] > 0.0 or (not_zero and a[0] == 0.0 < a[1]):
        return math.nextafter(1.0 / a[1], 0.0), math.nextafter(1.0 / a[0], math.inf) if a[0] else math.inf
    if a[1] < 0.0 or (not_zero and a[1] == 0.0 > a[0]):
        low, high = _inverse((-a[1], -a[0]), not_zero)
        return -high, -low
    return ALL


class Ways:
    """The decisions of a function in its present way; `number` counts the values of a way."""

    present: "Ways | None" = None
    number, fresh = 0, 0

    def __init__(self) -> None:
        self.choices: list[list[int]] = []  # the present one of how many, for each decision
        self.depth = 0

    @classmethod
    def choose(cls, count: int) -> int:
        """Return one of several ways, each in its turn."""
        here = cls.present
        if count == 1:
            return 0
        assert here is not None, "decisions belong to a function"
        if here.depth == MOST_DECISIONS or count > MOST_WAYS:
            raise Unknown
        if here.depth == len(here.choices):
            here.choices.append([0, count])
        here.depth += 1
        cls.mark()
        return here.choices[here.depth - 1][0]

    @classmethod
    def mark(cls) -> None:
        """Values from here on are none of those of another way."""
        cls.fresh += 1 << 40
        cls.number = cls.fresh

    def turn(self) -> bool:
        """Turn to the next way; false where there is none left."""
        while self.choices and self.choices[-1][0] == self.choices[-1][1] - 1:
            self.choices.pop()
        if self.choices:
            self.choices[-1][0] += 1
        self.depth = 0
        return bool(self.choices)


def joined(function: Callable[..., Any]) -> Callable[..., Any]:
    """Call a function in all its ways: results that agree in whole numbers become one."""

    def call(*given: Any) -> Any:
        before, start = Ways.present, Ways.number
        here = Ways.present = Ways()
        found: dict[Any, Any] = {}
        many = 0
        try:
            while True:
                Ways.number = start
                result = function(*map(_copy, given))
                kind = _kind(result)
                found[kind] = _join(found[kind], result) if kind in found else result
                many += 1
                if many > MOST_WAYS:
                    raise Unknown
                if not here.turn():
                    break
        finally:
            Ways.present = before
        if many > 1:
            Ways.mark()
        return list(found.values())[Ways.choose(len(found))]

    return call


def _parts(value: Any) -> list[Any]:
    if isinstance(value, list | tuple):
        return list(value)
    if hasattr(value, "__slots__") and not isinstance(value, Interval):
        return [getattr(value, name) for name in value.__slots__]
    return list(vars(value).values()) if hasattr(value, "__dict__") else []


def _rebuilt(value: Any, parts: Sequence[Any]) -> Any:
    if isinstance(value, list | tuple):
        return type(value)(parts)
    made = object.__new__(type(value))
    for name, part in zip(getattr(value, "__slots__", None) or vars(value), parts, strict=True):
        setattr(made, name, part)
    return made


def _copy(value: Any) -> Any:
    if isinstance(value, Interval):
        return Interval(value.ends, value.slopes, value.number, value.not_zero)
    if isinstance(value, dict):
        return {key: _copy(part) for key, part in value.items()}
    parts = _parts(value)
    return _rebuilt(value, [_copy(part) for part in parts]) if parts else value


def _kind(value: Any) -> Any:
    if isinstance(value, Interval):
        return None
    parts = _parts(value)
    return tuple(map(_kind, parts)) if parts else value


def _join(a: Any, b: Any) -> Any:
    if not isinstance(a, Interval):
        parts = _parts(a)
        return _rebuilt(a, [_join(x, y) for x, y in zip(parts, _parts(b), strict=True)]) if parts else a
    ends = min(a.ends[0], b.ends[0]), max(a.ends[1], b.ends[1])
    if a.number and a.number == b.number:
        return Interval(ends, a.slopes, a.number, a.not_zero and b.not_zero)
    if not a.number and not b.number and ends[0] == ends[1]:
        return a
    return Interval(ends, [ALL] * Interval.sides)


class Interval:
    """A number: the ends of its values, and of its slopes by each side of a box; none for a constant."""

    __slots__ = ("ends", "not_zero", "number", "slopes")
    sides = 0

    def __init__(self, ends: Ends, slopes: list[Ends] | None, number: int = -1, not_zero: bool = False):
        if number < 0:
            Ways.number += 1
            number = Ways.number
        if ends == ALL and slopes is not None:
            slopes = [ALL] * Interval.sides
        self.ends, self.slopes, self.number = ends, slopes, number
        self.not_zero = not_zero or ends[0] > 0.0 or ends[1] < 0.0

    def __add__(self, other: Any) -> "Interval":
        b = number(other)
        return _of(
            (self, (1.0, 1.0)),
            (b, (1.0, 1.0)),
            ends=_sum(self.ends, b.ends),
        )

    def __neg__(self) -> "Interval":
        return _of((self, (-1.0, -1.0)), ends=(-self.ends[1], -self.ends[0]), not_zero=self.not_zero)

    def __mul__(self, other: Any) -> "Interval":
        b = number(other)
        ends = _product(self.ends, b.ends)
        if self.number and self.number == b.number:
            ends = (max(ends[0], 0.0), ends[1])
            return _of((self, _product((2.0, 2.0), self.ends)), ends=ends, not_zero=self.not_zero)
        return _of((self, b.ends), (b, self.ends), ends=ends, not_zero=self.not_zero and b.not_zero)

    def __truediv__(self, other: Any) -> "Interval":
        b = number(other)
        part = _inverse(b.ends, b.not_zero)
        if part == ALL:
            raise Unknown
        ends = _product(self.ends, part)
        low, high = _product(ends, part)
        return _of((self, part), (b, (-high, -low)), ends=ends, not_zero=self.not_zero)

    def __sub__(self, other: Any) -> "Interval":
        return self + -number(other)

    def __radd__(self, other: Any) -> "Interval":
        return number(other) + self

    def __rsub__(self, other: Any) -> "Interval":
        return number(other) - self

    def __rmul__(self, other: Any) -> "Interval":
        return number(other) * self

    def __rtruediv__(self, other: Any) -> "Interval":
        return number(other) / self

    def __mod__(self, other: Any) -> "Interval":
        return self - number(other) * floor(self / number(other))

    def __lt__(self, other: Any) -> bool:
        return _less(self, number(other), False)

    def __le__(self, other: Any) -> bool:
        return _less(self, number(other), True)

    def __gt__(self, other: Any) -> bool:
        return _less(number(other), self, False)

    def __ge__(self, other: Any) -> bool:
        return _less(number(other), self, True)

    def __eq__(self, other: object) -> bool:
        b = number(other)
        if self.number and self.number == b.number:
            return True
        may = self.ends[0] <= b.ends[1] and b.ends[0] <= self.ends[1]
        return _decided(may, not may or self.ends[0] < self.ends[1] or b.ends[0] < b.ends[1])

    __hash__ = None  # type: ignore[assignment]


def number(value: Any) -> Interval:
    """Return a number as an interval."""
    if isinstance(value, Interval):
        return value
    exact = float(value)
    return Interval((exact, exact) if exact == value else _outwards(exact, exact), None, 0)


def _of(*parts: tuple[Interval, Ends], ends: Ends, not_zero: bool = False) -> Interval:
    """A function of intervals, with its slope by each of them."""
    moving = [(each.slopes, by) for each, by in parts if each.slopes is not None]
    if not moving:
        return Interval(ends, None, not_zero=not_zero)
    slopes = []
    for side in range(Interval.sides):
        total = NONE
        for own, by in moving:
            total = _sum(total, _product(own[side], by))
        slopes.append(total)
    return Interval(ends, slopes, not_zero=not_zero)


def _decided(may: bool, may_not: bool) -> bool:
    return Ways.choose(2) == 0 if may and may_not else may


def _less(x: Interval, y: Interval, equal: bool) -> bool:
    """x < y, or with `equal` x <= y; both are narrowed to what that means."""
    if x.number and x.number == y.number:
        return equal
    a, b = x.ends, y.ends
    found = _decided(a[0] < b[1] or (equal and a[0] == b[1]), a[1] > b[0] or (not equal and a[1] == b[0]))
    small, large, strict = (x, y, not equal) if found else (y, x, equal)
    (low, high), (other_low, other_high) = small.ends, large.ends
    if small.slopes is not None:
        small.ends = low, min(high, other_high)
        small.not_zero |= other_high < 0.0 or (strict and other_high == 0.0)
    if large.slopes is not None:
        large.ends = max(low, other_low), other_high
        large.not_zero |= low > 0.0 or (strict and low == 0.0)
    return found


# ---- functions

Slope = Callable[[Ends, Ends], Ends]  # of a function over values x, where its own are y


def _ends(ball: Any) -> Ends:
    if not ball.is_finite():
        return ALL
    return math.nextafter(float(ball.lower()), -math.inf), math.nextafter(float(ball.upper()), math.inf)


DOMAINS: dict[str, Ends] = {
    "sqrt": (0.0, math.inf),
    "acos": (-1.0, 1.0),
    "asin": (-1.0, 1.0),
    "log": (1e-300, 1e308),
}


def _at(name: str, x: Ends) -> Ends:
    """A function over all values between two ends: at the ends, where it only rises. Raises Unknown."""
    if name in ("sin", "cos"):
        if not all(map(math.isfinite, x)):
            return -1.0, 1.0
        low, high = _ends(getattr(arb(x[0]).union(arb(x[1])), name)())
        return max(low, -1.0), min(high, 1.0)
    first, last = DOMAINS.get(name, (-700.0, 700.0))
    if not first <= x[0] <= x[1] <= last:
        raise Unknown
    at_first, at_last = (_ends(getattr(arb(end), name)()) if math.isfinite(end) else (end, end) for end in x)
    low, high = (at_last[0], at_first[1]) if name == "acos" else (at_first[0], at_last[1])
    if name == "sqrt":
        low = max(low, 0.0)
    return low, high


def _square(x: Ends) -> Ends:
    low, high = _product(x, x)
    return max(low, 0.0), high


def _rest(x: Ends) -> Ends:
    """1 - x^2, which is not negative where it is used."""
    low, high = _square(x)
    return max(math.nextafter(1.0 - high, -math.inf), 0.0), math.nextafter(1.0 - low, math.inf)


SLOPES: dict[str, Slope] = {
    "sin": lambda x, y: _at("cos", x),
    "cos": lambda x, y: _product((-1.0, -1.0), _at("sin", x)),
    "sqrt": lambda x, y: _inverse(_product((2.0, 2.0), y)),
    "asin": lambda x, y: _inverse(_at("sqrt", _rest(x))),
    "acos": lambda x, y: _product((-1.0, -1.0), _inverse(_at("sqrt", _rest(x)))),
    "atan": lambda x, y: _inverse(_outwards(*(1.0 + end for end in _square(x)))),
    "exp": lambda x, y: y,
    "log": lambda x, y: _inverse(x),
    "sinh": lambda x, y: _at("exp", (0.0, max(map(abs, x)))),
    "tanh": lambda x, y: (0.0, 1.0),
}


def _function(name: str) -> Callable[[Any], Interval]:
    def call(value: Any) -> Interval:
        x = number(value)
        ends = _at(name, x.ends)
        return _of((x, SLOPES[name](x.ends, ends)), ends=ends)

    return call


def fabs(value: Any) -> Interval:
    """Return the size of a number."""
    x = number(value)
    low, high = x.ends
    ends = (0.0 if low <= 0.0 <= high else min(abs(low), abs(high)), max(abs(low), abs(high)))
    return _of((x, (1.0 if low >= 0.0 else -1.0, -1.0 if high <= 0.0 else 1.0)), ends=ends)


def atan2(of: Any, beside: Any) -> Interval:
    """Return the angle of a point, which jumps behind the origin."""
    y, x = number(of), number(beside)
    if ALL in (x.ends, y.ends):
        raise Unknown
    if not (x.ends[0] > 0.0 or y.ends[0] > 0.0 or y.ends[1] < 0.0):
        return Interval((-math.pi - 1e-15, math.pi + 1e-15), [ALL] * Interval.sides)
    ball = [arb(each.ends[0]).union(arb(each.ends[1])) for each in (y, x)]
    squares = (_square(each.ends) for each in (y, x))
    part = _inverse(_outwards(*map(sum, zip(*squares, strict=True))))
    by_x = _product((-1.0, -1.0), _product(y.ends, part))
    return _of((y, _product(x.ends, part)), (x, by_x), ends=_ends(arb.atan2(*ball)))


def floor(x: Any) -> int:
    """Return the whole part of a number, each in its turn where that is in doubt."""
    low, high = (math.floor(end) if math.isfinite(end) else 0 for end in number(x).ends)
    if not all(map(math.isfinite, number(x).ends)):
        raise Unknown
    return low + Ways.choose(high - low + 1)


MATH = {name: _function(name) for name in SLOPES} | {"fabs": fabs, "atan2": atan2, "floor": floor}
