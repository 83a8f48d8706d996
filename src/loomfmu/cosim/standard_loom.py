"""The loom that a scene need not spell out: its instances, their components and their wiring."""

import re
from pathlib import Path
from typing import Any

from .. import weave as weaves
from ..errors import LoomfmuError, suggestion

COMPONENT_OF = {
    "shaft": "MainShaft",
    "weft": "WeftInsertion",
    "belt": "BeltMonitor",
    "dobby": "DobbyDrive",
    "heald": "HealdFrame",
    "damper": "HealdDamper",
    "warp": "WarpTension",
    "reed": "ReedBeatUp",
    "lock": "PatternLock",
    "wrap": "BeltWrap",
    "roller": "DetachingRoller",
}

# input of a mechanism on the shaft -> output of the shaft that it follows
FOLLOWED = {
    "shaft_angle": "angle",
    "shaft_velocity": "velocity",
    "shaft_acceleration": "acceleration",
}
_SHAFT = {sink: f"shaft.{variable}" for sink, variable in FOLLOWED.items()}

# component -> input -> output it is wired to if that instance is there; # is the instance's own number
WIRES = {
    "DrivenShaft": {"torque_1": "weft.shaft_torque", "torque_2": "reed.shaft_torque"},
    "WeftInsertion": _SHAFT,
    "DobbyDrive": _SHAFT,
    "BeltMonitor": _SHAFT
    | {"travel": "weft.travel", "velocity": "weft.velocity", "acceleration": "weft.acceleration"},
    "HealdFrame": {
        "rotor_angle": "dobby.rotor_angle",
        "rotor_velocity": "dobby.rotor_velocity",
        "rotor_acceleration": "dobby.rotor_acceleration",
        "lift_fraction": "dobby.lift_fraction",
        "lift_rate": "dobby.lift_rate",
        "lift_acceleration": "dobby.lift_acceleration",
    },
    "HealdDamper": {
        "lift": "heald_#.lift",
        "velocity": "heald_#.velocity",
        "acceleration": "heald_#.acceleration",
        "warp_force": "warp_#.frame_load",
    },
    "WarpTension": {
        "lift": "heald_#.lift",
        "velocity": "heald_#.velocity",
        "acceleration": "heald_#.acceleration",
    },
    "ReedBeatUp": _SHAFT,
    "PatternLock": _SHAFT,
    "DetachingRoller": _SHAFT,
}

FRAME_FITTINGS = {"warps": "warp", "dampers": "damper"}  # one for each frame
LOOM_FITTINGS = {"reed": "reed", "locks": "lock"}  # one for the loom
LOOM_KEYS = ("machine", "head", "weave", *FRAME_FITTINGS, *LOOM_FITTINGS)
PICKS_IN_A_WORD = 16


def stem(instance: str) -> str:
    """An instance's name without its number: `heald_3` is a `heald`."""
    return re.sub(r"_\d+$", "", instance)


def loom(table: dict[str, Any], directory: Path) -> dict[str, dict[str, Any]]:
    """Instances of a standard loom, each with the keys that a scene would give it.

    `machine` and `head` name published ones, `weave` is one string of pegs for each frame
    (`"10/01"` or a list) or the name of a WIF file. `dampers` hangs each frame's carrier on springs,
    `warps` loads it with its threads, `reed` and `locks` add beat-up and pattern locks.
    """
    for key in table:
        if key not in LOOM_KEYS:
            raise LoomfmuError(f"loom.{key} is unknown{suggestion(key, LOOM_KEYS)}")
    frames = weaves.parse(table["weave"], directory).pegs if "weave" in table else ()
    machine = {key: table[key] for key in ("machine",) if key in table}
    head = {key: table[key] for key in ("head",) if key in table}
    instances: dict[str, dict[str, Any]] = {"shaft": {}, "weft": machine | head, "belt": machine | head}
    if frames:
        instances["dobby"] = {}
    for number, pegs in enumerate(frames, start=1):
        instances[f"heald_{number}"] = {"pattern": pegs}
    for key, name in FRAME_FITTINGS.items():
        if _wanted(table, key):
            instances |= {f"{name}_{number}": {} for number in range(1, len(frames) + 1)}
    for key, name in LOOM_FITTINGS.items():
        if _wanted(table, key):
            instances[name] = {}
    return instances


def _wanted(table: dict[str, Any], key: str) -> bool:
    wanted = table.get(key, False)
    if not isinstance(wanted, bool):
        raise LoomfmuError(f"loom.{key} = {wanted!r} is neither true nor false")
    return wanted


def pattern(pegs: Any, where: str) -> dict[str, int]:
    """Parameters of a heald frame for a string of pegs, the first pick first: 1 raised, 0 lowered.

    >>> pattern("10", "heald_1.pattern")["pattern_1"]
    1
    """
    pegs = weaves.check_pegs(pegs, where)
    values = {"pattern_length": len(pegs)}
    for word in range(weaves.MOST_PICKS // PICKS_IN_A_WORD):
        part = pegs[word * PICKS_IN_A_WORD : (word + 1) * PICKS_IN_A_WORD]
        values[f"pattern_{word + 1}"] = int(part[::-1] or "0", 2)
    return values


def wires(instance: str, component: str) -> dict[str, str]:
    """Where the inputs of an instance are wired to in a standard loom."""
    number = instance.removeprefix(stem(instance))
    return {name: source.replace("_#", number) for name, source in WIRES.get(component, {}).items()}
