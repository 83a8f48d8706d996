"""The sources of a scene's inputs: wires from outputs, and tables."""

from collections import ChainMap
from typing import Any

from ...errors import LoomfmuError, shown, suggestion
from ..importing.ports import mismatch
from . import usual_wires
from .drives import Drive, drive, split
from .graph import Wire
from .instances import Instance


def wires_of(instances: dict[str, Instance], spelt_out: Any, driven: Any = None) -> list[Wire]:
    """The standard loom's wires where both ends are there, and those that the scene spells out.

    `driven` is the table of the inputs that the scene drives.
    """
    if not isinstance(spelt_out, dict):
        raise LoomfmuError('wires must be a table of "instance.input" = "instance.output"')
    spelt = dotted(spelt_out)
    components = {name: each.fmu.component for name, each in instances.items() if each.fmu.component}
    usual = usual_wires.wires(components)
    sources: dict[str, Any] = {sink: each for sink, each in usual.items() if each.split(".")[0] in instances}
    values = {
        f"{name}.{key}": value for name, each in instances.items() for key, value in each.values.items()
    }
    tables = values | (dotted(driven) if isinstance(driven, dict) else {}) | spelt
    usual_wires.check_sources(components, usual, tables)
    for name in components:
        sources |= usual_wires.gathered(name, components, ChainMap(tables, sources))
    taken = {str(each) for each in (*sources.values(), *spelt.values())}
    sources |= usual_wires.fed_back(components, taken)
    sources |= usual_wires.fed_along(components, sources | spelt)
    for sink, source in spelt.items():
        if source is False:
            if sources.pop(sink, None) is None:
                raise LoomfmuError(f"wires: {sink!r} is not wired{suggestion(sink, sources)}")
        else:
            sources[sink] = source
    return [wire(instances, sink, source) for sink, source in sources.items()]


def dotted(table: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    """A TOML table with its keys joined by dots, quoted or not."""
    flat: dict[str, Any] = {}
    for key, value in table.items():
        flat |= dotted(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value}
    return flat


def wire(instances: dict[str, Instance], sink: str, source: Any) -> Wire:
    """A wire whose ends are known, of the right kind and of the same unit."""
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
    reason = mismatch(str(source), origin, sink, to)
    if reason:
        raise LoomfmuError(f"{where}: {reason}")
    return Wire(source=ends[1], sink=ends[0])


def drives_of(instances: dict[str, Instance], wires: list[Wire], table: Any) -> list[Drive]:
    """The inputs that the scene drives along tables; an input has one source."""
    if not isinstance(table, dict):
        raise LoomfmuError('inputs must be a table of "instance.input" = [[revolution, value], ...]')
    drives = []
    wired = {each.sink for each in wires}
    for name, rows in dotted(table).items():
        owner, variable = split(name, instances)
        variable = instances[owner].fmu.name_of(variable)
        if (owner, variable) in wired:
            raise LoomfmuError(f'inputs.{name} is wired already; cut that wire with wires."{name}" = false')
        drives.append(drive(name, instances[owner].fmu.port(variable, f"inputs.{name}"), rows))
    return drives
