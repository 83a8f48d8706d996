"""Calls named in the tables of the report, such as `belt.limit WL680-3400 mu=0.8`.

A name is that of a function in `validation.computed` or else in `loomfmu`; `->` takes one of several results,
by its name or its number. An argument is a number, a quantity such as `12deg`, which becomes SI, or a text;
`name=argument` is passed by name. Blanks or commas are between arguments. `1 - 0.5 / 2` is arithmetic.
"""

import csv
import re
import shlex
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from itertools import product
from pathlib import Path
from typing import Any

from loomfmu import machines, units
from validation.digits import number, small

HERE = Path(__file__).parent
FACTORS = {"m/min": 1.0 / 60.0, "mm/s": 1e-3, "mm/s2": 1e-3, "mm/s3": 1e-3, "1e-6 kg.m2": 1e-6}
_NUMBER = re.compile(r"([-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?)([a-zA-Z/%.0-9]*)")
_INNERMOST = re.compile(r"\{([^{}]+)\}")


def table(name: str) -> list[dict[str, str]]:
    """Rows of a table beside this file, or of one of the package's published data."""
    own = HERE / "tables" / f"{name}.csv"
    if not own.exists():
        return machines.table(name)
    with own.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def function(name: str) -> Any:
    """The function, or the constant, of that name."""
    module, _, attribute = name.rpartition(".")
    own = f"validation.computed.{module}"
    inside = "." not in module and find_spec(own)
    return getattr(import_module(own if inside else f"loomfmu.{module}"), attribute)


def argument(text: str) -> float | str:
    """A number or a quantity in SI, or else the text itself.

    >>> argument("0.5"), argument("2.5mm"), argument("WL680-3400")
    (0.5, 0.0025, 'WL680-3400')
    """
    match = _NUMBER.fullmatch(text)
    return float(match[1]) * factor(match[2]) if match else text


def factor(unit: str) -> float:
    """The factor from a unit to SI."""
    return FACTORS[unit] if unit in FACTORS else units.unit(unit).factor


def arguments(text: str) -> tuple[list[Any], dict[str, Any]]:
    """The arguments in a text: those in order, and those by name."""
    words = shlex.shlex(text, posix=True)
    words.whitespace, words.whitespace_split, words.commenters = " ,", True, ""
    given = [word.partition("=") for word in words]
    named = {name: argument(of) for name, equals, of in given if equals}
    return [argument(name) for name, equals, _of in given if not equals], named


@cache
def value(call: str) -> Any:
    """Result of a call, made once, or of arithmetic between numbers."""
    if not call[0].isalpha():
        numbers = _NUMBER.sub(lambda found: repr(argument(found[0])), call)
        return eval(numbers, {"__builtins__": {}})  # what a call has computed is a number in it
    path, _, given = call.partition(" ")
    name, _, part = path.partition("->")
    found = function(name)
    if callable(found):
        ordered, named = arguments(given)
        found = found(*ordered, **named)
    if part:
        return found[int(part)] if part.isdecimal() else getattr(found, part)
    return found


def shown(found: Any, unit: str = "", digits: str = "") -> str:
    """A result as the report shows it: texts as they are, numbers in their unit.

    `digits` is a count of decimals, with `+` before it for a sign, or `<` and a floor for a small error.
    """
    if isinstance(found, str):
        return found
    if not digits:
        return repr(found)
    if digits[0] == "<":
        return small(found / factor(unit), float(digits[1:]))
    return number(found / factor(unit), int(digits), sign=digits[0] == "+")


def filled(text: str, row: dict[str, str] | None = None) -> str:
    """A text with each `{column}` of a row and each `{call | unit | digits}` replaced, inner ones first."""

    def found(match: re.Match[str]) -> str:
        if row and match[1] in row:
            return str(row[match[1]])
        call, *form = (part.strip() for part in match[1].split("|"))
        return shown(value(call), *(["", *form] if len(form) == 1 else form))

    before = ""
    while before != text:
        before, text = text, _INNERMOST.sub(found, text)
    return text


def combined(each: dict[str, list[Any]] | list[dict[str, list[Any]]]) -> list[dict[str, str]]:
    """All combinations of values of some columns, one set of them after the other.

    A value may set several columns, and the name of a table stands for its rows.
    """
    if isinstance(each, list):
        return [row for some in each for row in combined(some)]
    lists = [(name, table(values) if isinstance(values, str) else values) for name, values in each.items()]
    named = [[v if isinstance(v, dict) else {name: v} for v in values] for name, values in lists]
    return [{k: v for part in parts for k, v in part.items()} for parts in product(*named)]


def rows(given: dict[str, Any], row: dict[str, str] | None = None) -> list[dict[str, str]]:
    """Rows that a section or a curve names: combinations of `each`, or those of a `table`.

    `where` has the values that some of its columns may take, with | between them; a `row` fills them in.
    """
    if "table" not in given:
        return combined(given.get("each", {}))
    wanted = {column: filled(values, row).split("|") for column, values in given.get("where", {}).items()}
    return [each for each in table(given["table"]) if all(each[name] in of for name, of in wanted.items())]
