"""The sources of a scene's inputs: wires that it spells out and those that it need not, and tables."""

from collections import ChainMap
from collections.abc import Collection, Container, Mapping
from typing import Any

from ...components import COMPONENTS
from ...declaring.variables import Terminal, Variable
from ...errors import LoomfmuError, listed, shown, suggestion, within
from ..importing.conversions import SAME, Linear
from ..importing.facts import ALL, Facts, facts_of
from ..importing.ports import conversion
from ..standard import standard
from .graph import Drive, Wire, drive
from .instances import Instance, is_numbered, members, stem
from .settings import dotted

Known = Mapping[str, Facts]  # of the instances whose component is known, by their names


def wires_of(instances: dict[str, Instance], scene: Mapping[str, Any]) -> list[Wire]:
    """The standard loom's wires where both ends are there, and those that the tables of a scene spell out.

    Values that instances inherit from others, and switches that go with wires, are set.
    """
    spelt_out, driven = scene.get("wires", {}), scene.get("inputs")
    if not isinstance(spelt_out, dict):
        raise LoomfmuError('wires must be a table of "instance.input" = "instance.output"')
    spelt = dict[str, Any]()
    for end, source in dotted(spelt_out).items():
        sink = _own(instances, end)
        if sink in spelt:
            raise LoomfmuError(f"wires: {end!r} is {sink}, which has a wire; keep one of them")
        spelt[sink] = source
    known = {name: instance.fmu.facts for name, instance in instances.items() if instance.fmu.facts}
    usual = usual_wires(known)
    sources: dict[str, Any] = {sink: each for sink, each in usual.items() if each.split(".")[0] in instances}
    values = {
        f"{name}.{key}": value
        for name, instance in instances.items()
        for key, value in instance.values.items()
    }
    tables = values | (dotted(driven) if isinstance(driven, dict) else {}) | spelt
    _check_sources(known, usual, tables)
    for name in known:
        sources |= gathered(name, known, ChainMap(tables, sources))
    taken = {str(each) for each in (*sources.values(), *spelt.values())}
    sources |= _fed_back(known, taken)
    sources |= _fed_along(known, sources | spelt)
    for sink, source in spelt.items():
        if source is False:
            if sources.pop(sink, None) is None:
                raise LoomfmuError(f"wires: {sink!r} is not wired{suggestion(sink, sources)}")
        else:
            sources[sink] = source
    pairs = (pair for sink, source in sources.items() for pair in elements(instances, sink, source))
    wires = check_once([wire(instances, sink, source) for sink, source in pairs])
    fed = {each.sink for each in wires}
    for inheriting in instances.values():
        inheriting.inherit(instances, fed)
    for each in wires:
        instances[each.sink[0]].follow(each.sink[1])
    return wires


def wire(instances: dict[str, Instance], sink: str, source: Any, known: Linear | None = None) -> Wire:
    """A wire whose ends are known and of the right kind; its units are converted, if that is not `known`."""
    if not isinstance(source, str):
        raise LoomfmuError(
            f'wires: "{sink}" = {shown(source).lower()} must be an output, or false to cut the wire'
        )
    where = f"wire {source} -> {sink}"
    ends = []
    for end, causality in ((sink, "input"), (source, "output")):
        name, _, variable = str(end).partition(".")
        if name not in instances:
            raise LoomfmuError(f"{where}: there is no instance {name!r}{suggestion(name, instances)}")
        fmu = instances[name].fmu
        variable = fmu.name_of(variable)
        if variable not in fmu.ports or fmu.ports[variable].causality != causality:
            fitting = [port.name for port in fmu.ports.values() if port.causality == causality]
            raise LoomfmuError(
                f"{where}: {name} has no {causality} {variable!r}{suggestion(variable, fitting)}"
            )
        ends.append((name, variable))
    to, origin = (instances[name].fmu.ports[variable] for name, variable in ends)
    if origin.kind != to.kind:
        raise LoomfmuError(f"{where}: {source} is of type {origin.kind}, {sink} of type {to.kind}")
    if known is None:
        with within(where):
            known = conversion(source, origin.stated, sink, to.stated)
    elif known != SAME and to.kind != "Real":
        raise LoomfmuError(f"{where}: a value of type {to.kind} cannot be transformed")
    return Wire(source=ends[1], sink=ends[0], conversion=known)


def check_once(wires: list[Wire]) -> list[Wire]:
    """Return wires, each to an input of its own. Raises LoomfmuError for an input with two sources."""
    sources: dict[tuple[str, str], Wire] = {}
    for each in wires:
        first = sources.setdefault(each.sink, each)
        if first != each:
            sink, *ends = (".".join(end) for end in (each.sink, first.source, each.source))
            raise LoomfmuError(f"{sink} is wired twice, to {listed(ends)}; keep one wire")
    return wires


def _own(instances: Mapping[str, Instance], end: str) -> str:
    """Return an end of a wire by the scene's name of its variable."""
    name, _, variable = end.partition(".")
    return f"{name}.{instances[name].fmu.name_of(variable)}" if name in instances else end


