"""An instance of a scene: its FMU, the values it starts with, and its name."""

import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

from ... import machines
from ...components.shaft_driven import ShaftDriven
from ...declaring.variables import AT_STEP_END, Variable
from ...errors import LONGEST_NAME, LoomfmuError, shown, suggestion
from ...own.declared import FILES, ISOLATED, PARAMETER_SETS
from ..importing.facts import facts_of
from ..importing.fmus import Fmu, Value
from ..standard import standard
from .settings import KEYS, truth

TOLERANCE = "tolerance"  # of the solver in a third-party FMU
NAME = re.compile("[A-Za-z][A-Za-z0-9_]*")
TAKEN = ("time", "shaft_angle")  # what a trace has beside its instances
TYPES: dict[str, Callable[[Value], Value]] = {"Real": float, "Integer": int, "Boolean": bool}

Copied = TypeVar("Copied")


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
            self.values |= standard().pattern(given, f"{self.name}.pattern")
            return
        if elements := self.fmu.elements(key):
            content = _flat(given)
            last = elements[-1].own.removeprefix(elements[-1].array)
            if len(content) != len(elements):
                raise LoomfmuError(
                    f"{self.name}.{key} is an array up to {last}: {len(elements)} values, not {len(content)}"
                )
            shape = [int(each) for each in last.strip("[]").split(",")]
            if _is_nested(given) and not _has_shape(given, shape):
                raise LoomfmuError(f"{self.name}.{key} is an array up to {last}: write it row by row")
            for port, each in zip(elements, content, strict=True):
                self.set(port.name, each)
            return
        name = self.fmu.name_of(key)
        if key == ISOLATED and name not in self.fmu.ports:
            self.isolated = truth(given, f"{self.name}.{key}")
            return
        if key == TOLERANCE and name not in self.fmu.ports and not self.fmu.ours:
            self.fmu = self.fmu.with_tolerance(given, f"{self.name}.{key}")
            return
        if name not in self.fmu.ports:
            settable = {port.name: port.description for port in self.fmu.ports.values() if port.settable}
            extra = PARAMETER_SETS if self.fmu.built else (*FILES, TOLERANCE)
            hint = suggestion(key, [*settable, *extra, ISOLATED], settable)
            if last := self._last_element(key):
                hint = f": the array ends with {last}"
            if key in KEYS:
                hint = f": {key} belongs to the scene, write it above the first [table]"
            raise LoomfmuError(f"{self.name}.{key} is unknown{hint}")
        port = self.fmu.ports[name]
        if not port.settable:
            kinds = {"output": "an output", "structuralParameter": "a structural parameter"}
            kind = kinds.get(port.causality, "a state")
            raise LoomfmuError(f"{self.name}.{key} is {kind} of {self.fmu.name} and cannot be set")
        where = f"{self.name}.{key}"
        self.values[name] = port.value(given, where)
        self.doubts[where] = port.doubt(given, where)

    def _last_element(self, key: str) -> str:
        """The last element of the array that a name would be an element of; empty where there is none."""
        array = re.match(r"(.*?)(\[[\d,]*\]|(_\d+)+)$", key)
        elements = self.fmu.elements(array[1]) if array else []
        return elements[-1].own if elements else ""

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

    def follow(self, name: str) -> None:
        """Let an input that is fed take effect, such as a shaft's angle; rates of inputs come with these."""
        declared = self._declared()
        if name in declared and name not in {each.rate for each in declared.values()}:
            switch = declared[name].when or ""
            if switch in self.fmu.ports:
                self.values.setdefault(switch, True)

    def inherit(self, others: Mapping[str, "Instance"], fed: Collection[tuple[str, str]]) -> None:
        """Let parameters that are not set have the value of the instance that they usually take it from.

        `fed` are the wired inputs: some parameters have that value only with one of these.
        """
        number = self.name.removeprefix(stem(self.name))
        for name, variable in self._declared().items():
            if variable.causality != "parameter" or not variable.source or name in self.values:
                continue
            if variable.source_for and (self.name, variable.source_for) not in fed:
                continue
            owner, _, parameter = variable.source.replace("_#", number).partition(".")
            if owner in others and owner != self.name and parameter in others[owner].fmu.ports:
                self.inherited[name] = (owner, parameter)
                self.take(name, others)

    def inherit_equals(self, others: Mapping[str, "Instance"], fed: Collection[tuple[str, str]]) -> None:
        """Inherit what has the very value that it would inherit: packages say no more than values."""
        given = dict(self.values)
        for name, variable in self._declared().items():
            if variable.source:
                self.values.pop(name, None)
        self.inherit(others, fed)
        for name, value in given.items():
            if self.values.get(name) != value:
                self.values[name] = value
                self.inherited.pop(name, None)

    def take(self, name: str, others: Mapping[str, "Instance"]) -> None:
        """Give an inherited parameter the value of the instance that it is taken from."""
        owner, parameter = self.inherited[name]
        self.values[name] = others[owner].start(parameter) or 0

    def start(self, name: str) -> Value | None:
        """The value that one of its variables starts with, as it is set or by default."""
        return self.values.get(name, self.fmu.ports[name].start)

    def has_published(self, kind: str, name: str) -> bool:
        """Return whether it has all values of a published machine or head, by this name."""
        wanted = machines.parameters(self.fmu.name, **{kind: name})
        return all(self.start(key) == value for key, value in wanted.items())

    def _declared(self) -> Mapping[str, Variable]:
        """The variables of our component; one that is not known here has those of its kind."""
        return (self.fmu.facts or facts_of(ShaftDriven)).variables if self.fmu.ours else {}

    def effective(self, fed: Collection[str] = ()) -> dict[str, Value]:
        """Its parameters and inputs at the start, without inputs that are fed and values without effect."""
        found = {name: self.effect(name, fed) for name in self.fmu.ports}
        return {name: value for name, value in found.items() if value is not None}

    @property
    def own_speed(self) -> float | None:
        """The speed that it is given to turn at [rad/s]; None where it has none."""
        port = self.fmu.ports.get("speed")
        if port is None or port.causality == "output" or port.unit != "rad/s":
            return None
        return abs(float(self.start("speed") or 0.0))

    def effect(self, name: str, fed: Collection[str] = ()) -> Value | None:
        """A parameter or an input at the start; None if it is fed, or has no effect."""
        switch, _wanted = self.switched_off(name, fed)
        return None if switch else self._fed_start(name, fed)

    def switched_off(self, name: str, fed: Collection[str] = ()) -> tuple[str, str]:
        """The parameter because of whose value another one has no effect, and the value that it needs; no
        name where there is none."""
        declared = self._declared().get(name)
        if declared and declared.when and not self._is_on(declared.when, fed, True):
            return declared.when, self._switching(declared.when, True)
        if declared and declared.unless and self._is_on(declared.unless, fed, False):
            return declared.unless, self._switching(declared.unless, False)
        return "", ""

    def _is_on(self, switch: str, fed: Collection[str], otherwise: bool) -> bool:
        """Return whether a switch is true, or not the first of its choices; `otherwise` if unknown."""
        value = self._fed_start(switch, fed)
        if value is None:
            return otherwise
        return value != 1 if self._declared()[switch].choices else bool(value)

    def _switching(self, switch: str, on: bool) -> str:
        """The value that turns a switch on or off, as a user writes it."""
        choices = self._declared()[switch].choices
        return f'"{choices[on]}"' if choices else str(on).lower()

    def switched(self) -> list[tuple[str, str]]:
        """The inputs that usually come from another instance and that a parameter switches on, after it."""
        declared = self._declared().values()
        return [(v.when, v.name) for v in declared if v.causality == "input" and v.when and v.source]

    def _fed_start(self, name: str, fed: Collection[str]) -> Value | None:
        port = self.fmu.ports.get(name)
        if port is None or not port.settable or name in fed or (port.exact and name not in self.values):
            return None
        start = self.start(name)
        return None if start is None else TYPES[port.kind](start)


