"""The signals that a run must give: those recorded and those that claims need, checked first."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cached_property, partial

from ...declaring.variables import MOTION, TIME, Beside
from ...errors import LoomfmuError, suggestion
from ..claims.claim import Claim
from ..claims.claims import angles_in, doubts, place_of, read
from ..claims.movers import movers_of
from ..claims.signal_claims import Bounded, check_speed
from ..importing.fmus import Port
from ..scenes.scene import Scene
from ..scenes.wiring import left_out

SHAFT_ANGLE = "shaft.angle"
MOST = 5  # names that a warning lists


def output_port(scene: Scene, signal: str, where: str) -> Port:
    """The output, or the input driven by the scene, that a signal names."""
    instance, _, variable = signal.partition(".")
    if instance not in scene.instances:
        hint = suggestion(instance, scene.instances)
        raise LoomfmuError(f"{where}: there is no instance {instance!r}{hint}")
    ports = scene.instances[instance].fmu.ports
    driven = [drive.variable for drive in scene.drives if drive.instance == instance]
    if variable not in ports or (ports[variable].causality != "output" and variable not in driven):
        outputs = [*(port.name for port in ports.values() if port.causality == "output"), *driven]
        raise LoomfmuError(f"{where}: {instance} has no output {variable!r}{suggestion(variable, outputs)}")
    return ports[variable]


def beside_of(scene: Scene, signal: str) -> Beside:
    """The outputs that say more of a signal in this scene.

    It goes one way alone between samples where it is driven along a table, or if all inputs that it depends
    on are constant, or the one that it follows is driven.
    """
    instance, _, variable = signal.partition(".")
    port, facts = output_port(scene, signal, "record"), scene.instances[instance].fmu.facts
    wired = {wire.sink[1] for wire in scene.wires if wire.sink[0] == instance}
    driven = {drive.variable for drive in scene.drives if drive.instance == instance}
    steady = variable in driven
    if facts is not None and facts.component.keeps != MOTION and variable not in driven:
        declared = facts.variables[variable]
        needed = {TIME} if declared.depends is None else {*declared.depends}
        steady = not needed & {TIME, *wired, *(driven - {declared.follows})}
    return port.beside._replace(lowest=variable, highest=variable) if steady else port.beside


def effective_wires(scene: Scene) -> dict[str, str]:
    """The output that each wired input takes its values from, without inputs that are switched off.

    An input that a table drives is its own source.
    """
    wires = [(wire.sink, wire.source) for wire in scene.wires]
    driven = [(drive.instance, drive.variable) for drive in scene.drives]
    return {
        ".".join(sink): ".".join(source)
        for sink, source in wires + [(each, each) for each in driven]
        if not scene.instances[sink[0]].switched_off(sink[1])[0]
    }


def own_speeds(scene: Scene) -> frozenset[str]:
    """The instances that have a speed [rad/s] at which they turn by themselves."""
    return frozenset(name for name, each in scene.instances.items() if each.own_speed is not None)


class Requested:
    """A scene and what is asked of it: its claims, read once, and the signals that a run must give for them.

    It is also what claims see of the scene before the run: its outputs, driven inputs, wires and FMUs.
    """

    def __init__(self, scene: Scene):
        """Read the claims. Raises LoomfmuError for one that cannot be read."""
        self.scene = scene
        self.claims = [read(table, partial(_unit, scene, place_of(table))) for table in scene.claims]

    @cached_property
    def wires(self) -> dict[str, str]:
        """The output that each wired input takes its values from, without inputs that are switched off.

        A driven input is its own source.
        """
        return effective_wires(self.scene)

    @cached_property
    def fmus(self) -> dict[str, str]:
        """The name of each instance's FMU."""
        return {name: instance.fmu.name for name, instance in self.scene.instances.items()}

    @cached_property
    def own_speeds(self) -> frozenset[str]:
        """The instances that have a speed at which they turn by themselves."""
        return own_speeds(self.scene)

    def unit(self, signal: str) -> str:
        """The unit of an output."""
        return output_port(self.scene, signal, "record").unit

    def parameter(self, signal: str) -> float:
        """The value of a parameter. Raises LoomfmuError where it has no effect."""
        value = _parameter(self.scene, signal)
        if math.isnan(value):
            raise LoomfmuError(f"{signal} has no effect")
        return value

    @cached_property
    def _names(self) -> dict[str, None]:
        """The outputs, in the order of the scene, and the driven inputs."""
        instances = self.scene.instances.items()
        ports = ((name, port) for name, instance in instances for port in instance.fmu.ports.values())
        outputs = {f"{name}.{port.name}": None for name, port in ports if port.causality == "output"}
        return outputs | dict.fromkeys(self._driven)

    @property
    def _driven(self) -> list[str]:
        return [f"{drive.instance}.{drive.variable}" for drive in self.scene.drives]

    def __contains__(self, signal: object) -> bool:
        return signal in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    @property
    def angle(self) -> list[str]:
        """The signal of the shaft's angle, by which places are given; none in a scene without a shaft."""
        return [SHAFT_ANGLE] if "shaft" in self.scene.instances else []

    @property
    def recorded(self) -> list[str]:
        """The signals that the scene records, with the inputs that it drives, and all angles that turn
        something, which claims on the trace may need."""
        turning = (mover.angle for mover in movers_of(self.scene.instances, self))
        return [*self.scene.record, *self._driven, *(angle for angle in turning if angle in self)]

    def needed(self, claims: Iterable[Claim], values: Iterable[str]) -> tuple[str, ...]:
        """Return the signals that claims need, and some more whose values are wanted, with their rates."""
        wanted = self.with_rates([*self.angle, *values])
        return tuple(dict.fromkeys([*wanted, *self.judged(claims)]))

    def judged(self, claims: Iterable[Claim]) -> list[str]:
        """Return the signals that claims need, what holds extremes of these, and all rates."""
        wanted = []
        for claim in claims:
            signals = claim.signals(self)
            besides = (output_port(self.scene, signal, "claim").beside for signal in signals)
            names = [beside.lowest if claim.sense > 0 else beside.highest for beside in besides]
            owners = [signal.partition(".")[0] for signal in signals]
            wanted += signals + [f"{o}.{name}" for o, name in zip(owners, names, strict=True) if name]
            wanted += [mover.angle for mover in movers_of(owners, self) if mover.angle]
        return self.with_rates(wanted)

    def decider(self, claim: Claim) -> str:
        """Return the output whose sign decides a yes-or-no output that a claim is on, or an empty text."""
        for signal in claim.signals(self):
            instance, _, name = signal.partition(".")
            facts = self.scene.instances[instance].fmu.facts
            own = facts.variables.get(name) if facts else None
            if facts and own and own.type is bool and (own.lowest_of or own.highest_of):
                extremes = own.lowest_of, own.highest_of
                same = (v for v in facts.variables.values() if (v.lowest_of, v.highest_of) == extremes)
                return next((f"{instance}.{v.name}" for v in same if v.type is float), "")
        return ""

    def with_rates(self, wanted: Iterable[str]) -> list[str]:
        """Return signals, each with what says when it is known and how far it may be off, and its rate.

        The rate is that which is an output.
        """
        names: dict[str, None] = {}
        for signal in wanted:
            while signal and signal not in names:
                names[signal] = None
                port = output_port(self.scene, signal, "record")
                rate = port.rate if port.causality == "output" else None
                owner = signal.split(".")[0]
                for more in (port.beside.valid_if, port.beside.error):
                    if more:
                        names[f"{owner}.{more}"] = None
                signal = f"{owner}.{rate}" if rate else ""
        return list(names)


