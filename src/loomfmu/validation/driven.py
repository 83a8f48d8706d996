"""A loom on its motor: the coupled FMUs against one integration of the equations of the whole loom."""

import math
from collections.abc import Iterator
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..components import COMPONENTS
from ..cosim.run import evaluate
from ..cosim.scenes.scene import Scene, parse
from .sections import Row, Section, number, small

Floats = NDArray[np.float64]
GRAVITY = 9.80665
STEPS = (90, 360, 1440)  # in a revolution
FLOOR, ENERGY_FLOOR = 1e-9, 1e-10  # below which what the iteration of the loop leaves would show
LOOM = """
revolutions = 1
steps_per_revolution = {steps}
coupling = "iterated"
[loom]
machine = "WL680-3600"
{fittings}
[shaft]
component = "DrivenShaft"
speed = "300 rev/min"
{shaft}
[[claims]]
kind = "energy_balance"
"""
FRAMES = 'weave = "1100/0110/0011/1001"\nreed = true'
LOAD = 'torque_32 = "60 N.m"'
# name, what the loom has beside its weft insertion, what else the shaft has
LOOMS: tuple[tuple[str, str, str], ...] = (
    ("weft insertion", "", ""),
    ("and dobby, four frames, reed, 60 N m", FRAMES, LOAD),
    ("and carriers with warp threads", f"{FRAMES}\ndampers = true\nwarps = true", LOAD),
)
ROTOR = (
    "rotor_angle", "rotor_velocity", "rotor_acceleration", "lift_fraction", "lift_rate", "lift_acceleration",
)  # fmt: skip


class Carrier:
    """Carrier and threads of a frame: displacement, rate and force of the threads, between the stops."""

    def __init__(self, damper: Any) -> None:
        self.mass, self.stiffness = damper.carrier_mass, 4.0 * damper.spring_stiffness
        self.damping = 2.0 * damper.damping_ratio * math.sqrt(self.stiffness * self.mass)
        self.lengths = np.array([damper.front_length, damper.back_length])
        self.offset = damper.shed_offset - 0.5 * damper.stroke
        self.threads = damper.thread_count * damper.thread_stiffness
        self.pretension = damper.thread_count * damper.pretension
        self.creep, self.relaxation = damper.creep_rate, damper.relaxation_rate

    def geometry(self, height: float) -> tuple[float, float]:
        """Extension of a thread, and its derivative by the height of the eye."""
        parts = np.hypot(self.lengths, height)
        return float(np.sum(parts - self.lengths)), float(np.sum(height / parts))

    def start(self, lift: float) -> list[float]:
        """Its state with threads that have just been stretched."""
        return [0.0, 0.0, self.threads * self.geometry(lift + self.offset)[0]]

    def sent(self, state: Floats) -> float:
        """Force on the frame, upwards."""
        return float(self.stiffness * state[0] + self.damping * state[1])

    def rates(self, state: Floats, lift: float, velocity: float, acceleration: float) -> list[float]:
        """Rates of its state, for this motion of its frame."""
        z, rate, force = state
        x, slope = self.geometry(lift + z + self.offset)
        load = -max(self.pretension + force, 0.0) * slope
        growth = self.threads * (slope * (velocity + rate) + self.creep * x) - self.relaxation * force
        return [rate, (load - self.sent(state)) / self.mass - acceleration, growth]


class Motion(NamedTuple):
    """A mass on the shaft: derivatives of its place by the shaft's angle, weight, and what hangs in it."""

    name: str
    mass: float
    first: float
    second: float
    weight: float = 0.0
    lift: float = 0.0


