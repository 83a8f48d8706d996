"""The declarations of a component's variables, from which everything else is derived.

A component is a dataclass whose fields are made by `parameter`, `input_`, `output`, `state` and `auxiliary`,
or by `arrays.array` of these; the attributes of `variables.Variable` explain their arguments.
The model description, the FMU's state, the attributes of the traces, the variable tables of the
documentation, the checks of limits and the C struct all come from `variables_of(component)`.
"""

from dataclasses import field
from typing import Any

MAKERS = "parameter, input_, output, state, auxiliary or indicator"


def _declare(
    causality: str,
    variability: str,
    unit: str,
    start: float | int | bool,
    description: str,
    display: str | None,
    **rest: Any,
) -> Any:
    declared = {
        "causality": causality,
        "variability": variability,
        "unit": unit,
        "display": display or unit,
        "description": description,
        **rest,
    }
    return field(default=start, metadata=declared)


def parameter(
    unit: str,
    start: float | int | bool,
    description: str,
    *,
    display: str | None = None,
    minimum: float | None = None,
    maximum: float | None = None,
    nominal: float | None = None,
    choices: tuple[str, ...] = (),
    source: str | None = None,
    source_for: str | None = None,
    when: str | None = None,
    unless: str | None = None,
) -> Any:
    """A value that is set before a run and fixed during it."""
    if choices:
        minimum, maximum = 1, len(choices)
    return _declare(
        "parameter",
        "fixed",
        unit,
        start,
        description,
        display,
        minimum=minimum,
        maximum=maximum,
        nominal=nominal,
        choices=choices,
        source=source,
        source_for=source_for,
        when=when,
        unless=unless,
    )


def at_step_end() -> Any:
    """The parameter `inputs_at_step_end`, for the field of that name."""
    return parameter(
        "1", False, "Inputs are values at the end of the step (from a master that steps sources before sinks)"
    )


def input_(
    unit: str,
    start: float | int | bool,
    description: str,
    *,
    display: str | None = None,
    minimum: float | None = None,
    maximum: float | None = None,
    nominal: float | None = None,
    unbounded: bool = False,
    rate: str | None = None,
    source: str | None = None,
    source_for: str | None = None,
    when: str | None = None,
    unless: str | None = None,
) -> Any:
    """A value that comes from outside at every step; an integer or a boolean changes from step to step."""
    variability = "continuous" if isinstance(start, float) else "discrete"
    return _declare(
        "input",
        variability,
        unit,
        start,
        description,
        display,
        minimum=minimum,
        maximum=maximum,
        nominal=nominal,
        unbounded=unbounded,
        rate=rate,
        source=source,
        source_for=source_for,
        when=when,
        unless=unless,
    )


def output(
    unit: str,
    description: str,
    *,
    start: float | int | bool = 0.0,
    display: str | None = None,
    variability: str | None = None,
    nominal: float | None = None,
    unbounded: bool = False,
    rate: str | None = None,
    depends: tuple[str, ...] | None = None,
    follows: str | None = None,
    lowest_of: str | None = None,
    highest_of: str | None = None,
    so_far: bool = False,
    pole: bool = False,
    valid_if: str | None = None,
    error: str | None = None,
) -> Any:
    """A value that the component computes; integers and booleans are discrete by default."""
    usual = "continuous" if isinstance(start, float) else "discrete"
    return _declare(
        "output",
        variability or usual,
        unit,
        start,
        description,
        display,
        nominal=nominal,
        unbounded=unbounded,
        rate=rate,
        depends=(follows,) if follows else depends,
        follows=follows,
        lowest_of=lowest_of,
        highest_of=highest_of,
        so_far=so_far,
        pole=pole,
        valid_if=valid_if,
        error=error,
    )


def state(
    unit: str,
    description: str,
    *,
    start: float | int | bool = 0.0,
    minimum: float | None = None,
    maximum: float | None = None,
    carried: bool = True,
) -> Any:
    """A value that the component carries from one step to the next: its motion, a counter.

    Its limits are those that the component itself keeps to: a saved state beyond them is rejected.
    """
    variability = "continuous" if isinstance(start, float) else "discrete"
    return _declare(
        "local",
        variability,
        unit,
        start,
        description,
        None,
        minimum=minimum,
        maximum=maximum,
        carried=carried,
    )


def auxiliary(unit: str, description: str, **rest: Any) -> Any:
    """A `state` on whose past only extremes depend: it is computed once, or kept to find an extreme."""
    return state(unit, description, **rest, carried=False)


def indicator(unit: str, description: str) -> Any:
    """A value that changes its sign where an output jumps, so that a solver finds the instant."""
    return _declare("local", "continuous", unit, 0.0, description, None, indicator=True)
