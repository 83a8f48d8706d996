"""A shaft with inertia between its motor and its load, solved exactly for a load that is a parabola in time.

Equation of motion, `w` being the velocity and `N` the net torque, the motor's less the load's:

    J dw/dt = N,   N = k (w0 - w) - T(t),   d(angle)/dt = w

The motor's torque falls linearly, from `k w0` at rest to zero at the no-load speed `w0`: a motor with
permanent magnets at a constant voltage, or an induction motor within its working range. Over a step of
duration `h`, with the share `u` of the step, the load is

    T = T0 + dT u + 6 B u (1 - u)

`dT` is its rise over the step and `B`, its bulge, what its mean exceeds that of the straight line by.
"""

from dataclasses import dataclass
from math import sqrt

from .warp import fading


@dataclass(frozen=True)
class Response:
    """Response of the velocity to torques over a step: `h / J`, and the moments of `fading` for `z`."""

    gain: float
    i0: float
    i1: float
    i2: float
    i3: float
    i4: float
    i5: float


def response(duration: float, inertia: float, slope: float) -> Response:
    """Return the response of a shaft over a step, with `z = k h / J`.

    Args:
        duration: of the step, h [s]
        inertia: J [kg m2], positive
        slope: of the motor's torque line, k [N m s/rad]; where it is negative z is at least -3
    """
    _kept, i0, i1, i2, i3, i4, i5, _i6 = fading(slope * duration / inertia)
    return Response(duration / inertia, i0, i1, i2, i3, i4, i5)


def driven_motion(
    velocity: float, net: float, rise: float, bulge: float, by: Response
) -> tuple[float, float, float, float]:
    """Change of velocity over a step, and the moments of the velocity that angle and work follow from.

    With the moments of `fading`, `I_n = integral of exp(-z (1 - u)) u^n`, a part `u^n` of the net torque
    contributes `h / J I_n` to the velocity, and to its m-th repeated integral over the step
    `h / J I_(n+m) n! / (n + m)!`. Nothing cancels, whether `z` is zero, tiny or huge. Nothing is divided by
    `k`, which is 0 when coasting.

    Args:
        velocity: at the start of the step [rad/s]
        net: torque of the motor less that of the load at the start of the step, N0 [N m]
        rise, bulge: of the load over the step, dT and B [N m]
        by: response of the shaft over the step

    Returns:
        change of velocity [rad/s], mean of the velocity less that at the start, mean of (1 - u) times the
        velocity, mean of (1 - u)^2 / 2 times the velocity [rad/s]

    >>> driven_motion(0.0, 6.0, 0.0, 0.0, response(2.0, 3.0, 0.0))[:2]  # 2 rad/s2 for 2 s
    (4.0, 2.0)
    >>> driven_motion(0.0, 6.0, 0.0, 0.0, response(1e6, 3.0, 2.0))[0]  # in the end it has changed by N0 / k
    3.0
    """
    linear = -rise - 6.0 * bulge
    square = 6.0 * bulge
    return (
        by.gain * (net * by.i0 + linear * by.i1 + square * by.i2),
        by.gain * (net * by.i1 + linear * by.i2 / 2.0 + square * by.i3 / 3.0),
        0.5 * velocity + by.gain * (net * by.i2 / 2.0 + linear * by.i3 / 6.0 + square * by.i4 / 12.0),
        velocity / 6.0 + by.gain * (net * by.i3 / 6.0 + linear * by.i4 / 24.0 + square * by.i5 / 60.0),
    )


def work_of(
    start: float, rise: float, bulge: float, duration: float, mean: float, second: float, third: float
) -> float:
    """Work of a torque `T0 + dT u + 6 B u (1 - u)` over a step [J], by repeated integration by parts.

    Args:
        start, rise, bulge: T0, dT and B [N m]
        duration: of the step [s]
        mean, second, third: means of the velocity, of (1 - u) and of (1 - u)^2 / 2 times it [rad/s]

    >>> work_of(3.0, 0.0, 0.0, 2.0, 5.0, 2.5, 0.8333333333333334)  # 3 N m over 10 rad
    30.0
    """
    return duration * ((start + rise) * mean - (rise - 6.0 * bulge) * second - 12.0 * bulge * third)


def bulge_for(
    work: float,
    start: float,
    rise: float,
    velocity: float,
    net: float,
    net_rise: float,
    duration: float,
    by: Response,
) -> float:
    """The bulge [N m] with which torques do a known work over a step.

    The torques lie on a parabola then, whose ends and whose work are right. That makes the motion right to
    fourth order in the step, and leaves no error in the energy.

    The work is a quadratic polynomial of the bulge. Where it does not get as far as the known work, its
    vertex is taken, and a shaft that starts from rest, with which a torque does no work, has no bulge.

    Args:
        work: of the torques over the step [J]
        start, rise: of these torques [N m]
        net, net_rise: net torque at the start of the step, and the rise of the whole load [N m]
        duration: of the step [s]
        by: response of the shaft over it

    >>> steady = response(2.0, 1e300, 0.0)
    >>> bulge_for(44.0, 3.0, 2.0, 5.0, 0.0, 0.0, 2.0, steady)  # 4 N m over 10 rad, and 4 J more
    0.4
    """
    if velocity == 0.0 or duration == 0.0:
        return 0.0
    _gain, more, second, third = driven_motion(velocity, net, net_rise, 0.0, by)
    _gain, first_by, second_by, third_by = driven_motion(0.0, 0.0, 0.0, 1.0, by)
    mean = velocity + more
    missing = work - work_of(start, rise, 0.0, duration, mean, second, third)
    by_bulge = work_of(0.0, 0.0, 1.0, duration, mean, second, third) + work_of(
        start, rise, 0.0, duration, first_by, second_by, third_by
    )
    by_square = work_of(0.0, 0.0, 1.0, duration, first_by, second_by, third_by)
    within = by_bulge * by_bulge + 4.0 * by_square * missing
    root = sqrt(within) if within > 0.0 else 0.0
    whole = by_bulge + (root if by_bulge > 0.0 else -root)
    return 2.0 * missing / whole if by_bulge * velocity > 0.0 else 0.0


def summed(value: float, rest: float, change: float) -> tuple[float, float]:
    """Compensated sum: a value plus a change, and the rounding error to add the next time.

    The error of the rounded sum is exact (Knuth, The Art of Computer Programming, vol. 2, 4.2.2, theorem B).
    So the rounding of many small steps does not add up, and steps below the rounding of the value are not
    lost.

    Args:
        value: so far
        rest: rounding error so far, at first 0
        change: what is added

    >>> summed(1.0, 0.0, 1e-17)
    (1.0, 1e-17)
    """
    wanted = change + rest
    total = value + wanted
    part = total - value
    return total, (value - (total - part)) + (wanted - part)
