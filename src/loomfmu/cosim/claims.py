"""Claims: assertions on a recorded run, each judged to a verdict.

`judge(trace, kind="above", signal="belt.margin", bound=0.0)` returns a `Verdict`, which is true where the
claim holds: `assert judge(...)`. Scenes state the same as `[[claims]]` tables, with units.

Values between the samples count: a signal whose rate is recorded is followed on the cubic that joins
its samples, a frame's lift on the quintic of lift, velocity and acceleration. Where no rate is recorded
the verdict says that it speaks of the samples.
"""

import inspect
import math
import re
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from .. import units
from ..errors import LoomfmuError, suggestion
from ..traces import Signals
from . import curves
from .loom_claims import locks_in_time, rapier_in_open_shed, reed_clear_of_rapier
from .verdict import Verdict, verdict


def judge(trace: Signals, *, kind: str, name: str = "", **arguments: Any) -> Verdict:
    """Judge one claim on a trace; arguments are those of the claim's function, with units or in SI.

    `name` is what the verdict calls the claim, if not by its kind.

    Raises:
        LoomfmuError: an unknown kind, argument, signal or unit, or one that is missing
    """
    check(kind, arguments)
    check_values(kind, arguments, trace.unit)
    judged = KINDS[kind](trace, **arguments)
    return replace(judged, claim=f"{name}: {judged.claim}") if name else judged


def check(kind: Any, arguments: dict[str, Any]) -> None:
    """Refuse an unknown claim, an argument that it does not have, and one that it lacks."""
    if not isinstance(kind, str) or kind not in KINDS:
        raise LoomfmuError(f"claim kind = {kind!r} is unknown{suggestion(str(kind), KINDS)}")
    known = list(inspect.signature(KINDS[kind]).parameters.values())[1:]
    names = [parameter.name for parameter in known]
    for given in arguments:
        if given not in names:
            raise LoomfmuError(f"claim {kind!r} has no {given!r}{suggestion(given, [*names, 'name'])}")
    for parameter in known:
        if parameter.default is parameter.empty and parameter.name not in arguments:
            raise LoomfmuError(f"claim {kind!r} needs {parameter.name!r}")


def check_values(kind: str, arguments: dict[str, Any], unit_of: Callable[[str], str]) -> None:
    """Refuse quantities that cannot be read or compared; `unit_of` tells the unit of a signal."""
    for name, given in arguments.items():
        where = f"claim {kind!r}: {name}"
        several = name in ("window", "angles")
        if given is None or name not in UNITS or names_parameter(name, given):
            continue
        if name == "window" and not (isinstance(given, list | tuple) and len(given) == 2):
            raise LoomfmuError(f"{where} = {given!r} is not [from, to] in shaft angle")
        if name == "angles" and not (isinstance(given, list | tuple) and given):
            raise LoomfmuError(f"{where} = {given!r} is no list of shaft angles")
        unit = UNITS[name] or (unit_of(arguments["signal"]) if "signal" in arguments else "1")
        if kind == "peak_load":
            unit = "N"
        for quantity in given if several else [given]:
            try:
                value = units.parse(quantity, unit)
            except units.UnitError as error:
                raise LoomfmuError(f"{where}: {error}") from None
            if not math.isfinite(value):
                raise LoomfmuError(f"{where} = {quantity!r} is not finite")
            if name == "tolerance" and not 0.0 < value < 0.5:
                raise LoomfmuError(f"{where} = {value:g} is outside (0, 0.5), shares of the stroke")


def names_parameter(argument: str, given: Any) -> bool:
    """Whether a bound is that of a parameter, such as "shaft.speed"."""
    return argument == "bound" and isinstance(given, str) and bool(PARAMETER.fullmatch(given))


def signals_of(claim: dict[str, Any], instances: Iterable[str]) -> list[str]:
    """The signals that a claim needs to have been recorded, in a scene with these instances."""
    kind = claim.get("kind")
    if kind in ("above", "below"):
        return [str(claim.get("signal"))]
    owner, variables = NEEDS.get(str(kind), ("", ()))
    named = [str(claim.get(owner, owner))] if owner else []
    signals = [f"{instance}.{variable}" for instance in named for variable in variables]
    if kind in ("rapier_in_open_shed", "reed_clear_of_rapier"):
        signals.append(f"{claim.get('weft', 'weft')}.travel")
    if kind == "rapier_in_open_shed":
        healds = claim.get("healds") or [name for name in instances if name.startswith("heald_")]
        signals += [f"{heald}.{variable}" for heald in healds for variable in ("lift", "warp_height")]
    return signals


TOLERANCE = 0.015  # of the stroke: within it a frame dwells, if nothing else is said
PARAMETER = re.compile(r"[A-Za-z]\w*\.[A-Za-z]\w*")

# arguments that are quantities, and their units; a bound's is that of its signal
UNITS = {
    "bound": "",
    "at_most": "1",
    "at_least": "rad",
    "window": "rad",
    "angles": "rad",
    "tolerance": "1",
    "clearance": "m",
    "head_height": "m",
}

