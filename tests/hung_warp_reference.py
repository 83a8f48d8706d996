"""Carrier and threads as one initial value problem, integrated by scipy: what the damper is judged by.

State: displacement, rate, force of all threads above their pretension. Equations (3.28), corrected, and those
of the HealdDamper's README, written down a second time; contacts as in `damper_reference`.
"""

from math import pi

import numpy as np
from damper_reference import FREE, Carrier, frame, knots

from loomfmu.components import HealdDamper


class Hung(Carrier):
    """The carrier with its threads."""

    def __init__(self, damper: HealdDamper) -> None:
        super().__init__(damper)
        count = damper.thread_count
        self.offset = damper.shed_offset - damper.stroke / 2
        self.lengths = np.array([damper.front_length, damper.back_length])
        self.b, self.pretension = count * damper.thread_stiffness, count * damper.pretension
        self.n, self.r = damper.creep_rate, damper.relaxation_rate

    def geometry(self, height: float) -> tuple[float, float]:
        """Extension of a thread, and its derivative by the height."""
        parts = np.hypot(self.lengths, height)
        return float(np.sum(parts - self.lengths)), float(np.sum(height / parts))

    def load(self, height: float, force: float) -> float:
        return -max(self.pretension + force, 0.0) * self.geometry(height)[1]

    def together(self, speed: float, turns: int, times: np.ndarray) -> tuple[np.ndarray, int]:
        """Displacement, rate, thread force, load and transmitted force at sorted times; contacts."""
        height = frame(0.0, speed)[0] + self.offset + self.start[0]
        state = np.array([*self.start, self.b * self.geometry(height)[0]])

        def motion(contact, side, time, state):
            z, v, force = state
            y, dy, ddy = frame(time, speed)
            x, slope = self.geometry(y + z + self.offset)
            pull = self.load(y + z + self.offset, force) - self.force(contact, side, z, v)
            growth = self.b * (slope * (dy + v) + self.n * x) - self.r * force
            return v, pull / self.mass - ddy, growth

        rows, contacts = np.zeros((len(times), 5)), 0
        stops = [*knots(speed, turns), 2.0 * pi * turns / speed]
        for inside, before, _after, run in self.runs(motion, state, stops, times):
            for place in np.flatnonzero(inside):
                z, v, force = run.sol(times[place])
                height = frame(times[place], speed)[0] + z + self.offset
                rows[place] = z, v, force, self.load(height, force), self.force(*before, z, v)
            contacts += run.status == 1 and before[0] == FREE
        return rows, contacts


def stepped(damper: HealdDamper, speed: float, turns: int, steps: int) -> np.ndarray:
    """The component's displacement, rate, thread force, load and transmitted force after each step."""
    damper.inputs_at_step_end = True
    damper.lift, damper.velocity, damper.acceleration = frame(0.0, speed)
    assert damper.initialize(0.0) == 0
    step, rows = 2.0 * pi / speed / steps, []
    for n in range(-1, turns * steps):
        if n >= 0:
            damper.lift, damper.velocity, damper.acceleration = frame((n + 1) * step, speed)
            assert damper.step(n * step, step) == 0
        rows.append(
            (
                damper.displacement,
                damper.rate,
                damper.thread_force,
                damper.warp_load,
                damper.transmitted_force,
            )
        )
    return np.array(rows)
