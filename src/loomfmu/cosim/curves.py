"""Recorded signals between their samples."""

import math

import numpy as np
from numpy.typing import NDArray

from ..errors import LoomfmuError
from ..traces import Signals

Floats = NDArray[np.float64]
TURN = 2.0 * math.pi


class Motion:
    """A signal with its first and second rate: on each interval the quintic that joins the samples."""

    def __init__(self, trace: Signals, signal: str):
        rate = trace.rate(signal)
        second = trace.rate(rate) if rate else None
        if rate is None or second is None:
            raise LoomfmuError(f"{trace.name}: {signal} is not recorded with its rate and second rate")
        self.time = trace.time
        self.values = [np.asarray(trace[name]) for name in (signal, rate, second)]

    def coefficients(self, interval: int) -> Floats:
        """Polynomial on an interval in the share of the way, the constant first."""
        h = self.time[interval + 1] - self.time[interval]
        (y0, y1), (v0, v1), (a0, a1) = (values[interval : interval + 2] for values in self.values)
        v0, v1, a0, a1 = v0 * h, v1 * h, a0 * h * h, a1 * h * h
        rise = y1 - y0 - v0 - 0.5 * a0
        turn = v1 - v0 - a0
        bend = a1 - a0
        return np.array(
            [
                y0,
                v0,
                0.5 * a0,
                10 * rise - 4 * turn + 0.5 * bend,
                -15 * rise + 7 * turn - bend,
                6 * rise - 3 * turn + 0.5 * bend,
            ]
        )

    def interval(self, time: float) -> int:
        """The interval that a time lies in."""
        return int(np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, len(self.time) - 2))

    def at(self, time: float) -> float:
        """Value at a time."""
        interval = self.interval(time)
        share = (time - self.time[interval]) / (self.time[interval + 1] - self.time[interval])
        return float(np.polynomial.polynomial.polyval(share, self.coefficients(interval)))

    def crossings(self, level: float) -> list[float]:
        """Times at which the motion passes a level, found to rounding on each interval's quintic."""
        side = self.values[0] - level
        found = []
        for interval in np.flatnonzero((side[:-1] < 0) != (side[1:] < 0)):
            polynomial = self.coefficients(int(interval))
            polynomial[0] -= level
            share = _root(polynomial.tolist())
            found.append(float(self.time[interval] + share * (self.time[interval + 1] - self.time[interval])))
        return found


def _root(polynomial: list[float]) -> float:
    """Where a polynomial that changes its sign between 0 and 1 does so; the constant comes first.

    Halved until nothing is left between: scipy.optimize would take longer to be imported than to do it.
    """
    low, high = 0.0, 1.0
    rises = polynomial[0] < 0.0
    while low < (middle := 0.5 * (low + high)) < high:
        value = 0.0
        for coefficient in reversed(polynomial):
            value = value * middle + coefficient
        if (value < 0.0) == rises:
            low = middle
        else:
            high = middle
    return high


def spans_within(lift: Motion, distance: float, stroke: float) -> list[tuple[float, float]]:
    """Times from entering to leaving a distance from the lower or the upper end, whole ones only.

    A frame that holds stays within: its span is as long as the picks it holds for.
    """
    spans = []
    for level, sign in ((distance, -1.0), (stroke - distance, 1.0)):
        times = lift.crossings(level)
        inside = bool(sign * (lift.values[0][0] - level) > 0.0)
        if inside:
            times = times[1:]  # the span under way at the start is not whole
        spans += list(zip(times[::2], times[1::2], strict=False))
    return sorted(spans)


def times_at(trace: Signals, angle: float) -> list[float]:
    """All times at which the shaft stands at an angle of its revolution."""
    shaft = Motion(trace, "shaft.angle")
    low, high = sorted((float(shaft.values[0][0]), float(shaft.values[0][-1])))
    first = math.ceil((low - angle) / TURN - 1e-12)
    last = math.floor((high - angle) / TURN + 1e-12)
    times = []
    for turn in range(first, last + 1):
        level = angle + TURN * turn
        if level <= low or level >= high:
            times.append(float(shaft.time[0 if abs(shaft.values[0][0] - level) < 1e-9 else -1]))
        else:
            times += shaft.crossings(level)
    return times


