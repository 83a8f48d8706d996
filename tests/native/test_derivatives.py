"""Derivatives of inputs, which carry them over a step, and of outputs."""

import math

import pytest
from driving import assign, inputs
from natives import DISCARD, ERROR, OK

from loomfmu.components import COMPONENTS
from loomfmu.declaring.variables import variables_of

DRIVEN = [name for name, component in COMPONENTS.items() if inputs(component)]
SIZE = 2e-3
STEPS = 60


def polynomial(name: str, time: float) -> tuple[dict[str, float], dict[tuple[str, int], float]]:
    """Inputs at a time and their first three derivatives; those that are declared rates fit together."""
    values: dict[str, float] = {}
    derivatives: dict[tuple[str, int], float] = {}
    for place, variable in enumerate(inputs(COMPONENTS[name])):
        reach = 0.05 * (variable.nominal or max(abs(variable.start), 1.0))
        low = -math.inf if variable.minimum is None else variable.minimum
        high = math.inf if variable.maximum is None else variable.maximum
        reach = min(reach, 0.2 * (high - low))
        middle = min(max(variable.start, low + 1.2 * reach), high - 1.2 * reach)
        rate = 10.0 + place
        values[variable.name] = middle + reach * math.sin(rate * time)
        derivatives[variable.name, 1] = reach * rate * math.cos(rate * time)
        derivatives[variable.name, 2] = -reach * rate * rate * math.sin(rate * time)
        derivatives[variable.name, 3] = -reach * rate**3 * math.cos(rate * time)
    return values, derivatives


def carried(values: dict[str, float], derivatives: dict[tuple[str, int], float]) -> dict[str, float]:
    def ahead(name: str) -> float:
        first, second, third = (derivatives.get((name, order), 0.0) for order in (1, 2, 3))
        return values[name] + SIZE * (first + SIZE / 2.0 * (second + SIZE / 3.0 * third))

    return {name: ahead(name) for name in values}


@pytest.mark.few(12)
@pytest.mark.parametrize("name", DRIVEN)
@pytest.mark.parametrize("highest", [1, 2, 3])
def test_given_derivatives_carry_the_inputs_to_the_end_of_the_step(native, name, highest):
    flags = {"follow_shaft": True} if "follow_shaft" in COMPONENTS[name].__dataclass_fields__ else {}
    values, _ = polynomial(name, 0.0)
    instance = native(name).start(**flags, **values)
    component = COMPONENTS[name](**flags)
    assign(component, values)
    assert component.initialize(0.0) == 0
    for step in range(STEPS):
        time = step * SIZE
        values, derivatives = polynomial(name, time)
        derivatives = {key: value for key, value in derivatives.items() if key[1] <= highest}
        # all given: an order that is not given would be read through the declared rates
        derivatives |= {(key, order): 0.0 for key in values for order in range(highest + 1, 4)}
        assert instance.set(**values) == OK
        assert instance.set_derivatives(derivatives) == OK
        assert instance.step(time, SIZE) == OK, instance.texts
        assign(component, carried(values, derivatives))
        if hasattr(component, "inputs_at_step_end"):
            component.inputs_at_step_end = True
        assert component.step(time, SIZE) == 0
        found = instance.variables()
        for variable in variables_of(COMPONENTS[name]):
            if variable.causality in ("output", "local"):
                assert found[variable.name] == getattr(component, variable.name), variable.name
        assert {key: found[key] for key in values} == values  # as they were set
        assert found.get("inputs_at_step_end") in (False, None)


def test_inputs_without_given_derivatives_go_on_with_their_declared_rates(native):
    given, declared = native("WeftInsertion"), native("WeftInsertion")
    for instance in (given, declared):
        instance.start(follow_shaft=True, shaft_angle=1.0, shaft_velocity=50.0, shaft_acceleration=300.0)
    assert (
        given.set_derivatives(
            {("shaft_angle", 1): 50.0, ("shaft_angle", 2): 300.0, ("shaft_velocity", 1): 300.0}
        )
        == OK
    )
    assert declared.set_derivatives({("shaft_acceleration", 1): 0.0}) == OK
    for instance in (given, declared):
        assert instance.step(0.0, SIZE) == OK
    assert declared.outputs() == given.outputs()
    # a derivative of a rate counts for what it is the rate of, too
    jerk = native("WeftInsertion")
    jerk.start(follow_shaft=True, shaft_angle=1.0, shaft_velocity=50.0, shaft_acceleration=300.0)
    assert jerk.set_derivatives({("shaft_acceleration", 1): 1e5}) == OK
    assert jerk.step(0.0, SIZE) == OK
    component = COMPONENTS["WeftInsertion"](follow_shaft=True, inputs_at_step_end=True)
    component.initialize(0.0)
    component.shaft_angle = 1.0 + SIZE * (50.0 + SIZE / 2.0 * (300.0 + SIZE / 3.0 * 1e5))
    component.shaft_velocity = 50.0 + SIZE * (300.0 + SIZE / 2.0 * 1e5)
    component.shaft_acceleration = 300.0 + SIZE * 1e5
    component.step(0.0, SIZE)
    assert jerk.get("travel", "acceleration") == pytest.approx(
        [component.travel, component.acceleration], rel=1e-14
    )


