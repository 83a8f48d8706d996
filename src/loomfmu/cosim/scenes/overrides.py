"""Values that differ from a scene's: what each key of `--set` stands for."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from ... import machines
from ...components import COMPONENTS
from ...errors import LoomfmuError, listed, shown, suggestion
from ..importing.facts import facts_of
from .instance_tables import fmu_of
from .instances import Instance
from .keys import TIMES, WHOLE, members, stem

WEAVE = "loom.weave"  # the frames depend on it, so it is set before there are instances


def override(
    tables: dict[str, Any], given: dict[str, dict[str, Any]], key: str, value: Any, directory: Path
) -> None:
    """Change one value of a scene's tables."""

    def component(name: str) -> str:
        fmu = fmu_of(name, given[name], directory)
        return fmu.name if fmu.ours else ""

    for member, variable in overridden(given, key, component):
        about = unit_of(variable)
        if about:
            stated = given[member].get("units", {})
            value = {**stated, about: value} if isinstance(stated, dict) else stated
            given[member] = given[member] | {"units": value}
        elif member:
            given[member] = given[member] | {variable: value}
        else:
            tables[variable] = value


def override_weave(tables: dict[str, Any], overrides: dict[str, Any]) -> dict[str, Any]:
    """Change the weave of a scene's loom, if that is among the overrides; the other ones."""
    if WEAVE in overrides:
        if not isinstance(tables.get("loom"), dict):
            raise LoomfmuError(f"{WEAVE}: the scene has no [loom]; set the pattern of a heald frame instead")
        tables["loom"] = tables["loom"] | {"weave": overrides[WEAVE]}
    return {key: value for key, value in overrides.items() if key != WEAVE}


def unit_of(key: str) -> str:
    """The variable whose unit a key such as `units.flange.w` states; an empty text for other keys."""
    return key.removeprefix("units.") if key.startswith("units.") else ""


def components(instances: dict[str, Instance]) -> Callable[[str], str]:
    """A function that names the component of each instance; an empty text for a third-party FMU."""
    return lambda name: instances[name].fmu.name if instances[name].fmu.ours else ""


def overridden(given: Iterable[str], key: str, component: Callable[[str], str]) -> list[tuple[str, str]]:
    """Return the variables that a key of `--set` or of a sweep sets, as (instance, variable).

    The scene's own keys have no instance. What the loom has one of, such as its machine, goes to all
    instances that take something of it.
    """
    given = list(given)
    instance, dot, variable = key.partition(".")
    if instance == "loom" and "loom" not in given:
        if key == WEAVE:
            raise LoomfmuError(f"{key} cannot be set here: the scene's frames depend on it")
        if variable not in machines.TAKERS:
            raise LoomfmuError(f"{key} cannot be set{suggestion(variable, [*machines.TAKERS, 'weave'])}")
        key, dot = variable, ""
    if key in machines.TAKERS:
        takers = machines.TAKERS[key]
        found = [name for name in given if component(name) in takers]
        if not found:
            raise LoomfmuError(f"{key}: the scene has no {listed(takers, 'or')} to apply it to")
        return [(name, key) for name in found]
    if not dot:
        if key not in (*TIMES, *WHOLE):
            raise LoomfmuError(f"{shown(key)} cannot be set{_nearest(key, given, component)}")
        return [("", key)]
    found = [instance] if instance in given else members(instance, given)
    if not found:
        raise LoomfmuError(f"{key}: the scene has no instance {instance!r}{suggestion(instance, given)}")
    return [(member, variable) for member in found]


def _nearest(key: str, given: Iterable[str], component: Callable[[str], str]) -> str:
    """Return a suggestion for a key without an instance, as the end of a message."""
    variables: dict[str, list[str]] = {}  # of each of our instances, those that can be set
    for name in given:
        if component(name) in COMPONENTS:
            declared = facts_of(COMPONENTS[component(name)]).variables.values()
            variables[name] = [variable.name for variable in declared if variable.settable]
    for name in variables:
        if key in (name, stem(name)):
            return f": it is an instance; set one of its variables, such as {key}.{variables[name][0]}"
    full = [WEAVE, *(f"{name}.{variable}" for name, each in variables.items() for variable in each)]
    for name in full:
        if name.partition(".")[2] == key:
            return f"; did you mean {name!r}?"
    return suggestion(key, [*TIMES, *WHOLE, *machines.TAKERS, *(f"{name}." for name in variables)])
