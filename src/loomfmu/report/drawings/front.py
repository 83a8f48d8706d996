"""The loom from its front, from wheel to wheel, and nearer its two heads where they meet."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from ..occasions import instances
from ..rules import mm
from .belt import Belt, reached, through_guide, wheel_centre, wheel_radius, wound
from .drive import SECTOR, Drive, parts
from .side import BOARD, RAIL, Shed, boarded
from .sketch import Figure, Sketch, Value, title
from .tracks import Tracks
from .yarn import EYE

WIDE = 1100.0  # px of the view
SHOWN = 400.0  # mm: on both sides of the middle of the loom
GUIDE = 20.0  # mm: half the heights of guides and heads, drawn
HEALDS = 24  # of a frame, drawn
Pair = tuple[str, Belt, Belt | None]  # what moves in one shed: a transfer with its giver and taker, or a belt


def pairs(tracks: Tracks, belts: Sequence[Belt]) -> list[Pair]:
    """Belts whose heads meet, then the other ones."""
    found, left = list[Pair](), list(belts)
    for name in instances(tracks.trace, "WeftTransfer", "overlap", "closing_velocity"):
        pair = [_moved_with(tracks, f"{name}.{each}_travel", belts) for each in ("giver", "taker")]
        giver, taker = (each[0] if each else None for each in pair)
        if giver and taker and giver is not taker:
            found.append((name, giver, taker))
            left = [belt for belt in left if belt not in (giver, taker)]
    return found + [(belt.name, belt, None) for belt in left]


def _moved_with(tracks: Tracks, sink: str, belts: Sequence[Belt]) -> list[Belt]:
    """The belts of the head whose travel an input of the transfer takes."""
    wires = tracks.trace.wires
    return [belt for belt in belts if sink in wires and wires.get(f"{belt.name}.travel") == wires[sink]]


def _apart(tracks: Tracks, name: str, giver: Belt, taker: Belt) -> float:
    """Distance between the ends of both guides [mm]."""
    return 1000.0 * tracks.parameter(f"{name}.separation") - giver.idle - taker.idle


@dataclass(frozen=True)
class End:
    """A belt with its drive, if that is known, from its wheel to its head."""

    belt: Belt
    radius: float  # of the wheel [mm]; 0 if the trace has none
    drive: Drive | None

    @property
    def centre(self) -> float:
        """Place of the wheel before the guide's end [mm]."""
        return wheel_centre(self.belt, self.radius)

    @property
    def box(self) -> tuple[float, float, float]:
        """Left, bottom and top of what is drawn before the guide's end [mm]."""
        if not self.drive:
            return self.centre - self.radius - 40.0, -60.0, max(2.0 * self.radius, GUIDE)
        (x, y), (left, bottom, _right, top) = self.drive.leaves, self.drive.corners
        return min(self.centre - x + left, self.centre - self.radius) - 40.0, bottom - y, top - y

    def draw(self, sketch: Sketch) -> None:
        """Draw it from the left."""
        if self.drive:
            x, y = self.drive.leaves
            with sketch.group(shift=(self.centre - x, -y)):
                parts(sketch, self.drive)
        elif self.radius:
            wound(sketch, self.belt, self.radius)
        through_guide(sketch, self.belt, self.radius, GUIDE)


