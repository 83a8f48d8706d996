"""Derivatives of outputs by inputs and parameters: beside differences of the outputs, and between themselves."""

import math
import random
from collections.abc import Callable
from pathlib import Path

import pytest
from driving import declared, moved
from natives import DISCARD, ERROR, MEMORYLESS, OK, SOLVED, Instance

from loomfmu.components import COMPONENTS
from loomfmu.declaring.variables import Variable

STEPS = [1e-2 / 4.0**n for n in range(8)]  # of the differences, as shares of a variable's scale
POINTS = {"start": 2, "step": 3}
MANY = 100  # of each kind: 200 points for a component


def reals(name: str, *causalities: str) -> list[Variable]:
    return [v for v in declared(COMPONENTS[name]) if v.type is float and v.causality in causalities]


def drawn(variable: Variable, value: float, rng: random.Random) -> float:
    """A value near another one, far enough from the limits for differences."""
    low, high = variable.limits
    reach = 0.02 * scale(variable, value)
    return min(max(value + rng.uniform(-reach, reach), low + reach), high - reach)


def scale(variable: Variable, value: float) -> float:
    width = variable.limits[1] - variable.limits[0]
    return min(variable.nominal or abs(value) or 1.0, width / 10.0)


class Point:
    """An instance at a start or after a step, and its outputs as functions of its knowns."""

    def __init__(self, instance: Instance, name: str, kind: str, seed: int):
        rng = random.Random(f"{name} {kind} {seed}")
        self.instance, self.start = instance, kind == "start"
        self.outputs = [v.name for v in reals(name, "output")]
        self.knowns = reals(name, "input", "parameter") if self.start else reals(name, "input")
        self.values = {v.name: drawn(v, v.start, rng) for v in reals(name, "parameter")}
        for v in declared(COMPONENTS[name]):
            if v.causality == "parameter" and v.type is bool:
                self.values[v.name] = rng.random() < 0.5
            if v.choices:
                self.values[v.name] = rng.randint(1, len(v.choices))
        self.size, self.time = rng.choice([1e-4, 1e-3, 3e-3]), rng.uniform(0.0, 0.2)
        self.possible = instance.set(**self.values) == OK and self._reach(COMPONENTS[name], rng)

    def _reach(self, component: type, rng: random.Random) -> bool:
        ports = {v.name: v for v in declared(component)}
        instance = self.instance

        def at(time: float) -> dict[str, float]:
            return {key: drawn(ports[key], value, rng) for key, value in moved(component, time).items()}

        start = at(self.time)
        if instance.set(**start) != OK or instance.enter(self.time) != OK:
            return False
        self.values |= start
        if not self.start:
            if instance.call("ExitInitializationMode") != OK:
                return False
            for _ in range(rng.randint(0, 20)):
                if instance.set(**moved(component, self.time)) != OK:
                    return False
                if instance.step(self.time, self.size) != OK:
                    return False
                self.time += self.size
            self.values |= at(self.time)
        self.before = instance.save()
        return self.outputs_at({}) is not None

    def outputs_at(self, values: dict[str, float]) -> list[float] | None:
        """The outputs with these inputs or parameters, or nothing where the component rejects them."""
        instance = self.instance
        assert instance.call("SetFMUstate", self.before) == OK
        given = {v.name: self.values[v.name] for v in self.knowns if v.name in self.values} | values
        if instance.set(**given) != OK or (not self.start and instance.step(self.time, self.size) != OK):
            return None
        status, found = instance.read(self.outputs)
        return found if status == OK else None

    def differences(self, known: Variable) -> list[list[tuple[float, float]]]:
        """For each output its derivatives to the fourth order, from both sides, from the left and the right.

        Each comes with its error: the change from one step of the differences to the next.
        """
        value = self.values.get(known.name, known.start)
        found = []
        for share in STEPS:
            step = share * scale(known, value)
            ys = [self.outputs_at({known.name: value + n * step}) for n in (-2, -1, 0, 1, 2)]
            if None not in ys:
                found.append([slopes(*each, step) for each in zip(*ys, strict=True)])
        return [
            [best([at[place][side] for at in found]) for side in range(3)] for place in range(len(self.outputs))
        ]


def slopes(a: float, b: float, c: float, d: float, e: float, step: float) -> tuple[float, float, float]:
    return (
        (a - 8.0 * b + 8.0 * d - e) / (12.0 * step),
        (3.0 * c - 4.0 * b + a) / (2.0 * step),
        (4.0 * d - 3.0 * c - e) / (2.0 * step),
    )


def best(values: list[float]) -> tuple[float, float]:
    """The value that the next step changes least, and that change."""
    changes = [(abs(a - b), b) for a, b in zip(values, values[1:], strict=False)]
    error, value = min(changes, default=(math.inf, 0.0))
    return value, error


def compared(point: Point, report: Callable[[str, str, float, float], None]) -> tuple[int, int]:
    """Compare all derivatives at a point; returns how many were compared, and how many have no difference."""
    count = unresolved = 0
    base = point.outputs_at({})
    for known in point.knowns:
        wanted = point.differences(known)
        point.outputs_at({})
        status, found = point.instance.derivative(point.outputs, [known.name], [1.0])
        assert status in (OK, DISCARD), point.instance.texts
        if status == DISCARD:
            unresolved += len(point.outputs)
            continue
        unit = scale(known, point.values.get(known.name, known.start))
        for output, value, tangent, candidates in zip(point.outputs, base, found, wanted, strict=True):
            # the outputs' rounding, with what their terms cancel, over the steps of the differences
            noise = 1e-8 * max(abs(value), 1e-3) / unit
            off, error = min((abs(tangent - each) - 10.0 * error, error) for each, error in candidates)
            size = max(abs(tangent), noise * 1e3)
            count += 1
            if error > 1e-3 * size:
                unresolved += 1
            else:
                report(output, known.name, off - noise, size)
    return count, unresolved


def check(native: Callable[..., Instance], name: str, kind: str, seeds: range, fmi: int) -> float:
    """Return the largest difference over the size of a derivative."""
    largest, count, unresolved, reached = 0.0, 0, 0, 0
    for seed in seeds:
        point = Point(native(name, fmi=fmi), name, kind, seed)
        if not point.possible:
            continue
        reached += 1

        def report(output: str, known: str, off: float, size: float, seed: int = seed) -> None:
            nonlocal largest
            largest = max(largest, off / size)
            # 1e-5: the error of the differences is known by its order of magnitude alone
            assert off <= 1e-5 * size, (name, kind, seed, output, known, off, size)

        more, without = compared(point, report)
        count, unresolved = count + more, unresolved + without
    assert reached >= 0.6 * len(seeds) and unresolved <= 0.1 * count, (reached, unresolved, count)
    return largest


@pytest.mark.parametrize("kind", POINTS)
@pytest.mark.parametrize("name", COMPONENTS)
def test_derivatives_are_those_of_the_outputs(native, name, kind):
    check(native, name, kind, range(POINTS[kind]), 2)


@pytest.mark.slow
@pytest.mark.parametrize("kind", POINTS)
@pytest.mark.parametrize("name", COMPONENTS)
def test_derivatives_are_those_of_the_outputs_at_many_points(native, name, kind):
    check(native, name, kind, range(MANY), 3)
