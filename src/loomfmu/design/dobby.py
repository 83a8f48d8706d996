"""Two drives of older dobbies, described without dimensions: eccentric chain, knives and hooks.

Source: Korolev, thesis on rotary dobbies (Moscow), section 1.2, equations (1.4) to (1.11), Figures 1.2 and
1.7. Both figures are lost, so the geometry is what the text and the equations leave; inferences are marked.
Lengths in metres, angles in radians, or as texts with a unit.
"""

from dataclasses import dataclass
from math import acos, atan2, cos, hypot, pi, sin, sqrt

from ..errors import LoomfmuError
from .quantities import Quantity, read

HOOK_BASE = 0.7002648809946137  # rad; eta = 40 deg 07' 20'', "determined by the construction of the dobby"


@dataclass(frozen=True)
class EccentricChain:
    """A chain drive whose driven sprocket sits eccentrically on its shaft.

    `driver` and `driven` are the radii of the sprockets, `eccentricity` is that of the driven one on its
    shaft, `distance` lies between the shafts [m].
    """

    driver: float
    driven: float
    eccentricity: float
    distance: float

    def lever(self, angle: float) -> float:
        """Distance h of the driven shaft from the taut strand, at an angle of the driven shaft [m].

        The strand is the outer tangent of both sprockets. The angle is that of the eccentricity from the line
        between the shafts, away from the driver, in the driver's sense of rotation with the strand on the
        left.
        """
        centre_x = self.distance + self.eccentricity * cos(angle)
        centre_y = self.eccentricity * sin(angle)
        apart = hypot(centre_x, centre_y)
        # unit normal n of the strand: n . centre = driver - driven, on the left of the line of centres
        normal = atan2(centre_y, centre_x) + acos((self.driver - self.driven) / apart)
        return self.driven + self.eccentricity * cos(angle - normal)

    def speed_ratio(self, angle: float) -> float:
        """Speed of the driven shaft over that of the driver, from `w1 r1 = w2 h`.

        Erratum: the source calls h the eccentricity of the driven sprocket; with that the ratio would be
        constant. h is the distance of its shaft from the strand, which varies.

        >>> chain = eccentric_chain("60 mm", "60 mm", "15 mm", "1000 m")
        >>> round(chain.speed_ratio(pi / 2), 4), round(chain.speed_ratio(-pi / 2), 4)  # 60/75 and 60/45
        (0.8, 1.3333)
        """
        return self.driver / self.lever(angle)

    def extremes(self) -> tuple[float, float]:
        """Lowest and highest speed ratio in a turn, the eccentricity towards the strand and away from it."""
        low, high = self.driven - self.eccentricity, self.driven + self.eccentricity
        return self.driver / high, self.driver / low


def eccentric_chain(
    driver: Quantity, driven: Quantity, eccentricity: Quantity, distance: Quantity
) -> EccentricChain:
    """The chain drive of Figure 1.7, for given dimensions; the source gives none.

    Raises:
        LoomfmuError: the eccentricity reaches the radius of its sprocket, or the sprockets touch
    """
    r1, r2 = read("sprocket_radius", driver), read("sprocket_radius", driven)
    e, apart = read("eccentricity", eccentricity), read("distance", distance)
    if not e < r2:
        raise LoomfmuError(
            f"eccentricity = {1e3 * e:.7g} mm must be below the radius of the driven sprocket,"
            f" {1e3 * r2:.7g} mm: the shaft would stop or turn back"
        )
    if not apart > r1 + r2 + e:
        raise LoomfmuError(
            f"distance = {1e3 * apart:.7g} mm must exceed both radii and the eccentricity,"
            f" {1e3 * (r1 + r2 + e):.7g} mm: the sprockets would touch"
        )
    return EccentricChain(r1, r2, e, apart)


def hook_angle(
    reach: Quantity,
    place: Quantity,
    *,
    frame: Quantity,
    link: Quantity,
    hook: Quantity,
    base: Quantity = HOOK_BASE,
) -> float:
    """Angle omega between a knife and its hook, equations (1.5) to (1.10).

    The triangles ADK and DMK, with K at the distance rho from A, give

        S^2 = rho^2 + f^2 - 2 rho f sin(phi + eta)                     (1.8), (1.9)
        omega = pi - acos((f^2 + S^2 - rho^2) / (2 f S)) - acos((C^2 + S^2 - b^2) / (2 C S)) + eta
                - acos((b^2 + C^2 - S^2) / (2 b C))                    (1.5) to (1.7), (1.10)

    Erratum: (1.11) adds the second arc cosine, (1.6) subtracts it; (1.6) is right where D sees K between A
        and M, which we infer. Of the dimensions only eta is published, so the published largest angle of
        1.5 deg cannot be recomputed.

    Args:
        reach: rho, from A to K [m]
        place: phi, the direction of AK [rad]
        frame, link, hook: lengths f = AD, C_1 = DM, b_1 = KM [m]
        base: eta [rad]

    Raises:
        LoomfmuError: the triangles do not close

    >>> round(hook_angle(0.2, 0.0, frame=0.3, link=0.25, hook=0.2), 4)
    1.2068
    """
    rho, phi, eta = read("reach", reach), read("place", place), read("place", base)
    f, c, b = (read("link", length) for length in (frame, link, hook))
    s = sqrt(rho * rho + f * f - 2.0 * rho * f * sin(phi + eta))
    return pi - _corner(f, s, rho, "ADK") - _corner(c, s, b, "DMK") + eta - _corner(b, c, s, "DMK")


def _corner(one: float, other: float, opposite: float, triangle: str) -> float:
    """Angle between two sides of a triangle, by the law of cosines."""
    if one + other < opposite or abs(one - other) > opposite or one * other == 0.0:
        raise LoomfmuError(
            f"the triangle {triangle} does not close: its sides are {1e3 * one:.6g}, {1e3 * other:.6g} and"
            f" {1e3 * opposite:.6g} mm"
        )
    ratio = (one * one + other * other - opposite * opposite) / (2.0 * one * other)
    return acos(max(-1.0, min(1.0, ratio)))
