"""Every component wired as on a loom, scaled to any shaft speed, run directly and at the ends of steps."""

from collections.abc import Iterable, Iterator
from math import fabs, isfinite, pi
from typing import Any

from driven_reference import ROTOR
from driving import declared

from loomfmu import units
from loomfmu.components import COMPONENTS
from loomfmu.declaring.variables import Component

RPM = pi / 30.0
TURN = 2.0 * pi

SHAFT = {f"shaft_{name}": ("MainShaft", name) for name in ("angle", "velocity", "acceleration")}
FRAME = {name: ("HealdFrame", name) for name in ("lift", "velocity", "acceleration")}
# sources before sinks
WIRES: dict[str, dict[str, tuple[str, str]]] = {
    "MainShaft": {},
    "WeftInsertion": SHAFT,
    "BeltMonitor": SHAFT | {name: ("WeftInsertion", name) for name in ("travel", "velocity", "acceleration")},
    "WeftTension": SHAFT | {name: ("WeftInsertion", name) for name in ("travel", "velocity", "acceleration")},
    "DobbyDrive": SHAFT,
    "HealdFrame": {name: ("DobbyDrive", name) for name in ROTOR},
    "WarpTension": FRAME,
    "HealdDamper": FRAME | {"warp_force": ("WarpTension", "frame_load")},
    "PatternLock": SHAFT,
    "ReedBeatUp": SHAFT,
    "DetachingRoller": SHAFT,
}

# Parameters at a shaft that turns with 1 rad/s, chosen to stay within their limits when they are scaled
# to any speed from 0.001 to 5,000 rev/min
AT_ONE_RADIAN: dict[str, dict[str, Any]] = {
    "BeltMonitor": {"bending_stiffness": 1.5e-3, "head_mass": 1.0},
    "WeftTension": {  # air has a density of its own: without drag
        "linear_density": 2e-4,
        "yarn_stiffness": 10.0,
        "retardation_time": 1e-5,
        "air_friction": 0.0,
        "brake_force": 6e-4,
        "supply_tension": 1.5e-4,
    },
    "HealdFrame": {"frame_mass": 2.0, "gravity": 0.0, "pattern_length": 3},
    "WarpTension": {"pretension": 0.01, "thread_stiffness": 0.05, "creep_rate": 0.1, "relaxation_rate": 0.2},
    "HealdDamper": {
        "carrier_mass": 10.0,
        "spring_stiffness": 1.0,
        "stop_stiffness": 1e6,
        "pretension": 0.01,
        "thread_stiffness": 0.05,
        "creep_rate": 0.1,
        "relaxation_rate": 0.2,
    },
    "PatternLock": {"spring_force": 2.0, "spring_stiffness": 2e3},
    "DetachingRoller": {"nip_load": 0.5, "largest_drafting_force": 0.1},
}


def scale(unit: str, speed: float) -> float:
    """What a value of that unit is multiplied by on a loom that runs `speed` times as fast.

    Time is told in turns of the shaft, length as it is, and mass in a unit that shrinks with the root of
    the speed, so that neither masses nor forces leave their limits.
    """
    kilograms, _metres, seconds, *_others = units.unit(unit).dimension
    return float(fabs(speed) ** (-seconds - 0.5 * kilograms))


def at_speed(name: str, speed: float) -> dict[str, Any]:
    """Parameters of a component on a loom that runs at that speed: similar to that at 1 rad/s."""
    given: dict[str, Any] = {}
    for variable in declared(COMPONENTS[name]):
        if variable.causality == "parameter":
            value = AT_ONE_RADIAN.get(name, {}).get(variable.name, variable.start)
            given[variable.name] = value * scale(variable.unit, speed) if variable.type is float else value
    return given | {
        own: value for own, value in {"speed": speed, "inputs_at_step_end": True}.items() if own in given
    }


class WholeLoom:
    """One instance of each component. Followers of the shaft turn by themselves, or follow the main shaft."""

    def __init__(
        self, speed: float, *, follow: bool, time: float = 0.0, names: Iterable[str] = WIRES, **shaft: Any
    ) -> None:
        self.speed = speed
        self.parts: dict[str, Component] = {}
        for name in names:
            given = at_speed(name, speed)
            if any(variable.name == "follow_shaft" for variable in declared(COMPONENTS[name])):
                given["follow_shaft"] = follow
            self.parts[name] = COMPONENTS[name](**(given | (shaft if name == "MainShaft" else {})))
        for name, part in self.parts.items():
            self.wire(name)
            assert part.initialize(time) == 0, name

    def wire(self, name: str) -> None:
        for sink, (source, origin) in WIRES[name].items():
            if source in self.parts:
                setattr(self.parts[name], sink, getattr(self.parts[source], origin))

    def step(self, time: float, size: float) -> None:
        for name, part in self.parts.items():
            self.wire(name)
            problem = part.step(time, size)
            assert problem == 0 or part.problems[problem - 1].warning, (name, part.problems[problem - 1].text)

    def outputs(self) -> Iterator[tuple[str, str, Any]]:
        """Name, unit and value of every output; each one finite."""
        for name, part in self.parts.items():
            for variable in declared(type(part)):
                if variable.causality == "output":
                    value = getattr(part, variable.name)
                    assert isfinite(value), (name, variable.name)
                    yield f"{name}.{variable.name}", variable.unit, value
