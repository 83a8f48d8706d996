"""The instances that a scene's tables name, and the values that they and `--set` give them."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from ... import machines
from ...components import COMPONENTS
from ...errors import LoomfmuError, listed, shown, suggestion, within
from ...own import load
from ...own.declared import FILES, PARAMETER_SETS
from ..importing import fmus
from ..importing.facts import facts_of
from ..importing.fmus import Fmu
from ..standard import standard
from .instances import Instance, check_name, is_numbered, members, stem
from .settings import KEYS, TIMES, WHOLE, dotted, refuse_gone

WEAVE = "loom.weave"  # the frames depend on it, so it is set before there are instances


class Given(NamedTuple):
    """The instances of a scene, the keys that give them values, and the texts of the files that they name."""

    instances: dict[str, Instance]
    keys: list[tuple[str, str]]
    texts: dict[str, str]


def read(tables: dict[str, Any], overrides: Mapping[str, Any], directory: Path) -> Given:
    """Read the instances of a scene, with other values; those of the scene's own keys go into its tables."""
    rest = _override_weave(tables, overrides)
    texts = standard().resolve(tables, directory)
    given = _instance_tables(tables, directory)
    state_units(given, tables.get("units", {}))
    changed = {key for key in rest if override(given, key, rest)}
    instances = {
        name: Instance(name, _fmu_of(name, table, directory, texts)) for name, table in given.items()
    }
    for key, name, variable in prevailing(rest, partial(overridden, instances)):
        if not name:
            tables[variable] = rest[key]
        elif key not in changed:
            given[name] = given[name] | {variable: rest[key]}
    for name, table in given.items():
        _set(instances[name], table)
    keys = [(name, key) for name, table in given.items() for key in table]
    return Given(instances, keys, texts)


def _instance_tables(tables: dict[str, Any], directory: Path) -> dict[str, dict[str, Any]]:
    """The table of each instance: the standard loom's, then what the scene says of each."""
    given = _loom(tables, directory)
    groups: set[str] = set()
    of_loom = {stem(name) for name in given if is_numbered(name)}
    numbered = of_loom | {stem(name) for name in tables if is_numbered(name)}
    for key, table in tables.items():
        if key in KEYS:
            continue
        refuse_gone(key)
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


def _set(instance: Instance, table: Mapping[str, Any]) -> None:
    """Set its values, checked and in SI: a value of its own prevails over its machine's or its array's."""
    whole = {key: key in PARAMETER_SETS or bool(instance.fmu.elements(key)) for key in table}
    for key in sorted(table, key=lambda key: not whole[key]):
        if key != "component" and (key not in FILES or instance.fmu.built):
            instance.set(key, table[key])
    instance.settle()


def _fmu_of(name: str, table: dict[str, Any], directory: Path, texts: dict[str, str]) -> Fmu:
    """The FMU that a table names: a file, or one of our components.

    The texts of a component's Python files are added, by the names that the scene gives them.
    """
    for key in ("component", "fmu"):
        if not isinstance(table.get(key, ""), str):
            raise LoomfmuError(f"{name}.{key} = {shown(table[key])} is not a name in quotes")
    component = str(table.get("component", standard().COMPONENT_OF.get(stem(name))))
    if "fmu" not in table:
        fmu = _of_component(name, component, directory, texts)
        if name == "shaft" and not (fmu.facts and fmu.facts.turns_others):
            known = " or a ".join(name for name, each in COMPONENTS.items() if facts_of(each).turns_others)
            raise LoomfmuError(f"shaft.component = {component!r}: the shaft of a scene must be a {known}")
        return fmu
    if "component" in table:
        raise LoomfmuError(f"{name} has both a component and an fmu; keep one of them")
    try:
        fmu = fmus.load(directory / table["fmu"]).with_units(table.get("units", {}), name)
    except LoomfmuError as error:
        raise LoomfmuError(
            str(error) if str(error).startswith(f"{name}.") else f"{name}.fmu: {error}"
        ) from None
    return fmu.as_shaft() if name == "shaft" else fmu


def _of_component(name: str, component: str, directory: Path, texts: dict[str, str]) -> Fmu:
    """The FMU of a component: one of ours, or one of a Python file, which is run."""
    if not load.is_file(component):
        return fmus.of_component(component)
    with within(f"{name}.component"):
        made = load.component(component, directory)
        texts |= load.texts(component, directory, load.COMPONENT)
        return fmus.of_class(made)


# ---- values that differ from the scene's


def _override_weave(tables: dict[str, Any], overrides: Mapping[str, Any]) -> dict[str, Any]:
    """Change the weave of a scene's loom, if that is among the overrides; the other ones."""
    if WEAVE in overrides:
        if not isinstance(tables.get("loom"), dict):
            raise LoomfmuError(f"{WEAVE}: the scene has no [loom]; set the pattern of a heald frame instead")
        tables["loom"] = tables["loom"] | {"weave": overrides[WEAVE]}
    return {key: value for key, value in overrides.items() if key != WEAVE}


