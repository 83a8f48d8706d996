"""The keys of a scene: its own, and what its instances may be called."""

import re
from collections.abc import Collection, Iterable, Mapping
from typing import Any

from ...errors import LONGEST_NAME, LoomfmuError, shown
from ...own.declared import ISOLATED

COARSE = "coarse_steps_per_revolution"
ACCURACY = "accuracy"  # which chooses the steps
MAY_END = "may_end"  # whether an FMU may end the run early
TIMES = ("revolutions", "steps_per_revolution", "duration", "step")
# keys of the scene itself that can be set beside its times
WHOLE = (ACCURACY, "grid", COARSE, "coupling", ISOLATED, MAY_END, "step_timeout", "run_timeout")
KEYS = ("title", "description", *TIMES, *WHOLE, "record", "loom", "wires", "inputs", "claims", "tolerances")
LAGGED, ITERATED = COUPLINGS = ("lagged", "iterated")
UNIFORM, WINDOWS = GRIDS = ("uniform", "windows")
CHOSEN = ("steps_per_revolution", "grid", COARSE)  # what an accuracy chooses
# what files are: the command that takes each kind, and keys that tell it from the others
KINDS = {
    "scene": ("run", {"revolutions", "duration", "record", "loom", "shaft", "wires", "inputs", "claims"}),
    "sweep": ("sweep", {"scene", "values", "sample", "sensitivity", "traces", "map"}),
    "study": ("optimize", {"scene", "maximise", "minimise", "ranges", "choices", "search"}),
}
NAME = re.compile("[A-Za-z][A-Za-z0-9_]*")
TAKEN = ("time", "shaft_angle")  # what a trace has beside its instances


def replaced(keys: Collection[str]) -> tuple[str, ...]:
    """The keys of a scene that give way to these: an accuracy replaces steps, and steps an accuracy."""
    if ACCURACY in keys:
        return CHOSEN
    return (ACCURACY,) if any(key in keys for key in CHOSEN) else ()


def check_kind(tables: Mapping[str, Any], wanted: str) -> None:
    """Refuse the tables of a file that is plainly of another kind, and name the command that takes it."""
    given = set(tables)
    marks = {kind: len(own & given) for kind, (_, own) in KINDS.items() if "scene" not in own - given}
    found = max(marks, key=lambda kind: marks[kind])
    if marks[found] > marks.get(wanted, 0):
        raise LoomfmuError(f"is a {found}, not a {wanted}; loomfmu {KINDS[found][0]} takes it")


def check_name(name: str) -> None:
    """Refuse what cannot be the name of an instance."""
    if not NAME.fullmatch(name):
        raise LoomfmuError(f"instance name {shown(name)} must be letters, digits and _, with a letter first")
    if len(name) > LONGEST_NAME:
        raise LoomfmuError(f"instance name {shown(name)} has {len(name)} characters; at most {LONGEST_NAME}")
    if name in TAKEN:
        raise LoomfmuError(f"instance name {name!r} is taken: every trace has a {name} of its own")


def stem(instance: str) -> str:
    """An instance's name without its number: `heald_3` is a `heald`."""
    return re.sub(r"_\d+$", "", instance)


def is_numbered(instance: str) -> bool:
    """Return whether an instance's name ends with a number, as `heald_3` does."""
    return stem(instance) != instance


def members(key: str, given: Iterable[str]) -> list[str]:
    """The numbered instances that a name without number stands for."""
    if key in given:
        return []
    return [name for name in given if stem(name) == key]
