"""The wires that a scene need not spell out: by the declarations of its instances."""

import re
from collections.abc import Collection, Container, Iterable, Mapping
from typing import Any

from ...components import COMPONENTS
from ...declaring.variables import Component, Terminal, Variable, arrays_of, variables_of
from ...errors import LoomfmuError, suggestion
from ..standard import standard

ALL = "*."  # in the place of an instance: the output of that name of every instance that has it


def stem(instance: str) -> str:
    """An instance's name without its number: `heald_3` is a `heald`."""
    return re.sub(r"_\d+$", "", instance)


def is_numbered(instance: str) -> bool:
    """Return whether an instance's name ends with a number, as `heald_3` does."""
    return stem(instance) != instance


def members(key: str, given: Iterable[str]) -> list[str]:
    """The numbered instances that a name without number stands for."""
    if key in given:
        return []
    return [name for name in given if stem(name) == key]


def wires(components: Mapping[str, type[Component]]) -> dict[str, str]:
    """Return the usual wires to inputs such as `belt.travel`, by the declarations of all instances.

    Terminals go to the instance that the standard loom has for them, others to the only one that offers them.
    """
    offered: dict[tuple[str, int], dict[str, tuple[str, ...]]] = {}
    for name, component in components.items():
        for end in terminals(component, "output"):
            offered.setdefault((end.kind, len(end.variables)), {})[name] = end.variables
    found: dict[str, str] = {}
    for name, component in components.items():
        number = name.removeprefix(stem(name))
        for v in variables_of(component):
            if v.causality == "input" and v.source and not v.source_for and not v.source.startswith(ALL):
                found[f"{name}.{v.name}"] = v.source.replace("_#", number)
        for terminal in terminals(component, "input"):
            offering = offered.get((terminal.name, len(terminal.variables)), {})
            if terminal.name in standard().SOURCES:
                usual = [each.replace("_#", number) for each in standard().SOURCES[terminal.name]]
                owner = next((each for each in usual if each in offering and each != name), usual[-1])
                # another vendor's FMU in its place has outputs of the same names
                outputs = offering.get(owner, ()) if owner in components else _usual(terminal, owner)
            else:
                owner, outputs = next(iter(offering.items())) if len(offering) == 1 else ("", ())
            pairs = zip(terminal.variables, outputs, strict=False)
            found |= {f"{name}.{sink}": f"{owner}.{output}" for sink, output in pairs}
    return found


def check_sources(
    components: Mapping[str, type[Component]], usual: Mapping[str, str], given: Container[str]
) -> None:
    """Refuse an input whose source is absent: it would keep its start. `given` have another one.

    `usual` are the wires of a standard loom. Our own mechanisms, and all terminals, do without what such a
    loom leaves out, but not without the number of a source, nor without one that has another name here. A
    terminal is left to the scene that gives one of its inputs.
    """
    absent = {sink: source for sink, source in usual.items() if source.partition(".")[0] not in components}
    declared = {f"{name}.{v.name}": v.source for name, c in components.items() for v in variables_of(c)}
    spelt = {_owners(sink, source) for sink, source in absent.items() if sink in given and not declared[sink]}
    for sink, source in absent.items():
        name, owner = _owners(sink, source)
        of_terminal = not declared[sink]
        if sink in given or (of_terminal and (name, owner) in spelt):
            continue
        unnumbered = not is_numbered(name) and "_#" in (declared[sink] or "")
        others = members(owner, components) if unnumbered else _renamed(name, owner, components)
        ours = COMPONENTS.get(components[name].__name__) is components[name]
        if others or not (ours or of_terminal):
            missing = f"{name} has no number" if unnumbered else f"there is no instance {owner!r}"
            like = "" if unnumbered else suggestion(owner, components)
            hint = f"; did you mean {others[0]!r}?" if others and not unnumbered else like
            raise LoomfmuError(
                f"{sink}: its source is {declared[sink] or source}, but {missing}{hint};"
                f" name it in [wires], or set {sink}"
            )


def _owners(sink: str, source: str) -> tuple[str, str]:
    """The instances at both ends of a wire."""
    return sink.partition(".")[0], source.partition(".")[0]


def _renamed(name: str, owner: str, components: Mapping[str, type[Component]]) -> list[str]:
    """Return the instances that may replace an absent one of the standard loom, under other names."""
    wanted = standard().COMPONENT_OF.get(stem(owner))
    found = (each for each, component in components.items() if component.__name__ == wanted)
    return [each for each in found if each != name and stem(each) not in standard().COMPONENT_OF]


def fed_back(components: Mapping[str, type[Component]], taken: Collection[str]) -> dict[str, str]:
    """Wires that bring an instance what its own outputs cause, such as the load on a frame.

    They close a loop: each is made only where an output of `taken`, the sources of all wires, depends on it.
    """
    found: dict[str, str] = {}
    for name, v in _caused(components):
        if f"{name}.{v.source_for}" in taken:
            usual = _usual_sources(name, v)
            there = [each for each in usual if each.partition(".")[0] in components]
            found |= {f"{name}.{v.name}": each for each in there[:1]}
    return found