def elements(instances: dict[str, Instance], sink: str, source: Any) -> list[tuple[str, Any]]:
    """The wires that one between arrays stands for, or itself."""
    parts = [str(end).partition(".") for end in (sink, source)]
    arrays = [
        instances[name].fmu.elements(variable) if name in instances else [] for name, _, variable in parts
    ]
    ends = [[f"{part[0]}.{each.name}" for each in array] for part, array in zip(parts, arrays, strict=True)]
    if not any(ends):
        return [(sink, source)]
    if len(ends[0]) != len(ends[1]):
        raise LoomfmuError(f"wire {source} -> {sink}: {len(ends[1]) or 1} values for {len(ends[0]) or 1}")
    return list(zip(*ends, strict=True))


def drives_of(instances: dict[str, Instance], wires: list[Wire], table: Any) -> list[Drive]:
    """The inputs that the scene drives along tables; an input has one source.

    Refuses to use an input, such as the work of a mechanism, that comes from another instance but has no
    source: its torque would do no work.
    """
    if not isinstance(table, dict):
        raise LoomfmuError('inputs must be a table of "instance.input" = [[revolution, value], ...]')
    drives: list[Drive] = []
    wired = {each.sink for each in wires}
    for name, rows in dotted(table).items():
        owner, _, variable = name.partition(".")
        if owner not in instances:
            raise LoomfmuError(f"inputs.{name}: there is no instance {owner!r}{suggestion(owner, instances)}")
        variable = instances[owner].fmu.name_of(variable)
        if (owner, variable) in wired:
            raise LoomfmuError(f'inputs.{name} is wired already; cut that wire with wires."{name}" = false')
        if any((owner, variable) == (each.instance, each.variable) for each in drives):
            raise LoomfmuError(f"inputs.{name} is a second table for {owner}.{variable}; keep one of them")
        drives.append(drive(name, instances[owner].fmu.port(variable, f"inputs.{name}"), rows))
    fed = wired | {(each.instance, each.variable) for each in drives}
    for name, instance in instances.items():
        for switch, sink in instance.switched():
            if instance.values.get(switch) and (name, sink) not in fed:
                raise LoomfmuError(
                    f"{name}.{switch} = true, but {name}.{sink} is not wired:"
                    f" wire it, or set {name}.{switch} = false"
                )
    return drives


# ---- wires that a scene need not spell out


def usual_wires(known: Known) -> dict[str, str]:
    """Return the usual wires to inputs such as `belt.travel`, by the declarations of all instances.

    Terminals go to the instance that the standard loom has for them, others to the only one that offers them.
    """
    offered: dict[tuple[str, int], dict[str, tuple[str, ...]]] = {}
    for name, facts in known.items():
        for end in facts.offered:
            offered.setdefault((end.kind, len(end.variables)), {})[name] = end.variables
    found: dict[str, str] = {}
    for name, facts in known.items():
        number = name.removeprefix(stem(name))
        for v in facts.inputs:
            if v.source and not v.source_for and not v.source.startswith(ALL):
                found[f"{name}.{v.name}"] = v.source.replace("_#", number)
        for terminal in facts.taken:
            offering = offered.get((terminal.name, len(terminal.variables)), {})
            if terminal.name in standard().SOURCES:
                usual = [each.replace("_#", number) for each in standard().SOURCES[terminal.name]]
                owner = next((each for each in usual if each in offering and each != name), usual[-1])
                # another vendor's FMU in its place has outputs of the same names
                outputs = offering.get(owner, ()) if owner in known else _usual(terminal, owner)
            else:
                owner, outputs = next(iter(offering.items())) if len(offering) == 1 else ("", ())
            pairs = zip(terminal.variables, outputs, strict=False)
            found |= {f"{name}.{sink}": f"{owner}.{output}" for sink, output in pairs}
    return found


def _check_sources(known: Known, usual: Mapping[str, str], given: Container[str]) -> None:
    """Refuse an input whose source is absent: it would keep its start. `given` have another one.

    `usual` are the wires of a standard loom. Our own mechanisms, and all terminals, do without what such a
    loom leaves out, but not without the number of a source, nor without one that has another name here. A
    terminal is left to the scene that gives one of its inputs.
    """
    absent = {sink: source for sink, source in usual.items() if source.partition(".")[0] not in known}
    variables = [(name, v) for name, facts in known.items() for v in facts.variables.values()]
    declared = {f"{name}.{v.name}": v.source for name, v in variables}
    spelt = {_owners(sink, source) for sink, source in absent.items() if sink in given and not declared[sink]}
    for sink, source in absent.items():
        name, owner = _owners(sink, source)
        of_terminal = not declared[sink]
        if sink in given or (of_terminal and (name, owner) in spelt):
            continue
        unnumbered = not is_numbered(name) and "_#" in (declared[sink] or "")
        others = members(owner, known) if unnumbered else _renamed(name, owner, known)
        ours = COMPONENTS.owns(known[name].component)
        if others or not (ours or of_terminal):
            missing = f"{name} has no number" if unnumbered else f"there is no instance {owner!r}"
            like = "" if unnumbered else suggestion(owner, known)
            hint = f"; did you mean {others[0]!r}?" if others and not unnumbered else like
            raise LoomfmuError(
                f"{sink}: its source is {declared[sink] or source}, but {missing}{hint};"
                f" name it in [wires], or set {sink}"
            )


