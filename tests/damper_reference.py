"""The heald damper integrated by scipy, to judge the component by; `convergence` gives the table of errors.

Equations and contact rules stand here a second time, as an initial value problem with events. Nothing of
the component or of `loomfmu.physics.damper` is used but the damping ratio of a stop.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from math import copysign, log2, pi, sqrt
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from loomfmu.components import HealdDamper
from loomfmu.physics.damper import stop_damping_ratio
from loomfmu.physics.heald import lift_fraction
from loomfmu.physics.rotor_laws.rotor import SLOPED_SINE, rotor_law

STROKE = 0.098  # m, the frame's default
REDUCTION = 0.5
STEPS = (45, 90, 180, 360, 720, 1440, 2880, 5760)  # in a revolution

FREE, PRESSING, LET_GO = "free", "pressing", "let go"


def frame(time: float, speed: float, law: int = SLOPED_SINE) -> tuple[float, float, float]:
    """Lift, velocity and acceleration of a frame in plain weave; its rotor is slowest at half a turn."""
    x = speed * time - pi
    turns = x // (2.0 * pi)
    angle, first, second = rotor_law(law, x - 2.0 * pi * turns, REDUCTION)
    share, rate, second_rate = lift_fraction(angle + 2.0 * pi * turns, first * speed, second * speed**2)
    return STROKE * share, STROKE * rate, STROKE * second_rate


Load = Callable[[float], float]


def unloaded(_time: float) -> float:
    """No warp on the carrier."""
    return 0.0


def knots(speed: float, turns: int) -> list[float]:
    """Times at which the third derivative of the rotor law jumps: pi/8 to either side of the slow point."""
    return [(2.0 * pi * turn + pi + side * pi / 8.0) / speed for turn in range(turns) for side in (-1, 1)]


@dataclass(frozen=True)
class Trace:
    """Displacement, rate and transmitted force at given times, and the contacts with a stop on the way.

    `edges` are times and forces where a stop has just begun or ended to press: the force may jump there.
    """

    displacement: np.ndarray
    rate: np.ndarray
    force: np.ndarray
    contacts: int
    edges: tuple[tuple[float, float], ...] = ()

    @property
    def peak(self) -> float:
        """Largest displacement."""
        return float(np.max(np.abs(self.displacement)))


class Carrier:
    """The carrier as an initial value problem, one contact after the other."""

    def __init__(self, damper: HealdDamper) -> None:
        self.mass = damper.carrier_mass
        self.spring = 4.0 * damper.spring_stiffness
        self.damping = 2.0 * damper.damping_ratio * sqrt(self.spring * self.mass)
        self.travel = damper.free_travel
        self.stop_spring = damper.stop_stiffness
        ratio = stop_damping_ratio(damper.stop_restitution)
        self.stop_damping = 2.0 * ratio * sqrt(self.stop_spring * self.mass)
        self.start = (damper.start_displacement, damper.start_rate)

    def press(self, side: float, z: Any, v: Any) -> Any:
        """Force of a stop, were it to act."""
        return self.stop_spring * (side * z - self.travel) + self.stop_damping * side * v

    def force(self, contact: str, side: float, z: Any, v: Any) -> Any:
        """Force of the carrier on the frame."""
        free = self.spring * z + self.damping * v
        return free + side * self.press(side, z, v) if contact == PRESSING else free

    def events(self, contact: str, side: float) -> list[Callable[..., float]]:
        """What ends a contact, each with the sign that its zero is passed in."""

        def passed(value: Callable[[float, float], float], direction: int) -> Callable[..., float]:
            def event(_time: float, state: np.ndarray) -> float:
                return value(*state[:2])

            event.terminal, event.direction = True, direction  # type: ignore[attr-defined]
            return event

        if contact == FREE:
            return [passed(lambda z, v: z - self.travel, 1), passed(lambda z, v: -z - self.travel, 1)]
        falls = passed(lambda z, v: self.press(side, z, v), -1)
        left = passed(lambda z, v: side * z - self.travel, -1)
        rises = passed(lambda z, v: self.press(side, z, v), 1)
        return [falls] if contact == PRESSING else [left, rises]

    def after(self, contact: str, side: float, which: int, z: float) -> tuple[str, float]:
        """Contact that follows an event."""
        if contact == FREE:
            return PRESSING, copysign(1.0, z)
        if contact == PRESSING and side * z > self.travel:
            return LET_GO, side
        if contact == PRESSING:
            return FREE, 0.0
        return (FREE, 0.0) if which == 0 else (PRESSING, side)

    def integrate(
        self, speed: float, turns: int, times: np.ndarray, law: int = SLOPED_SINE, load: Load = unloaded
    ) -> Trace:
        """Trace behind a frame of a loom, at sorted times from 0 to the end of the turns."""

        def acceleration(time: float) -> float:
            return frame(time, speed, law)[2]

        return self.follow(acceleration, [*knots(speed, turns), 2.0 * pi * turns / speed], times, load)

    def follow(
        self, acceleration: Load, stops: Sequence[float], times: np.ndarray, load: Load = unloaded
    ) -> Trace:
        """Trace at sorted times from 0 to the last stop; the frame's acceleration is smooth between these."""

        def motion(contact: str, side: float, time: float, state: np.ndarray) -> tuple[float, float]:
            z, v = state
            return v, (load(time) - self.force(contact, side, z, v)) / self.mass - acceleration(time)

        rows, contacts, edges = np.zeros((len(times), 3)), 0, []
        for inside, before, after, run in self.runs(motion, np.array(self.start), stops, times):
            z, v = run.sol(times[inside]) if inside.any() else np.zeros((2, 0))
            rows[inside] = np.column_stack([z, v, self.force(*before, z, v)])
            if run.status == 1:
                contacts += before[0] == FREE
                edges += [(run.t[-1], self.force(*each, *run.y[:, -1])) for each in (before, after)]
        return Trace(*rows.T, contacts, tuple(edges))

    def runs(
        self, motion: Callable[..., Any], state: np.ndarray, stops: Sequence[float], times: np.ndarray
    ) -> Iterator[tuple[np.ndarray, tuple[str, float], tuple[str, float], Any]]:
        """Integrate from one change of contact to the next, or to a stop.

        Yield which of the times lie in it, contact and side in it and after it, and what scipy found. The
        state begins with displacement and rate.
        """
        contact, begin = (FREE, 0.0), 0.0
        for stop in stops:
            while begin < stop:
                # a step of 0.2 ms keeps the interpolation between scipy's steps as exact as the steps
                run = solve_ivp(
                    partial(motion, *contact),
                    (begin, stop),
                    state,
                    method="DOP853",
                    rtol=1e-12,
                    atol=1e-14,
                    max_step=2e-4,
                    dense_output=True,
                    events=self.events(*contact),
                )
                before, inside = contact, (times >= begin) & (times <= run.t[-1])
                state, begin = run.y[:, -1], run.t[-1]
                if run.status == 1:
                    which = next(index for index, found in enumerate(run.t_events) if len(found))
                    contact = self.after(*contact, which, state[0])
                yield inside, before, contact, run


