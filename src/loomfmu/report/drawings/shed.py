"""Heald frames with their carriers, and the shed that they form, with reed and rapier head in it."""

from ...components.warp_tension import WarpTension
from ...traces.verdict import SHED_OPENING
from ..occasions import instances
from ..rules import Rule, mm
from .sketch import Figure, Sketch, Value
from .tracks import Tracks

CARRIER = 9.0  # mm: half the height of a carrier, drawn
BEHIND = 9.0  # mm: drawn distance of one frame behind another
NARROWEST = 30.0  # mm: column of a frame


def frames(tracks: Tracks) -> Figure | None:
    """The frames side by side, each with its carrier; None if none records its lift."""
    trace = tracks.trace
    names = instances(trace, "HealdFrame", "lift")
    if not names:
        return None
    column = max(340.0 / max(len(names), 4), NARROWEST)
    stroke = max(1000.0 * tracks.parameter(f"{name}.stroke") for name in names)
    known = instances(trace, "HealdDamper", "displacement")
    carried = {trace.wires.get(f"{damper}.lift"): damper for damper in known}
    dampers = {name: carried.get(f"{name}.lift", "") for name in names}
    half = max([20.0, *(_room(tracks, damper) for damper in dampers.values() if damper)])
    sketch = Sketch(tracks, -75.0, -half - 34.0, column * max(len(names), 4) + 5.0, stroke + half + 12.0)
    for level, label in ((0.0, "lowered"), (stroke, "raised")):
        sketch.line((sketch.left, level), (sketch.right, level), role="path")
        sketch.label(sketch.left, level, label, "start", (4.0, -5.0))
    for place, name in enumerate(names):
        x = column * (place + 0.5)
        with sketch.group(shift=(x, tracks.mm(f"{name}.lift"))):
            _frame(sketch, dampers[name], 0.42 * column, half)
        sketch.label(x, -half, name.rpartition("_")[2], shift=(0.0, 22.0))
    carriers = any(dampers.values())
    unknown = known and not trace.wires  # in traces of older versions
    return sketch.figure(
        "frames",
        "Heald frames" + " with their carriers" * carriers,
        f"{len(names)} heald frames at their lifts"
        + (", each with its carrier between two stops." if carriers else "."),
        note=(
            "Lifts and displacements of the carriers are to scale; the frames are schematic, dashed lines are"
            " the stops."
            if carriers
            else "Lifts are to scale; the frames are schematic."
            + " The trace does not say which carrier is in which frame: none is drawn." * bool(unknown)
        ),
    )


def _room(tracks: Tracks, damper: str) -> float:
    """Half the height of a frame in which a carrier never meets the edge."""
    free = 1000.0 * tracks.parameter(f"{damper}.free_travel")
    moved = float(tracks.values(["highest", ["abs", mm(f"{damper}.displacement")]]))
    return max(free, moved) + CARRIER + 4.0


def _frame(sketch: Sketch, damper: str, side: float, half: float) -> None:
    sketch.box(-side, -half, side, half, role="body dwell")
    if not damper:
        return
    stop = 1000.0 * sketch.tracks.parameter(f"{damper}.free_travel") + CARRIER
    for y in (-stop, stop):
        sketch.line((-side, y), (side, y), role="path")
    with sketch.group(shift=(0.0, sketch.tracks.mm(f"{damper}.displacement"))):
        sketch.box(-0.75 * side, -CARRIER, 0.75 * side, CARRIER, role="carrier dwell")


