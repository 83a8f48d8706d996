"""Rules: what is computed of the signals of a run, as data that the script of a page evaluates, too.

A rule is the name of a signal or of a parameter, a number, or an operation followed by its operands.
The script is `page/live_rules.js`.
"""

from collections.abc import Callable
from functools import reduce
from typing import Any

import numpy as np

Rule = str | float | list[Any]

OPERATIONS: dict[str, Callable[..., Any]] = {
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "abs": np.abs,
    "min": lambda *values: reduce(np.minimum, values),
    "max": lambda *values: reduce(np.maximum, values),
    "lowest": lambda *values: min(float(np.min(each)) for each in values),
    "highest": lambda *values: max(float(np.max(each)) for each in values),
    "if positive": lambda value, one, other: np.where(value > 0.0, one, other),
}
TABLE = (
    "table"  # straight lines between the points of a table: a rule, its ascending values, what it has there
)


def evaluated(rule: Rule, of: Callable[[str], Any]) -> Any:
    """The value of a rule; `of` gives those of names.

    >>> evaluated(["-", "x", ["lowest", "x"]], {"x": np.array([1.0, 3.0])}.__getitem__).tolist()
    [0.0, 2.0]
    >>> float(evaluated(["table", "x", [0.0, 2.0], [5.0, 6.0]], {"x": 1.0}.__getitem__))
    5.5
    """
    if isinstance(rule, str):
        return of(rule)
    if not isinstance(rule, list):
        return rule
    operation, *operands = rule
    if operation == TABLE:
        return np.interp(evaluated(operands[0], of), *operands[1:])
    with np.errstate(invalid="ignore", divide="ignore"):  # what does not move has no share of its range
        return OPERATIONS[operation](*(evaluated(each, of) for each in operands))


def mm(rule: Rule) -> Rule:
    """A length in mm."""
    return ["*", 1000.0, rule]
