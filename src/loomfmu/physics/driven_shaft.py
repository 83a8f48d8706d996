"""A shaft with inertia between its motor and its load, solved exactly for a load on a straight line.

Equation of motion, `w` being the velocity and `N` the net torque, the motor's less the load's:

    J dw/dt = N,   N = k (w0 - w) - T(t),   d(angle)/dt = w

The motor's torque falls on a straight line, from `k w0` at rest to nothing at the no-load speed `w0`: a motor
with permanent magnets at a constant voltage, or an induction motor within its working range.
"""

from .warp import fading


def driven_motion(
    net: float, rise: float, duration: float, inertia: float, slope: float
) -> tuple[float, float]:
    """What a step adds to velocity and angle of a shaft whose load rises on a straight line.

    With `z = k h / J`, the share `u` of the step and the moments of `fading`, `I_k = integral of
    exp(-z (1 - u)) u^k`, the exact solution is

        w(h) - w(0)               = h / J (N0 I_0 - dT I_1)
        angle(h) - angle(0) - w(0) h = h^2 / J (N0 I_1 - dT I_2 / 2)

    Nothing cancels, be `z` nought, tiny or huge. There is no division by `k`: a shaft that coasts has none.

    Args:
        net: torque of the motor less that of the load at the start of the step, N0 [N m]
        rise: by how much the load grows in the step, dT [N m]
        duration: of the step, h [s]
        inertia: J [kg m2], positive
        slope: of the motor's torque line, k [N m s/rad], not negative

    Returns:
        velocity gained [rad/s], angle beyond that at the starting velocity [rad]

    >>> driven_motion(6.0, 0.0, 2.0, 3.0, 0.0)  # 2 rad/s2 for 2 s
    (4.0, 4.0)
    >>> driven_motion(6.0, 0.0, 1e6, 3.0, 2.0)[0]  # in the end the motor gives way by N0 / k
    3.0
    """
    _kept, i0, i1, i2, _i3, _i4, _i5, _i6 = fading(slope * duration / inertia)
    gain = duration / inertia
    return gain * (net * i0 - rise * i1), duration * gain * (net * i1 - 0.5 * rise * i2)


def summed(value: float, rest: float, change: float) -> tuple[float, float]:
    """A value that has grown by a change, and what its rounding leaves over for the next time.

    The error of the one rounded sum, exactly (Knuth, The Art of Computer Programming, vol. 2, 4.2.2,
    theorem B). So neither do the roundings of many small steps add up, nor do steps get lost that are
    smaller than the rounding of the value.

    Args:
        value: so far
        rest: what its rounding has left over so far, at first 0
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
