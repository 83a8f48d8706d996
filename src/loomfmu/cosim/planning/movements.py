"""Movements of instances: the shafts that turn them, and the longest steps that show what they do."""

import math
from functools import cached_property

from ...components import COMPONENTS
from ...declaring.variables import Component
from ..claims.movers import movers_of, whole_turn
from ..scenes.scene import Scene
from .requested import SHAFT_ANGLE, Requested

EVENT = 4.0  # steps that show an event of a mechanism
SHOWN = 9.0  # deg: the turn that shows any of them; with twice as much, claims on a shaft are undecided, too


class Movements:
    """The movements of the instances of a scene, as far as its wires tell."""

    def __init__(self, requested: Requested):
        self._instances, self._outputs = requested.scene.instances, requested
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
        instance, wires = self._instances[name], self._outputs.wires
        component, ports = instance.fmu.component, instance.fmu.ports.values()
        given = [*instance.fmu.shaft_inputs[:1]]
        if not given and component not in COMPONENTS.values():
            given = [each.name for each in ports if each.causality == "input" and whole_turn(each.unit)]
        if given:
            taken = [wires[each] for each in (f"{name}.{variable}" for variable in given) if each in wires]
        else:
            others = [each.angle for each in movers_of([name], self._outputs) if each.angle]
            alone = instance.own_speed is not None
            taken = others or [*(() if alone else self._main)]
            taken = [each for each in taken if each.partition(".")[0] != name]
        return tuple(dict.fromkeys(taken))

    @cached_property
    def _main(self) -> tuple[str, ...]:
        """The main shaft, if there is one."""
        return (SHAFT_ANGLE,) if SHAFT_ANGLE in self._outputs else ()

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
        speeds = [each for each in (speed, self._mean_speed(scene, name)) if each is not None]
        fastest = max(speeds, default=None)
        turns = [by_event, declared] if fastest is None else [by_event, declared, self._apart(name)]
        return min(component.longest_step(instance.effect), _taking(*min(turns), fastest))

    def _apart(self, name: str) -> tuple[float, str]:
        """The turn of a shaft that is not the main one, whose angle claims look at themselves."""
        other = self._instances[name].fmu.shaft_inputs and self.angles(name) != (SHAFT_ANGLE,)
        why = f"a sample of {name} is needed every {2.0 * SHOWN:g} deg"
        return math.radians(SHOWN) if other else math.inf, why

    def _mean_speed(self, scene: Scene, name: str, passed: tuple[str, ...] = ()) -> float | None:
        """The mean speed of the shafts by which an instance moves [rad/s]; None where it is not known."""
        angles = self.angles(name)
        if not angles:
            return scene.instances[name].own_speed
        turning = {angle.partition(".")[0] for angle in angles} - {name, *passed}
        speeds = [self._mean_speed(scene, each, (*passed, name)) for each in sorted(turning)]
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
