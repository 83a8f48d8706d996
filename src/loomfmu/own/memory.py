"""A test, by its outputs, for a component that remembers more between steps than extremes."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

from ..declaring.variables import AT_STEP_END, Component, variables_of

STEPS = 24
MOST_LINES = 1_000_000  # that the steps may execute: an endless loop must not hang the loading
STEP_SIZE = 0.013  # s: no simple part of a revolution at usual speeds


def carrying(component: type[Component]) -> str:
    """The first output, other than extremes, that differs if an instance starts just before the last step.

    Empty if there is none, or if the component does not run that far with its defaults.
    """
    try:
        with _bounded():
            used, fresh = _run(component, 0), _run(component, STEPS - 1)
    except Exception:  # whatever its code raises: a run reports it
        return ""
    for variable in variables_of(component):
        held = variable.causality != "output" or variable.lowest_of or variable.highest_of
        # the same operations on the same numbers: no tolerance, and NaN is NaN
        if not held and repr(getattr(used, variable.name)) != repr(getattr(fresh, variable.name)):
            return variable.name
    return ""


@contextmanager
def _bounded() -> Iterator[None]:
    """Raise TimeoutError in code that executes too many lines."""
    left = MOST_LINES

    def count(_frame: FrameType, event: str, _argument: Any) -> Any:
        nonlocal left
        left -= event == "line"
        if left < 0:
            raise TimeoutError
        return count

    before = sys.gettrace()
    sys.settrace(count)
    try:
        yield
    finally:
        sys.settrace(before)


def _run(component: type[Component], first: int) -> Component:
    """An instance that starts before a step and has taken all that follow."""
    at_step_end = any(variable.name == AT_STEP_END for variable in variables_of(component))
    running = component(**({AT_STEP_END: True} if at_step_end else {}))
    running.initialize(first * STEP_SIZE)
    for step in range(first, STEPS):
        running.step(step * STEP_SIZE, STEP_SIZE)
    return running
