"""The rapier's drive: spherical crank-rocker, four-bar, sector gear and wheel."""

from math import cos, degrees, pi, radians, sin

import numpy as np

from ...components.weft_insertion import WeftInsertion
from ...physics.linkage import spherical_rocker, wrapped
from ..rules import mm
from ..section import TURN
from .recorded import follows
from .sketch import Figure, Point, Sketch, Value, title
from .tracks import Tracks

BALL = 90.0  # mm: radius of the spherical linkage, which has no published size
SECTOR = 150.0  # mm: radius of the sector gear, likewise
ARC = 4  # pieces of the link between crank and rocker

Place = tuple[float, float]


def spherical(weft: WeftInsertion, angle: float) -> list[Place]:
    """The link of the spherical linkage from A on the crank to B on the rocker, seen along the rocker's axis.

    It is an arc about C, which is the origin; the shaft OC lies on x.
    """
    turned = weft.crank(angle)
    alpha, _first, _second = spherical_rocker(turned, weft.rocker_angle, weft.crank_cone)
    crank = cos(weft.crank_cone), -sin(weft.crank_cone) * cos(turned)
    rocker = cos(alpha), sin(alpha)
    arc = weft.rocker_angle
    points = []
    for n in range(ARC + 1):
        near, far = sin((1.0 - n / ARC) * arc) / sin(arc), sin(n / ARC * arc) / sin(arc)
        points.append(
            (BALL * (near * crank[0] + far * rocker[0]), BALL * (near * crank[1] + far * rocker[1]))
        )
    return points


def planar(weft: WeftInsertion, angle: float) -> list[Place]:
    """Joints D and K of the four-bar [mm]; C is the origin."""
    alpha, _first, _second = spherical_rocker(weft.crank(angle), weft.rocker_angle, weft.crank_cone)
    chi, _first, _second = weft.sector(weft.crank(angle))
    psi = alpha + weft.rocker_offset
    return [
        (1000.0 * weft.crank_length * cos(psi), 1000.0 * weft.crank_length * sin(psi)),
        (
            1000.0 * (weft.pivot_x + weft.output_length * cos(chi)),
            1000.0 * (weft.pivot_y + weft.output_length * sin(chi)),
        ),
    ]


def drive(tracks: Tracks, name: str) -> Figure | None:
    """The drive of a rapier; None if it does not follow the shaft of the trace."""
    weft: WeftInsertion | None = follows(tracks, name, WeftInsertion, "travel")
    if weft is None:
        return None
    angles = TURN * tracks.shares
    link = _cycles(tracks, f"{name}.AB", [spherical(weft, angle) for angle in angles])
    joints = [planar(weft, angle) for angle in angles] if weft.planar_linkage else []
    four_bar = _cycles(tracks, f"{name}.DK", joints) if joints else []
    hub = (1000.0 * weft.pivot_x, 1000.0 * weft.pivot_y) if weft.planar_linkage else (0.0, 0.0)
    radius = 500.0 * weft.wheel_diameter
    wheel = (hub[0] + SECTOR * (1.0 + 1.0 / weft.gear_ratio), hub[1])
    corners = [wheel[0] + radius + 60.0, wheel[1] + radius, wheel[1] - radius, *hub]
    xs = [-BALL, corners[0], *(x for points in joints for x, _y in points)]
    ys = [-BALL, *corners[1:3], *(y for points in joints for _x, y in points)]
    sketch = Sketch(tracks, min(xs) - 25.0, min(ys) - 25.0, max(xs), max(ys) + 25.0)
    _wheel(sketch, weft, name, wheel, radius)
    _sector(sketch, weft, name, hub)
    _linkages(sketch, weft, link, four_bar, hub)
    return sketch.figure(
        f"drive-{name}",
        title("Rapier drive", name, "weft"),
        "Rapier drive: the shaft's crank moves a spherical rocker,"
        + (" a four-bar C, D, K, G," if joints else "")
        + " a sector gear and the rapier wheel, on which the belt is wound.",
        [Value("travel", tracks.mm(f"{name}.travel"), "mm")],
        "A is the pin of the crank and B the end of the rocker, which turns about C."
        + (" The coupler DK moves the arm of the sector gear, which turns about G." if joints else "")
        + " Linkage and wheel are to scale; radius of the spherical linkage, gears and place of the wheel are"
        " schematic.",
    )


