"""The angles and speeds that turn the instances of a claim: whole revolutions of these matter."""

import math
import re
from collections.abc import Container, Iterable, Iterator, Mapping
from functools import lru_cache
from typing import NamedTuple, Protocol

from ...components import COMPONENTS
from ...components.shaft_driven import FOLLOWED, ShaftDriven
from ...components.terminals import SHAFT
from ...errors import LoomfmuError
from ...units import UNITS, canonical

ANGLE_INPUT, ANGLE = next(iter(FOLLOWED.items()))
SPEED = "speed"  # the parameter, or the input, of what turns by itself


class Mover(NamedTuple):
    """An angle that turns an instance, or the parameter with the speed at which one turns by itself.

    `turns` says that the angle goes on for whole turns; that of a mechanism of one's own may swing instead.
    `turn` is a whole turn in the angle's unit.
    """

    angle: str
    speed: str = ""
    turns: bool = True
    turn: float = math.tau


class Wired(Protocol):
    """A run, or a scene before it: its signals, its wires from input to output, its FMUs and parameters.

    An input that a table drives is wired to itself; `own_speeds` are the instances with a speed to turn at.
    """

    @property
    def wires(self) -> Mapping[str, str]: ...

    @property
    def fmus(self) -> Mapping[str, str]: ...

    @property
    def own_speeds(self) -> Container[str]: ...

    def __contains__(self, signal: object) -> bool: ...

    def __iter__(self) -> Iterator[str]: ...

    def unit(self, signal: str) -> str: ...

    def parameter(self, signal: str) -> float: ...


def owners_of(signals: Iterable[str]) -> set[str]:
    """Return the instances whose outputs some signals are, or stand in them where these are expressions."""
    return {name for signal in signals for name in re.findall(r"(?<![\w.])([^\W\d]\w*)\.\S", signal)}


def movers_of(instances: Iterable[str], run: Wired) -> list[Mover]:
    """Return what turns some instances, directly or through others, loads included."""
    found, passed, waiting = dict[Mover, None](), set[str](), sorted(set(instances))
    wires = _by_owner(tuple(run.wires.items()))
    followed = {given[ANGLE_INPUT] for given in wires.values() if ANGLE_INPUT in given}
    while waiting:
        name = waiting.pop()
        if name not in passed:
            passed.add(name)
            given = wires.get(name, {})
            found |= dict.fromkeys(_of(name, given, followed, run))
            waiting += [source.rpartition(".")[0] for source in given.values()]
    return list(found)


@lru_cache(maxsize=16)  # every claim on every run of a sweep asks
def _by_owner(wires: tuple[tuple[str, str], ...]) -> dict[str, dict[str, str]]:
    """Return the sources of the wired inputs of each instance."""
    found = dict[str, dict[str, str]]()
    for sink, source in wires:
        name, _dot, variable = sink.rpartition(".")
        found.setdefault(name, {})[variable] = source
    return found


def _of(name: str, given: Mapping[str, str], followed: Container[str], run: Wired) -> Iterator[Mover]:
    """Yield what turns one instance, given the sources of its inputs; a `followed` shaft turns itself."""
    fmu, own = run.fmus.get(name, ""), f"{name}.{ANGLE}"
    if ANGLE_INPUT in given:
        yield _turning(given[ANGLE_INPUT], run)
    elif turns_alone(name, run):
        yield Mover("", f"{name}.{SPEED}")
    if _is_shaft(fmu) or own in followed:
        yield _turning(own, run)
    for variable, source in given.items() if fmu not in COMPONENTS else ():
        if variable not in FOLLOWED and source in run and (turn := whole_turn(run.unit(source))):
            yield Mover(source, turns=_is_shaft(run.fmus.get(source.rpartition(".")[0], "")), turn=turn)


def _is_shaft(fmu: str) -> bool:
    """Return whether an FMU is a shaft of ours."""
    return fmu in COMPONENTS and SHAFT.of(*SHAFT.members) in COMPONENTS[fmu].terminals


def _turning(angle: str, run: Wired) -> Mover:
    unit = run.unit(angle) if angle in run else "rad"
    plain = math.tau if unit == "1" else math.inf  # of a unit that is not known nobody knows a whole turn
    return Mover(angle, turn=whole_turn(unit) or plain)


def whole_turn(unit: str) -> float:
    """Return a whole turn in a unit of angles, and 0 for any other unit."""
    known = UNITS.get(canonical(unit))
    return math.tau / known.factor if known and known.dimension == UNITS["rad"].dimension else 0.0


def turns_alone(name: str, run: Wired) -> bool:
    """Return whether an instance turns at its own speed: it cannot follow a shaft, or is set not to."""
    fmu = run.fmus.get(name, "")
    follows = fmu not in COMPONENTS or issubclass(COMPONENTS[fmu], ShaftDriven)
    if not follows or name not in run.own_speeds:
        return False
    try:
        run.parameter(f"{name}.{SPEED}")
    except LoomfmuError:  # it has no effect
        return False
    return True