def view(tracks: Tracks, pair: Pair, drives: Mapping[str, Drive], shed: Shed | None) -> Figure:
    """The loom from its front: drives, belts in their guides, heads, and the heald frames behind them."""
    name, giver, taker = pair
    wires = tracks.trace.wires
    ends = [
        End(
            belt,
            wheel_radius(tracks, belt),
            drives.get(wires.get(f"{belt.name}.travel", "").partition(".")[0]),
        )
        for belt in (giver, taker)
        if belt
    ]
    apart = _apart(tracks, name, giver, taker) if taker else max(reached(tracks, giver), 500.0)
    right = apart - ends[1].box[0] if taker else apart + 60.0
    tall = shed.high if shed else 0.0
    bottom, top = min(-tall, *(each.box[1] for each in ends)), max(tall, *(each.box[2] for each in ends))
    px = (right - ends[0].box[0]) / WIDE
    sketch = Sketch(tracks, ends[0].box[0], bottom - 24.0 * px, right, top + 24.0 * px, WIDE)
    if shed:
        _warp(sketch, shed, apart if taker else right + 100.0)
    _weft(sketch, giver)
    ends[0].draw(sketch)
    if taker:
        with sketch.mirrored(apart):
            ends[1].draw(sketch)
    _names(sketch, ends, apart, shed)
    heads = [("giver's head", giver), ("taker's head", taker)] if taker else [("head", giver)]
    return sketch.figure(
        f"front-{name}",
        title("The loom from its front", name, "transfer" if taker else "belt"),
        "The loom from its front: "
        + ("both drives, belts, guides and rapier heads" if taker else "drive, belt, guide and rapier head")
        + (", before the heald frames and the warp." if shed else "."),
        [Value(f"{who} into the shed", _unbent(tracks, belt), "mm") for who, belt in heads if belt],
        "Lengths across the loom, linkages, wheels and lifts are to scale. Heights of heads, guides and"
        f" frames and the places of the drives are schematic.{_of_straight(ends)}",
    )


def _warp(sketch: Sketch, shed: Shed, right: float) -> None:
    """The warp between fell and healds, as high as it is at the healds, and the frames."""
    for place, frame in enumerate(shed.frames):
        with sketch.group(stretch=(0.0, 0.0, 1.0, frame.eye)):
            sketch.box(0.0, 0.0, right, 1.0, role="veil")
        with sketch.group(shift=(0.0, frame.eye)):
            for n in range(HEALDS):
                x = right * (n + (place + 0.5) / len(shed.frames)) / HEALDS
                sketch.line((x, -frame.bar), (x, frame.bar), role="faint heald")
            for y in (-frame.bar, frame.bar) if frame.damper else ():
                sketch.line((0.0, y), (right, y), role="carrier dwell")
        with sketch.group(shift=(0.0, f"{frame.name}.lift_mm")):
            for y in (-frame.middle - shed.tall, -frame.middle + shed.tall):
                sketch.box(0.0, y - RAIL, right, y + RAIL, role="body dwell")
    if boarded(shed):
        y = -shed.low(shed.station) - 2.0
        sketch.box(0.0, y - BOARD, right, y, role="body")


def _weft(sketch: Sketch, giver: Belt) -> None:
    """The weft from its eyes to the head that draws it, below the guide until it is in the shed."""
    tracks, wires = sketch.tracks, sketch.tracks.trace.wires
    for name in instances(tracks.trace, "WeftTension", "length"):
        if f"{name}.travel" in wires and wires[f"{name}.travel"] == wires.get(f"{giver.name}.travel"):
            supply, taken = (
                1000.0 * tracks.parameter(f"{name}.{each}") for each in ("supply_length", "pick_up_travel")
            )
            brake = taken - giver.idle - supply
            end = tracks.add(f"{name}.drawn", ["-", mm(f"{name}.length"), -brake])
            start = brake + EYE * supply
            sketch.line((start, -2.5 * GUIDE), (end, 0.0), role="sheet weft")
            sketch.label(start, -2.5 * GUIDE, "weft", "end", (-4.0, 6.0))


