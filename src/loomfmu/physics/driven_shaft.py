"""A shaft with inertia between its motor and its load, solved exactly for a load that changes linearly.

Equation of motion, `w` being the velocity and `N` the net torque, the motor's less the load's:

    J dw/dt = N,   N = k (w0 - w) - T(t),   d(angle)/dt = w

The motor's torque falls linearly, from `k w0` at rest to zero at the no-load speed `w0`: a motor with
permanent magnets at a constant voltage, or an induction motor within its working range.
"""

from .warp import fading


def driven_motion(
    net: float, rise: float, duration: float, inertia: float, slope: float
) -> tuple[float, float]:
    """Change of velocity and angle over a step, of a shaft whose load changes linearly.

    With `z = k h / J`, the share `u` of the step and the moments of `fading`, `I_k = integral of
    exp(-z (1 - u)) u^k`, the exact solution is

        w(h) - w(0)               = h / J (N0 I_0 - dT I_1)
        angle(h) - angle(0) - w(0) h = h^2 / J (N0 I_1 - dT I_2 / 2)

    Nothing cancels, whether `z` is zero, tiny or huge. Nothing is divided by `k`, which is 0 when coasting.

    Args:
        net: torque of the motor less that of the load at the start of the step, N0 [N m]
        rise: of the load over the step, dT [N m]
        duration: of the step, h [s]
        inertia: J [kg m2], positive
        slope: of the motor's torque line, k [N m s/rad], not negative

    Returns:
        change of velocity [rad/s], angle beyond that at the initial velocity [rad]

    >>> driven_motion(6.0, 0.0, 2.0, 3.0, 0.0)  # 2 rad/s2 for 2 s
    (4.0, 4.0)
    >>> driven_motion(6.0, 0.0, 1e6, 3.0, 2.0)[0]  # in the end the speed has changed by N0 / k
    3.0
    """
    _kept, i0, i1, i2, _i3, _i4, _i5, _i6 = fading(slope * duration / inertia)
    gain = duration / inertia
    return gain * (net * i0 - rise * i1), duration * gain * (net * i1 - 0.5 * rise * i2)


def summed(value: float, rest: float, change: float) -> tuple[float, float]:
    """Compensated sum: a value plus a change, and the rounding error to add the next time.

    The error of the rounded sum is exact (Knuth, The Art of Computer Programming, vol. 2, 4.2.2, theorem B).
    So the rounding of many small steps does not add up, and steps below the rounding of the value are not
    lost.

    Args:
        value: so far
        rest: rounding error so far, at first 0
        change: what is added

    Returns:
        value, rest

    >>> summed(1.0, 0.0, 1e-17)
    (1.0, 1e-17)
    """
    wanted = change + rest
    total = value + wanted
    part = total - value
    return total, (value - (total - part)) + (wanted - part)
