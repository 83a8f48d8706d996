"""The loom that a scene need not spell out: its instances and their components."""

from pathlib import Path
from typing import Any

from ..errors import LoomfmuError, shown, suggestion
from . import weave as weaves
from .lifted import PICKS_IN_A_WORD, WORDS

COMPONENT_OF = {
    "shaft": "MainShaft",
    "weft": "WeftInsertion",
    "belt": "BeltMonitor",
    "belt_motion": "BeltDynamics",
    "yarn": "WeftTension",
    "transfer": "WeftTransfer",
    "dobby": "DobbyDrive",
    "heald": "HealdFrame",
    "damper": "HealdDamper",
    "warp": "WarpTension",
    "play": "HealdPlay",
    "reed": "ReedBeatUp",
    "lock": "PatternLock",
    "wrap": "BeltWrap",
    "roller": "DetachingRoller",
}

# kind of terminal -> the instances whose outputs it carries, the first one that the scene has; # is the
# number of the instance that follows it. Where a frame has a damper, what it lifts hangs on the carrier.
SOURCES = {
    "shaft": ("shaft",),
    "head": ("weft_#", "weft"),
    "rotor": ("dobby",),
    "frame": ("damper_#", "heald_#"),
}

FRAME_FITTINGS = {"warps": "warp", "dampers": "damper", "play": "play"}  # one for each frame
LOOM_FITTINGS = {"yarn": "yarn", "reed": "reed", "locks": "lock"}  # one for the loom
RAPIER_FITTINGS = {"belt_motion": "belt_motion"}  # one for each rapier
FITTINGS = (*FRAME_FITTINGS, *LOOM_FITTINGS, *RAPIER_FITTINGS)
# what a mechanism is fitted to, by the number that both have
FITTED_TO = {
    **dict.fromkeys(FRAME_FITTINGS.values(), "heald"),
    "belt": "weft",
    "belt_motion": "weft",
    "weft": "belt",
}
LOOM_KEYS = ("machine", "head", "taker_head", "both_rapiers", "weave", *FITTINGS)


def instances_of(table: dict[str, Any], directory: Path) -> dict[str, dict[str, Any]]:
    """Instances of a standard loom, each with the keys that a scene would give it.

    `machine` and `head` name published ones, `weave` is one string of pegs for each frame
    (`"10/01"` or a list) or the name of a WIF file. `both_rapiers` adds the taker, whose head is `head`
    unless there is a `taker_head`, and the transfer. `dampers` hangs each frame's carrier on springs,
    `warps` loads it with its threads, `play` adds the blows of its healds. `yarn`, `reed`, `locks` and
    `belt_motion` add the weft, beat-up, pattern locks and the deflection of the belt.
    """
    for key in table:
        if key not in LOOM_KEYS:
            raise LoomfmuError(f"loom.{key} is unknown{suggestion(key, LOOM_KEYS)}")
    frames = weaves.parse(table["weave"], directory).pegs if "weave" in table else ()
    instances: dict[str, dict[str, Any]] = {"shaft": {}, **_rapiers(table)}
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
    for key, name in RAPIER_FITTINGS.items():
        if _wanted(table, key):
            instances |= {each.replace("weft", name): {} for each in ("weft", "weft_2") if each in instances}
    return instances


def _rapiers(table: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """The rapier that brings the weft and, with `both_rapiers`, the one that takes it, and their transfer."""
    machine = {key: table[key] for key in ("machine",) if key in table}
    giver = machine | {key: table[key] for key in ("head",) if key in table}
    rapiers: dict[str, dict[str, Any]] = {"weft": giver, "belt": giver}
    taker = giver | ({"head": table["taker_head"]} if "taker_head" in table else {})
    if _wanted(table, "both_rapiers"):
        return rapiers | {"weft_2": taker, "belt_2": taker | {"taker": True}, "transfer": machine}
    if "taker_head" in table:
        raise LoomfmuError("loom.taker_head needs the second rapier: set loom.both_rapiers = true")
    return rapiers


def resolve(tables: dict[str, Any], directory: Path) -> dict[str, str]:
    """Put the pegs of a WIF file in the place of its name; the texts of such files, as they were read."""
    table = tables.get("loom")
    if not isinstance(table, dict) or not weaves.is_wif(table.get("weave")):
        return {}
    given = table["weave"]
    path = directory / given
    text = weaves.wif_text(path)
    tables["loom"] = table | {"weave": list(weaves.of_wif(text, path).pegs)}
    return {given: text}


def _wanted(table: dict[str, Any], key: str) -> bool:
    wanted = table.get(key, False)
    if not isinstance(wanted, bool):
        raise LoomfmuError(f"loom.{key} = {shown(wanted)} must be true or false")
    return wanted


def pattern(pegs: Any, where: str) -> dict[str, int]:
    """Parameters of a heald frame for a string of pegs, the first pick first: 1 raised, 0 lowered.

    >>> pattern("10", "heald_1.pattern")["pattern_1"]
    1
    """
    pegs = weaves.check_pegs(pegs, where)
    values = {"pattern_length": len(pegs)}
    for number, word in enumerate(WORDS):
        part = pegs[number * PICKS_IN_A_WORD : (number + 1) * PICKS_IN_A_WORD]
        values[word] = int(part[::-1] or "0", 2)
    return values
