"""Motion of the main shaft in closed form."""

from math import cos, fabs, sin

from .numerics.absent import absent

# Angle [rad] beyond which no mechanism is computed; it is rounded to 2e-7 rad there, after 3e8 revolutions
FARTHEST = 2e9


def too_far(angle: float) -> bool:
    """Return whether an angle [rad] is so large that its rounding matters.

    >>> too_far(1e9), too_far(-3e9)
    (False, True)
    """
    return fabs(angle) > FARTHEST


def ramp(time: float, duration: float) -> tuple[float, float, float]:
    """Smooth start-up: equivalent time at full speed [s], share of full speed [1] and its rate [1/s].

    The share of full speed is the quintic `10 u^3 - 15 u^4 + 6 u^5`, `u = time / duration`: velocity,
    acceleration and jerk are continuous at both ends. The ramp delays the shaft by half its duration.

    Args:
        time: time since the start [s]
        duration: length of the ramp [s]; 0 for none

    >>> ramp(2.0, 2.0)
    (1.0, 1.0, 0.0)
    """
    if time >= duration:
        return time - 0.5 * duration, 1.0, 0.0
    if duration <= 0.0:
        return time, 1.0, 0.0
    if time <= 0.0:
        return 0.0, 0.0, 0.0
    u = time / duration
    share = u * u * u * (10.0 - u * (15.0 - 6.0 * u))
    equivalent = duration * u * u * u * u * (2.5 - u * (3.0 - u))
    rate = 30.0 * u * u * (1.0 - u) * (1.0 - u) / duration
    return equivalent, share, rate


def shaft_motion(
    time: float,
    speed: float,
    start_angle: float,
    ramp_duration: float,
    ripple_amplitude: float,
    ripple_order: int,
) -> tuple[float, float, float]:
    """Angle [rad], velocity [rad/s] and acceleration [rad/s2] of a shaft that ramps up and ripples.

    With the mean angle `p(t)` of the ramp the shaft turns at `p' (1 + A sin(n p))`: integrable in closed
    form, periodic in the mean angle, never backwards while `A < 1`.

    Args:
        time: time since the start [s]
        speed: mean speed after the ramp [rad/s]
        start_angle: angle at time 0 [rad]
        ramp_duration: length of the start-up [s]
        ripple_amplitude: A, relative to the speed [1]
        ripple_order: n, ripples per revolution [1]

    >>> shaft_motion(0.5, 10.0, 1.0, 0.0, 0.0, 2)
    (6.0, 10.0, 0.0)
    """
    equivalent, share, rate = ramp(time, ramp_duration)
    turned = speed * equivalent
    velocity = speed * share
    acceleration = speed * rate
    if absent(ripple_amplitude):
        return start_angle + turned, velocity, acceleration
    mean = start_angle + turned
    # cos(n start) - cos(n mean), without cancellation near the start
    swing = 2.0 * sin(0.5 * ripple_order * (start_angle + mean)) * sin(0.5 * ripple_order * turned)
    factor = 1.0 + ripple_amplitude * sin(ripple_order * mean)
    slope = ripple_amplitude * ripple_order * cos(ripple_order * mean)
    return (
        mean + ripple_amplitude / ripple_order * swing,
        velocity * factor,
        acceleration * factor + velocity * velocity * slope,
    )


def carried(value: float, rate: float, second_rate: float, duration: float) -> float:
    """A value extrapolated over a step with its rates, `value + rate h + second_rate h^2 / 2`.

    >>> carried(1.0, 2.0, 4.0, 0.5)
    2.5
    """
    return value + duration * (rate + 0.5 * duration * second_rate)
