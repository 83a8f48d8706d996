"""A scene as a function of the shaft angle and some parameters, over boxes of these: its mechanisms in turn.

Each mechanism without a memory is placed at the shaft angle, as at the start of a run. What it gives is
enclosed twice: by its equations over the whole box, and from the middle of the box by its slopes.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...components import COMPONENTS
from ...components.shaft_driven import FOLLOWING, ShaftDriven
from ...cosim.claims.conditions import Unprovable, remembers
from ...cosim.scenes.graph import step_order
from ...cosim.scenes.instances import Instance
from ...cosim.scenes.scene import Scene
from ...declaring.variables import MOTION, TIME, Component, variables_of
from ...fmi.native.slicing import settings_of
from .enclosed import Enclosed
from .sides import SHAFT, START, needed_for
from .spans import TINY, ULP, Floats, both, constant, minus, plus, times


@dataclass(frozen=True)
class Number:
    """A number over boxes: its values (boxes, 2), its slopes by each side of the box (boxes, sides, 2), and
    its value in the middle of the box (boxes, 2)."""

    values: Floats
    slopes: Floats
    middle: Floats

    @classmethod
    def of(cls, value: float, boxes: Floats) -> "Number":
        """Return a number that is the same everywhere."""
        rows, sides, _two = boxes.shape
        return cls(constant(value, (rows,)), np.zeros((rows, sides, 2)), constant(value, (rows,)))

    @classmethod
    def side(cls, place: int, boxes: Floats) -> "Number":
        """Return a side of the boxes."""
        slopes = np.zeros_like(boxes)
        slopes[:, place] = 1.0
        return cls(boxes[:, place], slopes, np.repeat(middles(boxes)[:, place, None], 2, axis=-1))

    @property
    def bounds(self) -> Floats:
        """Return the values and the slopes in one array, (boxes, 1 + sides, 2)."""
        bounds: Floats = np.concatenate([self.values[:, None], self.slopes], axis=1)
        return bounds

    def plus(self, other: "Number", share: float = 1.0) -> "Number":
        """Return this number and a share of another one."""
        factor = constant(share)
        return Number(
            plus(self.values, times(other.values, factor)),
            plus(self.slopes, times(other.slopes, factor)),
            plus(self.middle, times(other.middle, factor)),
        )

    def times(self, other: "Number") -> "Number":
        """Return the product of two numbers."""
        slopes = plus(times(self.slopes, other.values[:, None]), times(other.slopes, self.values[:, None]))
        return Number(times(self.values, other.values), slopes, times(self.middle, other.middle))

    def narrowed(self, boxes: Floats) -> "Number":
        """Return this number, its values narrowed to what its slopes leave from the middle of each box."""
        reach = minus(boxes, np.repeat(middles(boxes)[..., None], 2, axis=-1))
        far = times(self.slopes, reach)
        values = self.middle
        for side in range(boxes.shape[1]):
            values = plus(values, far[:, side])
        return Number(both(self.values, values), self.slopes, self.middle)


class Table:
    """A table of inputs: values on straight lines between points, and held before and after."""

    def __init__(self, points: Sequence[float], values: Sequence[float]):
        self._points, self._values = np.array(points, dtype=float), np.array(values, dtype=float)
        rises = np.diff(self._values) / np.diff(self._points)
        self._rises = np.concatenate([[0.0], rises, [0.0]])
        self._edges = np.concatenate([[-np.inf], self._points, [np.inf]])
        self._blur = 16.0 * ULP * float(np.abs(self._values).max(initial=0.0)) + TINY

    def over(self, number: Number) -> Number:
        """Return the values of the table at a number."""
        reached = (self._edges[:-1] <= number.values[:, 1:]) & (self._edges[1:] >= number.values[:, :1])
        low = np.where(reached, self._rises, np.inf).min(axis=1)
        high = np.where(reached, self._rises, -np.inf).max(axis=1)
        rises = np.stack([low - 16.0 * ULP * np.abs(low), high + 16.0 * ULP * np.abs(high)], axis=-1)
        return Number(self._at(number.values), times(number.slopes, rises[:, None]), self._at(number.middle))

    def _at(self, spans: Floats) -> Floats:
        inside = (self._points >= spans[:, :1]) & (self._points <= spans[:, 1:])
        ends = np.interp(spans, self._points, self._values)
        low = np.minimum(ends.min(axis=1), np.where(inside, self._values, np.inf).min(axis=1))
        high = np.maximum(ends.max(axis=1), np.where(inside, self._values, -np.inf).max(axis=1))
        return np.stack([low - self._blur, high + self._blur], axis=-1)


def middles(boxes: Floats) -> Floats:
    """Return a point within each box, about its middle."""
    found: Floats = np.clip(boxes.mean(axis=-1), boxes[..., 0], boxes[..., 1])
    return found


@dataclass(frozen=True)
class _Placed:
    """A mechanism: what it is given, each by its variable, and what it is asked for."""

    name: str
    enclosed: Enclosed
    values: dict[str, float]
    sides: dict[str, int]
    wires: dict[str, str]


class Chain:
    """The mechanisms that give some signals. `sides` are the parameters that vary, by instance and variable.

    Their first side is the shaft angle; the time where the speed changes or inputs follow tables: then the
    chain is `timed`. Raises Unprovable for what has a memory or a loop.
    """

    def __init__(self, scene: Scene, signals: Sequence[str], sides: Mapping[tuple[str, str], int]):
        needed = needed_for(scene, signals)
        if SHAFT not in scene.instances:
            raise Unprovable("the scene has no shaft")
        shaft = scene.instances[SHAFT]
        unsteady = shaft.fmu.component.unsteady if shaft.fmu.component else ()
        self._drives = {(each.instance, each.variable): each for each in needed.drives}
        varies = any(owner == SHAFT and name in unsteady for owner, name in sides)
        self.timed = bool(self._drives) or varies or any(map(shaft.start, unsteady))
        self._scene, self._sides = scene, {**sides, (SHAFT, TIME if self.timed else START): 0}
        order, lagged = step_order(needed.instances, needed.wires)
        if lagged:
            raise Unprovable(f"{lagged[0]} closes a loop")
        self._tables = {place: Table(each.periods, each.values) for place, each in self._drives.items()}
        read = {wire.source for wire in needed.wires} | {tuple(each.split(".", 1)) for each in signals}
        self._placed = [
            self._place(needed.instances[name], needed, {each[1] for each in read if each[0] == name})
            for name in order
        ]

    def _place(self, instance: Instance, scene: Scene, read: set[str]) -> _Placed:
        component = _checked(instance)
        variables = {each.name: each for each in variables_of(component)}
        wires = {w.sink[1]: ".".join(w.source) for w in scene.wires if w.sink[0] == instance.name}
        if issubclass(component, ShaftDriven) and not instance.start(FOLLOWING):
            raise Unprovable(f"{instance.name} does not follow the shaft")
        values = {
            name: float(instance.start(name) or 0.0)
            for name, each in variables.items()
            if each.settable and name not in wires and instance.start(name) != each.start
        }
        sides = {name: side for (owner, name), side in self._sides.items() if owner == instance.name}
        if instance.name == SHAFT and not self.timed:
            values[TIME] = 0.0  # it turns by its start angle instead
        driven = [variable for owner, variable in self._drives if owner == instance.name]
        for variable in driven:
            if self._drives[instance.name, variable].held:
                raise Unprovable(f"{instance.name}.{variable} jumps from row to row of its table")
        wanted = tuple(sorted(each for each in read if variables[each].causality == "output"))
        for each in wanted:
            if remembers(variables[each]):
                raise Unprovable(f"{instance.name}.{each} depends on the run so far")
        return _Placed(
            instance.name,
            Enclosed(component, wanted, settings_of(variables.values(), instance.start)),
            {name: value for name, value in values.items() if name not in (*sides, *driven)},
            sides,
            wires,
        )

    @property
    def components(self) -> tuple[type[Component], ...]:
        """Return the components of the mechanisms."""
        return tuple(placed.enclosed.component for placed in self._placed)

    def numbers(self, boxes: Floats) -> dict[str, Number]:
        """Return all numbers over boxes (boxes, sides, 2), by signal; side 0 is the shaft angle."""
        found: dict[str, Number] = {}
        for placed in self._placed:
            given = {name: Number.side(place, boxes) for name, place in placed.sides.items()}
            given |= {name: found[source] for name, source in placed.wires.items()}
            given |= {
                name: table.over(self._turns(boxes))
                for (owner, name), table in self._tables.items()
                if owner == placed.name
            }
            wide = {name: each.bounds for name, each in given.items()}
            bounds = placed.enclosed.bounds(placed.values, wide, boxes.shape)
            points = {name: each.middle[:, None] for name, each in given.items()}
            middle = placed.enclosed.bounds(placed.values, points, (len(boxes), 0))
            for name, each in bounds.items():
                number = Number(each[:, 0], each[:, 1:], middle[name][:, 0])
                found[f"{placed.name}.{name}"] = number.narrowed(boxes)
        return found

    def _turns(self, boxes: Floats) -> Number:
        """The periods since the start: revolutions at the mean speed, or seconds."""
        time = Number.side(0, boxes)
        if self._scene.step is not None:
            return time
        speed = self.number(f"{SHAFT}.speed", {}, boxes)
        sense = math.copysign(1.0, float(speed.values.flat[0]))  # the same in all boxes
        return time.times(Number.of(0.0, boxes).plus(speed, sense / (2.0 * math.pi)))

    def number(self, name: str, found: Mapping[str, Number], boxes: Floats) -> Number:
        """Return a signal, or a parameter, over boxes."""
        if name in found:
            return found[name]
        instance, _, variable = name.partition(".")
        if side := self._sides.get((instance, variable)):  # side 0 is no parameter of the scene
            return Number.side(side, boxes)
        return Number.of(float(self._scene.instances[instance].start(variable) or 0.0), boxes)


def _checked(instance: Instance) -> type[Component]:
    """The component of an instance. Raises Unprovable where its outputs depend on more than the angle."""
    component = instance.fmu.component
    if component is None or not instance.fmu.built:
        raise Unprovable(f"{instance.name} is another tool's FMU, whose equations are not known")
    if not COMPONENTS.owns(component):
        raise Unprovable(f"{instance.name} is a mechanism of your own, which is not known to have no memory")
    if component.keeps == MOTION:
        raise Unprovable(f"{instance.name} moves by its own inertia, so that its past matters")
    if component.unsteady and instance.name != SHAFT and any(map(instance.start, component.unsteady)):
        raise Unprovable(f"the speed of {instance.name} changes, which is not the main shaft")
    return component
