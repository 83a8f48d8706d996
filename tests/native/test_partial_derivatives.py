"""Derivatives of outputs by inputs and parameters, beside differences of the outputs."""

import itertools
import math
import random
import subprocess
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from pathlib import Path

import fmpy.fmi2
import fmpy.fmi3
import pytest
from driving import declared, moved
from natives import DISCARD, ERROR, MEMORYLESS, OK, SOLVED, TIME, Instance

from loomfmu.components import COMPONENTS
from loomfmu.declaring.variables import Variable
from loomfmu.fmi.dataflow.dependencies import dependencies
from loomfmu.fmi.native.compiler import ARITHMETIC
from loomfmu.fmi.native.native_fmu import sources

STEPS = [1e-2 / 4.0**n for n in range(8)]  # of the differences, as shares of a variable's scale
POINTS = {"start": 2, "step": 4}
SIZE = 1e-3  # of a step [s]
MANY = 100  # of each kind: 200 points for a component


def reals(name: str, *causalities: str) -> list[Variable]:
    return [v for v in declared(COMPONENTS[name]) if v.type is float and v.causality in causalities]


def drawn(variable: Variable, value: float, rng: random.Random) -> float:
    """A value near another one, far enough from the limits for differences."""
    low, high = variable.limits
    reach = 0.01 * scale(variable, value)
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
        # a start value may switch something off, as 0 often does: there a derivative by it is easily lost
        self.values = {
            v.name: v.start if rng.random() < 0.3 else drawn(v, v.start, rng)
            for v in reals(name, "parameter")
        }
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
        if instance.write(given) != OK or (not self.start and instance.step(self.time, self.size) != OK):
            return None
        status, found = instance.read(self.outputs)
        return found if status == OK else None

    def differences(self, known: Variable) -> list[list[tuple[float, float]]]:
        """For each output its derivatives to the fourth order, from both sides, from the left and the right.

        Each comes with its error: the change from one step of the differences to the next. Those of the
        shortest steps follow.
        """
        value = self.values.get(known.name, known.start)
        found = []
        for share in STEPS:
            step = share * scale(known, value)
            ys = [self.outputs_at({known.name: value + n * step}) for n in (-2, -1, 0, 1, 2)]
            sides = [each or [math.nan] * len(self.outputs) for each in ys]  # beyond a limit, for instance
            found.append([slopes(*each, step) for each in zip(*sides, strict=True)])
        of_outputs = [
            [[at[place][side] for at in found] for side in range(3)] for place in range(len(self.outputs))
        ]
        return [[*map(best, sides), *map(shortest, sides)] for sides in of_outputs]


def slopes(a: float, b: float, c: float, d: float, e: float, step: float) -> tuple[float, float, float]:
    return (
        (a - 8.0 * b + 8.0 * d - e) / (12.0 * step),
        (3.0 * c - 4.0 * b + a) / (2.0 * step),
        (4.0 * d - 3.0 * c - e) / (2.0 * step),
    )


def best(values: list[float]) -> tuple[float, float]:
    """The value of the shortest step that the step before confirms, else that which it changes least.

    With it comes that change. Near a kink, long steps agree on what is true beyond it.
    """
    values = [*filter(math.isfinite, values)]
    changes = [(abs(a - b), b) for a, b in itertools.pairwise(values)]
    for limit in (1e-7, 1e-4):
        for error, value in reversed(changes):
            if error <= limit * abs(value):
                return value, error
    error, value = min(changes, default=(math.inf, 0.0))
    return value, error


def shortest(values: list[float]) -> tuple[float, float]:
    """The value of the shortest step, and how much it changed the one before."""
    values = [*filter(math.isfinite, values)]
    return (values[-1], abs(values[-1] - values[-2])) if len(values) > 1 else (0.0, math.inf)