# claim -> the argument that names an instance, or its usual name, and the outputs it is judged by
NEEDS: dict[str, tuple[str, tuple[str, ...]]] = {
    "lowest_margin": ("belt", ("margin", "lowest_margin")),
    "dwell": ("heald", ("lift",)),
    "dwell_contains": ("heald", ("lift",)),
    "clear_shed": ("heald", ("lift", "warp_height")),
    "peak_load": ("damper", ("transmitted_force", "peak_load")),
    "stop_contacts": ("damper", ("stop_contacts",)),
    "locks_in_time": ("lock", ("in_time", "torque_margin", "available_time")),
    "reed_clear_of_rapier": ("reed", ("position",)),
}


# ---- the claims


def above(
    trace: Signals, signal: str, bound: float | str, window: list[float | str] | None = None
) -> Verdict:
    """A signal stays at or above a bound: over the whole run, or in a window of shaft angles.

    The bound is a quantity, or the name of a parameter of the run, such as "shaft.speed".
    """
    return _bounded(trace, signal, bound, window, 1.0)


def below(
    trace: Signals, signal: str, bound: float | str, window: list[float | str] | None = None
) -> Verdict:
    """A signal stays at or below a bound; see `above`."""
    return _bounded(trace, signal, bound, window, -1.0)


def lowest_margin(trace: Signals, bound: float | str, belt: str = "belt") -> Verdict:
    """The belt's margin against buckling never falls below a bound, on the continuous curve."""
    limit = units.parse(bound, "1")
    worst = float(trace[f"{belt}.lowest_margin"][-1])
    place = int(np.argmin(trace[f"{belt}.margin"]))
    return verdict(
        trace, "lowest margin", f"{belt}.lowest_margin", worst >= limit, limit, worst, "1",
        float(trace.time[place]),
    )  # fmt: skip


def peak_load(trace: Signals, damper: str, at_most: float | str) -> Verdict:
    """The force that a damper's carrier puts on its frame never exceeds a bound, on the continuous curve."""
    limit = units.parse(at_most, "N")
    worst = float(trace[f"{damper}.peak_load"][-1])
    reached = int(np.argmax(trace[f"{damper}.peak_load"] >= worst))
    return verdict(
        trace, "peak load", f"{damper}.peak_load", worst <= limit, limit, worst, "N",
        float(trace.time[reached]),
    )  # fmt: skip


def stop_contacts(trace: Signals, damper: str, at_most: float | str) -> Verdict:
    """A damper's carrier touches its stops no more often than that."""
    limit = units.parse(at_most, "1")
    counted = trace[f"{damper}.stop_contacts"]
    worst = float(counted[-1])
    over = np.flatnonzero(counted > limit)
    time = float(trace.time[over[0]]) if len(over) else math.nan
    return verdict(trace, "stop contacts", f"{damper}.stop_contacts", worst <= limit, limit, worst, "1", time)


def dwell(trace: Signals, heald: str, at_least: float | str, tolerance: float | str = TOLERANCE) -> Verdict:
    """Every whole dwell of a frame, within a share of its stroke from an end, lasts that shaft angle."""
    share = units.parse(tolerance, "1")
    stroke = trace.parameter(f"{heald}.stroke")
    lift = curves.Motion(trace, f"{heald}.lift")
    spans = curves.spans_within(lift, share * stroke, stroke)
    return _shortest(trace, f"dwell within {100 * share:g} % of the stroke", f"{heald}.lift", spans, at_least)


def clear_shed(trace: Signals, heald: str, clearance: float | str, at_least: float | str) -> Verdict:
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
    trace: Signals, heald: str, angles: list[float | str], tolerance: float | str = TOLERANCE
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
    return verdict(
        trace, f"dwell at {shown}", f"{heald}.lift", holds, limit, worst if worst >= 0 else math.nan, "%",
        time, note,
    )  # fmt: skip


KINDS: dict[str, Callable[..., Verdict]] = {
    function.__name__: function
    for function in (
        above,
        below,
        lowest_margin,
        dwell,
        clear_shed,
        dwell_contains,
        peak_load,
        stop_contacts,
        rapier_in_open_shed,
        reed_clear_of_rapier,
        locks_in_time,
    )
}


# ---- what they share


def _bounded(
    trace: Signals, signal: str, bound: float | str, window: list[float | str] | None, sign: float
) -> Verdict:
    if names_parameter("bound", bound):
        limit = trace.parameter(str(bound))
    else:
        limit = units.parse(bound, trace.unit(signal))
    edges = None
    word = "above" if sign > 0 else "below"
    claim = f"stays {word}"
    if window is not None:
        edges = (units.parse(window[0], "rad"), units.parse(window[1], "rad"))
        claim += " in [" + ", ".join(units.show(edge, "deg") for edge in edges) + "]"
    worst, time, between = curves.lowest(trace, signal, sign, edges)
    note = "" if between else "at the samples: its rate is not recorded"
    if math.isnan(time):
        note = "the run never is in that window"
    holds = sign * worst >= sign * limit
    return verdict(trace, claim, signal, holds, limit, worst, trace.display(signal), time, note)


def _shortest(
    trace: Signals, claim: str, signal: str, spans: list[tuple[float, float]], at_least: float | str
) -> Verdict:
    """The shortest of some spans of time, by the angle that the shaft turns meanwhile."""
    limit = units.parse(at_least, "rad")
    if not spans:
        return verdict(
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
    return verdict(trace, claim, signal, turned[place] >= limit, limit, turned[place], "deg", spans[place][0])
