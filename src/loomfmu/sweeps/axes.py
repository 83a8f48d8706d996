"""Axes of a sweep: the values that a key takes, on a grid or in a Latin hypercube sample."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..cosim.scenes.settings import check_table
from ..errors import LoomfmuError, shown
from .varied import Keyed, Value, Varied

MOST = 10_000_000  # combinations, points of an axis
RANGE = ("from", "to", "count", "logarithmic")
TYPES = {"Real": np.float64, "Integer": np.int64, "Boolean": np.bool_, "Text": np.object_}


@dataclass(frozen=True)
class Axis(Keyed):
    """A key with its values in SI: the points of a grid, or one for each point of a sample."""

    values: NDArray[Any]
    sampled: bool = False
    logarithmic: bool = False
    doubts: tuple[str, ...] = ()

    @property
    def numeric(self) -> bool:
        """Return whether its values are numbers."""
        return self.varied.kind in ("Real", "Integer")


def whole(given: Any, where: str, low: int, high: int = MOST) -> int:
    """A whole number within bounds. Raises LoomfmuError."""
    if given is None:
        raise LoomfmuError(f"{where} is missing; give a whole number")
    if isinstance(given, bool) or not isinstance(given, int):
        raise LoomfmuError(f"{where} = {given!r} is not a whole number")
    if not low <= given <= high:
        raise LoomfmuError(f"{where} = {given} is outside [{low}, {high}]")
    return given


def flattened(table: Any, where: str, prefix: str = "") -> dict[str, Any]:
    """A table with its keys joined by dots, quoted or not; a table that is a range stays one."""
    check_table(table, where)
    flat: dict[str, Any] = {}
    for key, value in table.items():
        nested = isinstance(value, dict) and not set(RANGE) & set(value)
        found = flattened(value, where, f"{prefix}{key}.") if nested else {prefix + key: value}
        for name in found:
            if name in flat:
                raise LoomfmuError(f"{where}.{name} appears twice")
        flat |= found
    return flat


def grid_axis(varied: Varied, given: Any, table: str = "grid") -> Axis:
    """The axis of a grid from a list of values, or from its ends and their count.

    Raises:
        LoomfmuError: a value that is out of its bounds, of another unit, or there twice
    """
    where = f"{table}.{varied.key}"
    if isinstance(given, dict):
        low, high, logarithmic = _ends(varied, given, where)
        count = whole(given.get("count"), f"{where}.count", 2)
        space = np.geomspace if logarithmic else np.linspace
        values = [varied.read(float(value)) for value in space(low, high, count)]
        doubts = _doubts(varied, [given["from"], given["to"]])
        return Axis(varied, np.array(values, TYPES[varied.kind]), logarithmic=logarithmic, doubts=doubts)
    if given == []:
        raise LoomfmuError(f"{where} must name at least one value")
    if not isinstance(given, list):
        raise LoomfmuError(
            f"{where} = {shown(given)} is neither a list of values nor"
            ' { from = "..", to = "..", count = .. }'
        )
    values = [varied.read(value) for value in given]
    seen: set[Value] = set()
    for value in values:
        if value in seen:
            raise LoomfmuError(f"{where}: {varied.show(value)} appears twice")
        seen.add(value)
    return Axis(varied, np.array(values, TYPES[varied.kind]), doubts=_doubts(varied, given))


def _doubts(varied: Varied, given: list[Any]) -> tuple[str, ...]:
    """Return the warnings about values as they are written."""
    return tuple(filter(None, map(varied.doubt, given)))


@dataclass(frozen=True)
class Range(Keyed):
    """A key between two ends in SI, both included; shares of a logarithmic one are equal in the logarithm."""

    low: float
    high: float
    logarithmic: bool = False
    doubts: tuple[str, ...] = ()

    def at(self, shares: Any) -> NDArray[Any]:
        """The values at shares of the range, 0 to 1; each whole number has an equal share."""
        shares = np.asarray(shares, dtype=np.float64)
        low, high = self.low, self.high
        if self.varied.kind == "Integer":
            return np.asarray(np.minimum(np.floor(low + shares * (high - low + 1)), high), np.int64)
        values = low * (high / low) ** shares if self.logarithmic else low + shares * (high - low)
        return np.asarray(np.clip(np.where(shares == 1.0, high, values), low, high))

    def rate(self, share: float) -> float:
        """The derivative of a real value by the share of the range."""
        if self.logarithmic:
            return float(self.at(share)) * math.log(self.high / self.low)
        return self.high - self.low

    def share(self, value: float) -> float:
        """Return the place of a real number in the range, 0 to 1; the nearer end for one outside."""
        value = min(max(value, self.low), self.high)
        if self.logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def sampled(self, shares: Any) -> Axis:
        """The axis of a sample that has these shares."""
        return Axis(self.varied, self.at(shares), True, self.logarithmic, self.doubts)


def range_of(varied: Varied, given: Any, where: str, lists: str = "grid") -> Range:
    """A range from `[low, high]` or from a table of both ends, as the table `where` of a file has it.

    Raises LoomfmuError; `lists` is the table for what has no range.
    """
    where = f"{where}.{varied.key}"
    if isinstance(given, list) and len(given) == 2:
        given = {"from": given[0], "to": given[1]}
    if not isinstance(given, dict):
        raise LoomfmuError(f"{where} = {shown(given)} is not a range [low, high]")
    if "count" in given:
        raise LoomfmuError(f"{where}.count: a range here has no points of its own; leave out count")
    low, high, logarithmic = _ends(varied, given, where, lists)
    return Range(varied, low, high, logarithmic, _doubts(varied, [given["from"], given["to"]]))


def sample_axes(ranges: list[tuple[Varied, Any]], count: int, seed: int) -> list[Axis]:
    """The axes of a Latin hypercube sample: each of the `count` equal shares of a range is met once.

    A logarithmic range is shared equally in the logarithm, a range of whole numbers in the numbers.
    """
    if not ranges:
        return []
    from scipy.stats import qmc

    found = [range_of(varied, given, "sample") for varied, given in ranges]
    points = qmc.LatinHypercube(len(ranges), rng=seed).random(count)
    return [each.sampled(shares) for each, shares in zip(found, points.T, strict=True)]


def _ends(
    varied: Varied, table: dict[str, Any], where: str, lists: str = "grid"
) -> tuple[float, float, bool]:
    """Both ends of a range, and whether it is logarithmic."""
    check_table(table, where, RANGE)
    for key in ("from", "to"):
        if key not in table:
            raise LoomfmuError(f"{where} has no {key!r}")
    if varied.kind not in ("Real", "Integer"):
        raise LoomfmuError(f"{where} is not a number: list its values in [{lists}]")
    ends: list[Value] = [varied.read(table[key]) for key in ("from", "to")]
    low, high = (float(end) for end in ends)
    if not low < high:
        raise LoomfmuError(f"{where}: {varied.show(ends[0])} is not below {varied.show(ends[1])}")
    logarithmic = table.get("logarithmic", False)
    if not isinstance(logarithmic, bool):
        raise LoomfmuError(f"{where}.logarithmic = {logarithmic!r} must be true or false")
    if logarithmic and (low <= 0.0 or varied.kind == "Integer" or not math.isfinite(low)):
        raise LoomfmuError(f"{where}: only a range of real numbers above 0 can be logarithmic")
    return low, high, logarithmic