def sharp(output: str, values: dict[str, float]) -> bool:
    """Return whether the place of an extreme is known well enough for its derivatives.

    Golden sections find those of a belt to 2e-9 of the step. Where it goes far beyond buckling within a step,
    deflection and speed limit pass their extremes in a small part of that.
    """
    searched = output in ("largest_deflection", "lowest_speed_limit")
    return not searched or values.get("lowest_margin", 0.0) > -10.0


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
            noise = 1e-8 * max(abs(value), 1.0) / unit
            size = max(abs(tangent), noise * 1e3)
            offs = [(abs(tangent - each) - 10.0 * error, error) for each, error in candidates]
            sides = [each for each in offs[:3] if each[1] < math.inf]  # none beyond a limit
            off, error = min(sides, default=(0.0, math.inf))
            if off > noise:  # a kink may be closer than the steps that agree
                off, error = min([(off, error), *(each for each in offs[3:] if each[1] <= 1e-3 * size)])
            if not sharp(output, dict(zip(point.outputs, base, strict=True))):
                continue
            count += 1
            if error > 1e-3 * size:
                unresolved += 1
            else:
                report(output, known.name, off - noise, size)
    return count, unresolved


def check(native: Callable[..., Instance], name: str, kind: str, points: int, fmi: int) -> None:
    """Compare at that many points. Of those that are drawn, a component rejects some."""
    count = unresolved = reached = 0
    for seed in range(4 * points):
        point = Point(native(name, fmi=fmi), name, kind, seed)
        if not point.possible or reached == points:
            continue
        reached += 1

        def report(output: str, known: str, off: float, size: float, seed: int = seed) -> None:
            # 1e-5: the error of the differences is known by its order of magnitude alone
            assert off <= 1e-5 * size, (seed, output, known, off, size)

        more, without = compared(point, report)
        count, unresolved = count + more, unresolved + without
    # differences across a kink or a jump, or within the noise of an iteration, tell nothing
    assert reached == points and unresolved <= 0.15 * count, (reached, unresolved, count)


@pytest.mark.parametrize("kind", POINTS)
@pytest.mark.parametrize("name", COMPONENTS)
def test_derivatives_are_those_of_the_outputs(native, name, kind):
    check(native, name, kind, POINTS[kind], 2)


@pytest.mark.slow
@pytest.mark.parametrize("kind", POINTS)
@pytest.mark.parametrize("name", COMPONENTS)
def test_derivatives_are_those_of_the_outputs_at_many_points(native, name, kind):
    check(native, name, kind, MANY, 3)


@pytest.mark.parametrize("fmi", [3])
@pytest.mark.parametrize("name", COMPONENTS)
def test_adjoint_derivatives_are_those_of_all_directions(native, name, fmi):
    point = Point(native(name, fmi=fmi), name, "start", 0)
    rng = random.Random(name)
    knowns = [v.name for v in point.knowns]
    weights = [rng.uniform(-1.0, 1.0) for _ in point.outputs]
    status, found = point.instance.derivative(point.outputs, knowns, weights, adjoint=True)
    assert status == OK, point.instance.texts
    total = [0.0] * len(point.outputs)
    for known, adjoint in zip(knowns, found, strict=True):
        status, column = point.instance.derivative(point.outputs, [known], [1.0])
        assert (status, adjoint) == (OK, sum_of(weights, column))
        share = rng.uniform(-1.0, 1.0)
        total = [a + share * b for a, b in zip(total, column, strict=True)]
    rng = random.Random(name)
    seeds = [rng.uniform(-1.0, 1.0) for _ in (*weights, *knowns)][len(weights) :]
    status, together = point.instance.derivative(point.outputs, knowns, seeds)
    assert status == OK
    for one, other, output in zip(together, total, point.outputs, strict=True):
        # rounding of the terms, which cancel
        assert one == pytest.approx(other, rel=1e-6, abs=1e-9 * max(1.0, abs(one))), output


def sum_of(weights: list[float], column: list[float]) -> float:
    total = 0.0
    for weight, each in zip(weights, column, strict=True):
        total += weight * each
    return total