def _cycles(tracks: Tracks, name: str, places: list[list[Place]]) -> list[Point]:
    """Tracks of points over a revolution."""
    found = np.array(places)
    return [tracks.point(f"{name}{n}", found[:, n]) for n in range(found.shape[1])]


def _wheel(sketch: Sketch, weft: WeftInsertion, name: str, at: Place, radius: float) -> None:
    """The wheel with its belt, which leaves where the turning wheel pushes it to the right."""
    side = -1.0 if weft.travel_per_angle < 0.0 else 1.0
    turn = sketch.tracks.add(f"{name}.wheel", ["*", -side * degrees(1.0 / radius), mm(f"{name}.travel")])
    sketch.circle(at, radius, "body")
    with sketch.group(turn=(turn, *at)):
        for spoke in range(3):
            tip = radians(120.0 * spoke + 90.0)
            sketch.line(at, (at[0] + radius * cos(tip), at[1] + radius * sin(tip)))
    wound = [(at[0] - radius * sin(a), at[1] + side * radius * cos(a)) for a in np.linspace(pi, 0.0, 37)]
    sketch.line(*wound, (sketch.right, at[1] + side * radius), role="link belt")
    sketch.circle(at, SECTOR / weft.gear_ratio, "body")
    sketch.joint(at)
    sketch.label(at[0] + 0.45 * radius, at[1] - 0.4 * side * radius, "rapier wheel")
    sketch.label(sketch.right, at[1] + side * radius, "belt", "end", (-6.0, -8.0))


def _sector(sketch: Sketch, weft: WeftInsertion, name: str, hub: Place) -> None:
    """The sector gear, whose middle meets the pinion in the middle of its swing."""
    swing = weft.stroke / weft.travel_per_angle
    turns = [
        wrapped(weft.sector(weft.crank(angle))[0] - weft.sector_start) - 0.5 * swing
        for angle in TURN * sketch.tracks.shares
    ]
    turn = sketch.tracks.cycle(f"{name}.sector", np.degrees(turns))
    half = 0.5 * abs(swing) + 0.1
    rim = [(hub[0] + SECTOR * cos(a), hub[1] + SECTOR * sin(a)) for a in np.linspace(-half, half, 25)]
    with sketch.group(turn=(turn, *hub)):
        sketch.line(hub, *rim, role="body weft", closed=True)
    sketch.label(hub[0] + 0.52 * SECTOR, hub[1], "sector gear", shift=(0.0, 4.0))


def _linkages(
    sketch: Sketch, weft: WeftInsertion, link: list[Point], four_bar: list[Point], hub: Place
) -> None:
    foot = BALL * cos(weft.crank_cone), 0.0
    sketch.line((2.2 * BALL, 0.0), foot, role="link shaft")
    reach = BALL * sin(weft.crank_cone)
    sketch.line((foot[0], -reach), (foot[0], reach), role="path")
    sketch.line(foot, link[0], role="link shaft")
    sketch.line(*link, role="link weft")
    sketch.line((0.0, 0.0), link[-1], role="link weft")
    if four_bar:
        sketch.line((0.0, 0.0), *four_bar, hub, role="link weft")
        sketch.pivot(hub)
        sketch.label(*hub, "G", "end", (-10.0, -4.0))
    sketch.pivot((0.0, 0.0))
    sketch.joint(link[0], link[-1], *four_bar)
    for point, letter in zip((link[0], link[-1], *four_bar), "ABDK", strict=False):
        sketch.letter(point, letter, (0.0, -8.0) if letter in "BD" else (12.0, 15.0))
    sketch.label(0.0, 0.0, "C", "end", (-12.0, 4.0))
    sketch.label(2.2 * BALL, 0.0, "shaft", "start", (5.0, 4.0))
