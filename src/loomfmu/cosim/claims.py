"""Claims: assertions on a recorded run, each judged to a verdict.

`judge(trace, kind="above", signal="belt.margin", bound=0.0)` returns a `Verdict`, which is true where the
claim holds: `assert judge(...)`. Scenes state the same as `[[claims]]` tables, with units.

Values between the samples count: a signal whose rate is recorded is followed on the cubic that joins
its samples, a frame's lift on the quintic of lift, velocity and acceleration. Where no rate is recorded
the verdict says that it speaks of the samples.
"""

import inspect
import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import units
from ..errors import LoomfmuError, suggestion
from ..traces import Trace
from . import curves

TURN = 2.0 * math.pi
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Verdict:
    """What became of a claim; true where it holds. Values are in SI, `unit` the one to show them in."""

    claim: str
    signal: str
    holds: bool
    bound: float
    worst: float
    unit: str
    time: float
    angle: float
    revolution: int
    note: str = ""

    def __bool__(self) -> bool:
        return self.holds

    def __str__(self) -> str:
        word = "holds" if self.holds else "FAILS"
        where = ""
        if math.isfinite(self.time):
            angle = f"{math.degrees(self.angle):.3f} deg"
            where = f" at {self.time:.6g} s, {angle} of revolution {self.revolution}"
        note = f" ({self.note})" if self.note else ""
        return (
            f"{word}: {self.claim}: {self.signal} = {units.show(self.worst, self.unit)}{where},"
            f" bound {units.show(self.bound, self.unit)}{note}"
        )

    def as_dict(self) -> dict[str, Any]:
        """The verdict for JSON: what is not finite becomes null."""
        return {
            key: None if isinstance(value, float) and not math.isfinite(value) else value
            for key, value in asdict(self).items()
        }


def judge(trace: Trace, *, kind: str, name: str = "", **arguments: Any) -> Verdict:
    """Judge one claim on a trace; arguments are those of the claim's function, with units or in SI.

    `name` is what the verdict calls the claim, if not by its kind.

    Raises:
        LoomfmuError: an unknown kind, argument, signal or unit, or one that is missing
    """
    if kind not in KINDS:
        raise LoomfmuError(f"there is no claim {kind!r}{suggestion(kind, KINDS)}")
    function = KINDS[kind]
    known = list(inspect.signature(function).parameters.values())[1:]
    names = [parameter.name for parameter in known]
    for given in arguments:
        if given not in names:
            raise LoomfmuError(f"claim {kind!r} has no {given!r}{suggestion(given, [*names, 'name'])}")
    for parameter in known:
        if parameter.default is parameter.empty and parameter.name not in arguments:
            raise LoomfmuError(f"claim {kind!r} needs {parameter.name!r}")
    verdict = function(trace, **arguments)
    return replace(verdict, claim=f"{name}: {verdict.claim}") if name else verdict


def signals_of(claim: dict[str, Any]) -> list[str]:
    """The signals that a claim needs to have been recorded."""
    kind = claim.get("kind")
    if kind in ("above", "below"):
        return [str(claim.get("signal"))]
    if kind == "lowest_margin":
        return [f"{claim.get('belt', 'belt')}.{name}" for name in ("margin", "lowest_margin")]
    if kind in ("dwell", "dwell_contains"):
        return [f"{claim.get('heald')}.lift"]
    if kind == "clear_shed":
        return [f"{claim.get('heald')}.lift", f"{claim.get('heald')}.warp_height"]
    if kind == "peak_load":
        return [f"{claim.get('damper')}.{name}" for name in ("transmitted_force", "peak_load")]
    if kind == "stop_contacts":
        return [f"{claim.get('damper')}.stop_contacts"]
    return []


# ---- the claims


def above(trace: Trace, signal: str, bound: float | str, window: list[float | str] | None = None) -> Verdict:
    """A signal stays at or above a bound: over the whole run, or in a window of shaft angles."""
    return _bounded(trace, signal, bound, window, 1.0)


def below(trace: Trace, signal: str, bound: float | str, window: list[float | str] | None = None) -> Verdict:
    """A signal stays at or below a bound: over the whole run, or in a window of shaft angles."""
    return _bounded(trace, signal, bound, window, -1.0)


def lowest_margin(trace: Trace, bound: float | str, belt: str = "belt") -> Verdict:
    """The belt's margin against buckling never falls below a bound, on the continuous curve."""
    limit = units.parse(bound, "1")
    worst = float(trace[f"{belt}.lowest_margin"][-1])
    place = int(np.argmin(trace[f"{belt}.margin"]))
    return _verdict(
        trace, "lowest margin", f"{belt}.lowest_margin", worst >= limit, limit, worst, "1",
        float(trace.time[place]),
    )  # fmt: skip


def peak_load(trace: Trace, damper: str, at_most: float | str) -> Verdict:
    """The force that a damper's carrier puts on its frame never exceeds a bound, on the continuous curve."""
    limit = units.parse(at_most, "N")
    worst = float(trace[f"{damper}.peak_load"][-1])
    reached = int(np.argmax(trace[f"{damper}.peak_load"] >= worst))
    return _verdict(
        trace, "peak load", f"{damper}.peak_load", worst <= limit, limit, worst, "N",
        float(trace.time[reached]),
    )  # fmt: skip


