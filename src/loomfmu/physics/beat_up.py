"""Beat-up: the reed presses a pick into the cloth, whose fell gives way between warp and cloth, two springs.

Warp and cloth pull on the fell from both sides. Moved by Z towards the cloth, it is pulled back by `c Z`, c
being the stiffness of both together: the warp's tension rises, the cloth's falls. The pick that the reed
pushes, at a distance S from the pick before it, resists by `R(S)`; so `R = c Z`.

Symbols: K is the `resistance` [N m], c the `stiffness` [N/m], D the `least` spacing, P that of the cloth's
picks, `spacing`, and S0 the `reach` of the resistance [m], `D < P < S0`.
"""

from math import sqrt

from .numerics.absent import absent


def weaving_resistance(distance: float, resistance: float, least: float, reach: float) -> float:
    """Force that a pick resists with at a `distance` S from the one before it [N].

    `R = K (1 / (S - D) - 1 / (S0 - D))`, and 0 from S0 on: Greenwood and Cowhig's `K / (S - D)`, which has no
    end, less its value at S0.

    >>> round(weaving_resistance(0.5e-3, 0.2, 0.3e-3, 2e-3), 3), weaving_resistance(0.5, 0.2, 0.3e-3, 2e-3)
    (882.353, 0.0)
    """
    if distance >= reach:
        return 0.0
    return resistance * (reach - distance) / ((distance - least) * (reach - least))


def fell_displacement(
    behind: float,
    back: bool,
    resistance: float,
    stiffness: float,
    least: float,
    spacing: float,
    reach: float,
) -> tuple[float, float]:
    """Displacement Z of the fell from its rest, towards the cloth [m]; its derivative by the reed's way [1].

    The take-up keeps the spacing P, which is the distance of the picks at the reed's front limit, where
    `Z1 = R(P) / c`. A reed that is s behind it presses the pick to `S = P + s - Z1 + Z`, and with `y = S - D`

        y^2 - (P + s - Z1 - D - k / (S0 - D)) y - k = 0,   k = K / c

    On its way back the pick stays in the cloth: the fell follows the reed with `Z = Z1 - s` to its rest.

    Args:
        behind: s [m]
        back: whether the reed is on its way back

    >>> moved, slope = fell_displacement(0.0, False, 0.2, 1e6, 0.3e-3, 0.5e-3, 2e-3)
    >>> round(1e6 * moved, 3), round(slope, 6)  # N
    (882.353, 0.833333)
    """
    if absent(resistance):
        return 0.0, 0.0
    farthest = weaving_resistance(spacing, resistance, least, reach) / stiffness
    if back and farthest > behind:
        return farthest - behind, 1.0
    if back:
        return 0.0, 0.0
    k = resistance / stiffness
    clear = reach - least
    middle = spacing + behind - farthest - least - k / clear
    root = sqrt(middle * middle + 4.0 * k)
    y = 0.5 * (middle + root) if middle > 0.0 else 2.0 * k / (root - middle)
    if y >= clear:
        return 0.0, 0.0
    return k * (clear - y) / (y * clear), 1.0 - y / root
