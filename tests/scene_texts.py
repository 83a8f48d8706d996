"""Scenes from parts of their text, and the verdicts on them."""

import json
from pathlib import Path
from typing import Any

from loomfmu import Verdict, evaluate
from loomfmu.cosim.scenes.scene import Scene, parse

LOOM = '[loom]\nmachine = "WL680-3600"\nhead = "G6300 left"\n'
MOTION = ("angle", "velocity", "acceleration")  # of a shaft
HEAD = ("travel", "velocity", "acceleration")  # of a rapier


def loom(*parts: str) -> str:
    """The text of a loom: keys of its own table come before other tables, however they are given."""
    return LOOM + "".join(sorted(parts, key=lambda part: part.startswith("[")))


def table(name: str, /, **values: Any) -> str:
    """A table of a scene; texts, numbers, truth values and lists are written in TOML as in JSON."""
    return f"[{name}]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in values.items())


def claim(kind: str, /, **arguments: Any) -> str:
    return table("[claims]", kind=kind, **arguments)


SAFE = claim("above", name="safe", signal="belt.lowest_speed_limit", bound="shaft.speed")


def wires(**sources: Any) -> str:
    """Lines of [wires]; __ in a name stands for the dot."""
    return "".join(
        f'"{sink.replace("__", ".")}" = {json.dumps(source)}\n' for sink, source in sources.items()
    )


def parsed(*parts: str, directory: Path = Path(), **values: Any) -> Scene:
    """The scene of these parts of a text, with other values; __ in a name stands for the dot."""
    overrides = {name.replace("__", "."): value for name, value in values.items()}
    return parse("".join(parts), "scene", overrides, directory)


def verdicts(*parts: str, directory: Path = Path(), **values: Any) -> tuple[Verdict, ...]:
    return evaluate(parsed(*parts, directory=directory, **values)).claims


def unsolved(first: float, last: float) -> str:
    """A loop that has no solution while the yarn's tension rises, between these revolutions."""
    return (
        'coupling = "iterated"\nsteps_per_revolution = 90\nrecord = ["belt.margin"]\n'
        '[loom]\nmachine = "WL680-3600"\nweave = "10"\ndampers = true\n'
        # the carrier has the head's own mass: the belt's force would have to be 5 N more than it is
        + table("damper_1", damping_ratio=0.0, spring_stiffness=0.0, carrier_mass=0.1105)
        + "[wires]\n"
        + wires(belt__acceleration="damper_1.carrier_acceleration", damper_1__warp_force="belt.axial_force")
        + "[inputs]\n"
        + wires(belt__yarn_tension=[[0, 0], [first, 0], [last, "5 N"]])
    )
