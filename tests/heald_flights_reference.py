"""A heald in its play and its threads by scipy, flight by flight and rest by rest: a reference."""

import math

import numpy as np
from damper_reference import frame
from scipy.integrate import solve_ivp

from loomfmu.components import HealdPlay, WarpTension
from loomfmu.physics.rotor_laws.rotor import UNIFORM


class Flights:
    """A heald and its threads: nothing of the components is used but their parameters."""

    def __init__(self, restitution: float) -> None:
        self.play, self.warp, self.restitution = HealdPlay(), WarpTension(), restitution
        self.speed = 300.0 * math.pi / 30.0
        self.lengths = np.array([self.warp.front_length, self.warp.back_length])
        self.side, self.blows = 0.0, 0

    def eye(self, time: float) -> tuple[float, float, float, float]:
        """Velocity and acceleration of the bars, extension of the thread, and its slope."""
        lift, velocity, acceleration = frame(time, self.speed, UNIFORM)
        height = lift - 0.5 * self.warp.stroke + self.warp.shed_offset
        parts = np.hypot(self.lengths, height)
        return velocity, acceleration, float(np.sum(parts - self.lengths)), float(np.sum(height / parts))

    def pull(self, time: float, force: float) -> float:
        """Acceleration of a free heald in its play."""
        _velocity, acceleration, _x, slope = self.eye(time)
        tension = max(self.warp.pretension + force, 0.0)
        return -tension * slope / self.play.heald_mass - self.play.gravity - acceleration

    def rates(self, time: float, state: np.ndarray) -> tuple[float, float, float]:
        velocity, _acceleration, x, slope = self.eye(time)
        warp, force = self.warp, state[2]
        growth = warp.thread_stiffness * (slope * velocity + warp.creep_rate * x)
        growth -= warp.relaxation_rate * force
        moves = self.side == 0.0
        return state[1] * moves, self.pull(time, force) * moves, growth

    def run(self, end: float) -> list[float]:
        """Times of the blows."""
        reach, times = 0.5 * self.play.play, []
        force = self.warp.thread_stiffness * self.eye(0.0)[2]
        self.side = 1.0 if self.pull(0.0, force) > 0.0 else -1.0
        time, state = 0.0, np.array([self.side * reach, 0.0, force])
        while time < end:
            up = lambda t, s: s[0] - reach  # noqa: E731
            down = lambda t, s: -s[0] - reach  # noqa: E731
            free = lambda t, s: self.side * self.pull(t, s[2])  # noqa: E731
            for event, direction in ((up, 1.0), (down, 1.0), (free, -1.0)):
                event.terminal, event.direction = True, direction
            events = [free] if self.side else [up, down]
            found = solve_ivp(
                self.rates, (time, end), state, method="DOP853", rtol=1e-10, atol=1e-14, max_step=2e-3,
                events=events,
            )  # fmt: skip
            time, state = found.t[-1], found.y[:, -1].copy()
            if found.status != 1:
                break
            if self.side:
                self.side = 0.0
            else:
                bar, fast = np.sign(state[0]), abs(state[1])
                state[:2] = bar * reach, -self.restitution * state[1]
                if fast < self.play.least_speed:
                    self.side, state[1] = bar, 0.0
                else:
                    times.append(time)
        return times
