"""The tables of a scene's text and their keys: its own, and the names that its instances may have."""

import re
import tomllib
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

from ...errors import LONGEST_NAME, LoomfmuError, check_text, shown
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
DEEPEST = 50  # tables and lists in one another
TOO_DEEP = f"its tables or lists are nested more than {DEEPEST} deep"
LONGEST_TEXT = 1_000_000  # characters of one text, such as a description


def toml(text: str, kind: str = "") -> dict[str, Any]:
    """The tables of a file's text. Raises LoomfmuError for what is not TOML, or no scene could hold.

    A file that is plainly of another `kind` is refused, too, naming the command that takes it.
    """
    try:
        tables = tomllib.loads(text)
    except RecursionError:
        raise LoomfmuError(TOO_DEEP) from None
    except tomllib.TOMLDecodeError as error:
        raise LoomfmuError(f"not valid TOML: {error}") from None
    except ValueError:  # what tomllib passes on from int() and from dates
        raise LoomfmuError("not valid TOML: a number has too many digits, or a date does not exist") from None
    for place, value in texts_in(tables):
        check_text(value, place, LONGEST_TEXT)
    if kind:
        _check_kind(tables, kind)
    return tables


def texts_in(tables: Any) -> Iterator[tuple[str, str]]:
    """The texts in tables and lists, with the keys that lead to them; the keys are checked on the way."""
    level: list[tuple[str, Any]] = [("", tables)]
    for _ in range(DEEPEST):
        below: list[tuple[str, Any]] = []
        for place, value in level:
            if isinstance(value, str):
                yield place, value
            elif isinstance(value, list):
                below += [(place, each) for each in value]
            elif isinstance(value, dict):
                for key, each in value.items():
                    check_text(key, "a key")
                    below.append((f"{place}.{key}" if place else key, each))
        level = below
    if level:
        raise LoomfmuError(TOO_DEEP)


def replaced(keys: Collection[str]) -> tuple[str, ...]:
    """The keys of a scene that give way to these: an accuracy replaces steps, and steps an accuracy."""
    if ACCURACY in keys:
        return CHOSEN
    return (ACCURACY,) if any(key in keys for key in CHOSEN) else ()


def _check_kind(tables: Mapping[str, Any], wanted: str) -> None:
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