class Monolith:
    """The loom as one mechanism: Lagrange's equation in the shaft's angle, and the carriers.

        (J + M(x)) x'' + M'(x) x'^2 / 2 + V'(x) - sum of P s' + T = k (w0 - x'),   M = sum of m s'^2

    `P` are the forces of carriers on their frames. Only positions come from the components, as derivatives by
    the angle: their torques, energies and works do not.
    """

    def __init__(self, scene: Scene):
        self.speed = scene.speed
        self.load = float(scene.instances["shaft"].values.get("torque_32", 0.0))
        self.parts: dict[str, Any] = {}
        self.carriers: dict[str, Carrier] = {}
        for name, each in scene.instances.items():
            component = COMPONENTS[each.fmu.name](**each.values)
            if name.startswith("damper"):
                self.carriers[name.replace("damper", "heald")] = Carrier(component)
            elif name not in ("shaft", "belt") and not name.startswith("warp"):
                self.parts[name] = component
        for part in self.parts.values():
            self.place(part, 0.0)
            part.initialize(0.0)
        lifts = {each.name: each.lift for each in self.motions(0.0)}
        self.start = [0.0, self.speed]
        for name, carrier in self.carriers.items():
            self.start += carrier.start(lifts[name])

    @staticmethod
    def place(part: Any, angle: float) -> None:
        """Put a mechanism at a shaft angle, at unit velocity: its rates are derivatives by the angle then."""
        if hasattr(part, "shaft_angle"):
            part.shaft_angle, part.shaft_velocity, part.shaft_acceleration = angle, 1.0, 0.0

    def motions(self, angle: float) -> Iterator[Motion]:
        """Every mass at a shaft angle."""
        dobby = self.parts.get("dobby")
        for name, part in self.parts.items():
            self.place(part, angle)
            if name.startswith("heald"):
                for signal in ROTOR:
                    setattr(part, signal, getattr(dobby, signal))
            part.step(0.0, 0.0)
            if name == "weft":
                yield Motion(name, part.moving_mass, part.velocity, part.acceleration)
            elif name == "dobby":
                yield Motion(name, part.rotor_inertia, part.rotor_velocity, part.rotor_acceleration)
            elif name == "reed":
                yield Motion(name, part.reed_mass, part.velocity, part.acceleration)
            else:
                hung = self.carriers[name].mass if name in self.carriers else 0.0
                yield Motion(
                    name, part.frame_mass - hung, part.velocity, part.acceleration, part.frame_mass * GRAVITY,
                    part.lift,
                )  # fmt: skip

    def law(self, _time: float, state: Floats) -> list[float]:
        """Rates of shaft and carriers."""
        angle, velocity = state[:2]
        hung = dict(zip(self.carriers, state[2:].reshape(-1, 3), strict=True))
        inertia, torque = 2.0, 40.0 * (self.speed - velocity) - self.load
        motions = list(self.motions(angle))
        for each in motions:
            inertia += each.mass * each.first * each.first
            torque -= each.mass * each.first * each.second * velocity * velocity + each.weight * each.first
            if each.name in hung:
                torque += self.carriers[each.name].sent(hung[each.name]) * each.first
        acceleration = torque / inertia
        rates = [velocity, acceleration]
        for each in motions:
            if each.name in hung:
                bend = each.first * acceleration + each.second * velocity * velocity
                moved = (each.lift, each.first * velocity, bend)
                rates += self.carriers[each.name].rates(hung[each.name], *moved)
        return rates

    def solved(self, time: Floats) -> tuple[Floats, Floats]:
        """Velocity and angle of the shaft."""
        from scipy.integrate import solve_ivp

        # steps no longer than 2 deg: the laws of the dobby are smooth in pieces
        found = solve_ivp(
            self.law, (0.0, time[-1]), self.start, method="DOP853", rtol=1e-12, atol=1e-12, t_eval=time,
            max_step=time[-1] / 180.0,
        )  # fmt: skip
        return found.y[1], found.y[0]


class Comparison(NamedTuple):
    """Largest errors within the revolution, energy missing as a share, the motor's peak and the exact one."""

    velocity: float
    angle: float
    missing: float
    power: float
    exact_power: float


@cache
def compared(fittings: str, shaft: str) -> tuple[Comparison, ...]:
    """A loom with each number of steps against its integration."""
    found, exact = [], None
    for steps in reversed(STEPS):
        scene = parse(LOOM.format(steps=steps, fittings=fittings, shaft=shaft), "driven")
        signals = ["shaft.velocity", "shaft.angle", "shaft.motor_power"]
        run = evaluate(scene, values=signals)
        if exact is None:  # of the finest steps, which the others are among
            monolith = Monolith(scene)
            exact = monolith.solved(run.trace.time)
        velocity, angle = (each[:: STEPS[-1] // steps] for each in exact)
        errors = (np.abs(run.trace["shaft.velocity"] - velocity), np.abs(run.trace["shaft.angle"] - angle))
        power = 40.0 * (monolith.speed - velocity) * velocity
        off, turned_off = (float(error.max()) for error in errors)
        peak = float(run.trace["shaft.motor_power"].max())
        found.append(Comparison(off, turned_off, run.claims[0].worst, peak, float(power.max())))
    return tuple(found[::-1])


def section() -> Section:
    """Errors of the coupled loom, and where its energy goes."""
    rows = []
    for name, fittings, shaft in LOOMS:
        for steps, found in zip(STEPS, compared(fittings, shaft), strict=True):
            cells = (
                small(found.velocity, FLOOR), small(found.angle, FLOOR), small(found.missing, ENERGY_FLOOR),
                number(1e-3 * found.power, 4), number(1e-3 * found.exact_power, 4),
            )  # fmt: skip
            rows.append(Row((name, str(steps), *cells)))
    return Section(
        "Driven shaft against one integration of the whole loom",
        (
            "WL680-3600",
            "steps",
            "velocity: largest error, rad/s",
            "angle, rad",
            "energy missing, share",
            "motor's peak, kW",
            "integrated, kW",
        ),
        tuple(rows),
        intro="The first revolution at 300 rev/min without load, default motor and inertia. FMUs coupled with"
        " iterated steps, against scipy's DOP853 (rtol = 1e-12) on Lagrange's equation of the whole loom with"
        " its carriers and threads. Errors are the largest at any sample. Energy: what the claim"
        " `energy_balance` finds missing, of the work that the shaft exchanges in a revolution. The peak is"
        " that of the samples.",
        remarks=(
            "The error is of fourth order, 256 times less with four times as many steps, down to what the"
            " iteration of the loop leaves. The rotor's law has a third derivative that jumps 22.5 deg to"
            " either side of the slow point, where a sample falls with 1440 steps alone.",
            "No stop is hit. A contact makes the torque jump, and the error of second order.",
            "The sources publish neither inertia nor motor: these rows prove the coupling, not a loom.",
        ),
    )
