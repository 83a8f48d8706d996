"""Weft yarn on its way from the package to the rapier head: what holds it back, and how it stretches.

Behind the last guide eye the yarn follows its stretch: a Kelvin-Voigt body of unstretched length N, drawn
out to the length L between brake and head. The tension there stays below the limit at which the brake lets
more yarn through. With F = EA (L / N - 1) and the limit H of `drawing_limit`

    S = F + tau F' = min(F + tau (EA + F) v / L, H)

so F' is continuous, brake and yarn never chatter, and each of the two branches has a closed form: N is
constant while the brake holds, and F relaxes towards H while it lets yarn through.

Symbols: v and v' are `speed` and `acceleration` of the yarn [m/s, m/s2], q its `density` [kg/m], L its
`length` [m], EA its `stiffness` [N].
"""

from math import exp, fabs, pi, sqrt

from .numerics.motion import above_noise, bent, bump_noise, bumps, moved_on, sample_noise
from .warp import thread_force

AIR_DENSITY = 1.2  # kg/m3, at 20 degrees Celsius and sea level
MOST_DECAY = 1e15  # of a step, in retardation times: beyond that the force is its limit to rounding


def capstan_gain(friction: float, angle: float) -> float:
    """Ratio of the tensions after and before guide eyes over which the yarn slides, `exp(mu sum of angles)`.

    Args:
        friction: coefficient mu between yarn and eye [1]
        angle: sum of the wrap angles of all eyes [rad]

    >>> capstan_gain(0.0, 3.0)
    1.0
    """
    return exp(friction * angle)


def drag_per_length(coefficient: float, diameter: float) -> float:
    """Air drag on yarn that moves along itself, per length and square of its speed [kg/m2]: `c rho pi d / 2`.

    Args:
        coefficient: c of friction in air, for the yarn's circumference [1]
        diameter: d of the yarn [m]

    >>> round(drag_per_length(0.065, 0.2e-3) * 1.0 * 20.0**2, 5)  # 1 m at 20 m/s [N]
    0.0098
    """
    return 0.5 * AIR_DENSITY * pi * diameter * coefficient


def eased(start: float, end: float, share: float) -> tuple[float, float]:
    """Value between two points of a program and its derivative by the share: `3 u^2 - 2 u^3`, no overshoot.

    >>> eased(1.0, 3.0, 0.5)
    (2.0, 3.0)
    """
    rise = end - start
    return start + rise * share * share * (3.0 - 2.0 * share), 6.0 * rise * share * (1.0 - share)


def drawing_limit(
    gain: float,
    supply: float,
    unwound: float,
    density: float,
    brake: float,
    brake_rate: float,
    speed: float,
    acceleration: float,
) -> tuple[float, float]:
    """Tension H behind the last eye at which the brake lets yarn through [N], and its rate [N/s].

    Yarn that runs round an eye presses on it with `T - q v^2` for each radian: the rest turns its momentum.
    So `T - q v^2` is what friction multiplies, and before the eyes `T = T0 + m v^2 + B`. Where that is less
    than `q v^2` the yarn is off its eyes, and its tension passes them unchanged.

    Args:
        gain: g of all eyes, from `capstan_gain` [1]
        supply: tension T0 at the package [N]
        unwound: m, the yarn's mass per length times the factor for its balloon [kg/m]
        brake, brake_rate: force B of the brake and its rate [N, N/s]

    >>> drawing_limit(2.0, 0.5, 0.01, 0.01, 1.0, 3.0, 10.0, 100.0)
    (4.0, 26.0)
    """
    momentum = density * speed * speed
    turning = 2.0 * density * speed * acceleration
    pressing = supply + unwound * speed * speed + brake - momentum
    pressing_rate = 2.0 * unwound * speed * acceleration + brake_rate - turning
    grip = gain if pressing > 0.0 else 1.0
    return grip * pressing + momentum, grip * pressing_rate + turning


def stretch_force(stiffness: float, length: float, unstretched: float) -> float:
    """Elastic force of the yarn, `EA (L / N - 1)`, negative where it hangs loose.

    >>> stretch_force(75.0, 1.01, 1.0)
    0.7500000000000007
    """
    return stiffness * (length - unstretched) / unstretched


