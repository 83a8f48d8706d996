"""The tables of a scene's instances: which FMU each one names, and the values it gives."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...components import COMPONENTS
from ...errors import LoomfmuError, shown, suggestion
from ...own import load
from ...own.declared import FILES, PARAMETER_SETS
from ..importing import fmus
from ..importing.facts import facts_of
from ..importing.fmus import Fmu
from ..standard import standard
from .instances import Instance
from .keys import KEYS, check_name, is_numbered, stem

SHAFT = {"angle": ("rad", "velocity"), "velocity": ("rad/s", "acceleration"), "acceleration": ("rad/s2", "")}


def instance_tables(tables: dict[str, Any], directory: Path) -> dict[str, dict[str, Any]]:
    """The table of each instance: the standard loom's, then what the scene says of each."""
    given = _loom(tables, directory)
    groups: set[str] = set()
    of_loom = {stem(name) for name in given if is_numbered(name)}
    numbered = of_loom | {stem(name) for name in tables if is_numbered(name)}
    for key, table in tables.items():
        if key in KEYS:
            continue
        if not isinstance(table, dict):
            raise LoomfmuError(f"{key} is unknown{suggestion(key, KEYS)}")
        if key not in given and key in (of_loom if "component" in table else numbered):
            groups.add(key)
            continue
        known = standard().COMPONENT_OF
        named = "component" in table or "fmu" in table
        if key not in given and not named and stem(key) not in known:
            hint = suggestion(key, dict.fromkeys([*KEYS, *given, *known]))
            raise LoomfmuError(f'[{key}] is unknown and has no component = "..." of its own{hint}')
        check_name(key)
        given[key] = given.get(key, {}) | table
    for name in given:  # a table for all members says less than a member's own
        group = stem(name)
        if group in groups and is_numbered(name):
            given[name] = given[name] | tables[group] | tables.get(name, {})
    return given


def _loom(tables: dict[str, Any], directory: Path) -> dict[str, dict[str, Any]]:
    """The instances that a scene need not spell out. One that runs by seconds needs no shaft."""
    loom = tables.get("loom")
    if loom is None:
        return {} if "duration" in tables or "step" in tables else {"shaft": {}}
    if not isinstance(loom, dict):
        raise LoomfmuError(f"loom = {shown(loom)} must be a table [loom]")
    return standard().instances_of(loom, directory)


def instance(name: str, table: dict[str, Any], directory: Path) -> Instance:
    """An instance with its values checked and in SI: a value of its own prevails over its machine's."""
    fmu = fmu_of(name, table, directory)
    found = Instance(name, fmu)
    for key in sorted(table, key=lambda key: key not in PARAMETER_SETS):
        if key != "component" and (key not in FILES or fmu.built):
            found.set(key, table[key])
    found.settle()
    return found


def fmu_of(name: str, table: dict[str, Any], directory: Path) -> Fmu:
    """The FMU that a table names: a file, or one of our components."""
    for key in ("component", "fmu"):
        if not isinstance(table.get(key, ""), str):
            raise LoomfmuError(f"{name}.{key} = {shown(table[key])} is not a name in quotes")
    component = str(table.get("component", standard().COMPONENT_OF.get(stem(name))))
    if "fmu" not in table:
        fmu = _of_component(name, component, directory)
        if name == "shaft" and not (fmu.facts and fmu.facts.turns_others):
            known = " or a ".join(name for name, each in COMPONENTS.items() if facts_of(each).turns_others)
            raise LoomfmuError(f"shaft.component = {component!r}: the shaft of a scene must be a {known}")
        return fmu
    if "component" in table:
        raise LoomfmuError(f"{name} has both a component and an fmu; keep one of them")
    try:
        fmu = with_units(fmus.load(directory / table["fmu"]), table.get("units", {}), name)
    except LoomfmuError as error:
        raise LoomfmuError(
            str(error) if str(error).startswith(f"{name}.") else f"{name}.fmu: {error}"
        ) from None
    return as_shaft(fmu) if name == "shaft" else fmu


def _of_component(name: str, component: str, directory: Path) -> Fmu:
    """The FMU of a component: one of ours, or one of a Python file, which is run."""
    if not load.is_file(component):
        return fmus.of_component(component)
    try:
        return fmus.of_class(load.component(component, directory))
    except LoomfmuError as error:
        raise LoomfmuError(f"{name}.component: {error}") from None


def own_texts(tables: Iterable[dict[str, Any]], directory: Path) -> dict[str, str]:
    """The texts of the Python files that instances are made of, by the names that the scene gives them."""
    named = [table["component"] for table in tables if load.is_file(table.get("component"))]
    return {file: text for component in named for file, text in load.texts(component, directory).items()}


def with_units(fmu: Fmu, stated: Any, name: str) -> Fmu:
    """An FMU with the units that a scene states for its variables, where the FMU states none."""
    if not isinstance(stated, dict) or not all(isinstance(unit, str) for unit in stated.values()):
        raise LoomfmuError(f'{name}.units = {shown(stated)} must be a table of variable = "unit"')
    ports = dict(fmu.ports)
    for key, unit in stated.items():
        port = fmu.port(fmu.name_of(key), f"{name}.units")
        ports[port.name] = port.with_unit(unit, None, f"{name}.units.{key}")
    return replace(fmu, ports=ports)


def as_shaft(fmu: Fmu) -> Fmu:
    """An FMU in the place of the main shaft: it outputs the angle, and its other outputs are the rates."""
    ports = dict(fmu.ports)
    for variable, (unit, rate) in SHAFT.items():
        port = ports.get(variable)
        fits = port is not None and port.causality == "output" and port.unit == unit
        if port is not None and fits:
            ports[variable] = replace(port, rate=port.rate or (rate if rate in ports else None))
        elif variable == "angle":
            raise LoomfmuError(f"{fmu.path}: the shaft of a scene must have an output angle in rad")
    return replace(fmu, ports=ports)
