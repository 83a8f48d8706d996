"""Fifty-digit references, written from the sources' equations and independent of the code under test.

Derivatives come from truncated Taylor series (`Jet`) of the closed forms, not from formulas of our own.
"""

from functools import cache
from typing import Any

import mpmath

from loomfmu.machines import MACHINES, parameters

MP = mpmath.mp.clone()  # a context of our own: no other test sees its precision
MP.dps = 50

RPM = 2 * mpmath.pi / 60


class Jet:
    """A value with its first and second derivative."""

    def __init__(self, value: Any, first: Any = 0, second: Any = 0) -> None:
        self.value, self.first, self.second = MP.mpf(value), MP.mpf(first), MP.mpf(second)

    @staticmethod
    def of(number: Any) -> "Jet":
        return number if isinstance(number, Jet) else Jet(number)

    def __add__(self, other: Any) -> "Jet":
        other = Jet.of(other)
        return Jet(self.value + other.value, self.first + other.first, self.second + other.second)

    def __neg__(self) -> "Jet":
        return Jet(-self.value, -self.first, -self.second)

    def __sub__(self, other: Any) -> "Jet":
        return self + -Jet.of(other)

    def __mul__(self, other: Any) -> "Jet":
        other = Jet.of(other)
        return Jet(
            self.value * other.value,
            self.first * other.value + self.value * other.first,
            self.second * other.value + 2 * self.first * other.first + self.value * other.second,
        )

    __radd__, __rmul__ = __add__, __mul__

    def through(self, value: Any, first: Any, second: Any) -> "Jet":
        """f(self), from f, f' and f'' at its value."""
        return Jet(value, first * self.first, second * self.first**2 + first * self.second)

    def __truediv__(self, other: Any) -> "Jet":
        other = Jet.of(other)
        x = other.value
        return self * other.through(1 / x, -1 / x**2, 2 / x**3)

    def __rtruediv__(self, other: Any) -> "Jet":
        return Jet.of(other) / self


def sin(x: Jet) -> Jet:
    c, s = MP.cos_sin(x.value)
    return x.through(s, c, -s)


def cos(x: Jet) -> Jet:
    c, s = MP.cos_sin(x.value)
    return x.through(c, -s, -c)


def sqrt(x: Jet) -> Jet:
    root = MP.sqrt(x.value)
    return x.through(root, 1 / (2 * root), -1 / (4 * root * x.value))


def acos(x: Jet) -> Jet:
    rest = 1 - x.value**2
    root = MP.sqrt(rest)
    return x.through(MP.acos(x.value), -1 / root, -x.value / (root * rest))


def atan2(y: Jet, x: Jet) -> Jet:
    """The angle of (x, y): its rate is (x y' - y x') / (x^2 + y^2)."""
    square = x * x + y * y
    first = (x.value * y.first - y.value * x.first) / square.value
    turning = x.value * y.second - y.value * x.second
    return Jet(MP.atan2(y.value, x.value), first, (turning - first * square.first) / square.value)


def sector_angle(weft: dict[str, Any], theta: Jet) -> Jet:
    """Angle of the sector gear, equations (1) to (3) of Zhu and Zhou in closed form."""
    a = Jet(MP.cos(MP.mpf(weft["crank_cone"])))
    b = MP.sin(MP.mpf(weft["crank_cone"])) * cos(theta + weft["crank_phase"])
    alpha = acos(MP.cos(MP.mpf(weft["rocker_angle"])) / sqrt(a * a + b * b)) - atan2(b, a)
    if not weft["planar_linkage"]:
        return alpha
    psi = alpha + weft["rocker_offset"]
    crank, coupler, output = (
        MP.mpf(weft[name]) for name in ("crank_length", "coupler_length", "output_length")
    )
    x = crank * cos(psi) - weft["pivot_x"]
    y = crank * sin(psi) - weft["pivot_y"]
    square = x * x + y * y
    apex = acos((square + (output**2 - coupler**2)) / (2 * output * sqrt(square)))
    return atan2(y, x) + weft["assembly"] * apex


def six_bar(reed: Any, turned: Jet) -> tuple[Jet, Jet, Jet]:
    """Reed coordinate, angle of the rocker and slope of the rod of a `ReedBeatUp`, by its crank's angle."""
    x = MP.mpf(reed.crank_length) * cos(turned) + reed.crank_x
    y = MP.mpf(reed.crank_length) * sin(turned) + reed.crank_y
    square = x * x + y * y
    coupler, rocker, arm = map(MP.mpf, (reed.coupler_length, reed.rocker_length, reed.arm_length))
    apex = acos((square + (rocker**2 - coupler**2)) / (2 * rocker * sqrt(square)))
    chi = atan2(y, x) + reed.assembly * apex
    drop = Jet(reed.reed_height) - arm * sin(chi + reed.arm_angle)
    reach = sqrt(Jet(MP.mpf(reed.rod_length) ** 2) - drop * drop)
    return arm * cos(chi + reed.arm_angle) + reach, chi, atan2(drop, reach)


