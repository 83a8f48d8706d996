"""The instances of a scene: which FMU each is, and the values it starts with."""

import re
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeVar

from ... import machines
from ...components.shaft_driven import ShaftDriven
from ...errors import LONGEST_NAME, LoomfmuError, listed, shown, suggestion
from ...own import load
from ...own.declared import FILES, ISOLATED, PARAMETER_SETS
from ...variables import AT_STEP_END, Component, Variable, variables_of
from ..importing import fmus
from ..importing.fmus import Fmu, Port, Value
from . import standard_loom
from .graph import Wire

COARSE = "coarse_steps_per_revolution"
ACCURACY = "accuracy"  # which chooses the steps
# keys of the scene itself that can be set beside its times
WHOLE = (ACCURACY, "grid", COARSE, "coupling", ISOLATED, "step_timeout", "run_timeout")
KEYS = (
    "title",
    "description",
    "revolutions",
    "steps_per_revolution",
    "duration",
    "step",
    *WHOLE,
    "record",
    "loom",
    "wires",
    "inputs",
    "claims",
    "tolerances",
)
TIMES = ("revolutions", "steps_per_revolution", "duration", "step")
NAME = re.compile("[A-Za-z][A-Za-z0-9_]*")
TAKEN = ("time", "shaft_angle")  # what a trace has beside its instances
TYPES: dict[str, Callable[[Value], Value]] = {"Real": float, "Integer": int, "Boolean": bool}
SHAFT = {"angle": ("rad", "velocity"), "velocity": ("rad/s", "acceleration"), "acceleration": ("rad/s2", "")}

Copied = TypeVar("Copied")

_declared: dict[type[Component], Mapping[str, Variable]] = {}  # by name


