"""The reed's six-bar: crank, coupler, rocker with its arm, rod and reed."""

from math import cos, sin

import numpy as np

from ...components.reed_beat_up import ReedBeatUp
from ...physics.reed import servo_turn
from ..rules import mm
from ..section import TURN
from .recorded import follows
from .sketch import Figure, Sketch, Value, title
from .tracks import Tracks

Place = tuple[float, float]


def joints(reed: ReedBeatUp, angle: float) -> list[Place]:
    """Crank pin, end of the rocker, end of its arm, reed [mm]; the rocker's pivot is the origin."""
    turned = angle - reed.beat_up_angle
    if reed.servo:
        turned, _first, _second = servo_turn(turned, reed.run_angle, reed.ramp_share * reed.run_angle)
    crank = reed.beat_up_crank + reed.crank_direction * turned
    chi, _first, _second = reed.rocker(crank, 1.0)
    arm = chi + reed.arm_angle
    position, _first, _second, _slope = reed.reed(arm, 0.0, 0.0)
    places = (
        (reed.crank_x + reed.crank_length * cos(crank), reed.crank_y + reed.crank_length * sin(crank)),
        (reed.rocker_length * cos(chi), reed.rocker_length * sin(chi)),
        (reed.arm_length * cos(arm), reed.arm_length * sin(arm)),
        (position, reed.reed_height),
    )
    return [(1000.0 * x, 1000.0 * y) for x, y in places]


def beat_up(tracks: Tracks, name: str) -> Figure | None:
    """The reed with what drives it; None if it does not follow the shaft of the trace."""
    reed: ReedBeatUp | None = follows(tracks, name, ReedBeatUp, "position")
    if reed is None:
        return None
    found = np.array([joints(reed, angle) for angle in TURN * tracks.shares])
    pin, end, arm, tip = (
        tracks.point(f"{name}.{joint}", found[:, n]) for n, joint in enumerate(("pin", "end", "arm", "reed"))
    )
    crank, radius = (1000.0 * reed.crank_x, 1000.0 * reed.crank_y), 1000.0 * reed.crank_length
    xs = [0.0, crank[0] - radius, crank[0] + radius, *found[:, :, 0].flat]
    ys = [-20.0, crank[1] - radius, crank[1] + radius, *found[:, :, 1].flat]
    sketch = Sketch(tracks, min(xs) - 40.0, min(ys) - 20.0, max(xs) + 110.0, max(ys) + 110.0)
    line = 1000.0 * reed.reed_height
    sketch.line(
        (1000.0 * reed.back_limit - 40.0, line), (1000.0 * reed.front_limit + 40.0, line), role="path"
    )
    front = 1000.0 * reed.front_limit
    sketch.line((front, line - 75.0), (front, line + 75.0), role="path")
    sketch.label(front, line + 75.0, "front limit", shift=(0.0, -6.0))
    sketch.circle(crank, radius, "path")
    sketch.line(crank, pin, role="link shaft")
    sketch.line(pin, end, role="link reed")
    sketch.line((0.0, 0.0), end, role="link reed")
    sketch.line(end, arm, role="link reed")
    sketch.line((0.0, 0.0), arm, tip, role="link reed")
    with sketch.group(shift=tip):
        sketch.box(-6.0, -60.0, 6.0, 60.0, role="body reed")
    sketch.pivot(crank, (0.0, 0.0))
    sketch.joint(pin, end, arm, tip)
    sketch.tracks.add(f"{name}.back", ["-", front, mm(f"{name}.position")])
    return sketch.figure(
        f"reed-{name}",
        title("Reed beat-up", name, "reed"),
        "The reed's six-bar: crank, coupler, rocker with its arm, rod, and the reed on its line.",
        [Value("reed behind its front limit", f"{name}.back", "mm")],
        "The linkage is to scale; the height of the reed is schematic.",
    )
