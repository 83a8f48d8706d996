"""The loom from its side, from the healds to the cloth, and nearer the rapier head in the shed."""

from dataclasses import dataclass

from ...components.warp_tension import WarpTension
from ...traces import Trace
from ...traces.verdict import REED_DISTANCE, SHED_OPENING
from ..occasions import instances
from ..rules import Rule, mm
from .belt import Belt
from .sketch import Figure, Sketch, Value
from .tracks import Tracks

WIDE = 660.0  # px of the section
BEHIND, DEEPEST = 12.0, 150.0  # mm: one frame behind another, and all of them at most
RAIL, BAR = 8.0, 4.0  # mm: half the heights of a frame's rail and of a carrier's bar
REED = 62.0  # mm: half its height
HEAD, LOW = 12.0, 5.0  # mm: half the width of the head, and its height if no claim gives it
BOARD = 10.0  # mm: thickness of the race board
AROUND = 75.0, 45.0  # mm: what is drawn nearer
NEVER = 1e9  # mm: opening where the head is not in the shed


@dataclass(frozen=True)
class Frame:
    """A frame with its carrier and the play of its healds, if it has them.

    `eye` is the track of its healds' eyes, from the middle of its stroke, `bar` their distance from the
    healds' ends, `height` that of its warp at the head.
    """

    name: str
    damper: str
    play: str
    eye: str
    bar: float
    middle: float
    height: Rule


@dataclass(frozen=True)
class Shed:
    """Places in the section [mm]: x from the fell to the cloth, y from the closed shed upwards."""

    frames: list[Frame]
    front: float  # distances of the healds from fell and back rest
    back: float
    published: bool
    half: float  # of the stroke
    tall: float  # from a heald's eye to the middle of its frame's rail
    ratio: float
    reed: str
    behind: tuple[float, float]  # the reed from the fell: at most, and at least while the head is in the shed
    height: float  # of the head
    claimed: int | None  # place of the claim on its height
    tip: str  # track of the head in the shed

    @property
    def pitch(self) -> float:
        """Distance of a frame behind another."""
        return min(BEHIND, DEEPEST / len(self.frames))

    @property
    def high(self) -> float:
        """The top of a raised frame."""
        return self.half + self.tall + RAIL

    @property
    def station(self) -> float:
        """Distance of the head from the fell."""
        return self.ratio * self.front

    def low(self, x: float) -> float:
        """Half the opening of the open shed, so far from the fell."""
        return self.half * x / self.front


def views(tracks: Tracks, shed: Shed) -> list[Figure]:
    """The section and what is nearer."""
    return [_section(tracks, shed), _near(tracks, shed)]


def shed_of(tracks: Tracks, belt: Belt | None) -> Shed | None:
    """The shed with the head of a belt, if it gets there; None if no frame records its lift."""
    names = instances(tracks.trace, "HealdFrame", "lift")
    if not names:
        return None
    if belt and not (tracks.subject.live or tracks.values(["highest", belt.within]) > 0.0):
        belt = None
    stroke = max(1000.0 * tracks.parameter(f"{name}.stroke") for name in names)
    frames = [_framed(tracks, name, stroke + 30.0) for name in names]
    tracks.add("opening", ["min", *(["*", 2.0, ["abs", each.height]] for each in frames)])
    tracks.add("half_opening", ["*", 0.5, "opening"])
    reeds = instances(tracks.trace, "ReedBeatUp", "position", "front_limit")
    distance: Rule = mm(["-", f"{reeds[0]}.front_limit", f"{reeds[0]}.position"]) if reeds else 0.0
    if reeds:
        tracks.add(f"{reeds[0]}.behind", ["*", -1.0, distance])
    if belt:
        tracks.add("least_opening", ["lowest", ["if positive", belt.within, "opening", NEVER]])
        tracks.add("half_least", ["*", 0.5, "least_opening"])
    while_inside: Rule = ["lowest", ["if positive", belt.within if belt else 0.0, distance, NEVER]]
    claimed = _place_of(tracks.trace, SHED_OPENING)
    head = LOW if claimed is None else 1000.0 * tracks.trace.verdicts[claimed].bound
    tracks.add("room", ["-", "opening", head])
    tracks.add("tight", ["-", head, "opening"])
    return Shed(
        frames,
        *_lengths(tracks),
        0.5 * stroke,
        stroke + 30.0,
        tracks.parameter(f"{names[0]}.warp_ratio"),
        reeds[0] if reeds else "",
        (float(tracks.values(["highest", distance])), float(tracks.values(while_inside))),
        head,
        claimed,
        belt.tip if belt else "",
    )


def _place_of(trace: Trace, quantity: str) -> int | None:
    """Return the place of the first claim on a quantity, or None."""
    return next((n for n, each in enumerate(trace.verdicts) if each.claim.endswith(quantity)), None)


