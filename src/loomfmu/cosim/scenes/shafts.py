"""Shafts: the instances that turn others, and those that follow them."""

from collections.abc import Collection, Mapping
from typing import Any

from ...components import COMPONENTS
from ...components.shaft_driven import ShaftDriven
from ...components.terminals import SHAFT
from ...declaring.variables import Component, variables_of
from ..standard import standard
from .usual_wires import terminals

# input of a mechanism on the shaft -> output of the shaft that it follows
FOLLOWED = dict(zip(ShaftDriven.terminals[0].variables, SHAFT.members, strict=True))

FOLLOWING = "follow_shaft"  # whether a class on ShaftDriven follows a shaft, or turns by itself


def shaft_inputs(component: type[Component] | None, inputs: Collection[str]) -> tuple[str, ...]:
    """The inputs by which a mechanism follows a shaft; none where it follows none.

    Of an FMU whose component is not known here its inputs tell.
    """
    if component is None:
        return tuple(FOLLOWED) if set(FOLLOWED) <= set(inputs) else ()
    return next((t.variables for t in terminals(component, "input") if t.name == SHAFT.name), ())


def follows(component: type[Component] | None, values: Mapping[str, Any]) -> bool:
    """Return whether a mechanism follows a shaft, and could turn by itself instead."""
    return issubclass(component or ShaftDriven, ShaftDriven) and values.get(FOLLOWING) is True


def turning(speed: float, start_angle: float) -> dict[str, float | bool]:
    """The parameters of a mechanism that turns by itself as a shaft of constant speed would."""
    return {FOLLOWING: False, "speed": speed, "start_angle": start_angle}


def motions(component: type[Component]) -> list[tuple[str, ...]]:
    """The groups of inputs by which a mechanism follows another one than a shaft."""
    ends = terminals(component, "input")
    return [each.variables for each in ends if each.name in standard().SOURCES and each.name != SHAFT.name]


def turns_alone(component: type[Component]) -> bool:
    """Return whether a mechanism has a speed of its own and no way to follow a shaft."""
    turning = any(v.causality == "parameter" and v.unit == "rad/s" for v in variables_of(component))
    return turning and not turns_others(component) and not shaft_inputs(component, ())


def shafts() -> list[str]:
    """The components that turn others: those whose outputs are a shaft."""
    return [name for name, each in COMPONENTS.items() if turns_others(each)]


def turns_others(component: type[Component]) -> bool:
    """Return whether the outputs of a component are a shaft that others follow."""
    return any(terminal.name == SHAFT.name for terminal in terminals(component, "output"))
