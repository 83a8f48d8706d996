"""Faults in a component's declarations that would otherwise show later, or not at all."""

import ast
import inspect
import re
import textwrap
from collections.abc import Callable, Collection, Iterator
from dataclasses import Field, fields
from typing import Any, NamedTuple

from .. import units
from ..declaring.declarations import MAKERS
from ..declaring.variables import EXTREMES, MOTION, NOTHING, Component, Variable, variables_of
from ..errors import suggestion
from . import memory

NAME = re.compile("[A-Za-z][A-Za-z0-9_]*")
PARAMETER_SETS = ("machine", "head", "pattern", "component")  # keys of an instance for several values
FILES = ("fmu", "units")  # of an instance given as a file
ISOLATED = "isolated"  # whether it runs in a process of its own
# of all that an instance has beside its variables; `units` is one of FMUs that are files only
KEYS = (*PARAMETER_SETS, "fmu", ISOLATED)


class Fault(NamedTuple):
    """A fault, and the field or method of the class where it is."""

    field: str
    text: str


def fault(component: type[Component], taken: Collection[str]) -> Fault | None:
    """The first fault of a component, or None; its name must not be one of those `taken`."""
    for find in (_of_class, _of_variables, _of_references, _of_traits, _of_problems):
        for found in find(component):
            return found
    if component.__name__ in taken:
        return Fault("", f"{component.__name__} is the name of one of loomfmu's components: choose another")
    try:
        component()
    except ValueError as error:
        return Fault("", " ".join(str(error).split()))
    name = "" if component.keeps == MOTION else memory.carrying(component)
    if name:
        text = f"{name} depends on earlier steps, but keeps is not MOTION: remove keeps"
        return Fault(name, text)
    return None


def _of_class(component: type[Component]) -> Iterator[Fault]:
    name = component.__name__
    if any(isinstance(each, Field) for each in vars(component).values()):
        yield Fault("", f"{name} is not a dataclass: write @dataclass(slots=True) above it")
    elif "__slots__" not in vars(component):
        yield Fault("", f"{name} could store undeclared values: write @dataclass(slots=True) above it")
    for method, given in (("initialize", Component.initialize), ("step", Component.step)):
        if getattr(component, method) is given:
            yield Fault("", f"{name} has no method {method}")
    if not (component.__doc__ or "").strip() or str(component.__doc__).startswith(f"{name}("):
        yield Fault("", f"{name} has no docstring: its first line describes the FMU")


def _of_variables(component: type[Component]) -> Iterator[Fault]:
    for declared in fields(component):
        if "causality" not in declared.metadata:
            name = declared.name
            if callable(declared.default):  # the method came last, and took the name of the variable
                yield Fault(name, f"{name} is a variable and a method: give one of them another name")
            yield Fault(name, f"{name} is not declared by {MAKERS}")
    for variable in variables_of(component):
        text = _of_variable(component, variable)
        if text:
            yield Fault(variable.element.partition("[")[0] or variable.name, text)
    if not any(variable.causality == "output" for variable in variables_of(component)):
        yield Fault("", f"{component.__name__} has no output")


def _of_variable(component: type[Component], variable: Variable) -> str:
    name, annotation = variable.name, component.__dataclass_fields__[variable.name].type
    declared = annotation.__name__ if isinstance(annotation, type) else str(annotation)
    one = variable.type.__name__
    wanted = [f"tuple[{one}, ...]", f"collections.abc.Sequence[{one}]"] if variable.element else [one]
    if name in KEYS or name == "time" or not NAME.fullmatch(name):
        return f"a variable cannot be called {name}: scenes and traces use that name"
    if declared not in wanted:
        return (
            f"{name} is declared {declared}, but its start {variable.start!r} is of type"
            f" {variable.type.__name__}"
        )
    for unit in (variable.unit, variable.display):
        try:
            units.unit(unit)
        except units.UnitError as error:
            return f"{name}: {error}"
    if units.unit(variable.unit).factor != 1.0:
        return f"{name} is in {variable.unit}: values are SI, {units.si(variable.unit)}; use display="
    if units.unit(variable.unit).dimension != units.unit(variable.display).dimension:
        return f"{name} is in {variable.unit}, which cannot be shown in {variable.display}"
    return variable.complaint(variable.start) if variable.settable else ""


