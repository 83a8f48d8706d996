"""What drives any component in a test, from its declaration alone."""

import functools
import itertools
import random
from collections.abc import Iterator
from typing import Any

from loomfmu.components import DobbyDrive
from loomfmu.declaring.variables import Component, Variable, variables_of

declared = functools.cache(variables_of)  # a declaration does not change, and tests ask for it all the time
# the number of each rotor law
LAWS = {
    name: number
    for law in declared(DobbyDrive)
    if law.name == "law"
    for number, name in enumerate(law.choices, start=1)
}


def inputs(component: type[Component]) -> list[Variable]:
    return [variable for variable in declared(component) if variable.causality == "input"]


def flags(component: type[Component]) -> Iterator[dict[str, bool]]:
    """Every combination of the component's yes-or-no parameters, those of an array all alike."""
    groups: dict[str, list[str]] = {}
    for variable in declared(component):
        if variable.settable and variable.type is bool:
            groups.setdefault(variable.element.partition("[")[0] or variable.name, []).append(variable.name)
    for values in itertools.product((False, True), repeat=len(groups)):
        chosen = zip(groups.values(), values, strict=True)
        yield {name: value for names, value in chosen for name in names}


def values(component: Component, causality: str | None = None) -> dict[str, Any]:
    """Values of all variables, or of those of one causality."""
    return {
        variable.name: getattr(component, variable.name)
        for variable in declared(type(component))
        if causality in (None, variable.causality)
    }


def assign(component: Any, given: dict[str, Any]) -> None:
    for name, value in given.items():
        setattr(component, name, value)


def span(variable: Variable) -> tuple[float, float]:
    """Where a variable usually lies: within three times its nominal value of its start, and its limits."""
    reach = 3.0 * (variable.nominal or max(abs(variable.start), 1.0))
    low, high = variable.start - reach, variable.start + reach
    return (
        low if variable.minimum is None else max(low, variable.minimum),
        high if variable.maximum is None else min(high, variable.maximum),
    )


def drawn_inputs(component: type[Component], rng: random.Random) -> dict[str, float]:
    """Any inputs, each from where it usually lies; they need not belong together."""
    return {variable.name: rng.uniform(*span(variable)) for variable in inputs(component)}


def drawn_parameters(component: type[Component], rng: random.Random) -> dict[str, Any]:
    """Yes-or-no, whole-numbered and chosen parameters at random; the others stay at their defaults."""
    drawn: dict[str, Any] = {}
    for variable in declared(component):
        if variable.causality == "parameter" and variable.type is bool:
            drawn[variable.name] = rng.random() < 0.5
        if variable.causality == "parameter" and variable.type is int:
            low = variable.start if variable.minimum is None else int(variable.minimum)
            high = variable.start if variable.maximum is None else int(variable.maximum)
            drawn[variable.name] = rng.randint(low, high)
    return drawn


def moved(component: type[Component], time: float, quickening: float = 0.0) -> dict[str, float]:
    """Inputs that belong together: each goes on from its start with the rates it is declared to have.

    `quickening` is added to each that is the rate of a rate.
    """
    moving = {variable.name: float(variable.start) for variable in inputs(component)}
    rate = {variable.name: variable.rate for variable in inputs(component)}
    seconds = {name: rate[first] for name, first in rate.items() if first and rate[first]}
    for second in set(seconds.values()):
        moving[second] += quickening
    for name, second in seconds.items():
        first = rate[name]
        moving[name] += time * (moving[first] + 0.5 * time * moving[second])
    for name, first in rate.items():
        if first and name not in seconds:
            moving[name] += moving[first] * time
    return moving


def at_step_end(component: Component) -> bool:
    """Whether the component takes its inputs for those of the step's end."""
    return bool(getattr(component, "inputs_at_step_end", False))


def advance(component: Component, time: float, step_size: float, quickening: float = 0.0) -> int:
    """One step with inputs that belong together, given for the time that the component takes them for."""
    taken = time + step_size if at_step_end(component) else time
    assign(component, moved(type(component), taken, quickening))
    return component.step(time, step_size)