def _names(sketch: Sketch, ends: Sequence[End], apart: float, shed: Shed | None) -> None:
    """The names of the parts, outside the mirrored ones."""
    both, px = len(ends) > 1, 1.0 / sketch.scale
    for place, end in enumerate(ends):
        at = partial(_across, apart if place else 0.0)
        outer, inner = ("end", "start") if place else ("start", "end")
        left, bottom, top = end.box
        above = not end.drive or end.drive.side < 0.0  # of the guide: that is where the wheel is
        far = top if above else bottom
        if end.radius:
            inwards = 0.0 if above else 0.5 * end.radius  # past the linkages' name
            sketch.label(at(end.centre + inwards), far, "rapier wheel", shift=(0.0, -8.0 if above else 18.0))
        if end.drive:
            x, y = end.drive.leaves
            sector = end.centre - x + end.drive.hub[0] + 0.5 * SECTOR, end.drive.hub[1] - y
            beside = end.centre + end.radius + 4.0 * px, 0.78 * far
            sketch.pointed((at(beside[0]), beside[1]), (at(sector[0]), sector[1]), "sector gear", outer)
            sketch.label(at(left), bottom, "linkages", outer, (8.0 - 16.0 * place, 18.0))
        sketch.label(at(0.0), GUIDE, "guide", inner, (12.0 * place - 6.0, -8.0))
        sketch.label(at(end.centre), 0.0, "belt", outer, (8.0 - 16.0 * place, 18.0))
        tip = end.belt.tip
        if place:
            tip = sketch.tracks.add(f"{end.belt.name}.tip_across", ["-", apart, tip])
        who = ("taker" if place else "giver") if both else "rapier head"
        aside = 30.0 * (2 * place - 1) if both else -30.0
        if shed:  # above the frames
            with sketch.group(shift=(tip, 0.0)):
                sketch.line((aside * px, GUIDE), (aside * px, shed.high), role="leader")
        sketch.letter((tip, shed.high if shed else -GUIDE), who, (aside, -8.0 if shed else 15.0))
    if shed:
        low = -shed.high - 4.0 * px
        sketch.pointed((0.34 * apart, low), (0.34 * apart, RAIL - shed.high), "heald frames")
        sketch.pointed((0.2 * apart, low), (0.2 * apart, -0.5 * shed.half), "warp")
        if boarded(shed):
            y = -shed.low(shed.station) - BOARD
            sketch.pointed((0.8 * apart, low), (0.8 * apart, y), "race board")
    if both:
        low = sketch.bottom + 24.0 * px
        sketch.line((0.5 * apart, low), (0.5 * apart, sketch.top), role="path")
        sketch.label(0.5 * apart, low, "transfer", shift=(0.0, 14.0))


def _across(apart: float, x: float) -> float:
    """A place that counts from the right end, if the ends are apart."""
    return apart - x if apart else x


def transfer(tracks: Tracks, pair: Pair) -> Figure | None:
    """Both heads about the middle of the loom; None of a belt by itself."""
    name, giver, taker = pair
    if not taker:
        return None
    apart = _apart(tracks, name, giver, taker)
    near = Sketch(tracks, 0.5 * apart - SHOWN, -90.0, 0.5 * apart + SHOWN, 130.0)
    ends = [End(belt, wheel_radius(tracks, belt), None) for belt in (giver, taker)]
    with near.group(shift=(0.0, 40.0)):
        ends[0].draw(near)
    with near.mirrored(apart), near.group(shift=(0.0, -40.0)):
        ends[1].draw(near)
    for x, label in ((reached(tracks, giver), "giver"), (apart - reached(tracks, taker), "taker")):
        near.line((x, -80.0), (x, 95.0), role="path")
        near.label(x, 95.0, f"{label} at most", "start" if label == "giver" else "end", (0.0, -4.0))
    closing = tracks.add(f"{name}.closing", f"{name}.closing_velocity")
    return near.figure(
        f"transfer-{name}",
        title("The heads in mid-shed", name, "transfer"),
        "The heads of giver and taker about the middle of the loom, where they pass each other.",
        [Value("overlap", tracks.mm(f"{name}.overlap"), "mm"), Value("closing velocity", closing, "m/s")],
        "Dashed lines: the farthest reach of each head. Heights are schematic; the heads are drawn side"
        f" by side.{_of_straight(ends)}",
    )


def _of_straight(ends: Sequence[End]) -> str:
    """The note on numbers of belts that buckle."""
    if not any(end.belt.slope for end in ends):
        return ""
    return " Numbers are those of straight belts; where a belt bends, its head is drawn farther back."


def _unbent(tracks: Tracks, belt: Belt) -> str:
    """Return the name of a track: how far a head with a straight belt is in the shed [mm]."""
    return tracks.add(f"{belt.name}.unbent", belt.within)
