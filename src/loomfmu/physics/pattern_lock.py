"""Pattern lock of a rotary dobby: the sprung pawls that change the couplings.

Source: Korolev, thesis on rotary dobbies (Moscow), section 3.6.1, equations (3.30) to (3.48), in the
corrected form.

Symbols: M and I are `mass` and `inertia` of a pawl [kg, kg m2], b and c its `length` and `width` [m], of
which the `rest_share` c0 / c stays outside the slot [1]; T is the `span` of shaft angle that an engagement
takes and x the angle since it began [rad], phi0 the whole `turn` of the pawl and phi what it has `turned`
[rad]; P is the `force` of its spring at the end of the turn, its preload [N], C the spring's `stiffness`
[N/m], R its lever `arm` [m].
"""

from math import asin, cos, pi, sin, sqrt

# Time available to the pawl when the shaft stands still; longer than any that matters.
UNLIMITED_TIME = 1e6


def pawl_inertia(mass: float, length: float, width: float) -> float:
    """Moment of inertia of a pawl about its middle [kg m2], `I = M (b^2 + c^2) / 12`, equation (3.31).

    Erratum: 375e-6 is also printed as 3750e-6.

    >>> round(1e6 * pawl_inertia(0.170, 0.16, 0.03), 1)
    375.4
    """
    return mass * (length * length + width * width) / 12.0


def pawl_turn(length: float, width: float, rest_share: float) -> float:
    """Turn of a pawl from one disc to the other [rad], `phi0 = (c + c0) / b`, equation (3.30).

    >>> round(pawl_turn(0.16, 0.03, 0.15), 3)
    0.216
    """
    return (1.0 + rest_share) * width / length


def engagement(x: float, span: float, turn: float) -> tuple[float, float, float]:
    """Turn of the pawl [rad], `phi0 (x/T - sin(2 pi x/T) / (2 pi))`, two derivatives by x, (3.33), (3.34).

    The pawl is at rest before and after; velocity and acceleration are continuous. Erratum: (3.33) prints 1/T
    before the sine.

    >>> engagement(0.0, 1.3, 0.2), engagement(1.3, 1.3, 0.2)[0]
    ((0.0, 0.0, 0.0), 0.2)
    """
    if x <= 0.0:
        return 0.0, 0.0, 0.0
    if x >= span:
        return turn, 0.0, 0.0
    share = x / span
    wave = 2.0 * pi * share
    return (
        turn * (share - sin(wave) / (2.0 * pi)),
        turn / span * (1.0 - cos(wave)),
        2.0 * pi * turn / (span * span) * sin(wave),
    )


def largest_bend(span: float, turn: float) -> float:
    """Largest second derivative of `engagement` by the shaft angle [1/rad], `2 pi phi0 / T^2`, (3.34).

    It is the acceleration at a shaft speed of 1 rad/s. Erratum: its value is printed as 0.32.

    >>> from math import radians
    >>> round(largest_bend(radians(75), radians(12)), 3)
    0.768
    """
    return 2.0 * pi * turn / (span * span)


def spring_torque(turned: float, turn: float, force: float, stiffness: float, arm: float) -> float:
    """Torque of the spring on the pawl [N m], `M = R [P + C R (phi0 - phi)]`: (3.32) and (3.37) as one.

    The source takes it as constant for the torque, `P R`, and without preload for the time, `C R^2 phi`.

    >>> spring_torque(0.25, 0.25, 20.0, 2500.0, 0.05), spring_torque(0.0, 0.25, 20.0, 2500.0, 0.05)
    (1.0, 2.5625)
    """
    return arm * (force + stiffness * arm * (turn - turned))


def torque_speed_limit(
    inertia: float, span: float, turn: float, force: float, stiffness: float, arm: float
) -> float:
    """Shaft speed [rad/s] at which the pawl's inertia needs all of the spring's torque in the engagement.

    The least of `sqrt(M / (I phi''))`, from the condition before (3.35), with M from `spring_torque` and
    phi'' from `engagement`; found to rounding by bisection of its derivative, between the crest of phi'' and
    the middle. With a stiffness of 0 it is at the crest: the source's `sqrt(P R / (I bend))`.

    >>> from math import radians
    >>> round(torque_speed_limit(375.4e-6, radians(75), radians(12), 20.0, 0.0, 0.05) * 30 / pi)
    562
    """
    low = 0.25
    high = 0.5
    for _ in range(60):
        share = 0.5 * (low + high)
        wave = 2.0 * pi * share
        torque = spring_torque(turn * (share - sin(wave) / (2.0 * pi)), turn, force, stiffness, arm)
        falling = stiffness * arm * arm * turn * (1.0 - cos(wave))
        if 2.0 * pi * torque * cos(wave) + falling * sin(wave) > 0.0:
            low = share
        else:
            high = share
    angle, _first, bend = engagement(low * span, span, turn)
    return sqrt(spring_torque(angle, turn, force, stiffness, arm) / (inertia * bend))


def release_time(inertia: float, turn: float, force: float, stiffness: float, arm: float) -> float:
    """Time in which the spring moves the pawl over from rest [s], (3.38) to (3.47) with a preload.

    `I phi'' = M` with M from `spring_torque`: `T_f = acos(d / (phi0 + d)) / k`, `d = P / (C R)`,
    `k^2 = C R^2 / I`, C positive. Without preload it is a quarter of a period, `pi / (2 k)`, independent of
    the turn. Erratum: the source divides by k^2 and finds 0.001 s.

    >>> round(1e3 * release_time(375.4e-6, 0.2156, 0.0, 2500.0, 0.05), 2)  # as in the source
    12.17
    >>> round(1e3 * release_time(375.4e-6, 0.2156, 20.0, 2500.0, 0.05), 2)
    8.76
    """
    full = stiffness * arm * turn  # force that the turn adds to the preload
    # acos(P / (P + full)), without cancellation for a large preload
    angle = 2.0 * asin(sqrt(0.5 * full / (force + full)))
    return angle * sqrt(inertia / (stiffness * arm * arm))


def available_time(angle: float, speed: float) -> float:
    """Time in which the shaft turns through an angle [s], at most 1e6 s.

    Args:
        angle: during which the rotor dwells [rad]
        speed: of the shaft, not negative [rad/s]

    >>> from math import radians
    >>> round(1e3 * available_time(radians(90), 620 * pi / 30), 1)
    24.2
    """
    if angle >= UNLIMITED_TIME * speed:
        return UNLIMITED_TIME
    return angle / speed


def friction_power(coefficient: float, force: float, radius: float, speed: float, count: float) -> float:
    """Power lost to friction between pawls and discs [W], `W = f N r w K`, equation (3.48).

    Args:
        coefficient: of friction f [1]
        force: of a pawl on its disc N [N]
        radius: of the contact r [m]
        speed: of the disc w [rad/s]
        count: of frames, with one pawl each, K [1]

    >>> round(friction_power(0.1, 20.0, 0.0875, 1.4 / 3 * 650 * pi / 30, 20.0))
    111
    """
    return coefficient * force * radius * speed * count
