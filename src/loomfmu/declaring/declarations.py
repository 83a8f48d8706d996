"""The declarations of a component's variables, from which everything else is derived.

A component is a dataclass whose fields are made by `parameter`, `input_`, `output`, `state` and `auxiliary`,
or by `arrays.array` of these; the attributes of `variables.Variable` explain their arguments.
The model description, the FMU's state, the attributes of the traces, the variable tables of the
documentation, the checks of limits and the C struct all come from `variables_of(component)`.
"""

from dataclasses import dataclass, field, replace
from typing import Any

MAKERS = "parameter, input_, output, state, auxiliary or indicator"


@dataclass(frozen=True)
class Quantity:
    """The facts that variables of a kind share; a declaration takes it in the place of its unit.

    Limits count for what is set, not for outputs. What a declaration states itself goes before.
    """

    unit: str
    display: str | None = None
    minimum: float | None = None
    maximum: float | None = None
    nominal: float | None = None

    def within(self, minimum: float, maximum: float, nominal: float | None = None) -> "Quantity":
        """This quantity between two limits, in SI."""
        return replace(self, minimum=minimum, maximum=maximum, nominal=nominal or self.nominal)


Unit = str | Quantity


def _declared(causality: str, variability: str, start: float | int | bool, **rest: Any) -> Any:
    """The field of a variable; `rest` are the arguments of its declaration under their own names."""
    kind = rest["unit"] if isinstance(rest["unit"], Quantity) else Quantity(rest["unit"])
    rest |= {name: value for name, value in vars(kind).items() if rest.get(name, ...) is None}
    rest |= {"causality": causality, "variability": variability, "unit": kind.unit}
    rest["display"] = rest.get("display") or kind.unit
    return field(default=start, metadata=rest)


def _usual(start: float | int | bool) -> str:
    return "continuous" if isinstance(start, float) else "discrete"


def parameter(
    unit: Unit,
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
    return _declared(causality="parameter", variability="fixed", **locals())


def at_step_end() -> Any:
    """The parameter `inputs_at_step_end`, for the field of that name."""
    return parameter(
        "1", False, "Inputs are values at the end of the step (from a master that steps sources before sinks)"
    )


def input_(
    unit: Unit,
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
    return _declared(causality="input", variability=_usual(start), **locals())


def output(
    unit: Unit,
    description: str,
    *,
    start: float | int | bool = 0.0,
    display: str | None = None,
    variability: str | None = None,
    nominal: float | None = None,
    unbounded: bool = False,
    rate: str | None = None,
    constant: bool = False,
    follows: str | None = None,
    lowest_of: str | None = None,
    highest_of: str | None = None,
    so_far: bool = False,
    brief: bool = False,
    valid_if: str | None = None,
    error: str | None = None,
) -> Any:
    """A value that the component computes; integers and booleans are discrete by default."""
    variability = variability or _usual(start)
    return _declared(causality="output", **locals())


def state(
    unit: Unit,
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
    return _declared(causality="local", variability=_usual(start), **locals())


def auxiliary(unit: Unit, description: str, **rest: Any) -> Any:
    """A `state` on whose past only extremes depend: it is computed once, or kept to find an extreme."""
    return state(unit, description, **rest, carried=False)


def indicator(unit: str, description: str) -> Any:
    """A value that changes its sign where an output jumps, so that a solver finds the instant."""
    return _declared(causality="local", variability="continuous", start=0.0, indicator=True, **locals())
