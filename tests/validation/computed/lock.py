"""Korolev, the pattern lock: section 3.6.1."""

import math

from loomfmu.components.pattern_lock import PatternLock
from loomfmu.physics import pattern_lock as physics

RPM = math.pi / 30.0
LENGTH, WIDTH = 0.16, 0.03
SPAN = math.radians(75.0)
STIFFNESS, ARM, FORCE = 2500.0, 0.05, 20.0
TWELVE = math.radians(12.0)  # the rounded turn that the source continues with; the exact one is 12.35 deg
INERTIA = physics.pawl_inertia(0.170, LENGTH, WIDTH)
PRINTED_INERTIA = 3750e-6  # kg m2, with which the source continues
TURN = physics.pawl_turn(LENGTH, WIDTH, 0.15)
BEND = physics.largest_bend(SPAN, TWELVE)
SQUARE = STIFFNESS * ARM**2 / INERTIA  # k^2 [1/s2]
PRINTED_SQUARE = STIFFNESS * ARM**2 / PRINTED_INERTIA
MISTAKEN_SQUARE = STIFFNESS * ARM**2 / TURN  # "k^2" with phi in the place of I
MISTAKEN_LIMIT = math.sqrt(1.0 / (375e-6 * 0.32))  # rad/s
START = 1.0 - 2.0 * math.pi / SPAN  # of the mean speed, by (3.33) as printed
TORQUE = INERTIA * BEND * (620.0 * RPM) ** 2  # N m, at 620 rev/min


def component() -> PatternLock:
    """The component with its defaults."""
    found = PatternLock()
    found.initialize(0.0)
    return found


def limit(turn: float = TURN) -> float:
    """Shaft speed at which the pawl needs all of a constant torque of the spring [rad/s]."""
    return physics.torque_speed_limit(INERTIA, SPAN, turn, FORCE, 0.0, ARM)


def release(inertia: float = INERTIA) -> float:
    """Release time without preload [s]."""
    return physics.release_time(inertia, TURN, 0.0, STIFFNESS, ARM)


def friction(speed: float) -> float:
    """Friction of 20 frames at a shaft speed, (3.48) [W]."""
    return physics.friction_power(0.1, FORCE, 0.0875, 1.4 / 3.0 * speed, 20.0)
