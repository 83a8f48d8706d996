"""The signals that a run must give for what is asked of a scene, and steps that show how instances move."""

import math
from collections.abc import Iterable, Iterator
from functools import cached_property, partial

from ...components import COMPONENTS
from ...declaring.variables import MOTION, TIME, Beside, Component
from ...errors import LoomfmuError, suggestion
from ..claims.claim import Claim
from ..claims.claims import place_of, read
from ..claims.movers import movers_of, whole_turn
from ..importing.fmus import Port
from ..scenes.scene import Scene

SHAFT_ANGLE = "shaft.angle"
EVENT = 4.0  # steps that show an event of a mechanism
SHOWN = 9.0  # deg: the turn that shows any of them; with twice as much, claims on a shaft are undecided, too


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
        follows = facts.variables[variable].follows
        steady = facts.needs[variable].isdisjoint({TIME, *wired, *(driven - {follows})})
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


def parameter_of(scene: Scene, name: str) -> float:
    """The value of a parameter, NaN where the scene does not know it."""
    instance, _, variable = name.partition(".")
    value = scene.instances[instance].effect(variable)
    return math.nan if value is None else float(value)


class Requested:
    """A scene and what is asked of it: its claims, read once, and the signals that a run must give for them.

    It is also what claims see of the scene before the run: its outputs, driven inputs, wires and FMUs.
    """

    def __init__(self, scene: Scene):
        """Read the claims. Raises LoomfmuError for one that cannot be read."""
        self.scene = scene
        directory = None if scene.package else scene.directory  # a package is data, but for its FMUs
        self.claims = [
            read(table, partial(_unit, scene, place_of(table)), directory) for table in scene.claims
        ]

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
        value = parameter_of(self.scene, signal)
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


class Movements:
    """The movements of the instances of a scene, as far as its wires tell."""

    def __init__(self, requested: Requested):
        self._instances, self._requested = requested.scene.instances, requested
        self._angles: dict[str, tuple[str, ...]] = {}

    def angles(self, name: str) -> tuple[str, ...]:
        """The signals of the angles by which an instance moves; none if it turns by itself.

        What follows no shaft moves with the shafts that move what it follows, a mechanism of one's own with
        all angles that it takes, too.
        """
        if name not in self._angles:
            self._angles[name] = self._found(name)
        return self._angles[name]

    def _found(self, name: str) -> tuple[str, ...]:
        instance, wires = self._instances[name], self._requested.wires
        component, ports = instance.fmu.component, instance.fmu.ports.values()
        given = [*instance.fmu.shaft_inputs[:1]]
        if not given and not COMPONENTS.owns(component):
            given = [each.name for each in ports if each.causality == "input" and whole_turn(each.unit)]
        if given:
            taken = [wires[each] for each in (f"{name}.{variable}" for variable in given) if each in wires]
        else:
            others = [each.angle for each in movers_of([name], self._requested) if each.angle]
            alone = instance.own_speed is not None
            taken = others or [*(() if alone else self._main)]
            taken = [each for each in taken if each.partition(".")[0] != name]
        return tuple(dict.fromkeys(taken))

    @cached_property
    def _main(self) -> tuple[str, ...]:
        """The main shaft, if there is one."""
        return (SHAFT_ANGLE,) if SHAFT_ANGLE in self._requested else ()

    def may_pass_by(self, name: str) -> bool:
        """Return whether steps may be too long to show how an instance moves, whatever the values."""
        component = self._instances[name].fmu.component
        if component is None:
            return False
        own = component.shortest_event.__func__, component.longest_step.__func__  # type: ignore[attr-defined]
        usual = Component.shortest_event.__func__, Component.longest_step.__func__  # type: ignore[attr-defined]
        return own != usual or component.longest_turn < math.inf or self._apart(name)[0] < math.inf

    def longest_step(self, scene: Scene, name: str, speed: float | None = None) -> tuple[float, str]:
        """The longest step that shows how an instance moves [s], and why; 0 where none is known.

        `scene` has the values; `speed` is the highest one of the angles by which it moves [rad/s], where a
        run has shown that.
        """
        instance = scene.instances[name]
        component = instance.fmu.component
        if component is None:
            return math.inf, ""
        turn, event = component.shortest_event(instance.effect)
        by_event = turn / EVENT, f"{event} of {name} takes {math.degrees(turn):.4g} deg"
        limit = f"allows steps of at most {math.degrees(component.longest_turn):.4g} deg"
        declared = (
            component.longest_turn,
            f"{name} {limit if component.longest_turn else 'declares no longest_turn'}",
        )
        speeds = [each for each in (speed, self.mean_speed(scene, name)) if each is not None]
        fastest = max(speeds, default=None)
        turns = [by_event, declared] if fastest is None else [by_event, declared, self._apart(name)]
        return min(component.longest_step(instance.effect), _taking(*min(turns), fastest))

    def _apart(self, name: str) -> tuple[float, str]:
        """The turn of a shaft that is not the main one, whose angle claims look at themselves."""
        other = self._instances[name].fmu.shaft_inputs and self.angles(name) != (SHAFT_ANGLE,)
        why = f"a sample of {name} is needed every {2.0 * SHOWN:g} deg"
        return math.radians(SHOWN) if other else math.inf, why

    def mean_speed(self, scene: Scene, name: str, passed: tuple[str, ...] = ()) -> float | None:
        """The mean speed of the shafts by which an instance moves [rad/s]; None where it is not known."""
        angles = self.angles(name)
        if not angles:
            return scene.instances[name].own_speed
        turning = {angle.partition(".")[0] for angle in angles} - {name, *passed}
        speeds = [self.mean_speed(scene, each, (*passed, name)) for each in sorted(turning)]
        if not scene.instances[name].fmu.shaft_inputs:  # it may turn by itself as well
            speeds.append(scene.instances[name].own_speed)
        return max((each for each in speeds if each is not None), default=None)


def _taking(turn: float, why: str, speed: float | None) -> tuple[float, str]:
    """The time that a turn of the shaft takes [s], 0 where its speed is not known, and why it matters."""
    if math.isinf(turn) or speed == 0.0:  # it stands
        return math.inf, why
    if speed is None:
        return 0.0, f"{why}, and the speed of the shaft is not known"
    return turn / speed, why
