"""The dependencies of a component's outputs."""

from collections.abc import Mapping
from typing import NamedTuple

from ...declaring.upstream import upstream
from ...declaring.variables import NOTHING, TIME, Component, variables_of
from ..source import one_at_a_time
from .flow import Unfollowed, followed, started
from .values import Names, Places, flat


class Dependencies(NamedTuple):
    """The inputs and parameters on which each output may depend, `TIME` among them.

    At the `start`, after a step from there (`once`), and after many steps (`always`). In steps what a
    component keeps from before is held. So parameters count only where it keeps nothing: else they are in
    what it keeps. Where the source cannot be followed an output depends on everything.
    """

    start: Mapping[str, Names]
    once: Mapping[str, Names]
    always: Mapping[str, Names]


_done: dict[type[Component], Dependencies] = {}


def dependencies(component: type[Component]) -> Dependencies:
    """The dependencies of a component's outputs."""
    if component.needs:
        return Dependencies(component.needs_at_start, component.needs, component.needs)
    with one_at_a_time:
        if component not in _done:
            _done[component] = _dependencies(component)
        return _done[component]


def _dependencies(component: type[Component]) -> Dependencies:
    variables = variables_of(component)

    def own(*known: str) -> dict[str, Names]:
        return {f".{v.member}": frozenset({v.name} if v.causality in known else ()) for v in variables}

    start = own("input", "parameter")
    step = start if component.keeps == NOTHING else own("input")
    outputs = {v.name: f".{v.member}" for v in variables if v.causality == "output"}
    # a host may have inputs go on with their rates to the end of the step
    rates = {v.name: [v.rate] for v in variables if v.causality == "input" and v.rate}

    def needs(places: Places, rates: Mapping[str, list[str]]) -> dict[str, Names]:
        return {name: frozenset(upstream(flat(places[place]), rates)) for name, place in outputs.items()}

    def everything(own: Mapping[str, Names]) -> Places:
        return dict.fromkeys(own, frozenset({TIME}).union(*own.values()))

    try:
        found = started(component, start), *followed(component, step)
    except (Unfollowed, RecursionError):
        found = everything(start), everything(step), everything(step)
    return Dependencies(*map(needs, found, ({}, rates, rates)))
