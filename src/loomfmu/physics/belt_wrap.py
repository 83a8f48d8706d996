"""Belt wrapped on the rapier wheel: bending stiffness, lever arm and load of the blocks that hold it there.

Source: Zhu and Zhou, "Restraint load characteristics of rapier loom carbon fiber belt wrapped rapier
wheel", Light Industry Machinery (2021) no. 5, 20, sections 2 and 3, equations (1) to (8), Tables 1 to 3.

D is the bottom `diameter` of the rapier wheel [m], c the `clearance` between block and belt, positive [m],
and EI the bending `stiffness` of the belt [N m2].
"""

from math import sqrt


def cantilever_stiffness(force: float, length: float, deflection: float) -> float:
    """Bending stiffness of a belt from a cantilever test [N m2], `EI = F l^3 / (3 v)`, equation (2).

    Args:
        force: at the free end [N]
        length: from the clamp to the force [m]
        deflection: of the free end, towards the force [m]

    Valid for small deflections; the published tests go up to a quarter of the length.

    >>> round(cantilever_stiffness(0.980, 0.150, 0.0045), 3)
    0.245
    """
    return force * length * length * length / (3.0 * deflection)


def lever_arm(diameter: float, clearance: float) -> float:
    """Lever arm of the restraint load [m], `a = 3 sqrt(D c + c^2)`, equation (7).

    A cantilever's deflection over its end slope, `2 a / 3`, is set equal to the chord that the clearance
    cuts off, `2 sqrt((D/2 + c)^2 - (D/2)^2)`, (5) and (6).

    Valid while the end slope `a / D` is small: the source replaces its tangent, at 0.2 1.4 % larger, by the
    angle.

    >>> round(1000 * lever_arm(0.3955, 0.3e-3), 2)
    32.69
    """
    return 3.0 * sqrt(clearance * (diameter + clearance))


def bending_moment(stiffness: float, diameter: float) -> float:
    """Moment that bends the belt to the curvature of the wheel [N m], `M = EI / rho = 2 EI / D`, (3).

    >>> bending_moment(0.25, 0.4)
    1.25
    """
    return 2.0 * stiffness / diameter


def restraint_load(stiffness: float, diameter: float, clearance: float) -> float:
    """Load with which each block holds the belt on the wheel [N], `F = 2 EI / (D a)`, equations (4) and (8).

    It does not depend on the wrap angle. Erratum: Table 3 prints 54.81 N for 430.0 mm and 0.1 mm, where the
    equation gives 59.10 N.

    >>> round(restraint_load(0.25, 0.3955, 0.3e-3), 2)
    38.67
    """
    return bending_moment(stiffness, diameter) / lever_arm(diameter, clearance)


def bending_strain(thickness: float, diameter: float) -> float:
    """Strain of the outer face of a belt of `thickness` t [m] on its wheel [1], `e = t / (D + t)`.

    The face is t / 2 from the belt's middle, which lies on a radius of (D + t) / 2.

    >>> round(100 * bending_strain(1.35e-3, 0.397), 3)  # per cent
    0.339
    """
    return thickness / (diameter + thickness)


def bending_stress(stiffness: float, width: float, thickness: float, diameter: float) -> float:
    """Stress in the outer face of a belt of a rectangular section on its wheel [Pa], `12 EI / (b t^3) e`.

    Its modulus follows from its bending stiffness; `e` is the `bending_strain`.

    Args:
        width: b of the belt [m]
        thickness: t [m]

    >>> round(1e-6 * bending_stress(0.25, 0.030, 1.35e-3, 0.397), 1)  # MPa
    137.7
    """
    modulus = 12.0 * stiffness / (width * thickness * thickness * thickness)
    return modulus * bending_strain(thickness, diameter)
