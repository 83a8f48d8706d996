"""Systems: their parts, and their variables, which are those of the parts with dotted names."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from ...declaring.declarations import parameter
from ...declaring.variables import TIME, Component, Problem, Terminal, Variable, variable_of, variables_of
from ..dataflow.dependencies import dependencies

Value = float | int | bool
Reach = Callable[[str], frozenset[str]]
STEP, STEPS = "step", "steps_per_revolution"  # the parameter that sets the grid, as scenes call it
REFERENCES = ("rate", "lowest_of", "highest_of", "when", "unless", "valid_if", "error")  # to variables
SPEED = "shaft.speed"  # with which a grid by revolutions goes


@dataclass(frozen=True)
class Part:
    """A component in a system, with the values that differ from its declared start values."""

    name: str
    component: type[Component]
    values: Mapping[str, Value]


@dataclass(frozen=True)
class Drive:
    """An input that follows a table: on straight lines between the points, or held."""

    points: tuple[float, ...]
    values: tuple[Value, ...]
    held: bool


@dataclass(frozen=True)
class System:
    """Components, the sources of their inputs, and the grid on which they are stepped.

    Parts are in the order of their steps, sources before sinks. Variables are `part.variable`: `wires` and
    `drives` give the source of an input, `outputs` are those that are shown. The grid is `step` [s], or
    `steps` in a revolution at the speed of the part `shaft`; `experiment` is the end and its step size [s].
    """

    name: str
    title: str
    description: str
    parts: tuple[Part, ...]
    wires: Mapping[str, str]
    drives: Mapping[str, Drive]
    outputs: frozenset[str]
    experiment: tuple[float, float]
    steps: int = 0
    step: float = 0.0

    @cached_property
    def closing(self) -> list[tuple[str, str]]:
        """The wires that close a loop, each as its sink and its source, in the order of the steps."""
        place = {part.name: number for number, part in enumerate(self.parts)}
        wires = [(sink, source, place[sink.partition(".")[0]]) for sink, source in self.wires.items()]
        closing = [wire for wire in wires if place[wire[1].partition(".")[0]] >= wire[2]]
        return [(sink, source) for sink, source, _ in sorted(closing, key=lambda wire: wire[2])]

    @cached_property
    def closing_sources(self) -> list[str]:
        """The sources of these wires, real ones first."""
        sources = dict.fromkeys(source for _, source in self.closing)
        return sorted(sources, key=lambda source: self.variable(source).type is not float)

    @property
    def closing_reals(self) -> int:
        """The number of these sources that are real."""
        return sum(self.variable(source).type is float for source in self.closing_sources)

    def variable(self, name: str) -> Variable:
        """The declaration of a variable `part.variable` in its component."""
        owner, _, variable = name.partition(".")
        (part,) = (each for each in self.parts if each.name == owner)
        (found,) = (each for each in variables_of(part.component) if each.name == variable)
        return found

    @property
    def problem(self) -> Problem:
        """The problem that is reported if the grid has no steps."""
        if self.step:
            return Problem("step = {step} must be greater than 0")
        return Problem(f"{SPEED} = {{{SPEED}}} must not be 0: it sets the step")


def component_of(system: System) -> type[Component]:
    """The system as a component: its variables are declared, its code is not in Python."""
    variables = (_grid(system), *(v for part in system.parts for v in _variables(system, part)))
    # a communication step may hold several of the system's
    reach = _reach(system, {p.name: dependencies(p.component).always for p in system.parts}, "input")
    starts = {p.name: dependencies(p.component).start for p in system.parts}
    reach_at_start = _reach(system, starts, "input", "parameter")
    outputs = [v.name for v in variables if v.causality == "output"]
    members = {
        "__doc__": system.title,
        "declared": classmethod(lambda _cls: variables),
        "problems": (system.problem, *(p for part in system.parts for p in problems_of(system, part))),
        "terminals": tuple(_terminals(system, {v.name: v for v in variables})),
        "needs": {name: reach(name) for name in outputs},
        "needs_at_start": {name: reach_at_start(name) for name in outputs},
        "experiment": system.experiment,
        "derivatives": not system.closing,
    }
    return type(system.name, (Component,), members)


def _grid(system: System) -> Variable:
    """The parameter that sets the grid."""
    about, most = "whatever the communication step", 1_000_000_000
    if system.step:
        given = parameter("s", system.step, f"Step of the components, {about}", minimum=1e-12, maximum=1e9)
        return variable_of(STEP, given)
    text = f"Steps of the components in a revolution at {SPEED}, {about}"
    return variable_of(STEPS, parameter("1", system.steps, text, minimum=1, maximum=most))


def _variables(system: System, part: Part) -> list[Variable]:
    """The variables of a part as those of the system: what is wired, or not an output of it, stays inside."""

    found = []
    for each in variables_of(part.component):
        name = f"{part.name}.{each.name}"
        causality = each.causality
        if causality == "output" or name in system.wires or name in system.drives:
            causality = "output" if name in system.outputs else "local"
        dotted: dict[str, Any] = {
            key: f"{part.name}.{there}" for key in REFERENCES if (there := getattr(each, key))
        }
        own = replace(
            each,
            name=name,
            element=f"{part.name}.{each.member}",
            causality=causality,
            start=each.type(part.values.get(each.name, each.start)),
            indicator=False,
            source=None,
            **dotted,
        )
        found.append(own)
    return found


def _reach(system: System, needs: Mapping[str, Mapping[str, frozenset[str]]], *knowns: str) -> Reach:
    """A function that gives the open `knowns` on which a variable depends, `TIME` among them."""
    names = {
        f"{part.name}.{v.name}": v.causality for part in system.parts for v in variables_of(part.component)
    }

    def sources(name: str) -> list[str]:
        owner, _, variable = name.partition(".")
        if name in system.wires:
            return [system.wires[name]]
        if name in system.drives:
            return [TIME]
        needed = needs[owner][variable] if names.get(name) == "output" else ()
        return [TIME if each == TIME else f"{owner}.{each}" for each in needed]

    def reach(name: str) -> frozenset[str]:
        found, left = {name}, [name]  # wires may close a loop
        while left:
            new = {*sources(left.pop())} - found
            found |= new
            left += new
        leaves = (each for each in found if names.get(each) in knowns and not sources(each))
        return frozenset(leaves) | (found & {TIME})

    return reach


def limited(system: System, part: Part) -> list[Variable]:
    """The wired inputs of a part whose values must be within limits."""
    return [
        each
        for each in variables_of(part.component)
        if f"{part.name}.{each.name}" in system.wires
        and each.type is not bool
        and (each.minimum is not None or each.maximum is not None)
    ]


def problems_of(system: System, part: Part) -> list[Problem]:
    """Return a part's problems: those of its component, and wired inputs outside their limits."""
    found = []
    names = {v.name for v in variables_of(part.component)}
    for problem in part.component.problems:
        text = problem.text
        for name in names:
            text = text.replace(f"{{{name}}}", f"{{{part.name}.{name}}}")
        found.append(Problem(f"{part.name}: {text}", problem.warning))
    for each in limited(system, part):
        name = f"{part.name}.{each.name}"
        found.append(Problem(f"{name} = {{{name}}} is outside {each.range}"))
    return found


def _terminals(system: System, variables: Mapping[str, Variable]) -> list[Terminal]:
    """The terminals of the parts all of whose members can be wired from outside."""
    found = []
    for part in system.parts:
        for terminal in part.component.terminals:
            names = [f"{part.name}.{name}" for name in terminal.variables]
            if {variables[name].causality for name in names} in ({"input"}, {"output"}):
                found.append(replace(terminal, name=f"{part.name}.{terminal.name}").of(*names))
    return found