def unstretched_length(stiffness: float, length: float, force: float) -> float:
    """Unstretched length N of yarn under an elastic force; `stretch_force` inverted.

    >>> unstretched_length(75.0, 1.5, 37.5)
    1.0
    """
    return length * (stiffness / (stiffness + force))


def relaxed_force(force: float, decay: float, low: float, share: float, limit: list[float]) -> float:
    """Elastic force while the brake lets yarn through [N]: exact solution of `tau F' + F = H`, H a cubic.

    Args:
        force: F at the beginning [N]
        decay: duration of the step over the retardation time tau [1]
        low, share: share u of the step at the beginning and at the end
        limit: H by u, coefficients of 1 .. u^3 [N]

    >>> relaxed_force(2.0, 3.0, 0.0, 1.0, [2.0, 0.0, 0.0, 0.0])
    2.0
    """
    z = decay if decay < MOST_DECAY else MOST_DECAY
    h0, h1, h2, h3 = limit
    p = [
        z * (h0 + low * (h1 + low * (h2 + low * h3))),
        z * (h1 + low * (2.0 * h2 + 3.0 * low * h3)),
        z * (h2 + 3.0 * low * h3),
        z * h3,
        0.0,
        0.0,
    ]
    end, _area = thread_force(force, z, p, share - low)
    return end


def snatch_tension(stiffness: float, density: float, speed: float) -> float:
    """Tension [N] at the end of elastic yarn at rest, drawn at a constant speed at once, `v sqrt(EA q)`.

    A wave runs along the yarn at `c = sqrt(EA / q)` and leaves it with the strain `v / c`; the tension stays
    until the wave is back.

    >>> round(snatch_tension(75.0, 3e-5, 20.0), 12)
    0.948683298051
    """
    return speed * sqrt(stiffness * density)


def moving_load(length: float, speed: float, acceleration: float, density: float, drag: float) -> float:
    """Return the tension that inertia and drag k [kg/m2] of the moving yarn add [N], `q L a + k L v^2`.

    >>> moving_load(2.0, 3.0, 10.0, 0.5, 1.0)
    28.0
    """
    return length * (density * acceleration + drag * speed * speed)


def moving_load_rate(
    length: float, speed: float, acceleration: float, jerk: float, density: float, drag: float
) -> float:
    """Rate of `moving_load`; `jerk` is the rate of the acceleration [m/s3].

    >>> moving_load_rate(2.0, 3.0, 10.0, 4.0, 0.5, 1.0)
    166.0
    """
    return speed * (density * acceleration + drag * speed * speed) + length * (
        density * jerk + 2.0 * drag * speed * acceleration
    )


def quintic(
    start: float, rate: float, second: float, end: float, end_rate: float, end_second: float, place: float
) -> list[float]:
    """The quintic that joins two samples of a motion, without what is lost in their rounding.

    Args:
        start .. end_second: values and rates by the share u of the way, as for `bumps`
        place: time of the samples, in ways [1]

    Returns:
        value and rate at the start, second rate as from `joined`

    >>> [round(each, 12) + 0.0 for each in quintic(0.0, 0.0, 0.0, 1.0, 5.0, 20.0, 1.0)]  # u^5
    [0.0, 0.0, 0.0, 0.0, 0.0, 20.0]
    """
    by_rate, by_value = bumps(start, rate, second, end, end_rate, end_second)
    rates = fabs(rate) + fabs(end_rate)
    rate_noise, value_noise = bump_noise(
        sample_noise(fabs(start) + fabs(end), rates, place),
        sample_noise(rates, fabs(second) + fabs(end_second), place),
    )
    a0, a1, a2, a3 = bent(
        second, end_second, above_noise(by_rate, 0.0, rate_noise), above_noise(by_value, 0.0, value_noise)
    )
    return [start, rate, a0, a1, a2, a3]


def along(share: float, way: list[float]) -> tuple[float, float, float, float]:
    """Value on a `quintic` at a share u of the way, and its first three derivatives by u.

    >>> along(0.5, [0.0, 0.0, 0.0, 0.0, 0.0, 20.0])
    (0.03125, 0.3125, 2.5, 15.0)
    """
    start, rate, a0, a1, a2, a3 = way
    value, first, second = moved_on(start, rate, a0, a1, a2, a3, share)
    return value, first, second, a1 + share * (2.0 * a2 + 3.0 * share * a3)
