"""The tables of a scene's text, and the simple values in them."""

import tomllib
from collections.abc import Iterator
from typing import Any

from ...errors import LoomfmuError, check_text, shown, suggestion

DEEPEST = 50  # tables and lists in one another
TOO_DEEP = f"its tables or lists are nested more than {DEEPEST} deep"
LONGEST_TEXT = 1_000_000  # characters of one text, such as a description


def toml(text: str) -> dict[str, Any]:
    """The tables of a scene's text. Raises LoomfmuError for what is not TOML, or no scene could hold."""
    try:
        tables = tomllib.loads(text)
    except RecursionError:
        raise LoomfmuError(TOO_DEEP) from None
    except tomllib.TOMLDecodeError as error:
        raise LoomfmuError(f"not valid TOML: {error}") from None
    except ValueError:  # what tomllib passes on from int() and from dates
        raise LoomfmuError("not valid TOML: a number has too many digits, or a date does not exist") from None
    for place, value in _texts(tables):
        check_text(value, place, LONGEST_TEXT)
    return tables


def _texts(tables: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """The texts among the values, with the keys that lead to them; the keys are checked on the way."""
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