@dataclass
class Instance:
    """One FMU of a scene with the values that are set at its start (SI).

    `published` are the machine and the head that its values come from, `doubts` warnings about its values.
    `isolated` says whether it runs in a process of its own; where it does not, the scene decides. `inherited`
    are the parameters that have the value of another instance, and that instance and its parameter.
    """

    name: str
    fmu: Fmu
    values: dict[str, Value] = field(default_factory=dict)
    published: dict[str, str] = field(default_factory=dict)
    doubts: dict[str, str] = field(default_factory=dict)
    isolated: bool | None = None
    inherited: dict[str, tuple[str, str]] = field(default_factory=dict)

    def set(self, key: str, given: Any) -> None:
        """Set a parameter, the start of an input, or all parameters that a published name stands for.

        Raises LoomfmuError for what cannot be set.
        """
        if self.fmu.ours and key in machines.TAKERS:
            self._publish(key, given)
            return
        if self.fmu.ours and key == "pattern":
            if "pattern_length" not in self.fmu.ports:
                raise LoomfmuError(f"{self.name}.pattern: a {self.fmu.name} has no pattern")
            self.values |= standard_loom.pattern(given, f"{self.name}.pattern")
            return
        name = self.fmu.name_of(key)
        if key == ISOLATED and name not in self.fmu.ports:
            self.isolated = truth(given, f"{self.name}.{key}")
            return
        if name not in self.fmu.ports:
            settable = {port.name: port.description for port in self.fmu.ports.values() if _can_be_set(port)}
            extra = PARAMETER_SETS if self.fmu.built else FILES
            hint = suggestion(key, [*settable, *extra, ISOLATED], settable)
            if key in KEYS:
                hint = f": {key} belongs to the scene, write it above the first [table]"
            raise LoomfmuError(f"{self.name}.{key} is unknown{hint}")
        port = self.fmu.ports[name]
        if not _can_be_set(port):
            kinds = {"output": "an output", "structuralParameter": "a structural parameter"}
            kind = kinds.get(port.causality, "a state")
            raise LoomfmuError(f"{self.name}.{key} is {kind} of {self.fmu.name} and cannot be set")
        where = f"{self.name}.{key}"
        self.values[name] = port.value(given, where)
        self.doubts[where] = port.doubt(given, where)

    def _publish(self, kind: str, given: Any) -> None:
        """Take all that a published machine or head gives this component."""
        where = f"{self.name}.{kind}"
        if not isinstance(given, str):
            raise LoomfmuError(f"{where} = {shown(given)} is not a name in quotes")
        if self.fmu.name not in machines.TAKERS[kind]:
            takers = " or a ".join(machines.TAKERS[kind])
            raise LoomfmuError(f"{where}: a {self.fmu.name} has no {kind}; only a {takers} has one")
        found = machines.parameters(self.fmu.name, **{kind: given})
        for key in found:
            self.fmu.port(key, self.name)  # an FMU of another version may lack it
        self.values |= found
        self.published[kind] = given

    def settle(self) -> None:
        """Have our own FMUs take inputs as those of a step's end: our master works in dependency order."""
        if self.fmu.ours and AT_STEP_END in self.fmu.ports:
            self.values.setdefault(AT_STEP_END, True)

    def follow(self, wire: Wire) -> None:
        """Let a wired input take effect, such as the angle of a shaft; rates of inputs come with these."""
        declared = self._declared()
        if wire.sink[1] in declared and wire.sink[1] not in {each.rate for each in declared.values()}:
            switch = declared[wire.sink[1]].when or ""
            if switch in self.fmu.ports:
                self.values.setdefault(switch, True)

    def inherit(self, others: Mapping[str, "Instance"], fed: Collection[tuple[str, str]]) -> None:
        """Let parameters that are not set have the value of the instance that they usually take it from.

        `fed` are the wired inputs: some parameters have that value only with one of these.
        """
        number = self.name.removeprefix(standard_loom.stem(self.name))
        for name, variable in self._declared().items():
            if variable.causality != "parameter" or not variable.source or name in self.values:
                continue
            if variable.source_for and (self.name, variable.source_for) not in fed:
                continue
            owner, _, parameter = variable.source.replace("_#", number).partition(".")
            if owner in others and owner != self.name and parameter in others[owner].fmu.ports:
                self.inherited[name] = (owner, parameter)
                self.take(name, others)

    def take(self, name: str, others: Mapping[str, "Instance"]) -> None:
        """Give an inherited parameter the value of the instance that it is taken from."""
        owner, parameter = self.inherited[name]
        self.values[name] = others[owner].values.get(parameter, others[owner].fmu.ports[parameter].start or 0)

    def _declared(self) -> Mapping[str, Variable]:
        """The variables of our component; one that is not known here has those of its kind."""
        component = self.fmu.component or ShaftDriven
        if component not in _declared:
            _declared[component] = {each.name: each for each in variables_of(component)}
        return _declared[component] if self.fmu.ours else {}

    def effective(self, fed: Collection[str] = ()) -> dict[str, Value]:
        """Its parameters and inputs at the start, without inputs that are fed and values without effect."""
        found = {name: self.effect(name, fed) for name in self.fmu.ports}
        return {name: value for name, value in found.items() if value is not None}

    def effect(self, name: str, fed: Collection[str] = ()) -> Value | None:
        """A parameter or an input at the start; None if it is fed, or has no effect."""
        switch, _wanted = self.switched_off(name, fed)
        return None if switch else self._start(name, fed)

    def switched_off(self, name: str, fed: Collection[str] = ()) -> tuple[str, bool]:
        """The parameter because of whose value another one has no effect, and the value that it needs; no
        name where there is none."""
        declared = self._declared().get(name)
        if declared and declared.when and not self._start(declared.when, fed, True):
            return declared.when, True
        if declared and declared.unless and self._start(declared.unless, fed, False):
            return declared.unless, False
        return "", False

    def switched(self) -> list[tuple[str, str]]:
        """The inputs that usually come from another instance and that a parameter switches on, after it."""
        declared = self._declared().values()
        return [(v.when, v.name) for v in declared if v.causality == "input" and v.when and v.source]

    def _start(self, name: str, fed: Collection[str], otherwise: bool | None = None) -> Value | None:
        port = self.fmu.ports.get(name)
        if port is None or not _can_be_set(port) or name in fed:
            return otherwise
        start = self.values.get(name, port.start)
        return otherwise if start is None else TYPES[port.kind](start)


def altered(original: Copied, **others: Any) -> Copied:
    """A shallow copy of an object that has no slots, with other attributes.

    A tenth of what `dataclasses.replace` costs, which a run of a prepared scene would call a dozen times.
    """
    made = object.__new__(type(original))
    made.__dict__.update(original.__dict__, **others)
    return made


def truth(given: Any, where: str) -> bool:
    """A truth value as people write it."""
    if str(given).lower() not in ("true", "false"):
        raise LoomfmuError(f"{where} = {given!r} must be true or false")
    return str(given).lower() == "true"


def _can_be_set(port: Port) -> bool:
    return port.causality in ("parameter", "input")


def check_name(name: str) -> None:
    """Refuse what cannot be the name of an instance."""
    if not NAME.fullmatch(name):
        raise LoomfmuError(f"instance name {shown(name)} must be letters, digits and _, with a letter first")
    if len(name) > LONGEST_NAME:
        raise LoomfmuError(f"instance name {shown(name)} has {len(name)} characters; at most {LONGEST_NAME}")
    if name in TAKEN:
        raise LoomfmuError(f"instance name {name!r} is taken: every trace has a {name} of its own")


