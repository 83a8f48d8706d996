"""The lift of the warp of a heald frame: that of its sprung carrier, or of the frame itself."""

import math
from collections.abc import Container, Iterable, Mapping
from contextlib import suppress
from itertools import chain
from typing import Any

from ..cosim.claims.conditions import Unprovable
from ..cosim.claims.movers import Wired
from ..declaring.upstream import sources_of, upstream
from ..errors import LoomfmuError, listed, shown
from ..traces import Signals

LENGTH = "pattern_length"  # of the pattern of a heald frame
WORDS = [f"pattern_{number}" for number in range(1, 9)]  # parameters of a heald frame: picks, as bits
PICKS_IN_A_WORD = 16
FRAME = "frame"  # as a claim's `lifted_by`: the frame, although it has a damper


def check_lifted_by(lifted_by: str, dampers: Container[str]) -> None:
    """Refuse what names neither the frame nor one of the dampers that it may name."""
    if lifted_by not in ("", FRAME) and lifted_by not in dampers:
        named = ", the name of a damper such as damper_1," if dampers else ""
        raise LoomfmuError(
            f'lifted_by = {shown(lifted_by)} must be "frame"{named} or be left out; then the carrier of each'
            " frame with a damper is judged"
        )


def frames_of(run: Wired) -> list[str]:
    """The heald frames of a run, whatever they are called: what has a lift and the height of its warp."""
    return _giving(run, "HealdFrame", "lift", "warp_height")


def pegs(values: Mapping[str, Any]) -> str:
    """Return the string of pegs that the parameters of a heald frame stand for: 1 raised, 0 lowered.

    >>> pegs({"pattern_length": 4, "pattern_1": 3})
    '1100'
    """
    every = "".join(f"{int(values[word]):0{PICKS_IN_A_WORD}b}"[::-1] for word in WORDS if word in values)
    return every[: int(values[LENGTH])]


def weave_of(instances: Iterable[str], trace: Signals) -> tuple[str, ...]:
    """Return the patterns of all frames on which these instances depend: 9 parameters of each."""
    known, wanted = trace.shared.setdefault(weave_of, {}), frozenset(instances)  # several claims ask
    if wanted not in known:
        owners = ((source.partition(".")[0], sink.partition(".")[0]) for sink, source in trace.wires.items())
        patterns = (_pattern(each, trace) for each in sorted(upstream(wanted, sources_of(owners))))
        known[wanted] = tuple(chain.from_iterable(patterns))
    found: tuple[str, ...] = known[wanted]
    return found


def _pattern(instance: str, trace: Signals) -> list[str]:
    names = [f"{instance}.{name}" for name in (LENGTH, *WORDS)]
    with suppress(LoomfmuError):  # it has no such parameters
        return names if all(math.isfinite(trace.parameter(each)) for each in names) else []
    return []


def dampers_of(run: Wired) -> list[str]:
    """The dampers of a run, whatever they are called: what has a carrier with a lift."""
    return _giving(run, "HealdDamper", "carrier_lift")


def _giving(run: Wired, fmu: str, *outputs: str) -> list[str]:
    """The instances of an FMU, whatever is recorded of them, and all others with these outputs."""
    owners = sorted({name.partition(".")[0] for name in run})
    return [
        owner
        for owner in owners
        if run.fmus.get(owner) == fmu or all(f"{owner}.{name}" in run for name in outputs)
    ]


def lift_of(frame: str, lifted_by: str, run: Wired) -> str:
    """The signal of the lift that the warp of a frame has.

    That is the lift of the carrier if a damper takes the lift of the frame, or if `lifted_by` names a damper.
    Raises LoomfmuError where the wires do not tell.
    """
    damper = lifted_by or _damper_in(frame, run)
    return f"{damper}.carrier_lift" if damper not in ("", FRAME) else f"{frame}.lift"


def _damper_in(frame: str, run: Wired) -> str:
    """The damper in a frame; empty if it has none."""
    dampers = dampers_of(run)
    if dampers and not run.wires:  # as in traces of older versions
        raise LoomfmuError(f"the run does not say which damper is in {frame}; set lifted_by")
    fed = {sink.partition(".")[0] for sink, source in run.wires.items() if source == f"{frame}.lift"}
    found = [each for each in dampers if each in fed]
    if len(found) > 1:
        raise LoomfmuError(f"{frame} has more than one damper, {listed(found)}; set lifted_by")
    return next(iter(found), "")


def height_of(frame: str, lifted_by: str, run: Wired) -> str:
    """The signal of the height of a frame's warp. Raises Unprovable where a damper's carrier lifts it."""
    lift = lift_of(frame, lifted_by, run)
    if lift != f"{frame}.lift":
        raise Unprovable(f"{lift} depends on the run so far, not on the shaft angle alone")
    return f"{frame}.warp_height"


def lifts(frame: str, lifted_by: str, run: Wired) -> list[str]:
    """The lift that the warp has, and, if the carrier gives it, that of the frame."""
    return list(dict.fromkeys((lift_of(frame, lifted_by, run), f"{frame}.lift")))