def override(given: dict[str, dict[str, Any]], key: str, overrides: Mapping[str, Any]) -> bool:
    """Change one value in the tables of instances; false for a key that names none of them."""
    value = overrides[key]
    instance, _, variable = key.partition(".")
    named = [instance] if instance in given else members(instance, given)
    if not variable:
        return False
    about = unit_of(variable)
    for name in named:
        if name != instance and f"{name}.{variable}" in overrides:
            continue
        if about:
            stated = given[name].get("units", {})
            value = {**stated, about: value} if isinstance(stated, dict) else stated
        given[name] = given[name] | {"units" if about else variable: value}
    return bool(named)


def state_units(given: dict[str, dict[str, Any]], stated: Any) -> None:
    """Put the units of a scene's own table into those of instances, which prevail."""
    if not isinstance(stated, dict):
        raise LoomfmuError('units must be a table of "instance.variable" = "unit"')
    for key, unit in dotted(stated).items():
        name, _, variable = key.partition(".")
        if name not in given:
            raise LoomfmuError(f"units.{key}: there is no instance {name!r}{suggestion(name, given)}")
        own = given[name].get("units", {})
        if isinstance(own, dict):
            given[name] = given[name] | {"units": {variable: unit} | dotted(own)}


def unit_of(key: str) -> str:
    """The variable whose unit a key such as `units.flange.w` states; an empty text for other keys."""
    return key.removeprefix("units.") if key.startswith("units.") else ""


def overridden(instances: Mapping[str, Instance], key: str) -> list[tuple[str, str]]:
    """Return the variables that a key of `--set` or of a sweep sets, as (instance, variable).

    The scene's own keys have no instance. What the loom has one of, such as its machine, goes to all
    instances that take something of it.
    """
    instance, dot, variable = key.partition(".")
    if instance == "loom" and "loom" not in instances:
        if key == WEAVE:
            raise LoomfmuError(f"{key} cannot be set here: the scene's frames depend on it")
        if variable not in machines.TAKERS:
            raise LoomfmuError(f"{key} cannot be set{suggestion(variable, [*machines.TAKERS, 'weave'])}")
        key, dot = variable, ""
    if key in machines.TAKERS:
        takers = machines.TAKERS[key]
        found = [name for name, each in instances.items() if each.fmu.ours and each.fmu.name in takers]
        if not found:
            raise LoomfmuError(f"{key}: the scene has no {listed(takers, 'or')} to apply it to")
        return [(name, key) for name in found]
    if not dot:
        if key not in (*TIMES, *WHOLE):
            refuse_gone(key)
            raise LoomfmuError(f"{shown(key)} cannot be set{_nearest(key, instances)}")
        return [("", key)]
    found = [instance] if instance in instances else members(instance, instances)
    if not found:
        raise LoomfmuError(f"{key}: the scene has no instance {instance!r}{suggestion(instance, instances)}")
    return [(member, variable) for member in found]


def prevailing(
    keys: Collection[str], targets: Callable[[str], Iterable[tuple[str, str]]]
) -> Iterator[tuple[str, str, str]]:
    """Yield the keys with the variables that each sets, as (key, instance, variable).

    A key that names the very variable prevails over those for all members or of the loom. Raises
    LoomfmuError for two others that set the same one.
    """
    setting: dict[str, str] = {}
    for key in keys:
        for instance, variable in targets(key):
            name = f"{instance}.{variable}" if instance else variable
            if key != name and name in keys:
                continue
            if name in setting:
                raise LoomfmuError(f"{setting[name]} and {key} both set {name}; leave out one of them")
            setting[name] = key
            yield key, instance, variable


def _nearest(key: str, instances: Mapping[str, Instance]) -> str:
    """Return a suggestion for a key without an instance, as the end of a message."""
    variables: dict[str, list[str]] = {}  # of each of our instances, those that can be set
    for name, each in instances.items():
        if each.fmu.ours and each.fmu.name in COMPONENTS:
            declared = facts_of(COMPONENTS[each.fmu.name]).variables.values()
            variables[name] = [variable.name for variable in declared if variable.settable]
    for name in variables:
        if key in (name, stem(name)):
            return f": it is an instance; set one of its variables, such as {key}.{variables[name][0]}"
    full = [WEAVE, *(f"{name}.{variable}" for name, each in variables.items() for variable in each)]
    for name in full:
        if name.partition(".")[2] == key:
            return f"; did you mean {name!r}?"
    return suggestion(key, [*TIMES, *WHOLE, *machines.TAKERS, *(f"{name}." for name in variables)])
