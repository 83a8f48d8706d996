"""Heald frames with their carriers."""

from ..occasions import instances
from ..rules import mm
from .sketch import Figure, Sketch
from .tracks import Tracks

CARRIER = 9.0  # mm: half the height of a carrier, drawn
NARROWEST = 30.0  # mm: column of a frame


def frames(tracks: Tracks) -> Figure | None:
    """The frames side by side, each with its carrier; None if none records its lift."""
    trace = tracks.trace
    names = instances(trace, "HealdFrame", "lift")
    if not names:
        return None
    column = max(340.0 / max(len(names), 4), NARROWEST)
    stroke = max(1000.0 * tracks.parameter(f"{name}.stroke") for name in names)
    dampers = {name: on_lift_of(tracks, name, "HealdDamper") for name in names}
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
    # in traces of older versions
    unknown = instances(trace, "HealdDamper", "displacement") and not trace.wires
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


def on_lift_of(tracks: Tracks, name: str, fmu: str, lift: str = "lift") -> str:
    """An instance of an FMU with a displacement that is wired to a lift of another one; "" without one."""
    wires = tracks.trace.wires
    found = instances(tracks.trace, fmu, "displacement")
    return next((each for each in found if wires.get(f"{each}.lift") == f"{name}.{lift}"), "")


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
