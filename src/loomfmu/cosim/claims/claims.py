"""Claims: assertions on a recorded run, each judged to a verdict.

`judge(trace, kind="above", signal="belt.margin", bound=0.0)` returns a `Verdict`, which is true where the
claim holds: `assert judge(...)`. Scenes state the same as `[[claims]]` tables, with units.

Values between the samples count: a signal whose rate is recorded is followed on the cubic that joins
its samples, and where the rate's rate is recorded, too, on the quintic of value, velocity and acceleration.
Where no rate is recorded the verdict's note says so. Where the curve passes a bound between two samples that
do not, and by no more than it may be off there, the claim holds, and the note says so.
"""

import inspect
import math
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ... import units
from ...errors import LoomfmuError, shown, suggestion
from ...traces import Signals
from . import curves
from .heald_claims import TOLERANCE as TOLERANCE
from .heald_claims import clear_shed, dwell, dwell_contains
from .loom_claims import locks_in_time, rapier_in_open_shed, reed_clear_of_rapier
from .verdict import FORCE, ONE, Verdict, verdict


def judge(trace: Signals, *, kind: str, name: str = "", **arguments: Any) -> Verdict:
    """Judge one claim on a trace; arguments are those of the claim's function, with units or in SI.

    `name` is what the verdict calls the claim, if not by its kind.

    Raises:
        LoomfmuError: an unknown kind, argument, signal or unit, or one that is missing
    """
    if not isinstance(trace, Signals):
        raise LoomfmuError(f"trace = {shown(trace)} is not a trace, such as result.trace")
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
    for name in NAMES.intersection(arguments):
        if not isinstance(arguments[name], str):
            raise LoomfmuError(f"claim {kind!r}: {name} = {shown(arguments[name])} is not a name in quotes")


def check_values(kind: str, arguments: dict[str, Any], unit_of: Callable[[str], str]) -> None:
    """Refuse quantities that cannot be read or compared; `unit_of` tells the unit of a signal."""
    for name, given in arguments.items():
        where = f"claim {kind!r}: {name}"
        several = name in ("window", "angles")
        if given is None or name not in UNITS or ("signal" in arguments and names_parameter(name, given)):
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
                raise LoomfmuError(f"{where} = {shown(quantity)} is not finite")
            if name == "tolerance" and not 0.0 < value < 0.5:
                raise LoomfmuError(f"{where} = {value:g} is outside (0, 0.5), shares of the stroke")
            if name in NEVER_NEGATIVE and value < 0.0:
                raise LoomfmuError(f"{where} = {quantity!r} is negative")
            if name == "angles" and abs(value) > curves.TURN * (1.0 + 1e-12):
                raise LoomfmuError(
                    f"{where}: {quantity!r} is {units.show(value, 'deg')}, outside [-360, 360] deg"
                )
        if name == "window":
            _window(given, where)


def _window(given: Sequence[float | str], where: str) -> tuple[float, float]:
    """Where a window of shaft angles begins and how far it reaches; it may pass over 360 deg."""
    start, end = (units.parse(edge, "rad") for edge in given)
    width = end - start
    if width > curves.TURN * (1.0 + 1e-12):
        raise LoomfmuError(f"{where} = {_angles(start, end)} is longer than a revolution")
    if width <= 0.0:
        width %= curves.TURN
    if min(width, curves.TURN - width if end < start else width) < 1e-12:
        raise LoomfmuError(
            f"{where} = {_angles(start, end)} is empty; a whole revolution is [0 deg, 360 deg]"
        )
    return start, min(width, curves.TURN)


def _angles(*angles: float) -> str:
    return "[" + ", ".join(units.show(angle, "deg") for angle in angles) + "]"


def names_parameter(argument: str, given: Any) -> bool:
    """Whether a bound is that of a parameter, such as "shaft.speed"."""
    return argument == "bound" and isinstance(given, str) and bool(PARAMETER.fullmatch(given))


def check_speed(name: str, value: float, unit: str) -> None:
    """Refuse a negative speed as a bound: limits of speed are those of its amount."""
    if unit == "rad/s" and value < 0.0:
        raise LoomfmuError(
            f"claim: bound {name} = {units.show(value, 'rev/min')} is negative, and limits of speed are not;"
            f' write the speed itself, such as bound = "{units.show(-value, "rev/min")}"'
        )


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


