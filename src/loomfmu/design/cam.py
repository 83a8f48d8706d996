"""Design of the cam that moves the heald frames: profile, path of the cutter, pressure angle, curvature.

One turn of the cam is two picks. A law gives the lift as a share of the largest, over the cam's angle, with
its derivatives. Source: Korolev, thesis on rotary dobbies (Moscow), section 4.2, Appendices 2 and 3.
Lengths in metres, angles in radians, or as texts with a unit, such as "84 mm".
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import degrees, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import LoomfmuError
from ..machines import table
from .quantities import Quantity, listed, read, whole

Floats = NDArray[np.float64]
Law = Callable[[Floats], tuple[Floats, Floats, Floats]]

TURN = 2.0 * pi
SHALLOW = 1e-6  # m: what a cutter may take off or leave at a corner of the profile


def spline_law(angles: ArrayLike | None = None, heights: ArrayLike | None = None) -> Law:
    """Law of the cubic spline with "cubic ends" through control points, by default those of Table 4.2.

    It starts at the first point, which need not be its lowest. Derivatives jump where two picks join.

    Args:
        angles: of the main shaft, from 0 to 4 pi, increasing [rad]
        heights: there, in any unit; the first and the last equal

    Raises:
        LoomfmuError: fewer than four points, or points that are not in order

    >>> law = spline_law()
    >>> [round(float(value), 3) for value in law(np.array([3.198]))[0]]  # close to its top
    [1.0]
    """
    from scipy.interpolate import CubicSpline

    if angles is None or heights is None:
        rows = table("shed_control_points")
        angles = np.radians([float(row["shaft_angle_deg"]) for row in rows])
        heights = [float(row["warp_height_mm"]) for row in rows]
    x, y = listed("angles", angles, "rad"), listed("heights", heights, "m")
    if x.ndim != 1 or x.shape != y.shape or x.size < 4:
        raise LoomfmuError(
            f"{x.size} angles and {y.size} heights: the spline needs as many heights as angles, at least four"
        )
    if not np.all(np.diff(x) > 0.0) or abs(x[0]) > 1e-9 or abs(x[-1] - 2.0 * TURN) > 1e-9:
        raise LoomfmuError("the angles of the control points must rise from 0 to 720 deg of the main shaft")
    spline = CubicSpline(x, y, bc_type="not-a-knot")
    tops = spline.derivative().roots(extrapolate=False)
    span = float(np.max(spline(tops[np.isfinite(tops)]), initial=np.max(y)) - y[0])
    if not span > 0.0 or abs(y[-1] - y[0]) > 1e-9 * span:
        raise LoomfmuError(
            f"the heights of the control points start at {y[0]:.7g} and end at {y[-1]:.7g}: the ends must be"
            " equal and the spline must rise between them"
        )

    def law(angle: Floats) -> tuple[Floats, Floats, Floats]:
        x = 2.0 * angle  # of the main shaft
        return (spline(x) - y[0]) / span, 2.0 * spline(x, 1) / span, 4.0 * spline(x, 2) / span

    return law


def sampled_law(lifts: ArrayLike) -> Law:
    """Law through lifts at even angles over one turn of the cam, without its end.

    Between them lies the periodic spline of fifth degree. The lowest sample has the share 0, the highest 1.

    Raises:
        LoomfmuError: fewer than eight samples, or all equal

    >>> law = sampled_law([1 - np.cos(TURN * k / 36) for k in range(36)])
    >>> [round(float(value[0]), 6) for value in law(np.array([0.5 * pi]))]
    [0.5, 0.5, 0.0]
    """
    from scipy.interpolate import make_interp_spline

    y = listed("lifts", lifts, "m")
    if y.ndim != 1 or y.size < 8 or not np.all(np.isfinite(y)) or np.ptp(y) == 0.0:
        raise LoomfmuError(f"{y.size} lifts: there must be at least eight, all finite and not all equal")
    shares = (y - y.min()) / np.ptp(y)
    closed = np.append(shares, shares[0])
    spline = make_interp_spline(np.linspace(0.0, TURN, closed.size), closed, k=5, bc_type="periodic")
    return lambda angle: (spline(angle), spline(angle, 1), spline(angle, 2))


def lift_law(lift: Callable[[float], float], samples: int = 720) -> Law:
    """Law of a function that gives the lift at an angle of the cam, from samples of it.

    >>> law = lift_law(lambda angle: 1 - np.cos(angle))
    >>> round(float(law(np.array([pi]))[0][0]), 12)
    1.0
    """
    samples = whole("samples", samples, 8)
    return sampled_law([lift(TURN * k / samples) for k in range(samples)])


@dataclass(frozen=True)
class Cam:
    """A cam at even angles of its turn, both ends included.

    `profile` and `path` are points (x, y) of the working profile and of its equidistant, on which the
    centres of roller and cutter run [m]. `curvature_radius` is that of the profile, negative where it is
    hollow [m]; `pressure_angle` that of a roller on a radial guide, positive while it rises [rad].
    """

    law: Law
    lowest_radius: float
    highest_radius: float
    roller_radius: float
    law_on_roller: bool
    angle: Floats
    profile: Floats
    path: Floats
    curvature_radius: Floats
    pressure_angle: Floats

    def radius(self, angle: Floats) -> tuple[Floats, Floats, Floats]:
        """Radius of the curve that carries the law, and its derivatives."""
        return _radius(self.law, self.lowest_radius, self.highest_radius, angle)

    def radial_excess(self) -> Floats:
        """Return how far a curve offset along the cam's radius (Appendix 2) exceeds the true offset [m].

        The path if the law is the profile's, the profile if it is the roller's; at the points of that curve.
        """
        curve = self.profile if self.law_on_roller else self.path
        added = -self.roller_radius if self.law_on_roller else self.roller_radius
        radius, _slope, _bend = self.radius(np.arctan2(curve[:, 1], curve[:, 0]) % TURN)
        return np.asarray(radius + added - np.hypot(curve[:, 0], curve[:, 1]))


def design_cam(
    law: Law | None = None,
    *,
    lowest_radius: Quantity = 0.084,
    highest_radius: Quantity = 0.107,
    roller_radius: Quantity = 0.019,
    law_on_roller: bool = False,
    points: int = 1440,
) -> Cam:
    """Cam for a law, by default the published one; its equidistant is the true normal offset.

    Args:
        law: from `spline_law`, `sampled_law` or `lift_law`
        lowest_radius, highest_radius: at the shares 0 and 1 of the law [m]
        roller_radius: of roller and cutter [m]
        law_on_roller: radii and law are those of the roller's centre, and the profile is offset inwards;
            otherwise they are the profile's, as in Appendix 2
        points: intervals in a turn

    Raises:
        LoomfmuError: impossible dimensions, or a roller that does not fit the curve (undercut)

    >>> cam = design_cam()
    >>> round(1000 * float(np.hypot(*cam.path.T).max()), 1)  # 107 and 19
    126.0
    """
    low, high = read("lowest_radius", lowest_radius), read("highest_radius", highest_radius)
    roller, points = read("roller_radius", roller_radius), whole("points", points, 36)
    if not low < high:
        raise LoomfmuError(
            f"lowest_radius = {1e3 * low:.7g} mm is not below highest_radius = {1e3 * high:.7g} mm"
        )
    law = law or spline_law()
    angle = np.linspace(0.0, TURN, points + 1)
    r, r1, r2 = _radius(law, low, high, angle)
    curvature, carrier, normal = _curve(angle, r, r1, r2)
    outwards = -1.0 if law_on_roller else 1.0
    _refuse_undercut(angle, curvature, np.arctan2(r1, r), roller, outwards)
    offset = carrier + outwards * roller * normal
    path = carrier if law_on_roller else offset
    turned = normal[:, 0] * path[:, 1] - normal[:, 1] * path[:, 0]
    with np.errstate(divide="ignore"):
        carrier_curvature_radius = 1.0 / curvature
    return Cam(
        law=law,
        lowest_radius=low,
        highest_radius=high,
        roller_radius=roller,
        law_on_roller=law_on_roller,
        angle=angle,
        profile=offset if law_on_roller else carrier,
        path=path,
        curvature_radius=carrier_curvature_radius - (roller if law_on_roller else 0.0),
        pressure_angle=np.arctan2(turned, np.sum(normal * path, axis=1)),
    )


def _radius(law: Law, low: float, high: float, angle: Floats) -> tuple[Floats, Floats, Floats]:
    """Radius of the curve that carries the law, and its derivatives by the angle."""
    share, slope, bend = law(angle)
    return low + (high - low) * share, (high - low) * slope, (high - low) * bend


def _curve(angle: Floats, r: Floats, r1: Floats, r2: Floats) -> tuple[Floats, Floats, Floats]:
    """Curvature, points and outward normals of the curve with that radius and its derivatives."""
    length = np.hypot(r, r1)
    radial = np.column_stack([np.cos(angle), np.sin(angle)])
    across = np.column_stack([-np.sin(angle), np.cos(angle)])
    normal = (r[:, None] * radial - r1[:, None] * across) / length[:, None]
    return (r * r + 2.0 * r1 * r1 - r * r2) / length**3, r[:, None] * radial, normal


def _refuse_undercut(
    angle: Floats, curvature: Floats, tilt: Floats, roller_radius: float, outwards: float
) -> None:
    """Reject an offset curve that turns back: the roller would cut into the profile, or not fit it.

    Outwards, no hollow may be tighter than the roller; inwards, no crest. The same holds for the corner
    where the turn closes, unless it is too slight to matter.
    """
    kind = "hollow" if outwards > 0.0 else "crest"
    tightest = int(np.argmin(outwards * curvature))
    place, radius = float(angle[tightest]), 0.0
    undercut = 1.0 + outwards * roller_radius * float(curvature[tightest]) <= 0.0
    if undercut:
        radius = abs(1.0 / float(curvature[tightest]))
    else:
        corner = outwards * float(tilt[0] - tilt[-1])  # above 0 where offset curves cross
        undercut = corner > 0.0 and roller_radius * (1.0 / np.cos(0.5 * corner) - 1.0) > SHALLOW
        place = 0.0
    if undercut:
        raise LoomfmuError(
            f"the cam is undercut at cam angle {degrees(place):.4g} deg: the {kind} there has a radius of"
            f" curvature of {1e3 * radius:.4g} mm, the roller a radius of {1e3 * roller_radius:.4g} mm; use a"
            " smaller roller or a larger cam"
        )


def published_path() -> Floats:
    """Points of the cutter's path in the program of Appendix 3: its start and the ends of its arcs [m].

    The program does not follow the published law: minus the cutter's 19 mm its radii span 28.0 mm, from
    81.7 to 109.7; those of the law go from 84 to 107.

    >>> radii = np.hypot(*published_path().T) - 0.019
    >>> [round(1000 * float(radius), 2) for radius in (radii.min(), radii.max(), np.ptp(radii))]
    [81.66, 109.67, 28.01]
    """
    rows = table("cam_nc_arcs")
    ends = [(float(row["x_mm"]), float(row["y_mm"])) for row in rows]
    return 1e-3 * np.array([ends[-1], *ends])
