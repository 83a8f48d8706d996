"""The dependencies of a component's outputs."""

from collections.abc import Mapping

from ...declaring.upstream import upstream
from ...declaring.variables import NOTHING, TIME, Component, variables_of
from ..source import one_at_a_time
from .flow import Unfollowed, followed
from .values import Names, Places, flat

_done: dict[type[Component], tuple[Mapping[str, Names], Mapping[str, Names]]] = {}


def dependencies(component: type[Component], many_steps: bool = False) -> Mapping[str, Names]:
    """The inputs and parameters on which each output may depend, `TIME` among them, in a step or in several.

    What a component keeps from before is held. So parameters count only where it keeps nothing: else they are
    in what it keeps. Where the source cannot be followed an output depends on everything.
    """
    if component.needs:
        return component.needs
    with one_at_a_time:
        if component not in _done:
            _done[component] = _dependencies(component)
        return _done[component][many_steps]


def _dependencies(component: type[Component]) -> tuple[dict[str, Names], dict[str, Names]]:
    variables = variables_of(component)
    known = ("input", "parameter") if component.keeps == NOTHING else ("input",)
    own = {f".{v.member}": frozenset({v.name} if v.causality in known else ()) for v in variables}
    outputs = {v.name: f".{v.member}" for v in variables if v.causality == "output"}
    # a host may have inputs go on with their rates to the end of the step
    rates = {v.name: [v.rate] for v in variables if v.causality == "input" and v.rate}

    def needs(places: Places) -> dict[str, Names]:
        return {name: frozenset(upstream(flat(places[place]), rates)) for name, place in outputs.items()}

    try:
        once, always = followed(component, own)
    except (Unfollowed, RecursionError):
        once = always = dict.fromkeys(own, frozenset({TIME}).union(*own.values()))
    return needs(once), needs(always)