def fed_along(components: Mapping[str, type[Component]], sources: Mapping[str, Any]) -> dict[str, str]:
    """Wires to inputs that go with another input, from the instance that this one is wired to.

    Such as the work done on what loads a frame. `sources` are the sources of all wired inputs. Each is made
    only where it reaches an output that is taken.
    """
    taken = set(map(str, sources.values()))
    found: dict[str, str] = {}
    for name, v in _caused(components):
        owner = str(sources.get(f"{name}.{v.source_for}", "")).partition(".")[0]
        reached = [
            f"{name}.{each.name}"
            for each in variables_of(components[name])
            if each.causality == "output" and (each.depends is None or v.name in each.depends)
        ]
        if owner in components and not taken.isdisjoint(reached):
            there = [each for each in _usual_sources(name, v) if each.partition(".")[0] == owner]
            found |= {f"{name}.{v.name}": each for each in there[:1]}
    return found


def left_out(
    components: Mapping[str, type[Component]], wired: Collection[str], signal: str
) -> dict[str, str]:
    """Inputs that an output depends on, but that are not wired in a scene without `fed_back`, and from where
    they could be."""
    owner, _, output = signal.partition(".")
    if owner not in components:
        return {}
    known = {v.name: v for v in variables_of(components[owner])}
    depends = known[output].depends if output in known else ()
    found: dict[str, str] = {}
    for name, v in _caused({owner: components[owner]}):
        sink, of_output = f"{name}.{v.name}", known.get(v.source_for or "")
        if sink not in wired and of_output and of_output.causality == "output":
            there = [each for each in _usual_sources(name, v) if each.partition(".")[0] in components]
            if there and (depends is None or v.name in depends):
                found[sink] = there[0]
    return found


def _caused(components: Mapping[str, type[Component]]) -> list[tuple[str, Variable]]:
    """The inputs that are wired only for the sake of something else, and their instances."""
    return [
        (name, v)
        for name, component in components.items()
        for v in variables_of(component)
        if v.causality == "input" and v.source_for
    ]


def _usual_sources(name: str, variable: Variable) -> list[str]:
    """Return the outputs that an input is usually wired to, in order of preference."""
    return (variable.source or "").replace("_#", name.removeprefix(stem(name))).split("|")


def gathers(component: type[Component]) -> str:
    """The output that a component takes of every instance that has it; the first one, or none."""
    sources = (v.source or "" for v in variables_of(component))
    return next((each.removeprefix(ALL) for each in sources if each.startswith(ALL)), "")


def gathered(
    name: str, components: Mapping[str, type[Component]], given: Mapping[str, Any]
) -> dict[str, str]:
    """Wires of an instance whose arrays take an output of every instance that has it, at the next free place.

    `given` are the inputs that have a source or a value, or false where their wire is cut. The first array
    decides: where its wire is cut, or wired by hand, the others have none at this place.
    """
    arrays = arrays_of(components[name]).values()
    from_all = [each for each in arrays if (each[0].source or "").startswith(ALL)]
    if not from_all:
        return {}
    first, *others = [(each[0].source or "").removeprefix(ALL) for each in from_all]
    places = [[f"{name}.{v.name}" for v in place] for place in zip(*from_all, strict=True)]
    free = [place for place in places if not any(given.get(sink, False) is not False for sink in place)]
    wired = [given.get(sink) for place in places for sink in place]
    offered = {
        other: {v.name for v in variables_of(component) if v.causality == "output"}
        for other, component in components.items()
    }
    offering = [other for other in offered if first in offered[other] and f"{other}.{first}" not in wired]
    if len(offering) > len(free):
        raise LoomfmuError(
            f"{name} has free inputs for {len(free)} mechanisms, but {len(offering)} have an output {first}"
        )
    wires = {}
    for other, (sink, *further) in zip(offering, free, strict=False):
        wires[sink] = f"{other}.{first}"
        if given.get(sink) is not False:
            pairs = zip(further, others, strict=True)
            wires |= {to: f"{other}.{output}" for to, output in pairs if output in offered[other]}
    return wires


def _usual(terminal: Terminal, owner: str) -> tuple[str, ...]:
    """The outputs that a terminal is wired to in a standard loom."""
    feeding = COMPONENTS[standard().COMPONENT_OF[stem(owner)]]
    return next(each.variables for each in terminals(feeding, "output") if each.kind == terminal.name)


def terminals(component: type[Component], causality: str) -> list[Terminal]:
    """The terminals of a component whose variables are its inputs, or its outputs."""
    names = {v.name for v in variables_of(component) if v.causality == causality}
    return [terminal for terminal in component.terminals if terminal.variables[0] in names]
