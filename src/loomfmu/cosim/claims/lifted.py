"""What lifts the warp of a heald frame: the carrier on springs in it, or the frame itself."""

from collections.abc import Container, Iterable

from ...errors import LoomfmuError, shown
from ...traces import Signals

FRAME = "frame"  # as a claim's `lifted_by`: the frame, although it has a damper


def check_lifted_by(lifted_by: str, dampers: Container[str]) -> None:
    """Refuse what names neither the frame nor one of the dampers that it may name."""
    if lifted_by not in ("", FRAME) and lifted_by not in dampers:
        named = ", the name of a damper such as damper_1," if dampers else ""
        raise LoomfmuError(
            f'lifted_by = {shown(lifted_by)} must be "frame"{named} or be left out; then the carrier of each'
            " frame with a damper is judged"
        )


def lift_of(frame: str, lifted_by: str, names: Iterable[str]) -> str:
    """The signal of the lift that the warp of a frame has.

    That is the lift of the carrier if the run has the damper of the frame, which has its number, or if
    `lifted_by` names a damper; `names` are instances or signals of the run.

    >>> lift_of("heald_2", "", ["heald_2", "damper_2"]), lift_of("heald_2", "frame", ["heald_2", "damper_2"])
    ('damper_2.carrier_lift', 'heald_2.lift')
    """
    usual = frame.replace("heald", "damper", 1)
    damper = lifted_by
    if not damper and usual != frame and any(name.partition(".")[0] == usual for name in names):
        damper = usual
    return f"{damper}.carrier_lift" if damper not in ("", FRAME) else f"{frame}.lift"


def frames_of(trace: Signals) -> list[str]:
    """The heald frames of a run, whatever they are called: what has a lift and the height of its warp."""
    owners = sorted({name.partition(".")[0] for name in trace})
    return [each for each in owners if f"{each}.lift" in trace and f"{each}.warp_height" in trace]


def lifts(frame: str, lifted_by: str, trace: Signals) -> list[str]:
    """The lift that the warp has, and, if the carrier gives it, that of the frame."""
    return list(dict.fromkeys((lift_of(frame, lifted_by, trace), f"{frame}.lift")))
