"""Stability of a rapier belt without guide hooks: buckling load, margin, safe speed, deflection.

Source: Zhu and Zhou, J. Zhejiang Sci-Tech Univ. 45 (2021) 497, sections 3 and 4, equations (7) to (12),
Tables 2 to 7.

Lengths l of the free section are negative inside the guide [m], mu is the column length factor [1], EI the
bending stiffness [N m2], everywhere the arguments `free_length`, `factor` and `stiffness`.
"""

from math import fabs, inf, pi, sqrt

from .numerics.brackets import at_root

# Largest speed limit that is returned: 95,493 rev/min. Towards the edge of its window the limit grows
# without bound; outside it there is none.
NO_LIMIT = 1e4
REST = 1e-9  # m/s: of a head that is slower, rounding may have made the direction


# knots of Table 3: guide clearances [m] and length factors [1]
CLEARANCES = (0.0, 0.30e-3, 0.50e-3, 0.75e-3, 0.80e-3)
FACTORS = (0.70, 0.80, 0.90, 0.97, 1.00)
SLOPES = (  # of the cubics there [1/m]
    233.33333333333394,
    405.4054054054056,
    362.7639155470247,
    415.3846153846153,
    653.3333333333337,
)


def length_factor(clearance: float) -> float:
    """Column length factor [1] of the belt for a clearance in its guide, Table 3.

    Monotone cubic (PCHIP) through the five published points; 1 (pinned at both ends) from 0.8 mm.

    Args:
        clearance: between belt and guide, not negative [m]

    >>> length_factor(0.3e-3), length_factor(2e-3)
    (0.8, 1.0)
    """
    factor = FACTORS[0]
    for index in range(4):
        width = CLEARANCES[index + 1] - CLEARANCES[index]
        t = _within_one((clearance - CLEARANCES[index]) / width)
        factor += (FACTORS[index + 1] - FACTORS[index]) * t * t * (3.0 - 2.0 * t) + width * t * (1.0 - t) * (
            (1.0 - t) * SLOPES[index] - t * SLOPES[index + 1]
        )
    return factor


def length_factor_slope(clearance: float) -> float:
    """Slope of `length_factor` [1/m]; at the last knot that beyond it, which is 0."""
    slope = 0.0
    for index in range(4):
        if CLEARANCES[index] <= clearance < CLEARANCES[index + 1]:
            width = CLEARANCES[index + 1] - CLEARANCES[index]
            t = (clearance - CLEARANCES[index]) / width
            slope = (
                6.0 * t * (1.0 - t) * (FACTORS[index + 1] - FACTORS[index]) / width
                + (1.0 - t) * (1.0 - 3.0 * t) * SLOPES[index]
                - t * (2.0 - 3.0 * t) * SLOPES[index + 1]
            )
    return slope


def _within_one(t: float) -> float:
    """Return a number, or 0 below 0 and 1 above 1: without a comparison, so that its slopes are known."""
    return 0.5 * (fabs(t) - fabs(t - 1.0) + 1.0)


def euler_column(free_length: float, factor: float, stiffness: float) -> tuple[float, float]:
    """Euler's critical load `pi^2 EI / (mu l)^2`, equation (8), as `pi^2 EI` [N m2] and `mu l` [m].

    Apart, since the load grows without bound towards the guide, where `mu l` is 0.
    """
    return pi * pi * stiffness, factor * free_length


def critical_force(free_length: float, factor: float, stiffness: float) -> float:
    """Euler's critical load of the free section [N], equation (8).

    >>> round(critical_force(0.174, 0.8, 0.25), 1)
    127.3
    """
    strength, reduced = euler_column(free_length, factor, stiffness)
    return strength / (reduced * reduced)


def margin(free_length: float, axial_force: float, factor: float, stiffness: float) -> float:
    """Stability margin `1 - F / F_cr` [1], F_cr from (8): finite for every load, negative once it buckles.

    It is 1 while the belt is inside its guide and above 1 under tension. The force is negative for
    tension [N].

    >>> margin(-0.1, 50.0, 0.8, 0.25)
    1.0
    """
    if free_length <= 0.0:
        return 1.0
    strength, reduced = euler_column(free_length, factor, stiffness)
    return 1.0 - axial_force * reduced * reduced / strength


def on_way_in(velocity: float) -> bool:
    """Return whether a head counts as on its way in: up to and with its inner dead centre, the hand-over.

    There the velocity is what rounding leaves, other on each platform; the giver has the weft up to then.

    >>> on_way_in(30.0), on_way_in(-1e-12), on_way_in(-1e-6)
    (True, True, False)
    """
    return velocity > -REST


def weft_load(tension: float, velocity: float, taker: bool) -> float:
    """Compression of the belt by the weft that its head carries [N]: F_z of (12) with its direction.

    The weft pulls back against the motion of the head. A giver carries it on the way in, pushed by its belt,
    and returns empty; a taker goes in empty and draws the weft out, pulled by its belt. The source describes
    both in section 1, but counts the tension as compression for either head. It is negative where the weft
    relieves the belt.

    Args:
        tension: of the weft [N]
        velocity: of the head, positive on its way in [m/s]
        taker: whether the head takes the weft over, instead of bringing it

    >>> weft_load(2.0, 10.0, False), weft_load(2.0, -10.0, False)
    (2.0, 0.0)
    >>> weft_load(2.0, 10.0, True), weft_load(2.0, -10.0, True)
    (0.0, -2.0)
    """
    if taker:
        return 0.0 if on_way_in(velocity) else 0.0 - tension
    return tension if on_way_in(velocity) else 0.0