def simulated(
    damper: HealdDamper, speed: float, turns: int, steps: int, law: int = SLOPED_SINE, load: Load = unloaded
) -> tuple[Trace, HealdDamper]:
    """The component's trace, fed with the exact motion of the frame at the end of each step."""
    damper.inputs_at_step_end = True
    damper.lift, damper.velocity, damper.acceleration = frame(0.0, speed, law)
    damper.warp_force = float(load(0.0))
    assert damper.initialize(0.0) == 0
    step = 2.0 * pi / speed / steps
    rows = [(damper.displacement, damper.rate, damper.transmitted_force)]
    for n in range(turns * steps):
        damper.lift, damper.velocity, damper.acceleration = frame((n + 1) * step, speed, law)
        damper.warp_force = float(load((n + 1) * step))
        assert damper.step(n * step, step) == 0
        rows.append((damper.displacement, damper.rate, damper.transmitted_force))
    return Trace(*np.array(rows).T, damper.stop_contacts), damper


@dataclass(frozen=True)
class Row:
    """Errors for one number of steps in a revolution, in shares of the peak."""

    steps: int
    displacement: float
    rate: float
    order: float

    def __str__(self) -> str:
        order = "" if np.isnan(self.order) else f"{self.order:6.2f}"
        return f"{self.steps:6d}  {self.displacement:12.3e}  {self.rate:12.3e}  {order}"


def convergence(
    speed: float,
    turns: int = 1,
    steps: tuple[int, ...] = STEPS,
    law: int = SLOPED_SINE,
    load: Load = unloaded,
    **parameters: float,
) -> list[Row]:
    """Errors against the integration for each number of steps, with the order seen from one to the next.

    The order is that of the displacement's error, by the number of steps.
    """
    finest = max(steps)
    times = np.arange(turns * finest + 1) * (2.0 * pi / speed / finest)
    times[-1] = 2.0 * pi * turns / speed
    exact = Carrier(HealdDamper(**parameters)).integrate(speed, turns, times, law, load)
    rows: list[Row] = []
    for count in steps:
        trace, _ = simulated(HealdDamper(**parameters), speed, turns, count, law, load)
        every = slice(None, None, finest // count)
        z = float(np.max(np.abs(trace.displacement - exact.displacement[every]))) / exact.peak
        v = float(np.max(np.abs(trace.rate - exact.rate[every]))) / float(np.max(np.abs(exact.rate)))
        order = log2(rows[-1].displacement / z) / log2(count / rows[-1].steps) if rows else float("nan")
        rows.append(Row(count, z, v, order))
    return rows


def table(rows: list[Row]) -> str:
    """The rows as text."""
    return "\n".join([" steps  displacement          rate   order", *map(str, rows)])
