"""Both rapiers across the loom: the giver from the left, and mirrored from the right the taker."""

from collections.abc import Sequence

from ..occasions import instances
from ..rules import mm
from .belt import Belt, axis, reached, side, wheel_centre, wheel_radius, width
from .sketch import Figure, Sketch, Value, title
from .tracks import Tracks

SHOWN = 400.0  # mm: on both sides of the middle of the loom


def across(tracks: Tracks, belts: Sequence[Belt]) -> list[Figure]:
    """Ways across the loom: of both heads in one drawing where they meet, of other ones by themselves."""
    figures, left = [], list(belts)
    for name in instances(tracks.trace, "WeftTransfer", "overlap", "closing_velocity"):
        pair = [_moved_with(tracks, f"{name}.{each}_travel", belts) for each in ("giver", "taker")]
        giver, taker = (found[0] if found else None for found in pair)
        if giver and taker and giver is not taker:
            figures += _both(tracks, name, giver, taker)
            left = [belt for belt in left if belt not in (giver, taker)]
    return figures + [width(tracks, belt) for belt in left]


def _moved_with(tracks: Tracks, sink: str, belts: Sequence[Belt]) -> list[Belt]:
    """The belts of the head whose travel an input of the transfer takes."""
    wires = tracks.trace.wires
    return [belt for belt in belts if sink in wires and wires.get(f"{belt.name}.travel") == wires[sink]]


def _both(tracks: Tracks, name: str, giver: Belt, taker: Belt) -> list[Figure]:
    """Both rapiers between their wheels, and their heads where they meet."""
    apart = 1000.0 * tracks.parameter(f"{name}.separation") - giver.idle - taker.idle
    radii = wheel_radius(tracks, giver), wheel_radius(tracks, taker)
    ends = [wheel_centre(belt, r) - r - 40.0 for belt, r in zip((giver, taker), radii, strict=True)]
    sketch = Sketch(tracks, ends[0], -260.0, apart - ends[1], 2.0 * max(radii) + 130.0)
    axis(sketch, apart, 1000.0)
    near = Sketch(tracks, 0.5 * apart - SHOWN, -90.0, 0.5 * apart + SHOWN, 130.0)
    for each, beside in ((sketch, 0.0), (near, 40.0)):
        with each.group(shift=(0.0, beside)):
            side(each, giver, radii[0])
        with each.mirrored(apart), each.group(shift=(0.0, -beside)):
            side(each, taker, radii[1])
    for x, label in ((reached(tracks, giver), "giver"), (apart - reached(tracks, taker), "taker")):
        near.line((x, -80.0), (x, 95.0), role="path")
        near.label(x, 95.0, f"{label} at most", "start" if label == "giver" else "end", (0.0, -4.0))
    closing = tracks.add(f"{name}.closing", f"{name}.closing_velocity")
    unbent = (
        " Numbers are those of straight belts; a head is drawn back by the length that the bend takes up."
        if giver.slope or taker.slope
        else ""
    )
    return [
        sketch.figure(
            f"rapiers-{name}",
            title("Both rapiers across the loom", name, "transfer"),
            "Both rapier heads on their ways from their guides to the middle of the loom, where the giver,"
            " on the left, hands the weft over to the taker.",
            [
                Value(f"{who}'s head into the shed", _unbent(tracks, belt), "mm")
                for who, belt in (("giver", giver), ("taker", taker))
            ],
            f"The axis counts mm from the end of the giver's guide. Heights are schematic.{unbent}",
        ),
        near.figure(
            f"transfer-{name}",
            title("The heads in mid-shed", name, "transfer"),
            "The heads of giver and taker about the middle of the loom, where they pass each other.",
            [Value("overlap", tracks.mm(f"{name}.overlap"), "mm"), Value("closing velocity", closing, "m/s")],
            "Dashed lines: the farthest reach of each head. Heights are schematic; the heads are drawn side"
            f" by side.{unbent}",
        ),
    ]


def _unbent(tracks: Tracks, belt: Belt) -> str:
    """Return the name of a track: how far a head with a straight belt is in the shed [mm]."""
    return tracks.add(f"{belt.name}.unbent", ["-", mm(f"{belt.name}.free_length"), -belt.head])