def parameters_of(claim: dict[str, Any]) -> list[str]:
    """The instances whose parameters a claim reads beside those of the signals that it needs."""
    if claim.get("kind") in ("rapier_in_open_shed", "reed_clear_of_rapier"):
        return [str(claim.get("belt", "belt"))]
    bound = claim.get("bound")
    return [str(bound).partition(".")[0]] if names_parameter("bound", bound) else []


NO_RISK = "the belt is never at risk in this run"
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

NAMES = frozenset(("signal", "belt", "heald", "damper", "lock", "weft", "reed"))  # of signals, of instances
NEVER_NEGATIVE = frozenset(("at_most", "at_least", "clearance", "head_height"))

# claim -> the argument that names an instance, or its usual name, and the outputs it is judged by
NEEDS: dict[str, tuple[str, tuple[str, ...]]] = {
    "lowest_margin": ("belt", ("margin", "lowest_margin")),
    "dwell": ("heald", ("lift",)),
    "dwell_contains": ("heald", ("lift",)),
    "clear_shed": ("heald", ("lift", "warp_height")),
    "peak_load": ("damper", ("transmitted_force", "peak_load")),
    "stop_contacts": ("damper", ("stop_contacts",)),
    "locks_in_time": ("lock", ("in_time", "torque_margin", "speed_limit")),
    "reed_clear_of_rapier": ("reed", ("position", "front_limit")),
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
    signal, margin = f"{belt}.lowest_margin", trace[f"{belt}.margin"]
    worst, time = float(trace[signal][-1]), curves.reached(trace, signal, margin)
    note = NO_RISK if worst >= 1.0 else ""
    return verdict(trace, "lowest margin", signal, worst >= limit, limit, worst, ONE, time, note)


def peak_load(trace: Signals, damper: str, at_most: float | str) -> Verdict:
    """The force that a damper's carrier puts on its frame never exceeds a bound, on the continuous curve."""
    limit = units.parse(at_most, "N")
    signal, force = f"{damper}.peak_load", trace[f"{damper}.transmitted_force"]
    worst, time = float(trace[signal][-1]), curves.reached(trace, signal, -np.abs(force))
    return verdict(trace, "peak load", signal, worst <= limit, limit, worst, FORCE, time)


def stop_contacts(trace: Signals, damper: str, at_most: float | str) -> Verdict:
    """A damper's carrier touches its stops no more often than that; its place is that of the last contact."""
    limit = units.parse(at_most, "1")
    counted = trace[f"{damper}.stop_contacts"]
    worst = float(counted[-1])
    time = float(trace.time[np.argmax(counted == counted[-1])]) if worst > 0.0 else math.nan
    return verdict(trace, "stop contacts", f"{damper}.stop_contacts", worst <= limit, limit, worst, ONE, time)


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
        check_speed(str(bound), limit, trace.unit(signal))
    else:
        limit = units.parse(bound, trace.unit(signal))
    claim = f"stays {'above' if sign > 0 else 'below'}"
    unit = (trace.unit(signal), trace.display(signal))
    within = None
    if window is not None:
        start, width = _window(window, "window")
        claim += f" in {_angles(*(units.parse(edge, 'rad') for edge in window))}"
        within = curves.within_window(trace, start, width)
        if not within:
            reason = "the run is never in that window"
            return verdict(trace, claim, signal, False, limit, math.nan, unit, math.nan, reason)
    motion = curves.Motion(trace, signal)
    worst = motion.lowest(sign, within)
    holds = sign * worst.sure >= sign * limit and not worst.coarse
    found = verdict(
        trace, claim, signal, holds, limit, worst.value, unit, worst.time, motion.note, worst.note
    )
    if holds and sign * worst.value < sign * limit:
        doubt = found.displayed(motion.doubt_at(worst.time))
        unit_text = "" if found.label == "1" else f" {found.label}"
        note = f"beyond the bound only between samples, where the curve may be off by {doubt:.1e}{unit_text}"
        return replace(found, note="; ".join(filter(None, (found.note, note))))
    return found
