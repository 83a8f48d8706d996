"""The rapier's drive: spherical crank-rocker, four-bar, sector gear and wheel."""

from dataclasses import dataclass
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
NAMES = {
    "A": "crank pin",
    "B": "end of the rocker",
    "C": "pivot of rocker and drive arm",
    "D": "end of the drive arm, from which the coupler leads",
    "K": "arm of the sector gear",
    "G": "pivot of the sector gear",
}
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


@dataclass(frozen=True)
class Drive:
    """The drive of a rapier [mm], whose origin is C: its hub G, its wheel, and the tracks of its joints."""

    name: str
    weft: WeftInsertion
    link: list[Point]
    four_bar: list[Point]
    hub: Place
    wheel: Place
    corners: tuple[float, float, float, float]  # of what moves: left, bottom, right, top

    @property
    def radius(self) -> float:
        """Radius of the wheel."""
        return 500.0 * self.weft.wheel_diameter

    @property
    def side(self) -> float:
        """On which side of the wheel the belt leaves: where the turning wheel pushes it to the right."""
        return -1.0 if self.weft.travel_per_angle < 0.0 else 1.0

    @property
    def leaves(self) -> Place:
        """The point at which the belt leaves the wheel."""
        return self.wheel[0], self.wheel[1] + self.side * self.radius


def drive(tracks: Tracks, name: str) -> Drive | None:
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
    xs = [-BALL, wheel[0] + radius, hub[0], *(x for points in joints for x, _y in points)]
    ys = [-BALL, wheel[1] + radius, wheel[1] - radius, hub[1], *(y for points in joints for _x, y in points)]
    return Drive(name, weft, link, four_bar, hub, wheel, (min(xs), min(ys), max(xs), max(ys)))


def parts(sketch: Sketch, drive: Drive) -> None:
    """The wheel with the belt on it, the sector gear and the linkages."""
    _wheel(sketch, drive)
    _sector(sketch, drive)
    _linkages(sketch, drive)


def figure(tracks: Tracks, drive: Drive) -> Figure:
    """The drive by itself, with its names."""
    left, bottom, right, top = drive.corners
    sketch = Sketch(tracks, left - 25.0, bottom - 25.0, right + 60.0, top + 25.0)
    parts(sketch, drive)
    sketch.line(drive.leaves, (sketch.right, drive.leaves[1]), role="link belt")
    (x, y), radius, hub = drive.wheel, drive.radius, drive.hub
    sketch.label(x + 0.45 * radius, y - 0.4 * drive.side * radius, "rapier wheel")
    sketch.label(sketch.right, drive.leaves[1], "belt", "end", (-6.0, -8.0))
    sketch.label(hub[0] + 0.52 * SECTOR, hub[1], "sector gear", shift=(0.0, 4.0))
    joints = drive.link[0], drive.link[-1], *drive.four_bar
    for point, letter in zip(joints, "ABDK", strict=False):
        beside = {"A": (-13.0, 14.0), "B": (12.0, -5.0), "D": (0.0, -8.0)}.get(letter, (12.0, 15.0))
        sketch.letter(point, letter, beside)
    if drive.four_bar:
        sketch.letter(hub, "G", (5.0, -9.0))
    sketch.label(0.0, 0.0, "C", "end", (-12.0, 4.0))
    sketch.label(2.2 * BALL, 0.0, "shaft", "start", (5.0, 4.0))
    return sketch.figure(
        f"drive-{drive.name}",
        title("Rapier drive", drive.name, "weft"),
        "Rapier drive: the shaft's crank moves a spherical rocker,"
        + (" a four-bar C, D, K, G," if drive.four_bar else "")
        + " a sector gear and the rapier wheel, on which the belt is wound.",
        [Value("travel", tracks.mm(f"{drive.name}.travel"), "mm")],
        "; ".join(f"{letter}: {NAMES[letter]}" for letter in ("ABCDKG" if drive.four_bar else "ABC"))
        + ". Linkage and wheel are to scale; radius of the spherical linkage, gears and place of the wheel"
        " are schematic.",
    )


def _cycles(tracks: Tracks, name: str, places: list[list[Place]]) -> list[Point]:
    """Tracks of points over a revolution."""
    found = np.array(places)
    return [tracks.point(f"{name}{n}", found[:, n]) for n in range(found.shape[1])]


def _wheel(sketch: Sketch, drive: Drive) -> None:
    """The wheel with the belt that is wound on it."""
    at, radius, side, name = drive.wheel, drive.radius, drive.side, drive.name
    turn = sketch.tracks.add(f"{name}.wheel", ["*", -side * degrees(1.0 / radius), mm(f"{name}.travel")])
    sketch.circle(at, radius, "body")
    with sketch.group(turn=(turn, *at)):
        for spoke in range(3):
            tip = radians(120.0 * spoke + 90.0)
            sketch.line(at, (at[0] + radius * cos(tip), at[1] + radius * sin(tip)))
    wound = [(at[0] - radius * sin(a), at[1] + side * radius * cos(a)) for a in np.linspace(pi, 0.0, 37)]
    sketch.line(*wound, role="link belt")
    sketch.circle(at, SECTOR / drive.weft.gear_ratio, "body")
    sketch.joint(at)


def _sector(sketch: Sketch, drive: Drive) -> None:
    """The sector gear, whose middle meets the pinion in the middle of its swing."""
    weft, hub = drive.weft, drive.hub
    swing = weft.stroke / weft.travel_per_angle
    turns = [
        wrapped(weft.sector(weft.crank(angle))[0] - weft.sector_start) - 0.5 * swing
        for angle in TURN * sketch.tracks.shares
    ]
    turn = sketch.tracks.cycle(f"{drive.name}.sector", np.degrees(turns))
    half = 0.5 * abs(swing) + 0.1
    rim = [(hub[0] + SECTOR * cos(a), hub[1] + SECTOR * sin(a)) for a in np.linspace(-half, half, 25)]
    with sketch.group(turn=(turn, *hub)):
        sketch.line(hub, *rim, role="body weft", closed=True)


def _linkages(sketch: Sketch, drive: Drive) -> None:
    foot, link, four_bar = (BALL * cos(drive.weft.crank_cone), 0.0), drive.link, drive.four_bar
    sketch.line((2.2 * BALL, 0.0), foot, role="link shaft")
    reach = BALL * sin(drive.weft.crank_cone)
    sketch.line((foot[0], -reach), (foot[0], reach), role="path")
    sketch.line(foot, link[0], role="link shaft")
    sketch.line(*link, role="link weft")
    sketch.line((0.0, 0.0), link[-1], role="link weft")
    if four_bar:
        sketch.line((0.0, 0.0), *four_bar, drive.hub, role="link weft")
        sketch.pivot(drive.hub)
    sketch.pivot((0.0, 0.0))
    sketch.joint(link[0], link[-1], *four_bar)
