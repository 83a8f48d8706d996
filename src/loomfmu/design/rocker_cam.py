"""Cam with a roller on a rocker, and its counter-cam: profile, path of the cutter, pressure angle, curvature.

The drive of Korolev's Figure 4.10 has a rocker with two rollers between a cam and a counter-cam; its
dimensions are not published. As for `cam`, one turn of the cam is two picks, and a law gives the share of
the swing.
"""

from dataclasses import dataclass
from math import degrees

import numpy as np
from numpy.typing import NDArray

from ..errors import LoomfmuError
from .cam import TURN, Floats, Law, spline_law
from .quantities import Quantity, read, whole

Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class RockerCam:
    """A cam with a rocker at even angles of its turn, both ends included.

    `swing_angle` is that of the rocker's arm from the line to the cam's centre [rad]; `profile` and `path`
    are points (x, y) of the cam and of the roller's centre on it [m]; `curvature_radius` is that of the
    profile, negative where it is hollow [m]; `pressure_angle` lies between the force on the roller and the
    way it goes as the arm swings out, and other than that of a radial follower it is not 0 in a dwell
    [rad].
    """

    law: Law
    distance: float
    arm: float
    roller_radius: float
    swing: float
    trailing: bool
    angle: Floats
    swing_angle: Floats
    profile: Floats
    path: Floats
    curvature_radius: Floats
    pressure_angle: Floats

    @property
    def lowest_radius(self) -> float:
        """Smallest radius of the profile [m]."""
        return float(np.hypot(*self.profile.T).min())

    @property
    def highest_radius(self) -> float:
        """Largest radius of the profile [m]."""
        return float(np.hypot(*self.profile.T).max())


def design_rocker_cam(
    law: Law | None = None,
    *,
    distance: Quantity,
    arm: Quantity,
    lowest_angle: Quantity,
    swing: Quantity,
    roller_radius: Quantity = 0.019,
    trailing: bool = True,
    points: int = 1440,
) -> RockerCam:
    """Cam that swings a rocker by a law, by default the published one.

    In the frame of the cam the rocker goes round it by phi. With psi the arm's angle from the line to the
    cam's centre, the roller's centre is `exp(i phi) (C - A exp(+-i psi))`, + for a trailing arm; the
    profile lies inside it at the roller's radius. All derivatives are exact.

    Args:
        law: from `cam.spline_law`, `cam.sampled_law` or `cam.lift_law`
        distance: C, from the cam's centre to the rocker's pivot [m]
        arm: A, from the pivot to the roller's centre [m]
        lowest_angle: psi where the law has the share 0 [rad]
        swing: of the rocker between the shares 0 and 1 [rad]; negative for a counter-cam, whose roller goes
            in while the other goes out
        roller_radius: of roller and cutter [m]
        trailing: the cam's surface runs from the pivot to the roller, otherwise the other way, as on the
            other arm of a rocker with a counter-cam
        points: intervals in a turn

    Raises:
        LoomfmuError: impossible dimensions, or a roller that cuts into the profile (undercut)

    >>> cam = design_rocker_cam(distance="200 mm", arm="160 mm", lowest_angle="30 deg", swing="8 deg")
    >>> round(1000 * float(np.hypot(*cam.path[0])), 2)  # sqrt(200^2 + 160^2 - 2 200 160 cos 30 deg)
    100.87
    """
    apart, length = read("distance", distance), read("arm", arm)
    start, span = read("rocker_angle", lowest_angle), read("rocker_angle", swing)
    roller, points = read("roller_radius", roller_radius), whole("points", points, 36)
    _check_swing(start, span)
    law = law or spline_law()
    angle = np.linspace(0.0, TURN, points + 1)
    share, slope, bend = law(angle)
    psi, rate, second = start + span * share, span * slope, span * bend
    side = 1.0 if trailing else -1.0
    turned = np.exp(1j * angle)
    reach = length * turned * np.exp(1j * side * psi)
    centre = apart * turned - reach
    first = 1j * centre - 1j * side * rate * reach
    curve = 1j * first + reach * (side * rate - 1j * side * second + rate * rate)
    speed = np.abs(first)
    normal = -1j * first / speed  # outwards: the path runs anticlockwise
    curvature = np.imag(np.conj(first) * curve) / speed**3
    _refuse(angle, speed, curvature, roller, normal, centre)
    outwards = -1j * side * reach  # the way of the roller's centre as psi grows
    tilt = np.conj(normal) * outwards
    with np.errstate(divide="ignore"):
        radius = 1.0 / curvature - roller
    return RockerCam(
        law=law,
        distance=apart,
        arm=length,
        roller_radius=roller,
        swing=span,
        trailing=trailing,
        angle=angle,
        swing_angle=psi,
        profile=_points(centre - roller * normal),
        path=_points(centre),
        curvature_radius=radius,
        pressure_angle=np.arctan2(tilt.imag, tilt.real),
    )


def _check_swing(start: float, span: float) -> None:
    """Refuse an arm that would swing through the line to the cam's centre, or not at all."""
    ends = min(start, start + span), max(start, start + span)
    if not (ends[0] > 0.0 and ends[1] < np.pi and span != 0.0):
        raise LoomfmuError(
            f"lowest_angle = {degrees(start):.7g} deg and swing = {degrees(span):.7g} deg: the arm must swing"
            " within 0 to 180 deg from the line to the cam's centre, and not by 0"
        )


def _points(curve: Complex) -> Floats:
    return np.column_stack([curve.real, curve.imag])


def _refuse(
    angle: Floats, speed: Floats, curvature: Floats, roller: float, normal: Complex, centre: Complex
) -> None:
    """Refuse a path that turns round the wrong way, and a crest tighter than the roller."""
    inside = np.real(np.conj(normal) * centre)
    if not (np.all(speed > 0.0) and np.all(inside > roller)):
        place = degrees(float(angle[int(np.argmin(inside))]))
        raise LoomfmuError(
            f"the rocker swings too fast or too near: at cam angle {place:.4g} deg the roller's path does not"
            " run round the cam's centre; use a larger distance or a smaller swing"
        )
    tightest = int(np.argmax(curvature))
    if roller * float(curvature[tightest]) >= 1.0:
        raise LoomfmuError(
            f"the cam is undercut at cam angle {degrees(float(angle[tightest])):.4g} deg: the path of the"
            f" roller has a radius of curvature of {1e3 / float(curvature[tightest]):.4g} mm there, the"
            f" roller a radius of {1e3 * roller:.4g} mm; use a smaller roller or a larger cam"
        )
