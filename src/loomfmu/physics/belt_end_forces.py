"""Forces of the end shapes of the belt on its modes, by inertia and by the push on them; see `belt_ends`."""

from math import pi

from .belt_ends import Ends, moment_forces, turned_by
from .belt_modes import dot, summed
from .belt_moving import Belt, Instant
from .numerics.absent import absent

# integrals of the square of the slope of psi and of its product with that of the other end, with x and x^2
SQUARE_ALONG = 7.6948373537988e-4
SQUARE_TWICE = 7.0247428329297e-4
CROSS_ALONG = 9.793947498038e-5
CROSS_TWICE = 8.088007123494e-5
AREA = 24.0 / pi**4 * (1.0 + 1.0 / 81.0 + 1.0 / 625.0) - 0.25  # integral of psi, which its weight acts on


def end_forces(drifting: float, pushed: float, thrown: float) -> list[float]:
    """Forces of the end shape f on the modes.

    `drifting int x sin(m pi x) f' dx + m pi int (pushed x + thrown x^2) cos(m pi x) f' dx`. Neither its mass
    nor its bending nor a constant push couples it to the modes.

    >>> round(1e3 * end_forces(0.0, 0.0, 1.0)[5], 12)
    64.346861254998
    """
    return [
        -4.7089567642551875e-4 * drifting - 3.7459780768771716e-4 * pushed - 9.6859380879856009e-4 * thrown,
        9.8414417326917609e-4 * drifting + 1.3724543680458386e-3 * pushed + 2.2062984750290385e-3 * thrown,
        -1.5988989078060496e-3 * drifting - 1.5082121747237921e-3 * pushed - 4.1698697220745896e-3 * thrown,
        2.4262042855303312e-3 * drifting + 5.3277178537743802e-3 * pushed + 8.0022473175899444e-3 * thrown,
        -3.7496322717787359e-3 * drifting - 5.1008168187945264e-3 * pushed - 1.7878343284047494e-2 * thrown,
        6.7764158189493683e-3 * drifting + 5.2530030899903327e-2 * pushed + 6.4346861254997988e-2 * thrown,
    ]


def head_forces(drifting: float, pushed: float, thrown: float) -> list[float]:
    """As `end_forces`, of the end shape at the head.

    >>> round(1e3 * head_forces(0.0, 0.0, 1.0)[5], 12)
    40.71320054481
    """
    return [
        -0.000104905913126 * drifting + 0.0003745978076877 * pushed - 0.0002193981934231 * thrown,
        0.0002252290338837 * drifting + 0.001372454368046 * pushed + 0.0005386102610626 * thrown,
        -0.0003847868683333 * drifting + 0.001508212174724 * pushed - 0.001153445372627 * thrown,
        0.0006357420843851 * drifting + 0.005327717853774 * pushed + 0.002653188389959 * thrown,
        -0.001138755142245 * drifting + 0.005100816818795 * pushed - 0.007676709646458 * thrown,
        0.002760765088614 * drifting + 0.0525300308999 * pushed + 0.04071320054481 * thrown,
    ]


def tilt_forces(offset: float, pushed: float, thrown: float, dragged: float) -> list[float]:
    """Forces on the modes by the line between guide and head, which turns as the belt grows.

    Where the guide's exit is off the head's line by y, a point of the belt is at `u + y X / L`. So

        rho y / (m pi) [2 (-1)^m V^2 / L - A] - c y V (-1)^m / (m pi)

    Args:
        offset: y [m]
        pushed, thrown, dragged: rho A, rho V^2 / L and c V [N/m, kg/s2, N/m]

    >>> [round(pi * each, 12) for each in tilt_forces(1.0, 1.0, 1.0, 1.0)[:2]]
    [-2.0, 0.0]
    """
    share = offset / pi
    even = share * (2.0 * thrown - dragged - pushed)
    odd = share * (dragged - 2.0 * thrown - pushed)
    return [odd, even / 2.0, odd / 3.0, even / 4.0, odd / 5.0, even / 6.0]


def end_coupling(
    belt: Belt, at: Instant, ends: Ends, thrown: float, q: list[float], v: list[float]
) -> list[float]:
    """Forces on the modes by the inertia of the end shapes on a belt that moves through its guide.

    Both ways: the end shapes drive the modes, and clamped ends hold them against what the modes do to them.
    With them are those of the line between guide and head, see `tilt_forces`. `thrown` is `rho V^2 / L`
    [kg/s2].
    """
    twice = 2.0 * belt.mass * at.velocity
    pushed = belt.mass * at.acceleration
    dragged = pushed + belt.damping * at.velocity
    guide = ends.guide
    head = ends.head
    f = end_forces(dragged * guide + twice * ends.guide_rate, pushed * guide, thrown * guide)
    if not absent(belt.offset):
        tilted = tilt_forces(belt.offset, pushed, thrown, belt.damping * at.velocity)
        f = summed(1.0, tilted, f)
    if ends.clamped == 0:
        return f
    by_head = head_forces(dragged * head + twice * ends.head_rate, pushed * head, thrown * head)
    f = summed(1.0, by_head, f)
    r = end_forces(-dragged, pushed, thrown)
    s = end_forces(-twice, 0.0, 0.0)
    at_guide = dot(r, q) + dot(s, v)
    r = head_forces(-dragged, pushed, thrown)
    s = head_forces(-twice, 0.0, 0.0)
    at_head = dot(r, q) + dot(s, v)
    across = CROSS_ALONG * pushed + CROSS_TWICE * thrown
    at_guide = at_guide + (SQUARE_ALONG * pushed + SQUARE_TWICE * thrown) * guide + across * head
    at_head = at_head + across * guide
    if not absent(belt.gravity):
        weight = AREA * belt.mass * belt.gravity * at.length
        at_guide = at_guide + weight
        at_head = at_head + weight
    at_guide, at_head = turned_by(ends.clamped, at_guide, at_head)
    moments = moment_forces(at_guide, at_head)
    return summed(-1.0, moments, f)
