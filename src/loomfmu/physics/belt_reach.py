"""The most that a belt may still be deflected by on its way back into the guide.

With its energy E against the shape q* at rest, a belt between ends that do not yield is deflected from that
shape by no more than `w`, as by a force at the weakest place:

    E >= k B (1 - P / F) w^2 / (2 L^3)

with the compression P, Euler's load F, and k = 48 of pinned ends, 102 if the head cannot turn. The guide puts
in power as the length falls, by at most `3 E |V| / L`, since bending energy at given modes grows no faster
than `L^-3`; so `E L^3`, and `w` with it, does not grow while `P L^2` does not.
"""

from math import fabs, inf, pi, sqrt

from .belt_moving import Belt, Instant

WEAKEST, WEAKEST_GUIDED = 48.0, 101.9  # stiffness of a beam at its weakest place, times L^3 / B
MOST_PUSHED = 0.5  # of Euler's load: beyond, the head's push may bend the belt further


def may_reach(belt: Belt, at: Instant, energy: float, load: float) -> float:
    """Deflection that a belt cannot exceed while it goes back into its guide [m], infinite where unknown.

    Args:
        energy: of the motion across the belt, against the belt held straight [J]
        load: compression of a straight belt in its middle [N]
    """
    length = at.length
    square = length * length
    euler = pi * pi * belt.stiffness / square
    pushed = load if load > 0.0 else 0.0
    if at.velocity >= 0.0 or pushed > MOST_PUSHED * euler:
        return inf
    # the line between guide and head, which turns, presses on a belt that is off it
    turning = belt.mass * (2.0 * at.velocity * at.velocity / length + fabs(at.acceleration))
    still = 4.0 / pi**5 * fabs(belt.offset) * turning * length * square / belt.stiffness
    for n in range(6):
        wave = (n + 1) * pi / length
        stiff = 0.5 * length * wave * wave * (wave * wave - pushed / belt.stiffness)
        energy = energy + 0.5 * belt.stiffness * at.moments[n] * at.moments[n] / stiff
        still = still + fabs(at.moments[n]) / stiff
    energy = energy if energy > 0.0 else 0.0
    held = (WEAKEST_GUIDED if belt.guided else WEAKEST) * belt.stiffness * (1.0 - pushed / euler)
    return still + sqrt(2.0 * energy * length * square / held)
