"""Korolev, the pattern lock: section 3.6.1."""

import math

from ..components.pattern_lock import PatternLock
from ..physics.pattern_lock import (
    available_time,
    friction_power,
    largest_bend,
    pawl_inertia,
    pawl_turn,
    release_time,
    torque_speed_limit,
)
from .sections import DERIVED, Pair, Row, Section, consistent, number

RPM = math.pi / 30.0
MASS, LENGTH, WIDTH = 0.170, 0.16, 0.03
SPAN = math.radians(75.0)
STIFFNESS, ARM, FORCE = 2500.0, 0.05, 20.0
TWELVE = math.radians(12.0)  # the rounded turn that the source continues with; the exact one is 12.35 deg
INERTIA = pawl_inertia(MASS, LENGTH, WIDTH)


def sections() -> tuple[Section, ...]:
    """Speed and power."""
    return speed(), power()


def limit(turn: float) -> float:
    """Shaft speed at which the pawl needs all of a constant torque of the spring [rev/min]."""
    return torque_speed_limit(INERTIA, SPAN, turn, FORCE, 0.0, ARM) / RPM


def speed() -> Section:
    """Section 3.6.1.1."""
    turn = pawl_turn(LENGTH, WIDTH, 0.15)
    release = release_time(INERTIA, turn, 0.0, STIFFNESS, ARM)
    available = available_time(math.radians(90.0), 620.0 * RPM)
    lock = PatternLock()
    lock.initialize(0.0)
    return Section(
        "Section 3.6.1.1: how fast the lock is",
        ("quantity", ""),
        (
            Row(("moment of inertia of the pawl, 1e-6 kg m2, (3.31)", Pair("375", 1e6 * INERTIA, 1))),
            Row(("moment of inertia that the source continues with, 1e-6 kg m2",
                 Pair("3750", 1e6 * INERTIA, 1, misprint=True))),
            Row(("turn of the pawl, rad, (3.30)", Pair("0.216", turn, 4))),
            Row(("the same, deg", Pair("12", math.degrees(turn), 2, proves=DERIVED)),
                "rounded to whole degrees, with which the source goes on"),
            Row(("torque of the spring, N m, (3.32)", consistent("1.0", FORCE * ARM, 2))),
            Row(("largest acceleration at 1 rad/s, 12 deg, 1/s2, (3.34)",
                 Pair("0.32", largest_bend(SPAN, TWELVE), 3, misprint=True))),
            Row(("speed limit from the torque, 12 deg, rev/min",
                 Pair("620", limit(TWELVE), 1, misprint=True))),
            Row(("speed limit from the torque, 12.35 deg, rev/min", number(limit(turn), 1))),
            Row(("the same with stiffness and preload", number(lock.torque_speed_limit / RPM, 1))),
            Row(("release time, ms, (3.47)", Pair("1", 1e3 * release, 2, misprint=True))),
            Row(("time for 90 deg at 620 rev/min, ms", Pair("10", 1e3 * available, 2, misprint=True))),
            Row(("release time with preload, ms", number(1e3 * lock.release_time, 2))),
            Row(("speed limit from the release time, rev/min",
                 number(math.radians(90.0) / release / RPM, 1))),
            Row(("the same with preload, rev/min", number(lock.release_speed_limit / RPM, 1))),
        ),
        remarks=(
            "The source's conclusion that the pawl moves over in time holds. What limits the speed is the"
            " torque: with the source's constant torque to less than its 620 rev/min.",
            "The source takes the torque of the spring as constant, 1.0 N m, for the one limit and as"
            " proportional to the angle, without preload, for the other. The component has one torque for"
            " both, `R [P + C R (phi0 - phi)]`. That the 20 N are its preload, the force at the end of the"
            " turn, is an assumption: were they the force at the start, the spring would be slack before the"
            " end.",
        ),
    )  # fmt: skip


def power() -> Section:
    """Section 3.6.1.2."""
    ratio = 1.4 / 3.0
    unit = friction_power(0.1, FORCE, 0.0875, ratio, 20.0)
    fast = friction_power(0.1, FORCE, 0.0875, ratio * 650.0 * RPM, 20.0)
    return Section(
        "Section 3.6.1.2: friction of 20 frames, W, (3.48)",
        ("quantity", ""),
        (
            Row(("at a shaft speed of 1 rad/s", Pair("1.63", unit, 3))),
            Row(("at 650 rev/min", Pair("111", fast, 1, proves=DERIVED))),
        ),
        remarks=(
            "That the whole dobby takes no more than 500 W, as the source expects, cannot be judged by this"
            " part of it.",
        ),
    )