def _owners(sink: str, source: str) -> tuple[str, str]:
    """The instances at both ends of a wire."""
    return sink.partition(".")[0], source.partition(".")[0]


def _renamed(name: str, owner: str, known: Known) -> list[str]:
    """Return the instances that may replace an absent one of the standard loom, under other names."""
    wanted = standard().COMPONENT_OF.get(stem(owner))
    found = (other for other, facts in known.items() if facts.component.__name__ == wanted)
    return [other for other in found if other != name and stem(other) not in standard().COMPONENT_OF]


def _fed_back(known: Known, taken: Collection[str]) -> dict[str, str]:
    """Wires that bring an instance what its own outputs cause, such as the load on a frame.

    They close a loop: each is made only where an output of `taken`, the sources of all wires, depends on it.
    """
    found: dict[str, str] = {}
    for name, v in _caused(known):
        if f"{name}.{v.source_for}" in taken:
            found |= _usual_wire(name, v, known)
    return found


def _fed_along(known: Known, sources: Mapping[str, Any]) -> dict[str, str]:
    """Wires to inputs that go with another input, from the instance that this one is wired to.

    Such as the work done on what loads a frame. `sources` are the sources of all wired inputs. Each is made
    only where it reaches an output that is taken.
    """
    taken = set(map(str, sources.values()))
    found: dict[str, str] = {}
    for name, v in _caused(known):
        owner = str(sources.get(f"{name}.{v.source_for}", "")).partition(".")[0]
        reached = [f"{name}.{output}" for output, needed in known[name].needs.items() if v.name in needed]
        if owner in known and not taken.isdisjoint(reached):
            found |= _usual_wire(name, v, [owner])
    return found


def left_out(known: Known, wired: Collection[str], signal: str) -> dict[str, str]:
    """Inputs that an output depends on, but that are not wired although they could be, and from where."""
    owner, _, output = signal.partition(".")
    if owner not in known:
        return {}
    found: dict[str, str] = {}
    for v in known[owner].caused:
        needed = v.source_for in known[owner].outputs and v.name in known[owner].needs.get(output, ())
        if needed and f"{owner}.{v.name}" not in wired:
            found |= _usual_wire(owner, v, known)
    return found


def _caused(known: Known) -> list[tuple[str, Variable]]:
    """The inputs that are wired only for the sake of something else, and their instances."""
    return [(name, v) for name, facts in known.items() for v in facts.caused]


def _usual_wire(name: str, variable: Variable, owners: Container[str]) -> dict[str, str]:
    """Return the wire to an input from the first of its usual sources that one of these instances has."""
    usual = (variable.source or "").replace("_#", name.removeprefix(stem(name))).split("|")
    there = [source for source in usual if source.partition(".")[0] in owners]
    return {f"{name}.{variable.name}": source for source in there[:1]}


def gathered(name: str, known: Known, given: Mapping[str, Any]) -> dict[str, str]:
    """Wires of an instance whose arrays take an output of every instance that has it, at the next free place.

    `given` are the inputs that have a source or a value, or false where their wire is cut. The first array
    decides: where its wire is cut, or wired by hand, the others have none at this place.
    """
    arrays = known[name].gathering
    if not arrays:
        return {}
    first, *others = [(array[0].source or "").removeprefix(ALL) for array in arrays]
    places = [[f"{name}.{v.name}" for v in place] for place in zip(*arrays, strict=True)]
    free = [place for place in places if not any(given.get(sink, False) is not False for sink in place)]
    wired = [given.get(sink) for place in places for sink in place]
    outputs = {other: facts.outputs for other, facts in known.items()}
    offering = [other for other in known if first in outputs[other] and f"{other}.{first}" not in wired]
    if len(offering) > len(free):
        raise LoomfmuError(
            f"{name} has free inputs for {len(free)} mechanisms, but {len(offering)} have an output {first}"
        )
    wires = {}
    for other, (sink, *further) in zip(offering, free, strict=False):
        wires[sink] = f"{other}.{first}"
        if given.get(sink) is not False:
            pairs = zip(further, others, strict=True)
            wires |= {to: f"{other}.{output}" for to, output in pairs if output in outputs[other]}
    return wires


def _usual(terminal: Terminal, owner: str) -> tuple[str, ...]:
    """The outputs that a terminal is wired to in a standard loom."""
    feeding = facts_of(COMPONENTS[standard().COMPONENT_OF[stem(owner)]])
    return next(each.variables for each in feeding.offered if each.kind == terminal.name)