def speed_limit(
    free_length: float, slope: float, factor: float, stiffness: float, mass: float, tension: float
) -> float:
    """Shaft speed [rad/s] at which the belt would just buckle at this angle, equations (9) and (12).

    `sqrt((F_cr - F_z) / (m s''))`; without tension `(pi / (mu l)) sqrt(EI / (m s''))`. It is
    `NO_LIMIT` inside the guide and where the head does not push the belt, and 0 where the weft tension
    alone buckles it.

    Args:
        slope: second derivative s'' of the travel by the shaft angle [m]
        mass: of the head with the rigid section of the belt [kg]
        tension: compression by the weft F_z [N]; negative where the weft relieves the belt
    """
    if free_length <= 0.0 or slope <= 0.0:
        return NO_LIMIT
    strength, reduced = euler_column(free_length, factor, stiffness)
    if strength >= (tension + NO_LIMIT * NO_LIMIT * mass * slope) * reduced * reduced:
        return NO_LIMIT
    spare = strength / (reduced * reduced) - tension
    if spare <= 0.0:
        return 0.0
    return sqrt(spare / (mass * slope))


def complete_elliptic(modulus: float) -> float:
    """Complete elliptic integral of the first kind K(k), 0 <= k < 1, by the arithmetic-geometric mean.

    >>> round(complete_elliptic(0.0) * 2 / pi, 12)
    1.0
    """
    a = 1.0
    b = sqrt(1.0 - modulus * modulus)
    while fabs(a - b) > 1e-15 * a:
        a, b = 0.5 * (a + b), sqrt(a * b)
    return pi / (a + b)


def elliptic_slope(modulus: float) -> float:
    """Derivative of K(k) by the modulus: the steps of the arithmetic-geometric mean, differentiated.

    >>> round(elliptic_slope(0.5), 6)
    0.541732
    """
    a = 1.0
    b = sqrt(1.0 - modulus * modulus)
    da = 0.0
    db = -modulus / b
    for _ in range(8):
        mean = sqrt(a * b)
        da, db = 0.5 * (da + db), 0.5 * (da * b + a * db) / mean
        a, b = 0.5 * (a + b), mean
    return -pi * (da + db) / ((a + b) * (a + b))


def elastica_deflection(load_ratio: float, free_length: float) -> float:
    """Largest deflection of a buckled pinned column [m], from the exact elastica instead of (11).

    `F / F_cr = (2 K(k) / pi)^2` gives the modulus k by bisection, then `deflection / l = k / K(k)`.
    Erratum: the printed (11) gives half of it, 4.2 mm, where the paper's own result is 8 mm. It is 0 up to
    the critical load.

    Args:
        load_ratio: compression over critical load [1]
        free_length: length l of the free section [m]

    >>> round(elastica_deflection((686 / 685) ** 2, 0.174) * 1000, 1)
    8.4
    """
    if load_ratio <= 1.0 or free_length <= 0.0:
        return 0.0
    target = 0.5 * pi * sqrt(load_ratio)
    low = 0.0
    high = 1.0 - 1e-15  # K = 18.4 there: a load of 137 times the critical one
    if target >= complete_elliptic(high):
        return free_length / target
    while high - low > 1e-15:
        k = 0.5 * (low + high)
        if k == low or k == high:
            break
        if complete_elliptic(k) < target:
            low = k
        else:
            high = k
    middle = 0.5 * (low + high)
    return free_length * at_root(middle, complete_elliptic(middle) - target, elliptic_slope(middle)) / target


# Where the pinned elastica is bent most, 2 K (1 - k^2) = E: its modulus, its deflection over its length
MOST_BENT = 0.8374529602688741
LARGEST_BEND = 0.4031401897056502


def bent_load_ratio(bend: float) -> float:
    """Load ratio [1] at which a pinned column first has a deflection, `bend` times its length.

    `elastica_deflection` inverted: 1 without a deflection, `inf` from 0.4031 on, which no load gives.

    >>> round(bent_load_ratio(8.4e-3 / 0.174), 4)  # (686 / 685)^2 = 1.0029
    1.0029
    """
    if bend <= 0.0:
        return 1.0
    if bend >= LARGEST_BEND:
        return inf
    low = 0.0
    high = MOST_BENT
    for _ in range(60):
        k = 0.5 * (low + high)
        if k < bend * complete_elliptic(k):
            low = k
        else:
            high = k
    middle = 0.5 * (low + high)
    slope = 1.0 - bend * elliptic_slope(middle)
    k = at_root(middle, middle - bend * complete_elliptic(middle), slope)
    root = 2.0 / pi * complete_elliptic(k)
    return root * root