def instance_tables(tables: dict[str, Any], directory: Path) -> dict[str, dict[str, Any]]:
    """The table of each instance: the standard loom's, then what the scene says of each."""
    given = _loom(tables, directory)
    groups: set[str] = set()
    of_loom = {standard_loom.stem(name) for name in given if standard_loom.is_numbered(name)}
    numbered = of_loom | {standard_loom.stem(name) for name in tables if standard_loom.is_numbered(name)}
    for key, table in tables.items():
        if key in KEYS:
            continue
        if not isinstance(table, dict):
            raise LoomfmuError(f"{key} is unknown{suggestion(key, KEYS)}")
        if key not in given and key in (of_loom if "component" in table else numbered):
            groups.add(key)
            continue
        known = standard_loom.COMPONENT_OF
        named = "component" in table or "fmu" in table
        if key not in given and not named and standard_loom.stem(key) not in known:
            hint = suggestion(key, dict.fromkeys([*KEYS, *given, *known]))
            raise LoomfmuError(f'[{key}] is unknown and has no component = "..." of its own{hint}')
        check_name(key)
        given[key] = given.get(key, {}) | table
    for name in given:  # a table for all members says less than a member's own
        group = standard_loom.stem(name)
        if group in groups and standard_loom.is_numbered(name):
            given[name] = given[name] | tables[group] | tables.get(name, {})
    return given


def _loom(tables: dict[str, Any], directory: Path) -> dict[str, dict[str, Any]]:
    """The instances that a scene need not spell out. One that runs by seconds needs no shaft."""
    loom = tables.get("loom")
    if loom is None:
        return {} if "duration" in tables or "step" in tables else {"shaft": {}}
    if not isinstance(loom, dict):
        raise LoomfmuError(f"loom = {shown(loom)} must be a table [loom]")
    return standard_loom.loom(loom, directory)


def instance(name: str, table: dict[str, Any], directory: Path) -> Instance:
    """An instance with its values checked and in SI: a value of its own prevails over its machine's."""
    fmu = fmu_of(name, table, directory)
    found = Instance(name, fmu)
    for key in sorted(table, key=lambda key: key not in PARAMETER_SETS):
        if key != "component" and (key not in FILES or fmu.built):
            found.set(key, table[key])
    found.settle()
    return found


def mixed(instances: dict[str, Instance]) -> list[str]:
    """Warnings where the instances of a loom are not all of one machine, or those of a rapier of one head."""
    notes = []
    for kind, takers in machines.TAKERS.items():
        groups: dict[str, list[Instance]] = {}
        for name, each in instances.items():
            if each.fmu.ours and each.fmu.name in takers:
                groups.setdefault(_rapier(name, instances) if kind == "head" else "", []).append(each)
        notes += [note for fitted in groups.values() if (note := _mixed(kind, fitted))]
    return notes


def _rapier(name: str, instances: Collection[str]) -> str:
    """The number of the rapier that an instance belongs to; none where there is one."""
    number = name.removeprefix(standard_loom.stem(name))
    return number if f"weft{number}" in instances else ""


def _mixed(kind: str, fitted: list[Instance]) -> str:
    """A warning where some instances do not have the same machine or head; none where they do."""
    names = dict.fromkeys(each.published[kind] for each in fitted if kind in each.published)
    differing = [
        each for each in fitted if kind not in each.published and not all(_is(each, kind, n) for n in names)
    ]
    if len(names) < 2 and not differing:
        return ""
    shown = [f"{each.name} has {each.published[kind]}" for each in fitted if kind in each.published]
    shown += [f"{each.name} has its own values" for each in differing]
    return f"the loom mixes {kind}s: {listed(shown)}; {kind} = NAME sets all of them"


def _is(each: Instance, kind: str, name: str) -> bool:
    """Whether an instance has the values of a published machine or head though it does not name it."""
    wanted = machines.parameters(each.fmu.name, **{kind: name})
    return all(each.values.get(key, each.fmu.ports[key].start) == value for key, value in wanted.items())


def fmu_of(name: str, table: dict[str, Any], directory: Path) -> Fmu:
    """The FMU that a table names: a file, or one of our components."""
    for key in ("component", "fmu"):
        if not isinstance(table.get(key, ""), str):
            raise LoomfmuError(f"{name}.{key} = {shown(table[key])} is not a name in quotes")
    component = str(table.get("component", standard_loom.COMPONENT_OF.get(standard_loom.stem(name))))
    if "fmu" not in table:
        fmu = _of_component(name, component, directory)
        if name == "shaft" and not (fmu.component and standard_loom.turns_others(fmu.component)):
            shafts = " or a ".join(standard_loom.shafts())
            raise LoomfmuError(f"shaft.component = {component!r}: the shaft of a scene must be a {shafts}")
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
