"""Carrier and threads as one initial value problem, integrated by scipy: what the damper is judged by.

State: displacement, rate, force of all threads above their pretension. Equations (3.28), corrected, and those
of the HealdDamper's README, written down a second time; contacts as in `damper_reference`.
"""

from math import pi

import numpy as np
from damper_reference import FREE, Carrier, frame, knots
from scipy.integrate import solve_ivp

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
        contact, side, contacts, begin = FREE, 0.0, 0, 0.0
        rows = np.zeros((len(times), 5))
        for stop in [*knots(speed, turns), 2.0 * pi * turns / speed]:
            while begin < stop:

                def motion(time, state, contact=contact, side=side):
                    z, v, force = state
                    y, dy, ddy = frame(time, speed)
                    x, slope = self.geometry(y + z + self.offset)
                    pull = self.load(y + z + self.offset, force) - self.force(contact, side, z, v)
                    growth = self.b * (slope * (dy + v) + self.n * x) - self.r * force
                    return v, pull / self.mass - ddy, growth

                events = [of_two(each) for each in self.events(contact, side)]
                run = solve_ivp(
                    motion,
                    (begin, stop),
                    state,
                    method="DOP853",
                    rtol=1e-12,
                    atol=1e-13,
                    max_step=2e-4,
                    dense_output=True,
                    events=events,
                )
                inside = (times >= begin) & (times <= run.t[-1])
                for place in np.flatnonzero(inside):
                    z, v, force = run.sol(times[place])
                    height = frame(times[place], speed)[0] + z + self.offset
                    load, sent = self.load(height, force), self.force(contact, side, z, v)
                    rows[place] = z, v, force, load, sent
                state, begin = run.y[:, -1], run.t[-1]
                if run.status == 1:
                    which = next(index for index, found in enumerate(run.t_events) if len(found))
                    contacts += contact == FREE
                    contact, side = self.after(contact, side, which, state[0])
        return rows, contacts


def of_two(event):
    """An event of displacement and rate, for a state of three."""

    def of_three(time, state):
        return event(time, state[:2])

    of_three.terminal, of_three.direction = event.terminal, event.direction
    return of_three


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
