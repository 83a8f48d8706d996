"""The tables of a scene's text, and its own keys: how long it runs, in which steps, what it records."""

import fnmatch
import math
import re
import tomllib
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ... import units
from ...errors import LoomfmuError, check_text, listed, shown, suggestion, within
from ...own.declared import ISOLATED
from .tolerances import tolerances_of

ACCURACY = "accuracy"  # which chooses the steps
MAY_END = "may_end"  # whether an FMU may end the run early
STEPS = "steps_per_revolution"
TIMES = ("revolutions", STEPS, "duration", "step")
# keys of the scene itself that can be set beside its times
WHOLE = (ACCURACY, "coupling", ISOLATED, MAY_END, "step_timeout", "run_timeout")
KEYS = (
    *("title", "description", *TIMES, *WHOLE, "record", "loom", "wires", "inputs", "units"),
    *("claims", "tolerances"),
)
LAGGED, ITERATED = COUPLINGS = ("lagged", "iterated")
MOST_STEPS = 1e9  # in a revolution
GONE = ("grid", "coarse_steps_per_revolution")  # keys that scenes once had
# what files are: the command that takes each kind, and keys that tell it from the others
KINDS = {
    "scene": ("run", {"revolutions", "duration", "record", "loom", "shaft", "wires", "inputs", "claims"}),
    "sweep": ("sweep", {"scene", "values", "sample", "sensitivity", "traces", "map"}),
    "study": ("optimize", {"scene", "maximise", "minimise", "ranges", "choices", "search"}),
}
DEEPEST = 50  # tables and lists in one another
TOO_DEEP = f"its tables or lists are nested more than {DEEPEST} deep"
LONGEST_TEXT = 1_000_000  # characters of one text, such as a description
SLOWEST = 1e-12  # rad/s: below, times overflow
ROUNDING = 1e-9  # of a duration: one that is off by more than that from whole steps is refused
Readers = Mapping[str, Callable[[Any, str], Any]]  # of the keys of a table
EXAMPLES = {"duration": "2 s", "step": "1 ms"}


def toml(text: str, kind: str = "") -> dict[str, Any]:
    """The tables of a file's text. Raises LoomfmuError for what is not TOML, or no scene could hold.

    A file that is plainly of another `kind` is refused, too, naming the command that takes it.
    """
    try:
        tables = tomllib.loads(text)
    except RecursionError:
        raise LoomfmuError(TOO_DEEP) from None
    except tomllib.TOMLDecodeError as error:
        if single := re.search(r"(?m)^[ \t]*\[(claims|cases)\]", text):
            line = text.count("\n", 0, single.start(1)) + 1
            raise LoomfmuError(f"{several(single[1])}; line {line} has [{single[1]}]") from None
        raise LoomfmuError(f"not valid TOML: {error}") from None
    except ValueError:  # what tomllib passes on from int() and from dates
        raise LoomfmuError("not valid TOML: a number has too many digits, or a date does not exist") from None
    for place, value in texts_in(tables):
        check_text(value, place, LONGEST_TEXT)
    if kind:
        _check_kind(tables, kind)
    return tables


def several(name: str) -> str:
    """Return the message on a table that is written as if there could be one alone."""
    return f"{name} are written as [[{name}]] tables, with two brackets"


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