def stop_contacts(trace: Trace, damper: str, at_most: float | str) -> Verdict:
    """A damper's carrier touches its stops no more often than that."""
    limit = units.parse(at_most, "1")
    counted = trace[f"{damper}.stop_contacts"]
    worst = float(counted[-1])
    over = np.flatnonzero(counted > limit)
    time = float(trace.time[over[0]]) if len(over) else math.nan
    return _verdict(
        trace, "stop contacts", f"{damper}.stop_contacts", worst <= limit, limit, worst, "1", time
    )


def dwell(trace: Trace, heald: str, at_least: float | str, tolerance: float | str = 0.015) -> Verdict:
    """Every whole dwell of a frame, within a share of its stroke from an end, lasts that shaft angle."""
    share = units.parse(tolerance, "1")
    stroke = trace.parameter(f"{heald}.stroke")
    lift = curves.Motion(trace, f"{heald}.lift")
    spans = curves.spans_within(lift, share * stroke, stroke)
    return _shortest(trace, f"dwell within {100 * share:g} % of the stroke", f"{heald}.lift", spans, at_least)


def clear_shed(trace: Trace, heald: str, clearance: float | str, at_least: float | str) -> Verdict:
    """Every whole time that a frame's warp is beyond a height, either way, lasts that shaft angle."""
    height = units.parse(clearance, "m")
    stroke = trace.parameter(f"{heald}.stroke")
    ratio = trace.parameter(f"{heald}.warp_ratio")
    if not 0.0 < height < 0.5 * stroke * ratio:
        raise LoomfmuError(
            f"clear_shed of {heald}: clearance = {1e3 * height:.7g} mm is outside"
            f" (0, {500 * stroke * ratio:.7g}) mm, the warp's way to either side"
        )
    lift = curves.Motion(trace, f"{heald}.lift")
    spans = curves.spans_within(lift, 0.5 * stroke - height / ratio, stroke)
    return _shortest(trace, f"warp beyond {1e3 * height:g} mm", f"{heald}.warp_height", spans, at_least)


def dwell_contains(
    trace: Trace, heald: str, angles: list[float | str], tolerance: float | str = 0.015
) -> Verdict:
    """At these shaft angles of every revolution the frame is within a share of its stroke from an end."""
    limit = units.parse(tolerance, "1")
    stroke = trace.parameter(f"{heald}.stroke")
    lift = curves.Motion(trace, f"{heald}.lift")
    worst, time = -1.0, math.nan
    for angle in angles:
        for moment in curves.times_at(trace, units.parse(angle, "rad")):
            value = lift.at(moment)
            away = min(abs(value), abs(stroke - value)) / stroke
            if away > worst:
                worst, time = away, moment
    note = "" if worst >= 0.0 else "the run never reaches these angles"
    holds = 0.0 <= worst <= limit
    shown = ", ".join(units.show(units.parse(angle, "rad"), "deg") for angle in angles)
    return _verdict(
        trace, f"dwell at {shown}", f"{heald}.lift", holds, limit, worst if worst >= 0 else math.nan, "%",
        time, note,
    )  # fmt: skip


KINDS: dict[str, Callable[..., Verdict]] = {
    function.__name__: function
    for function in (above, below, lowest_margin, dwell, clear_shed, dwell_contains, peak_load, stop_contacts)
}


# ---- what they share


def _bounded(
    trace: Trace, signal: str, bound: float | str, window: list[float | str] | None, sign: float
) -> Verdict:
    limit = units.parse(bound, trace.unit(signal))
    edges = None
    word = "above" if sign > 0 else "below"
    claim = f"stays {word}"
    if window is not None:
        if len(window) != 2:
            raise LoomfmuError(f"window of {signal} is [from, to] in shaft angle, not {window!r}")
        edges = (units.parse(window[0], "rad"), units.parse(window[1], "rad"))
        claim += " in [" + ", ".join(units.show(edge, "deg") for edge in edges) + "]"
    worst, time, between = curves.lowest(trace, signal, sign, edges)
    note = "" if between else "at the samples: its rate is not recorded"
    if math.isnan(time):
        note = "the run never is in that window"
    holds = sign * worst >= sign * limit
    return _verdict(trace, claim, signal, holds, limit, worst, trace.display(signal), time, note)


def _shortest(
    trace: Trace, claim: str, signal: str, spans: list[tuple[float, float]], at_least: float | str
) -> Verdict:
    """The shortest of some spans of time, by the angle that the shaft turns meanwhile."""
    limit = units.parse(at_least, "rad")
    if not spans:
        return _verdict(
            trace,
            claim,
            signal,
            False,
            limit,
            math.nan,
            "deg",
            math.nan,
            "none begins and ends within the run",
        )
    angle = curves.Motion(trace, "shaft.angle")
    turned = [abs(angle.at(end) - angle.at(start)) for start, end in spans]
    place = int(np.argmin(turned))
    return _verdict(
        trace, claim, signal, turned[place] >= limit, limit, turned[place], "deg", spans[place][0]
    )


def _verdict(
    trace: Trace, claim: str, signal: str, holds: bool, bound: float, worst: float, unit: str, time: float,
    note: str = "",
) -> Verdict:  # fmt: skip
    """A verdict with the place on the shaft that belongs to its time."""
    angle = float(np.interp(time, trace.time, trace.shaft_angle)) if math.isfinite(time) else math.nan
    turns = math.floor(angle / TURN) if math.isfinite(angle) else 0
    return Verdict(
        claim, signal, bool(holds), bound, worst, unit, time, angle - TURN * turns, turns + 1, note
    )