@pytest.mark.parametrize("fmi", [3])
@pytest.mark.parametrize("name", COMPONENTS)
def test_there_are_derivatives_by_what_outputs_depend_on_alone(native, name, fmi):
    point = Point(native(name, fmi=fmi), name, "step", 1)
    needs = dependencies(COMPONENTS[name]).once
    knowns = {v.name: v.name for v in reals(name, "input", *["parameter"] * (name in MEMORYLESS))}
    listed = frozenset().union(*needs.values()) & {v.name for v in reals(name, "parameter", "input")}
    assert point.possible and listed <= knowns.keys()
    for known, port in {**knowns, "time": TIME}.items():
        status, found = point.instance.derivative(point.outputs, [port], [1.0])
        assert status in (OK, DISCARD), point.instance.texts
        for output, slope in zip(point.outputs, found, strict=True):
            assert known in needs[output] or status == DISCARD or slope == 0.0, (output, known)


def test_they_are_had_through_fmpy(package):
    name = "WeftInsertion"
    second = fmpy.read_model_description(package(name, 2).path)
    third = fmpy.read_model_description(package(name, 3).path)
    for interface in (second.coSimulation, second.modelExchange):
        assert interface.providesDirectionalDerivative
    for interface in (third.coSimulation, third.modelExchange):
        assert interface.providesAdjointDerivatives
    root = ElementTree.parse(package(name, 3).directory / "modelDescription.xml").getroot()
    for interface in ("CoSimulation", "ModelExchange"):  # fmpy reads the attribute by the name of FMI 2
        assert root.find(interface).get("providesDirectionalDerivatives") == "true"
    found = [_gradient(package(name, fmi)) for fmi in (2, 3)]
    assert found[0] == found[1]
    assert found[0][0] == pytest.approx(found[0][2], rel=1e-12)  # velocity over the shaft's


def _gradient(fmu) -> list[float]:
    """Derivatives of travel by the shaft's angle, in a step, and the ratio of their velocities."""
    make = fmpy.fmi2.FMU2Slave if fmu.fmi == 2 else fmpy.fmi3.FMU3Slave
    slave = make(guid=fmu.guid, modelIdentifier=fmu.identifier, unzipDirectory=str(fmu.directory))
    ports = {name: port.reference for name, port in fmu.ports.items()}
    slave.instantiate()
    set_real, set_flag, get = (
        (slave.setReal, slave.setBoolean, slave.getReal)
        if fmu.fmi == 2
        else (slave.setFloat64, slave.setBoolean, slave.getFloat64)
    )
    if fmu.fmi == 2:
        slave.setupExperiment(startTime=0.0)
    set_flag([ports["follow_shaft"], ports["inputs_at_step_end"]], [True, True])
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    set_real([ports["shaft_angle"], ports["shaft_velocity"]], [1.0, 50.0])
    slave.doStep(currentCommunicationPoint=0.0, communicationStepSize=1e-3)
    wanted = [ports["travel"], ports["velocity"]]
    found = slave.getDirectionalDerivative(wanted, [ports["shaft_angle"]], [1.0])
    if fmu.fmi == 3:
        assert slave.getAdjointDerivative(wanted, [ports["shaft_angle"]], [1.0, 0.0], 1) == found[:1]
    ratio = get([ports["velocity"]])[0] / 50.0
    slave.terminate()
    slave.freeInstance()
    return [*found, ratio]


@pytest.mark.few(2)
@pytest.mark.parametrize("name", COMPONENTS)
def test_the_values_of_dual_numbers_are_those_of_plain_ones(gcc, tmp_path, name):
    for file, text in sources(COMPONENTS[name]).items():
        (tmp_path / file).write_text(text, encoding="utf-8")
    host = Path(__file__).with_name("dual.c")
    call = [gcc, "-std=c99", *ARITHMETIC, f"-I{tmp_path}", "-o", tmp_path / "dual", host, "-lm"]
    subprocess.run(call, check=True)
    run = subprocess.run([tmp_path / "dual"], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout[:500]) == (0, "")