def test_derivatives_hold_for_one_step(native):
    instance = native("WeftInsertion").start(follow_shaft=True, shaft_velocity=0.0)
    assert instance.set_derivatives({("shaft_angle", 1): 50.0}) == OK
    assert instance.step(0.0, SIZE) == OK
    moved = instance.get("travel")
    assert instance.step(SIZE, SIZE) == OK
    assert instance.get("travel") != moved  # back where the angle stands that was set


def test_a_host_that_gives_inputs_of_the_steps_end_needs_no_derivatives(native):
    instance = native("WeftInsertion").start(follow_shaft=True, inputs_at_step_end=True, shaft_angle=1.0)
    plain = native("WeftInsertion").start(follow_shaft=True, inputs_at_step_end=True, shaft_angle=1.0)
    assert instance.set_derivatives({("shaft_angle", 1): 50.0}) == OK
    assert (instance.step(0.0, SIZE), plain.step(0.0, SIZE)) == (OK, OK)
    assert instance.outputs() == plain.outputs()


def test_better_than_holding_the_inputs(native):
    # what it is for: a host that knows the rates of its signals gets by with longer steps
    def displacement(derivatives: bool, steps: int) -> float:
        instance = native("HealdDamper")
        for step in range(steps):
            angle = 60.0 * step * 0.05 / steps
            values = {
                "lift": 2e-3 * math.sin(angle),
                "velocity": 0.12 * math.cos(angle),
                "acceleration": -7.2 * math.sin(angle),
            }
            if step == 0:
                instance.start(**values)
            assert instance.set(**values) == OK
            if derivatives:
                rate = {
                    ("acceleration", 1): -432.0 * math.cos(angle),
                    ("acceleration", 2): 25920.0 * math.sin(angle),
                }
                assert instance.set_derivatives(rate) == OK
            assert instance.step(step * 0.05 / steps, 0.05 / steps) == OK
        return float(instance.get("displacement")[0])

    exact = displacement(True, 4000)
    held, carried = (abs(displacement(derivatives, 100) - exact) for derivatives in (False, True))
    # holding is of first order, the quintic through carried samples limited by their Taylor polynomials
    assert carried < 1e-3 * held


def test_none_at_all_are_taken_by_one_without_inputs(native):
    assert native("MainShaft").start().set_derivatives({}) == OK


@pytest.mark.parametrize(
    ("derivatives", "reason"),
    [
        ({("travel", 1): 1.0}, "value reference 26, travel, is not an input"),
        ({("follow_shaft", 1): 1.0}, "value reference 3 is not a variable of type Real"),
        ({("shaft_angle", 0): 1.0}, "the derivative must be finite and of order 1 to 3"),
        ({("shaft_angle", 4): 1.0}, "the derivative must be finite and of order 1 to 3"),
        ({("shaft_angle", -2147483648): 1.0}, "the derivative must be finite and of order 1 to 3"),
        ({("shaft_angle", 1): math.nan}, "the derivative must be finite and of order 1 to 3"),
    ],
)
def test_derivatives_that_are_refused(native, derivatives, reason):
    instance = native("WeftInsertion").start()
    assert instance.set_derivatives(derivatives) == ERROR
    assert len(instance.texts) == 1 and reason in instance.texts[0]


def test_a_carried_input_keeps_its_limits(native):
    instance = native("BeltMonitor").start()
    assert instance.set_derivatives({("guide_clearance", 1): -1.0}) == OK
    assert instance.step(0.0, 1e-3) == DISCARD
    assert instance.texts == ["guide_clearance = -0.7 mm is outside [0, 50] mm"]


# ---- outputs


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", COMPONENTS)
def test_derivatives_of_outputs_are_their_declared_rates(native, name, fmi):
    instance = native(name, fmi=fmi).start()
    rates = {v.name: v.rate for v in variables_of(COMPONENTS[name])}
    for variable in variables_of(COMPONENTS[name]):
        if variable.causality == "output" and variable.type is float:
            wanted, following = [], rates[variable.name]
            while following is not None:
                wanted.append(instance.get(following)[0])
                following = rates[following]
            for order in range(1, 4):
                status, value = instance.output_derivative(variable.name, order)
                if order <= len(wanted):
                    assert (status, value) == (OK, wanted[order - 1])
                else:
                    assert (status, value) == (DISCARD, 0.0)


@pytest.mark.parametrize(("name", "order"), [("speed", 1), ("angle", 0), ("angle", -1), ("ripple_order", 1)])
def test_derivatives_that_no_output_has(native, name, order):
    instance = native("MainShaft").start()
    assert instance.output_derivative(name, order)[0] == ERROR