def dotted(table: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    """A TOML table with its keys joined by dots, quoted or not."""
    flat: dict[str, Any] = {}
    for key, value in table.items():
        flat |= dotted(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value}
    return flat


def replaced(keys: Collection[str]) -> tuple[str, ...]:
    """The keys of a scene that give way to these: an accuracy replaces steps, and steps an accuracy."""
    return (STEPS,) if ACCURACY in keys else (ACCURACY,) if STEPS in keys else ()


def refuse_gone(key: str) -> None:
    """Refuse a key that scenes once had. Raises LoomfmuError, which says what to do instead."""
    if key in GONE:
        raise LoomfmuError(
            f"{key} is no longer a key: all steps are equal, and few suffice where claims are judged by the"
            f" mechanisms' own functions; remove it, or set {ACCURACY}"
        )


def _check_kind(tables: Mapping[str, Any], wanted: str) -> None:
    given = set(tables)
    marks = {kind: len(own & given) for kind, (_, own) in KINDS.items() if "scene" not in own - given}
    found = max(marks, key=lambda kind: marks[kind])
    if marks[found] > marks.get(wanted, 0):
        raise LoomfmuError(f"is a {found}, not a {wanted}; loomfmu {KINDS[found][0]} takes it")


@dataclass(frozen=True)
class Times:
    """A run of `periods`, each in `steps_per_period`: revolutions, or seconds if there is a `step`."""

    periods: float
    steps_per_period: float
    step: float | None = None


def settings_of(
    tables: dict[str, Any], name: str, outputs: Collection[str], speed: float | None
) -> dict[str, Any]:
    """Read the scene's own keys, as fields of a scene that is called so and has these outputs.

    `speed` is the shaft's, if there is one [rad/s]. The coupling is None where the tables do not say it.
    """
    times = _times(tables)
    check_times(times, speed)
    return {
        "periods": times.periods,
        "steps_per_period": times.steps_per_period,
        "step": times.step,
        "title": check_text(text(tables, "title", name), "title"),
        "description": text(tables, "description").strip(),
        "record": _recorded(tables.get("record", ["*"]), outputs),
        "claims": _claims(tables.get("claims", [])),
        "tolerances": tolerances_of(tables.get("tolerances", {})),
        "coupling": choice(tables, "coupling", COUPLINGS) if "coupling" in tables else None,
        "accuracy": _accuracy(tables, times),
        **{key: read(tables[key], key) for key, read in READERS.items() if key in tables},
    }


def _times(tables: dict[str, Any]) -> Times:
    """Duration and step as the tables of a scene say them. Raises LoomfmuError for a mixture of both ways."""
    given = [key for key in TIMES if key in tables]
    if not {"duration", "step"} & set(given):
        revolutions = number(tables.get("revolutions", 1), "revolutions", 1e-9, 1e9)
        asked = tables.get("steps_per_revolution", 1440)
        steps = number(asked, "steps_per_revolution", 1, MOST_STEPS, whole=True)
        return Times(revolutions, int(steps))
    if len(given) == 1:
        missing = "duration" if given == ["step"] else "step"
        raise LoomfmuError(
            f'{given[0]} is given but not {missing}: say {missing} = "{EXAMPLES[missing]}" as well'
        )
    if set(given) != {"duration", "step"}:
        raise LoomfmuError(
            f"{listed(given)}: a scene runs either by duration and step,"
            " or by revolutions and steps_per_revolution"
        )
    duration, step = (seconds(tables[key], key, 1e-12) for key in ("duration", "step"))
    return Times(duration, 1.0 / step, step)


def _accuracy(tables: dict[str, Any], times: Times) -> float | None:
    """The accuracy that chooses the steps. Raises LoomfmuError beside what it chooses, or without claims."""
    if ACCURACY not in tables:
        return None
    if STEPS in tables:
        raise LoomfmuError(f"{ACCURACY} and {STEPS} are both given: {ACCURACY} chooses the steps; remove one")
    if times.step is not None:
        raise LoomfmuError(
            f"{ACCURACY} chooses the steps in a revolution, but the scene runs by seconds; remove it"
        )
    if not tables.get("claims"):
        raise LoomfmuError(
            f"{ACCURACY} is that of the claims, but the scene has none:"
            " add [[claims]] or set steps_per_revolution"
        )
    return number(tables[ACCURACY], ACCURACY, 1e-12, 1.0)


def _recorded(patterns: Any, outputs: Collection[str]) -> list[str]:
    """Return the outputs that match one of the patterns, in the order of the scene."""
    if not isinstance(patterns, list):
        raise LoomfmuError(f'record = {shown(patterns)} is not a list such as ["belt.*", "weft.travel"]')
    wanted: set[str] = set()
    for pattern in map(str, patterns):
        matched = [pattern] if pattern in outputs else fnmatch.filter(outputs, pattern)
        if not matched and (outputs or pattern != "*"):
            raise LoomfmuError(f"record: no output is called {shown(pattern)}{suggestion(pattern, outputs)}")
        wanted.update(matched)
    return [output for output in outputs if output in wanted]


def _claims(tables: Any) -> list[dict[str, Any]]:
    """The tables of the claims."""
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise LoomfmuError(several("claims"))
    return tables


def check_times(times: Times, speed: float | None) -> None:
    """Refuse times that are not a whole number of steps; `speed` is the shaft's, if there is one [rad/s]."""
    steps = round(times.periods * times.steps_per_period)
    if times.step is not None:
        if steps < 1:
            raise LoomfmuError(
                f"duration = {times.periods:g} s in steps of {times.step:g} s is less than one step"
            )
        _check_whole(times, "duration", " s", f"{times.step:g} s")
        return
    if speed is None:
        raise LoomfmuError(
            'there is no shaft whose speed sets the step: add duration = "2 s" and step = "1 ms"'
        )
    if speed == 0.0:
        raise LoomfmuError("shaft.speed = 0 rev/min: the shaft's speed sets the step, so it must not be 0")
    if abs(speed) < SLOWEST:
        shown = f"{speed / units.unit('rev/min').factor:.7g} rev/min"
        raise LoomfmuError(
            f"shaft.speed = {shown}: one revolution would take {2.0 * math.pi / SLOWEST:.1g} s or more"
        )
    if steps < 1:
        raise LoomfmuError(
            f"revolutions = {times.periods:g} at {times.steps_per_period} steps each is less than one step"
        )
    _check_whole(times, "revolutions", "", f"1/{times.steps_per_period:g} revolution")


def _check_whole(times: Times, key: str, unit: str, step: str) -> None:
    """Refuse a duration that does not end with a step: the run would be shorter or longer."""
    wanted = times.periods * times.steps_per_period
    if abs(wanted - round(wanted)) > ROUNDING * wanted:
        fitting = [n / times.steps_per_period for n in (math.floor(wanted), math.ceil(wanted)) if n]
        raise LoomfmuError(
            f"{key} = {times.periods:.10g}{unit} is {wanted:.7g} steps of {step}, not a whole number of"
            f" steps; these would fit: {' or '.join(f'{each:.10g}{unit}' for each in fitting)}"
        )


# ---- values


def check_table(given: Any, where: str, known: Collection[str] | None = None) -> None:
    """Refuse what is no table, and its keys that are not known, if these are given."""
    if not isinstance(given, dict):
        raise LoomfmuError(f"{where} must be a table")
    for key in given:
        if known is not None and key not in known:
            raise LoomfmuError(f"{where}.{key} is unknown{suggestion(key, known)}")


def read_table(given: Any, where: str, readers: Readers) -> dict[str, Any]:
    """Read the keys of a table, each by its own reader, which takes a value and the words for its place."""
    check_table(given, where, readers)
    return {key: readers[key](value, f"{where}.{key}") for key, value in given.items()}


def text(tables: dict[str, Any], key: str, default: str = "") -> str:
    """A text."""
    given = tables.get(key, default)
    if not isinstance(given, str):
        raise LoomfmuError(f"{key} = {shown(given)} is not a text in quotes")
    return given


def choice(tables: dict[str, Any], key: str, known: tuple[str, ...]) -> str:
    """One of some words; the first one by default."""
    given = tables.get(key, known[0])
    if given not in known:
        raise LoomfmuError(f"{key} = {shown(given)} is unknown{suggestion(str(given), known)}")
    return str(given)


def number(given: Any, where: str, low: float, high: float, whole: bool = False) -> float:
    """A plain number within bounds."""
    try:
        value = float(given if not isinstance(given, bool) else "")
    except (TypeError, ValueError):
        raise LoomfmuError(f"{where} = {shown(given)} is not a number") from None
    except OverflowError:
        raise LoomfmuError(f"{where} = {shown(given)} is outside [{low:g}, {high:g}]") from None
    if not low <= value <= high:
        raise LoomfmuError(f"{where} = {value:g} is outside [{low:g}, {high:g}]")
    if whole and value != int(value):
        raise LoomfmuError(f"{where} = {value:g} is not a whole number")
    return value


def truth(given: Any, where: str) -> bool:
    """A truth value as people write it."""
    if str(given).lower() not in ("true", "false"):
        raise LoomfmuError(f"{where} = {given!r} must be true or false")
    return str(given).lower() == "true"


def seconds(given: Any, key: str, low: float) -> float:
    """A time within bounds [s]."""
    with within(key):
        return number(units.parse(given, "s"), key, low, 1e9)


# the keys that say one thing each, and how they are read; a scene has their defaults
READERS: Readers = {
    ISOLATED: truth,
    MAY_END: truth,
    "step_timeout": lambda given, key: seconds(given, key, 1e-3),
    "run_timeout": lambda given, key: seconds(given, key, 1e-3),
}