class Machine:
    """A published machine: travel of its rapier head, free length and safe speed of its belt."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.weft = parameters("WeftInsertion", machine=name)
        belt = parameters("BeltMonitor", machine=name, head="G6300 left")
        self.guide = MP.mpf(belt["idle_travel"]) + MP.mpf(belt["head_length"])
        self.mass = MP.mpf(belt["head_mass"])
        self.stiffness = MP.mpf("0.25")
        self.start = self.sector(MP.mpf(0)).value
        swing = self.sector(MP.pi).value - self.start
        wheel = MP.mpf(self.weft["wheel_diameter"]) / 2 * self.weft["gear_ratio"]
        self.per_angle = wheel * MP.sign(nearest_turn(swing))

    def sector(self, theta: Any) -> Jet:
        return sector_angle(self.weft, Jet(theta, 1))

    def travel(self, theta: Any) -> tuple[Any, Any, Any]:
        """Travel and its derivatives by the shaft angle, in metres."""
        sector = self.sector(theta)
        return (
            self.per_angle * nearest_turn(sector.value - self.start),
            self.per_angle * sector.first,
            self.per_angle * sector.second,
        )

    def free_length(self, theta: Any) -> Any:
        return self.travel(theta)[0] - self.guide

    def load(self, theta: Any) -> Any:
        """Inertia force times the square of the free length, over m w^2: what buckles the belt."""
        travel, _slope, bend = self.travel(theta)
        return bend * (travel - self.guide) ** 2

    def free_start(self) -> Any:
        """Angle at which the belt leaves its guide."""
        return MP.findroot(self.free_length, (1.4, 1.8), solver="anderson")

    def push_end(self) -> Any:
        """Angle at which the acceleration ends to be positive."""
        return MP.findroot(lambda theta: self.travel(theta)[2], (1.5, 2.0), solver="anderson")

    def worst_angle(self) -> Any:
        """Angle of the window at which the belt is nearest to buckling."""
        start, end = self.free_start(), self.push_end()
        low, high = start + (end - start) * 0.3, start + (end - start) * 0.9
        return MP.findroot(lambda theta: MP.diff(self.load, theta), (low, high), solver="anderson")

    def safe_speed(self, theta: Any, factor: float, mass: Any = None, tension: Any = 0) -> Any:
        """Shaft speed at which the belt buckles at that angle, equations (8), (9) and (12), rad/s."""
        travel, _slope, bend = self.travel(theta)
        critical = MP.pi**2 * self.stiffness / (MP.mpf(factor) * (travel - self.guide)) ** 2
        return MP.sqrt((critical - tension) / ((mass or self.mass) * bend))


def nearest_turn(angle: Any) -> Any:
    """The same angle between -pi and pi."""
    return angle - 2 * MP.pi * MP.nint(angle / (2 * MP.pi))


@cache
def machine(name: str) -> Machine:
    return Machine(name)


ALL_MACHINES = tuple(MACHINES)


class Rotor:
    """A rotor law, integrated from its acceleration alone.

    Korolev, equations (3.1) to (3.24), each law's acceleration in its corrected form: as the gain times
    a shape over half a turn. The velocity starts at `1 - reduction`; the gain follows from closing,
    `S(pi) = pi`, not from the source's formula.
    """

    def __init__(self, law: str, reduction: float) -> None:
        self.reduction = MP.mpf(reduction)
        self.end = MP.pi / 4 if law == "harmonic_ends" else MP.pi / 8
        self.middle: Any = {
            "uniform": lambda x: 0 * x,
            "harmonic_ends": lambda x: 0 * x,
            "sloped_line": lambda x: -8 * (x - MP.pi) / (7 * MP.pi),
            "sloped_sine": lambda x: -(8 * (x - MP.pi) / 7 + MP.sin(8 * (x - MP.pi / 8) / 7)) / MP.pi,
        }[law]
        self.gain = MP.mpf(0)
        if law != "uniform":
            self.gain = MP.mpf(1)
            self.gain = self.reduction * MP.pi / self.moment(MP.pi)
        else:
            self.reduction = MP.mpf(0)

    def acceleration(self, x: Any) -> Any:
        return self.gain * (MP.sin(4 * x) if x < self.end else self.middle(x))

    def pieces(self, x: Any) -> list[Any]:
        return [0, self.end, x] if x > self.end else [0, x]

    def moment(self, x: Any) -> Any:
        """What the acceleration adds to the angle by x."""
        return MP.quad(lambda t: (x - t) * self.acceleration(t), self.pieces(x), method="gauss-legendre")

    def velocity(self, x: Any) -> Any:
        return 1 - self.reduction + MP.quad(self.acceleration, self.pieces(x), method="gauss-legendre")

    def angle(self, x: Any) -> Any:
        return (1 - self.reduction) * x + self.moment(x)

    def dwell(self, tolerance: float) -> Any:
        """Angle during which a frame stays within that share of its stroke: twice where S = 4 asin(..)."""
        target = 4 * MP.asin(MP.sqrt(MP.mpf(tolerance)))
        low, high = MP.mpf(0), MP.mpf("3.3")  # beyond pi, where the laws go on smoothly
        x, step = MP.pi / 2, MP.mpf(1)
        while abs(step) > 1e-20:  # Newton, kept in the bracket: the last step leaves the square of it
            rest = self.angle(x) - target
            low, high = (low, x) if rest > 0 else (x, high)
            nearer = x - rest / self.velocity(x)
            if not low < nearer < high:
                nearer = (low + high) / 2
            x, step = nearer, nearer - x
        return 2 * x