def _of_references(component: type[Component]) -> Iterator[Fault]:
    """Names that stand for other variables."""
    known = {variable.name: variable for variable in variables_of(component)}
    for variable in known.values():
        for key, name, causality in (
            ("rate", variable.rate, variable.causality),
            ("lowest_of", variable.lowest_of, "output"),
            ("highest_of", variable.highest_of, "output"),
            ("valid_if", variable.valid_if, "output"),
            ("error", variable.error, "output"),
            ("when", variable.when, "parameter"),
            ("unless", variable.unless, "parameter"),
        ):
            if name is not None and (name not in known or known[name].causality != causality):
                fitting = [other for other, each in known.items() if each.causality == causality]
                text = f"{variable.name}: {key} = {name!r} is not one of its {causality}s"
                yield Fault(variable.name, text + suggestion(name, fitting))
        if variable.valid_if in known and known[variable.valid_if].type is not bool:
            text = f"{variable.name}: valid_if = {variable.valid_if!r} is not a yes-or-no output"
            yield Fault(variable.name, text)
        for key in ("error", "lowest_of", "highest_of"):
            other = known.get(getattr(variable, key))
            if other and other.unit != variable.unit:
                text = f"{variable.name} is in {variable.unit}, but {key} = {other.name!r} in {other.unit}"
                yield Fault(variable.name, text)
        if variable.rate is not None:
            yield from _of_rate(variable, known[variable.rate])
    for terminal in component.terminals:
        absent = [name for name in terminal.variables if name not in known]
        if absent or len(terminal.variables) != len(terminal.members) or not terminal.variables:
            about = (
                f"{absent[0]!r} is not a variable" if absent else f"it has {len(terminal.members)} members"
            )
            yield Fault("terminals", f"terminals: {terminal.name}: {about}{suggestion('', terminal.members)}")


def _of_rate(variable: Variable, rate: Variable) -> Iterator[Fault]:
    if units.unit(rate.unit).dimension != units.unit(variable.unit).rate:
        text = f"{variable.name} is in {variable.unit}, but its rate {rate.name} in {rate.unit}"
        yield Fault(variable.name, text)


def _of_traits(component: type[Component]) -> Iterator[Fault]:
    outputs = [variable.name for variable in variables_of(component) if variable.causality == "output"]
    held = [v.name for v in variables_of(component) if v.lowest_of or v.highest_of]
    if component.keeps not in (NOTHING, EXTREMES, MOTION):
        yield Fault("keeps", f"keeps = {component.keeps!r} is not NOTHING, EXTREMES or MOTION")
    if held and component.keeps == NOTHING:
        yield Fault(held[0], f"{held[0]} is an extreme so far, but keeps = NOTHING: write keeps = EXTREMES")
    if component.keeps != MOTION:
        for name in (v.name for v in variables_of(component) if v.carried):
            yield Fault(
                name,
                f"{name} is a state, but keeps is not MOTION: remove keeps, or declare {name} as"
                " auxiliary if nothing but extremes depends on its past",
            )
    for name in component.windows:
        if name not in outputs:
            yield Fault("windows", f"windows: {name!r} is not an output{suggestion(name, outputs)}")
    counts = [v.name for v in variables_of(component) if v.causality == "output" and v.type is int]
    if component.bounces and component.bounces not in counts:
        hint = suggestion(component.bounces, counts)
        yield Fault("bounces", f"bounces = {component.bounces!r} is not an output that counts{hint}")


def _of_problems(component: type[Component]) -> Iterator[Fault]:
    """Problems that methods return but that have no text, and texts that name unknown variables."""
    names = [variable.name for variable in variables_of(component)]
    for problem in component.problems:
        for name in re.findall(r"\{([^{}]*)\}", problem.text.replace("{{", "").replace("}}", "")):
            if name not in names:
                yield Fault("problems", f"problems: {{{name}}} is not a variable{suggestion(name, names)}")
    for method in ("check", "initialize", "step"):
        for number in _returned(getattr(component, method)):
            if number > len(component.problems):
                count = len(component.problems)
                yield Fault(method, f"{method} returns problem {number}, but `problems` has only {count}")


def _returned(method: Callable[..., Any]) -> Iterator[int]:
    """The whole numbers that a method returns as they stand."""
    for node in ast.walk(ast.parse(textwrap.dedent(inspect.getsource(method)))):
        if isinstance(node, ast.Return):
            given = node.value
            for each in (given.body, given.orelse) if isinstance(given, ast.IfExp) else (given,):
                if isinstance(each, ast.Constant) and type(each.value) is int:
                    yield each.value