either_fmi = pytest.mark.parametrize("fmi", [2, 3])


@either_fmi
@pytest.mark.parametrize(
    ("unknown", "known", "message"),
    [
        ("pick", "shaft_angle", "is not a variable of type"),  # whole numbers
        ("rotor_angle", "law", "is not a variable of type"),
        ("table_1", "shaft_angle", "table_1, is not an output with a derivative now"),
        ("rotor_angle", "rotor_velocity", "rotor_velocity: there is no derivative by it now"),
    ],
)
def test_other_variables_are_rejected(native, fmi, unknown, known, message):
    instance = native("DobbyDrive", fmi=fmi).start()
    status, _values = instance.derivative([unknown], [known], [1.0])
    assert (status, len(instance.texts)) == (ERROR, 1)
    assert message in instance.texts[0]


@either_fmi
def test_parameters_count_at_the_start_and_without_a_memory(native, fmi):
    monitor = native("BeltMonitor", fmi=fmi)
    assert monitor.enter() == OK
    assert monitor.derivative(["margin"], ["bending_stiffness"], [1.0])[0] == OK
    assert monitor.call("ExitInitializationMode") == OK
    assert monitor.derivative(["margin"], ["bending_stiffness"], [1.0])[0] == ERROR
    insertion = native("WeftInsertion", fmi=fmi).start()
    assert insertion.step(0.0, 1e-3) == OK
    (status, (slope,)), size = insertion.derivative(["travel"], ["speed"], [1.0]), 1e-4
    assert status == OK
    (travel,) = insertion.get("travel")
    speed = COMPONENTS["WeftInsertion"]().speed
    other = native("WeftInsertion", fmi=fmi).start(speed=speed + size)
    assert other.step(0.0, 1e-3) == OK
    assert (other.get("travel")[0] - travel) / size == pytest.approx(slope, rel=1e-4)  # forward difference


def test_an_input_that_stays_counts(native):
    """As the clearance of a guide does, whose length factor is computed anew only where it changes."""

    def after(clearance: float) -> Instance:
        belt = native("BeltMonitor").start(
            travel=1.2, velocity=10.0, acceleration=-1500.0, guide_clearance=4e-4
        )
        assert belt.step(0.0, SIZE) == OK
        assert belt.set(guide_clearance=clearance, travel=1.2 + 10.0 * SIZE) == OK
        assert belt.step(SIZE, SIZE) == OK
        return belt

    size, outputs = 1e-8, ["length_factor", "margin", "lowest_margin"]
    _status, slopes = after(4e-4).derivative(outputs, ["guide_clearance"], [1.0])
    above, below = after(4e-4 + size).get(*outputs), after(4e-4 - size).get(*outputs)
    for slope, high, low in zip(slopes, above, below, strict=True):
        assert slope == pytest.approx((high - low) / (2.0 * size), rel=1e-5)
    assert slopes[0] == pytest.approx(557.96, rel=1e-4)


@either_fmi
def test_there_are_none_before_the_start(native, fmi):
    instance = native("WeftInsertion", fmi=fmi)
    assert instance.derivative(["travel"], ["shaft_angle"], [1.0])[0] == ERROR
    assert "is not allowed in the state 'instantiated'" in instance.texts[0]


@either_fmi
def test_there_are_none_of_a_step_that_failed(native, fmi):
    instance = native("BeltMonitor", fmi=fmi).start()
    assert instance.step(0.0, 1e-3) == OK
    assert instance.step(1e300, 1e-3) == DISCARD
    assert instance.derivative(["margin"], ["travel"], [1.0])[0] == DISCARD
    assert instance.texts[-1] == "the last step failed: there are no outputs to differentiate"