def _framed(tracks: Tracks, name: str, tall: float) -> Frame:
    """A frame with what hangs in it."""
    damper = _on_lift_of(tracks, name, "HealdDamper")
    play = _on_lift_of(tracks, damper or name, "HealdPlay", "carrier_lift" if damper else "lift")
    own: Rule = mm(["-", f"{name}.lift", ["*", 0.5, f"{name}.stroke"]])
    free = 1000.0 * tracks.parameter(f"{damper}.free_travel") + BAR if damper else 0.0
    eye = tracks.add(f"{name}.eye", ["-", own, ["*", -1000.0, f"{damper}.displacement"]] if damper else own)
    height: Rule = ["*", f"{name}.warp_ratio", eye]
    return Frame(
        name, damper, play, eye, tall - RAIL - free, 500.0 * tracks.parameter(f"{name}.stroke"), height
    )


def _on_lift_of(tracks: Tracks, name: str, fmu: str, lift: str = "lift") -> str:
    """An instance of an FMU with a displacement that is wired to a lift of another one; "" without one."""
    wires = tracks.trace.wires
    found = instances(tracks.trace, fmu, "displacement")
    return next((each for each in found if wires.get(f"{each}.lift") == f"{name}.{lift}"), "")


def _lengths(tracks: Tracks) -> tuple[float, float, bool]:
    """Distances of the healds from fell and back rest [mm], and whether the trace has them."""
    found = instances(tracks.trace, "WarpTension")
    if found:
        front, back = (1000.0 * tracks.parameter(f"{found[0]}.{each}_length") for each in ("front", "back"))
        return front, back, True
    assumed = WarpTension()
    return 1000.0 * assumed.front_length, 1000.0 * assumed.back_length, False


def _section(tracks: Tracks, shed: Shed) -> Figure:
    """The section from the healds to the cloth."""
    last = -shed.front - shed.pitch * (len(shed.frames) - 1)
    sketch = Sketch(tracks, last - 85.0, -shed.high - 8.0, 90.0, shed.high + 22.0, WIDE)
    _parts(sketch, shed)
    first = shed.frames[0]
    sketch.label(0.5 * (last - shed.front), sketch.top, "heald frames", shift=(0.0, 18.0))
    sketch.label(sketch.left, 0.0, "← back rest", "start", (4.0, -6.0))
    sketch.label(sketch.right, 0.0, "cloth", "end", (-4.0, -8.0))
    sketch.label(0.0, 0.0, "fell", "start", (5.0, 20.0))
    middle = tracks.add("warp.named", ["*", 0.8, f"{first.name}.eye"])
    sketch.letter((-0.8 * shed.front, middle), "warp sheet", (10.0, -18.0))
    end = shed.frames[-1]
    if end.damper:
        sketch.letter((last - 0.5 * shed.pitch, end.eye), "carrier", (-38.0, sketch.scale * end.bar + 6.0))
    sketch.letter((last - 0.5 * shed.pitch, end.eye), "heald", (-34.0, 0.6 * sketch.scale * end.bar))
    if shed.reed:
        sketch.letter((f"{shed.reed}.behind", 0.0), "reed", (0.0, -REED * sketch.scale - 6.0))
    if boarded(shed):
        sketch.letter((f"{shed.reed}.behind", 0.0), "race board", (64.0, REED * sketch.scale - 8.0))
    if shed.tip:
        with sketch.group(shown=shed.tip):
            sketch.letter(
                (-shed.station, 0.0), "rapier head", (0.0, -sketch.scale * shed.low(shed.station) - 14.0)
            )
    names = "healds in their frames" + " with carriers" * bool(end.damper)
    reed = ", reed" * bool(shed.reed)
    head = ", rapier head" * bool(shed.tip)
    return sketch.figure(
        "side",
        "The loom from its side",
        f"Section of the loom at true scale: warp sheets, {names}{reed}{head}, fell and cloth.",
        note=_notes(tracks, shed),
    )


def _notes(tracks: Tracks, shed: Shed) -> str:
    """Return the assumptions of the section."""
    found = [
        "The model has the eyes of all frames at the distance of the first; the frames are drawn behind one"
        f" another. Heights of healds and frames{' and of the reed' * bool(shed.reed)} are assumed."
    ]
    if instances(tracks.trace, "HealdDamper") and not tracks.trace.wires:  # in traces of older versions
        found.append("The trace does not say which carrier is in which frame: none is drawn.")
    if not shed.published:
        found.append("So are the distances along the warp, which are not in the trace.")
    if boarded(shed):
        found.append("So is the race board, which goes with the reed under the open shed.")
    if shed.tip and shed.reed and shed.behind[1] < shed.station:
        judged = _place_of(tracks.trace, REED_DISTANCE)
        near = f"{shed.behind[1]:.3g} mm" if judged is None else tracks.trace.verdicts[judged].shown_worst
        found.append(
            f"The head is {shed.station:.3g} mm behind the fell, where warp_ratio puts it. While it is in the"
            f" shed, the reed comes to within {near} of the fell, which is beyond the head."
        )
    return " ".join(found)