def shed(tracks: Tracks, tip: str) -> Figure | None:
    """The warp from its side, between fell and heald frames; None if no frame records its lift.

    `tip` is the track of the rapier head in the shed, empty if there is none.
    """
    trace = tracks.trace
    names = instances(trace, "HealdFrame", "lift")
    if not names:
        return None
    front, back, published = _lengths(tracks)
    half = max(500.0 * tracks.parameter(f"{name}.stroke") for name in names)
    pitch = min(BEHIND, 60.0 / len(names))
    sketch = Sketch(tracks, -front - pitch * len(names) - 15.0, -half - 36.0, 30.0, half + 36.0)
    sketch.line((0.0, 0.0), (30.0, 0.0), role="link cloth")
    sketch.label(0.0, 0.0, "fell", "start", (6.0, -8.0))
    sketch.line((sketch.left, 0.0), (0.0, 0.0), role="path")
    for place, name in enumerate(names):
        lift = tracks.mm(f"{name}.lift")
        x, middle = -front - pitch * place, 500.0 * tracks.parameter(f"{name}.stroke")
        with sketch.group(shift=(0.0, -middle)):
            sketch.line((0.0, middle), (-front, lift), (x, lift), (-front - back, middle), role="sheet shed")
            with sketch.group(shift=(x, lift)):
                for end in (-26.0, 26.0):
                    sketch.line((0.0, 0.0), (0.0, end), role="heald")
                    sketch.box(-0.35 * pitch, end - 4.0, 0.35 * pitch, end + 4.0, role="body dwell")
    reeds = _reed(sketch)
    ratio = tracks.parameter(f"{names[0]}.warp_ratio")
    note = _head(sketch, tip, ratio * front, 2.0 * half * ratio) if tip else ""
    openings: list[Rule] = [
        [
            "*",
            ["*", 2000.0, f"{name}.warp_ratio"],
            ["abs", ["-", f"{name}.lift", ["*", 0.5, f"{name}.stroke"]]],
        ]
        for name in names
    ]
    tracks.add("opening", ["min", *openings])
    assumed = "" if published else " Distances along the warp are assumed: they are not in the trace."
    return sketch.figure(
        "shed",
        "The shed from its side",
        f"The warp sheets of {len(names)} heald frames between the fell of the cloth and the healds"
        + (", with the reed" if reeds else "")
        + (", and the rapier head in the shed." if tip else "."),
        [Value("opening at the rapier", "opening", "mm")],
        f"The sheets follow the lifts of the frames, which are drawn behind one another.{note}{assumed}",
    )


def _lengths(tracks: Tracks) -> tuple[float, float, bool]:
    """Distances of the healds from fell and back rest [mm], and whether the trace has them."""
    found = instances(tracks.trace, "WarpTension")
    if found:
        front, back = (1000.0 * tracks.parameter(f"{found[0]}.{each}_length") for each in ("front", "back"))
        return front, back, True
    assumed = WarpTension()
    return 1000.0 * assumed.front_length, 1000.0 * assumed.back_length, False


def _reed(sketch: Sketch) -> bool:
    """The reed, at its distance from its front limit, which is the fell."""
    trace = sketch.tracks.trace
    for name in instances(trace, "ReedBeatUp", "position", "front_limit"):
        behind = sketch.tracks.add(f"{name}.behind", mm(["-", f"{name}.position", f"{name}.front_limit"]))
        with sketch.group(shift=(behind, 0.0)):
            sketch.line((0.0, -55.0), (0.0, 55.0), role="link reed")
        return True
    return False


def _head(sketch: Sketch, tip: str, station: float, low: float) -> str:
    """The head in the shed, of the height that a claim gives it; what is to be said of it."""
    heights = [
        1000.0 * verdict.bound
        for verdict in sketch.tracks.trace.verdicts
        if verdict.claim.endswith(SHED_OPENING)
    ]
    height = heights[0] if heights else 8.0
    with sketch.group(shown=tip):
        sketch.box(-station - 9.0, -0.5 * height, -station + 9.0, 0.5 * height, role="body weft")
        sketch.letter((-station, -0.5 * max(height, low)), "rapier", (0.0, 18.0))
    if heights:
        return f" The rapier head has the {height:g} mm that its claim gives it."
    return " The size of the rapier head is schematic."