def lowest(
    trace: Signals, signal: str, sign: float, window: tuple[float, float] | None
) -> tuple[float, float, bool]:
    """Lowest value of `sign` times a signal, its time, and whether values between samples were counted.

    Between samples the signal runs on the cubic that joins them with their recorded rates. A window
    `(from, to)` of shaft angles may wrap; its edges count too. The last result tells whether the values
    between samples were counted: by a rate, or because the signal only rises or only falls.
    """
    time, angle = trace.time, trace.shaft_angle
    values = np.asarray(trace[signal], dtype=float)
    rate_name = trace.rate(signal)
    inside = _inside(angle, window)
    candidates = [(time[inside], values[inside])]
    if rate_name is not None and len(time) > 1:
        rates = np.asarray(trace[rate_name])
        for share, interval in _turning_points(time, values, rates, angle, window):
            h = np.diff(time)[interval]
            at = time[interval] + share * h
            value = _cubic(values, rates, h, interval, share)
            kept = _inside(np.interp(at, time, angle), window)
            candidates.append((at[kept], value[kept]))
    moments = np.concatenate([moment for moment, _ in candidates])
    found = np.concatenate([value for _, value in candidates])
    if not len(found):
        return math.nan, math.nan, True
    place = int(np.argmin(sign * found))
    steps = np.diff(values)
    covered = rate_name is not None or bool(np.all(steps <= 0.0) or np.all(steps >= 0.0))
    return float(found[place]), float(moments[place]), covered


def _inside(angle: Floats, window: tuple[float, float] | None) -> NDArray[np.bool_]:
    if window is None:
        return np.ones(len(angle), dtype=bool)
    start, end = window
    width = (end - start) % TURN or TURN
    # an edge belongs to the window, to rounding of an angle that may be thousands of turns
    slack = 1e-12 * (1.0 + np.abs(angle))
    away = (angle - start + slack) % TURN
    return np.asarray(away <= width + 2 * slack)


def _cubic(values: Floats, rates: Floats, h: Floats, interval: NDArray[np.int64], u: Floats) -> Floats:
    y0, y1 = values[interval], values[interval + 1]
    v0, v1 = rates[interval] * h, rates[interval + 1] * h
    rise = y1 - y0
    result = y0 + u * (v0 + u * (3 * rise - 2 * v0 - v1 + u * (v0 + v1 - 2 * rise)))
    return np.asarray(result)


def _turning_points(
    time: Floats, values: Floats, rates: Floats, angle: Floats, window: tuple[float, float] | None
) -> list[tuple[Floats, NDArray[np.int64]]]:
    """Shares and intervals at which the cubics turn, and at which the shaft passes the window's edges."""
    h = np.diff(time)
    v0, v1 = rates[:-1] * h, rates[1:] * h
    rise = np.diff(values)
    # derivative a + b u + c u^2
    a, b, c = v0, 2 * (3 * rise - 2 * v0 - v1), 3 * (v0 + v1 - 2 * rise)
    root = np.sqrt(np.maximum(b * b - 4 * a * c, 0.0))
    q = -0.5 * (b + np.where(b >= 0, root, -root))
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = [q / c, a / q]
    for edge in window or ():
        turns = np.ceil((np.minimum(angle[:-1], angle[1:]) - edge) / TURN)
        with np.errstate(divide="ignore", invalid="ignore"):
            shares.append((edge + TURN * turns - angle[:-1]) / np.diff(angle))
    points = []
    for share in shares:
        interval = np.flatnonzero((share > 0.0) & (share < 1.0))
        points.append((share[interval], interval))
    return points