def _unit(scene: Scene, where: str, signal: str) -> str:
    return output_port(scene, signal, where).unit


def checked_claims(scene: Scene) -> Requested:
    """A scene with a note on each number of a claim that was probably meant in another unit.

    Refuses, before the run, a claim that could not be judged after it.
    """
    requested = Requested(scene)
    notes = [*scene.notes, *_unrecorded(scene)]
    wired = {".".join(wire.sink) for wire in scene.wires}
    known = {name: each.fmu.facts for name, each in scene.instances.items() if each.fmu.facts}
    for table, claim in zip(scene.claims, requested.claims, strict=True):
        where = place_of(table)
        for angle in angles_in(table) if "shaft" not in scene.instances else ():
            raise LoomfmuError(f"{where}: {angle} is a shaft angle, but the scene has no shaft")
        for signal in claim.signals(requested):
            output_port(scene, signal, where)
            notes += [
                f"{where}: {signal} leaves out {source}, because {sink} is not wired;"
                f' set "{sink}" = "{source}" in [wires] and coupling = "iterated"'
                for sink, source in left_out(known, wired, signal).items()
            ]
        if isinstance(claim, Bounded) and not isinstance(claim.bound, str):
            port = output_port(scene, claim.signal, where)
            notes.append(port.doubt(table["bound"], f"{where} of {claim.signal}: bound"))
        check_bounds(scene, [claim])
        notes += doubts(table)
    requested.scene = replace(scene, notes=tuple(dict.fromkeys(note for note in notes if note)))
    return requested


def check_bounds(scene: Scene, claims: Iterable[Claim]) -> None:
    """Refuse parameters that cannot bound the signal of a claim, or that rule it out."""
    for claim in claims:
        claim.check(partial(_parameter, scene))
        if isinstance(claim, Bounded) and isinstance(claim.bound, str):
            _check_parameter(scene, claim.bound, claim.signal)


def _parameter(scene: Scene, name: str) -> float:
    """The value of a parameter, NaN where the scene does not know it."""
    instance, _, variable = name.partition(".")
    value = scene.instances[instance].effect(variable)
    return math.nan if value is None else float(value)


def _unrecorded(scene: Scene) -> Iterator[str]:
    """A warning for each FMU that has outputs, but none that can be recorded."""
    for name, instance in scene.instances.items():
        fmu = instance.fmu
        if fmu.unsupported and not any(port.causality == "output" for port in fmu.ports.values()):
            listed = ", ".join([*fmu.unsupported[:MOST], *["..."] * (len(fmu.unsupported) > MOST)])
            yield f"{name}: nothing recorded; none of its outputs is a scalar number or a Boolean: {listed}"


def _check_parameter(scene: Scene, name: str, signal: str) -> None:
    """A parameter that bounds a signal is one of the scene, in the signal's unit."""
    instance, _, variable = name.partition(".")
    ports = scene.instances[instance].fmu.ports if instance in scene.instances else {}
    if variable not in ports or ports[variable].causality != "parameter":
        known = [f"{instance}.{port.name}" for port in ports.values() if port.causality == "parameter"]
        raise LoomfmuError(f"claim: bound = {name!r} is not a parameter{suggestion(name, known)}")
    value = scene.instances[instance].effect(variable)
    if value is None:
        raise LoomfmuError(
            f"claim: bound = {name!r} has no effect in this scene, as {instance} does not use it"
        )
    wanted, given = output_port(scene, signal, "claim").unit, ports[variable].unit
    if given != wanted:
        raise LoomfmuError(f"claim: bound {name} is in {given}, but {signal} is in {wanted}")
    check_speed(name, float(value), wanted)