@either_fmi
def test_a_restored_state_has_the_derivatives_of_its_outputs(native, fmi):
    instance = native("BeltMonitor", fmi=fmi).start(travel=0.9, acceleration=50.0)
    assert instance.step(0.0, 1e-3) == OK
    wanted = instance.derivative(["margin", "deflection"], ["travel"], [1.0])
    state = instance.save()
    packed = instance.packed(state)
    assert (instance.set(travel=1.1), instance.step(1e-3, 1e-3)) == (OK, OK)
    assert instance.derivative(["margin", "deflection"], ["travel"], [1.0]) != wanted
    assert instance.call("SetFMUstate", state) == OK
    assert instance.derivative(["margin", "deflection"], ["travel"], [1.0]) == wanted
    other = native("BeltMonitor", fmi=fmi)
    status, unpacked = other.unpack(packed)
    assert (status, other.call("SetFMUstate", unpacked)) == (OK, OK)
    assert other.derivative(["margin", "deflection"], ["travel"], [1.0]) == wanted
    assert (instance.drop(state), other.drop(unpacked)) == (OK, OK)


@either_fmi
@pytest.mark.parametrize("name", MEMORYLESS)
def test_in_model_exchange_they_are_those_of_a_step_to_now(native, fmi, name):
    given = {v.name: moved(COMPONENTS[name], 0.03)[v.name] for v in reals(name, "input")}
    solved, stepped = native(name, SOLVED, fmi).ready(), native(name, fmi=fmi).start()
    assert (solved.set_time(0.03), solved.set(**given), stepped.set(**given)) == (OK, OK, OK)
    assert stepped.step(0.03, 0.0) == OK
    continuous = [v.name for v in reals(name, "output") if v.variability == "continuous"]
    knowns = [v.name for v in reals(name, "input", "parameter")]
    seeds = [1.0 + place for place, _known in enumerate(knowns)]
    assert solved.derivative(continuous, knowns, seeds) == stepped.derivative(continuous, knowns, seeds)


def test_time_is_a_known_of_fmi_3(native):
    instance = native("MainShaft", fmi=3).start(ramp_duration=0.1)
    assert instance.step(0.02, 1e-3) == OK
    (velocity, acceleration) = instance.get("velocity", "acceleration")
    status, found = instance.derivative(["angle", "velocity"], ["time_"], [1.0])
    assert status == OK
    assert found == pytest.approx([velocity, acceleration], rel=1e-12)


def test_carried_inputs_carry_their_directions(native):
    """A step with given derivatives is one with the inputs of its end, and what they are made of."""
    size, rate = 1e-3, 30.0
    carried = native("WeftInsertion").start(follow_shaft=True, shaft_angle=1.0, shaft_velocity=rate)
    assert carried.set_derivatives({("shaft_velocity", 1): 0.0}) == OK
    assert carried.step(0.0, size) == OK
    ended = native("WeftInsertion").start(follow_shaft=True, inputs_at_step_end=True)
    assert ended.set(shaft_angle=1.0 + size * rate, shaft_velocity=rate) == OK
    assert ended.step(0.0, size) == OK
    _status, (of_angle,) = ended.derivative(["travel"], ["shaft_angle"], [1.0])
    assert carried.derivative(["travel"], ["shaft_angle"], [1.0]) == (OK, [of_angle])
    _status, (of_velocity,) = carried.derivative(["travel"], ["shaft_velocity"], [1.0])
    assert of_velocity == pytest.approx(size * of_angle, rel=1e-12)


def test_a_belt_without_play_leans_as_one_with_a_little(native):
    instance = native("BeltDynamics")
    given = {"guide_end": 2, "travel": 1.0, "velocity": 5.0, "guide_clearance": 0.0}
    assert instance.set(**given) == OK and instance.enter(0.0) == OK
    status, found = instance.derivative(["deflection"], ["guide_clearance"], [1.0])
    at = []
    for clearance in (0.0, 1e-7):
        assert instance.write({"guide_clearance": clearance}) == OK
        at.append(instance.read(["deflection"])[1][0])
    assert status == OK
    assert found[0] == pytest.approx((at[1] - at[0]) / 1e-7, rel=1e-3)  # the guide has no other side
