"""A loom on its motor as one mechanism, integrated by scipy, to judge the coupled FMUs by."""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from loomfmu.components import COMPONENTS
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.units import STANDARD_GRAVITY

ROTOR = (
    "rotor_angle",
    "rotor_velocity",
    "rotor_acceleration",
    "lift_fraction",
    "lift_rate",
    "lift_acceleration",
)


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
        """Return its state with threads that have just been stretched."""
        return [0.0, 0.0, self.threads * self.geometry(lift + self.offset)[0]]

    def sent(self, state: np.ndarray) -> float:
        """Force on the frame, upwards."""
        return float(self.stiffness * state[0] + self.damping * state[1])

    def rates(self, state: np.ndarray, lift: float, velocity: float, acceleration: float) -> list[float]:
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
        """Yield every mass at a shaft angle."""
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
                weight = part.frame_mass * STANDARD_GRAVITY
                yield Motion(
                    name, part.frame_mass - hung, part.velocity, part.acceleration, weight, part.lift
                )

    def law(self, _time: float, state: np.ndarray) -> list[float]:
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

    def solved(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Velocity and angle of the shaft."""
        # steps no longer than 2 deg: the laws of the dobby are smooth in pieces
        found = solve_ivp(
            self.law,
            (0.0, time[-1]),
            self.start,
            method="DOP853",
            rtol=1e-12,
            atol=1e-12,
            t_eval=time,
            max_step=time[-1] / 180.0,
        )
        return found.y[1], found.y[0]
