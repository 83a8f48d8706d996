"""The heald damper integrated by scipy, to judge the component by.

Equations and contact rules stand here a second time, as an initial value problem with events. Nothing of
the component or of `physics.damper` is used but the damping ratio of a stop.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..components.heald_damper import HealdDamper
from ..physics.damper import stop_damping_ratio
from .chain import RPM, HealdLine

Floats = NDArray[np.float64]
FREE, PRESSING, LET_GO = 0, 1, 2


@dataclass(frozen=True)
class Motion:
    """Displacement and rate of the carrier at given times, and its contacts with a stop on the way."""

    displacement: Floats
    rate: Floats
    contacts: int


class Carrier:
    """The carrier between its stops, one contact after the other."""

    def __init__(self, damper: HealdDamper, frame: Callable[[float], float]) -> None:
        self.mass, self.travel = damper.carrier_mass, damper.free_travel
        self.spring = 4.0 * damper.spring_stiffness
        self.damping = 2.0 * damper.damping_ratio * math.sqrt(self.spring * self.mass)
        self.stop_spring = damper.stop_stiffness
        ratio = stop_damping_ratio(damper.stop_restitution)
        self.stop_damping = 2.0 * ratio * math.sqrt(self.stop_spring * self.mass)
        self.frame = frame
        self.contact, self.side, self.contacts = FREE, 0.0, 0

    def press(self, z: float, v: float) -> float:
        """Force of the stop, were it to act."""
        return self.stop_spring * (self.side * z - self.travel) + self.stop_damping * self.side * v

    def motion(self, time: float, state: Floats) -> tuple[float, float]:
        """Rates of displacement and rate."""
        z, v = state
        force = self.spring * z + self.damping * v
        if self.contact == PRESSING:
            force += self.side * self.press(z, v)
        return v, -force / self.mass - self.frame(time)

    def events(self) -> list[Any]:
        """What ends the present contact, each with the sign that its zero is passed in."""
        travel, side = self.travel, self.side
        of = {
            FREE: [(lambda z, v: z - travel, 1.0), (lambda z, v: -z - travel, 1.0)],
            PRESSING: [(self.press, -1.0)],
            LET_GO: [(lambda z, v: side * z - travel, -1.0), (self.press, 1.0)],
        }
        found = []
        for value, direction in of[self.contact]:

            def event(_time: float, state: Floats, value: Callable[..., float] = value) -> float:
                return float(value(*state))

            event.terminal = True  # type: ignore[attr-defined]
            event.direction = direction  # type: ignore[attr-defined]
            found.append(event)
        return found

    def change(self, which: int, z: float) -> None:
        """Go over to the contact that follows an event."""
        if self.contact == FREE:
            self.contacts += 1
            self.contact, self.side = PRESSING, math.copysign(1.0, z)
        elif self.contact == PRESSING:
            self.contact = LET_GO if self.side * z > self.travel else FREE
        else:
            self.contact = FREE if which == 0 else PRESSING

    def integrate(self, times: Floats, knots: list[float]) -> Motion:
        """Motion at sorted times from 0, from rest; at the knots the frame's third rate jumps."""
        from scipy.integrate import solve_ivp

        state, begin = np.zeros(2), 0.0
        rows = np.zeros((len(times), 2))
        for stop in [*knots, float(times[-1])]:
            while begin < stop:
                # a step of 0.2 ms keeps the interpolation between scipy's steps as exact as the steps
                run = solve_ivp(
                    self.motion, (begin, stop), state, method="DOP853", rtol=1e-12, atol=1e-14,
                    max_step=2e-4, dense_output=True, events=self.events(),
                )  # fmt: skip
                inside = (times >= begin) & (times <= run.t[-1])
                if inside.any():
                    rows[inside] = run.sol(times[inside]).T
                state, begin = run.y[:, -1], float(run.t[-1])
                if run.status == 1:
                    self.change(next(k for k, at in enumerate(run.t_events) if len(at)), float(state[0]))
        return Motion(rows[:, 0], rows[:, 1], self.contacts)


def reference(rpm: float, points: int, law: int, **parameters: float) -> Motion:
    """Motion over one turn of the shaft, at `points` even intervals, under a frame in plain weave."""
    line = HealdLine(rpm, 1, law=law)

    def frame(time: float) -> float:
        line.dobby.step(time, 0.0)
        line.wire()
        line.heald.step(time, 0.0)
        return line.heald.acceleration

    turn = 2.0 * math.pi / (rpm * RPM)
    times = np.arange(points + 1) * (turn / points)
    knots = [turn * (0.5 - 1.0 / 16.0), turn * 0.5, turn * (0.5 + 1.0 / 16.0)]
    return Carrier(HealdDamper(**parameters), frame).integrate(times, knots)  # type: ignore[arg-type]


def simulated(rpm: float, steps: int, law: int, **parameters: float) -> Motion:
    """The component's motion over one turn, fed with the exact motion of the frame at each step's end."""
    line = HealdLine(rpm, steps, law=law)
    damper = HealdDamper(inputs_at_step_end=True, **parameters)  # type: ignore[arg-type]
    line.feed(damper)
    damper.initialize(0.0)
    rows = [(damper.displacement, damper.rate)]
    for _ in range(steps):
        before = line.time
        line.advance()
        line.feed(damper)
        damper.step(before, line.step_size)
        rows.append((damper.displacement, damper.rate))
    found = np.array(rows)
    return Motion(found[:, 0], found[:, 1], damper.stop_contacts)
