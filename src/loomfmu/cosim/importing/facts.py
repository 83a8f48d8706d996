"""Facts that follow from the declarations of a component, computed once for each class."""

from collections.abc import Mapping
from functools import cached_property

from ...components.terminals import SHAFT
from ...declaring.variables import Component, arrays_of, variables_of
from ...fmi.identities import needs

ALL = "*."  # in the place of an instance: the output of that name of every instance that has it


class Facts:
    """A component as scenes wire it and warn of it.

    `taken` are the terminals of its inputs, `offered` those of its outputs. `caused` are the inputs that are
    wired only for the sake of something else. `gathering` are the arrays that take an output of every
    instance that has it, and `gathers` is the output that the first of them takes, if there is one.
    """

    def __init__(self, component: type[Component]):
        declared = variables_of(component)
        self.component = component
        self.variables = {each.name: each for each in declared}
        self.inputs = [each for each in declared if each.causality == "input"]
        self.outputs = {each.name: each for each in declared if each.causality == "output"}
        self.caused = [input_ for input_ in self.inputs if input_.source_for]
        arrays = arrays_of(component).values()
        self.gathering = [each for each in arrays if (each[0].source or "").startswith(ALL)]
        sources = (each.source or "" for each in declared)
        self.gathers = next((source.removeprefix(ALL) for source in sources if source.startswith(ALL)), "")
        names = {input_.name for input_ in self.inputs}
        self.taken = [terminal for terminal in component.terminals if terminal.variables[0] in names]
        self.offered = [terminal for terminal in component.terminals if terminal.variables[0] in self.outputs]
        # outputs that hold an extreme, or whose extreme is held: whose it is, and 1 for its lowest, else -1
        self.extremes: dict[str, tuple[str, float]] = {}
        for variable in declared:
            for followed, sign in ((variable.lowest_of, 1.0), (variable.highest_of, -1.0)):
                if followed:
                    self.extremes |= {variable.name: (followed, sign), followed: (followed, sign)}
        # the inputs by which it follows a shaft; none where it follows none
        self.shaft_inputs = next((each.variables for each in self.taken if each.name == SHAFT.name), ())
        # its outputs are a shaft that others follow
        self.turns_others = any(each.name == SHAFT.name for each in self.offered)
        # it has a speed of its own and no way to follow a shaft
        turning = any(each.causality == "parameter" and each.unit == "rad/s" for each in declared)
        self.turns_alone = turning and not self.turns_others and not self.shaft_inputs

    @cached_property
    def needs(self) -> Mapping[str, frozenset[str]]:
        """The inputs on which each output depends, now or later, and `TIME`."""
        return needs(self.component)


_known: dict[type[Component], Facts] = {}


def facts_of(component: type[Component]) -> Facts:
    """Return the facts of a component."""
    if component not in _known:
        _known[component] = Facts(component)
    return _known[component]