def altered(original: Copied, **others: Any) -> Copied:
    """A shallow copy of an object that has no slots, with other attributes.

    A tenth of what `dataclasses.replace` costs, which a run of a prepared scene would call a dozen times.
    """
    made = object.__new__(type(original))
    made.__dict__.update(original.__dict__, **others)
    return made


def _flat(given: Any) -> list[Any]:
    """The values of an array row by row, of lists in lists."""
    return [value for each in given for value in _flat(each)] if isinstance(given, list) else [given]


def _is_nested(given: Any) -> bool:
    """Return whether a list has lists in it."""
    return isinstance(given, list) and any(isinstance(each, list) for each in given)


def _has_shape(given: Any, shape: Sequence[int]) -> bool:
    """Return whether lists in lists are as long as the dimensions of an array."""
    if not shape or not isinstance(given, list):
        return not shape and not isinstance(given, list)
    return len(given) == shape[0] and all(_has_shape(each, shape[1:]) for each in given)


# ---- names


def check_name(name: str) -> None:
    """Refuse what cannot be the name of an instance."""
    if not NAME.fullmatch(name):
        raise LoomfmuError(f"instance name {shown(name)} must be letters, digits and _, with a letter first")
    if len(name) > LONGEST_NAME:
        raise LoomfmuError(f"instance name {shown(name)} has {len(name)} characters; at most {LONGEST_NAME}")
    if name in TAKEN:
        raise LoomfmuError(f"instance name {name!r} is taken: every trace has a {name} of its own")


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