def _near(tracks: Tracks, shed: Shed) -> Figure:
    """The shed about the head."""
    x, y = AROUND
    high = max(y, 1.3 * shed.low(shed.station))
    sketch = Sketch(tracks, -shed.station - x, -high, -shed.station + x, high)
    _parts(sketch, shed)
    values = [Value("opening at the head" if shed.tip else "opening of the shed", "opening", "mm")]
    note = ""
    if shed.tip:
        side = -shed.station - 0.7 * x
        for name in ("half_least", tracks.add("least_below", ["*", -1.0, "half_least"])):
            sketch.line((side, name), (-shed.station + 0.7 * x, name), role="path")
        sketch.letter((side, "half_least"), "least opening", (44.0, -5.0))
        least = "least while the head is inside"
        if shed.claimed is None:
            values.append(Value(least, "least_opening", "mm"))
        else:
            values += [Value(least, claim=shed.claimed), Value("room left by the head", "room", "mm")]
        note = (
            f"The rapier head has the {shed.height:g} mm that its claim gives it. Where it is higher than the"
            " opening, it is dark orange."
            if shed.claimed is not None
            else f"The height of the head is assumed, {shed.height:g} mm: no claim gives it."
        )
        note += (
            " Green: the room that it has. Dashed: the least opening while it is in the shed. Width and taper"
            " of the head are assumed."
        )
    return sketch.figure(
        "shed",
        "The rapier head in the shed" if shed.tip else "The shed from its side",
        "The warp sheets"
        + (
            " above and below the rapier head, with the room that it has."
            if shed.tip
            else " of the frames, nearer."
        ),
        values,
        note,
    )


def _parts(sketch: Sketch, shed: Shed) -> None:
    sketch.line((sketch.left, 0.0), (0.0, 0.0), role="path")
    for place, each in enumerate(shed.frames):
        _frame(sketch, shed, each, -shed.front - shed.pitch * place)
    if shed.tip:
        with sketch.group(shown=shed.tip), sketch.group(stretch=(0.0, 0.0, 1.0, "half_opening")):
            sketch.line(*_wedge(shed, 1.0), role="room", closed=True)
    for place, each in enumerate(shed.frames):
        x = -shed.front - shed.pitch * place
        sketch.line(
            (0.0, 0.0),
            (-shed.front, each.eye),
            (x, each.eye),
            (-shed.front - shed.back, 0.0),
            role="sheet shed",
        )
    sketch.line((0.0, 0.0), (200.0, 0.0), role="link cloth")
    if shed.reed:
        with sketch.group(shift=(f"{shed.reed}.behind", 0.0)):
            _reed(sketch, shed)
    if shed.tip:
        with sketch.group(shown=shed.tip):
            sketch.line((-shed.station - 15.0, 0.0), (-shed.station + 15.0, 0.0), role="link belt")
            sketch.line(*_wedge(shed, 0.5 * shed.height), role="body weft", closed=True)
            if shed.claimed is not None:
                with sketch.group(shown="tight"):
                    sketch.line(*_wedge(shed, 0.5 * shed.height), role="body risk", closed=True)


def _wedge(shed: Shed, half: float) -> list[tuple[float, float]]:
    """The outline of the head, tapered like the shed, by half its height."""
    far, near = (half * (1.0 + sign * HEAD / shed.station) for sign in (1.0, -1.0))
    left, right = -shed.station - HEAD, -shed.station + HEAD
    return [(left, -far), (right, -near), (right, near), (left, far)]


def _frame(sketch: Sketch, shed: Shed, frame: Frame, x: float) -> None:
    """A frame with its rails, the bars of its carrier, if it has one, and a heald with its eye."""
    wide, tracks = 0.4 * shed.pitch, sketch.tracks
    with sketch.group(shift=(x, -frame.middle)), sketch.group(shift=(0.0, tracks.mm(f"{frame.name}.lift"))):
        sketch.box(-wide, -shed.tall, wide, shed.tall, role="faint dwell")
        for end in (-shed.tall, shed.tall):
            sketch.box(-wide, end - RAIL, wide, end + RAIL, role="body dwell")
    with sketch.group(shift=(x, frame.eye)):
        for end in (-frame.bar, frame.bar) if frame.damper else ():
            sketch.box(-wide, end - BAR, wide, end + BAR, role="carrier dwell")
        with sketch.group(shift=(0.0, tracks.mm(f"{frame.play}.displacement")) if frame.play else None):
            sketch.line((0.0, -frame.bar), (0.0, frame.bar), role="heald")
            sketch.circle((0.0, 0.0), 3.0, "joint")


def boarded(shed: Shed) -> bool:
    """Return whether the reed gets behind the head: then the race board reaches to below it."""
    return bool(shed.reed and shed.tip) and shed.behind[0] > shed.station + HEAD


def _reed(sketch: Sketch, shed: Shed) -> None:
    """The reed, with the race board before it, as low as the open shed where the reed is farthest."""
    sketch.box(-2.0, -REED, 2.0, REED, role="body reed")
    if boarded(shed):
        back, wide = shed.behind[0], shed.behind[0] - shed.station + HEAD
        tops = [(2.0, -shed.low(back) - 2.0), (wide, -shed.low(back - wide) - 2.0)]
        sketch.line(*tops, *((x, y - BOARD) for x, y in tops[::-1]), role="body", closed=True)
