"""The belt of a machine behind its rapier, and its shape: what tests of BeltDynamics share."""

import math
from math import pi

import numpy as np

from loomfmu.components.weft_insertion import WeftInsertion
from loomfmu.machines import parameters
from loomfmu.physics.belt_ends import end_shape
from loomfmu.physics.belt_motion import ends_at
from loomfmu.physics.belt_moving import instant

RPM = pi / 30.0
MACHINE = "WL680-3600"


class Loom:
    """The belt of a machine behind its rapier, with steps of the shaft."""

    def __init__(self, belt_class, rpm, steps=720, start=85.0, machine=MACHINE, **given):
        self.weft = WeftInsertion(**parameters("WeftInsertion", machine=machine), speed=rpm * RPM)
        self.weft.initialize(0.0)
        self.step_size = 2.0 * pi / steps / self.weft.speed
        self.time = math.radians(start) / self.weft.speed
        self.belt = belt_class(
            **{**parameters("BeltMonitor", machine=machine), **given}, inputs_at_step_end=True
        )
        self.feed()
        self.belt.initialize(self.time)

    def feed(self):
        self.weft.step(self.time, 0.0)
        for name in ("travel", "velocity", "acceleration"):
            setattr(self.belt, name, getattr(self.weft, name))

    def motion(self, time):
        self.weft.step(time, 0.0)
        guide = self.belt.idle_travel + self.belt.head_length
        return self.weft.travel - guide, self.weft.velocity, self.weft.acceleration

    def turn_to(self, degrees):
        problems = set()
        while self.time * self.weft.speed < math.radians(degrees) - 1e-9:
            self.time += self.step_size
            self.feed()
            problems.add(self.belt.step(self.time - self.step_size, self.step_size))
        return problems


X = np.linspace(1.0, 0.0, 201)  # of BeltDynamics, from the head; the finite elements count from the guide


def shape(modes, ends, x=X):
    """Deflection by modes and by the end shapes at guide and head."""
    guide, head = ends
    sines = np.sin(np.outer(pi * x, np.arange(1, 7))) @ np.array(end_shape(guide, head, modes))
    return sines + guide * (x**3 - x) + head * ((1.0 - x) ** 3 - (1.0 - x))


def ends(belt, length, speed=0.0):
    """Amplitudes of the end shapes at guide and head, and their rates."""
    at = instant(belt.given(), length, speed, 0.0, 0.0)
    found = ends_at(belt.given(), at, belt.guide_contact, list(belt.mode), list(belt.mode_rate))
    return (found.guide, found.head), (found.guide_rate, found.head_rate)
