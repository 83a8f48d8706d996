"""What every component keeps to. There is no list of exceptions: a new component joins by being declared."""

import math
import random

import pytest
from driving import (
    advance,
    assign,
    declared,
    drawn_inputs,
    drawn_parameters,
    flags,
    inputs,
    moved,
    span,
    values,
)

from loomfmu import units
from loomfmu.components import COMPONENTS, BeltDynamics
from loomfmu.cosim.importing.facts import facts_of
from loomfmu.cosim.scenes.instances import stem
from loomfmu.cosim.scenes.wiring import usual_wires
from loomfmu.declaring.variables import EXTREMES, MIXED, MOTION, NOTHING, OWN, PUBLISHED, TIME
from loomfmu.errors import numbered
from loomfmu.fmi.dataflow.dependencies import dependencies
from loomfmu.loom.standard_loom import COMPONENT_OF

QUICKENING = 300.0  # of a shaft or a head, in SI
every_component = pytest.mark.parametrize("component", COMPONENTS.values(), ids=COMPONENTS)
every_flag = pytest.mark.parametrize(
    ("component", "given"),
    [
        pytest.param(component, given, id="-".join([name, *(flag for flag, on in given.items() if on)]))
        for name, component in COMPONENTS.items()
        for given in flags(component)
    ],
)


def finite(component):
    """Every number finite and within its limits, every value of its declared type."""
    for variable in declared(type(component)):
        value = getattr(component, variable.name)
        assert type(value) is variable.type, variable.name
        low, high = variable.limits
        assert low <= value <= high, variable.name


# What a component says of itself


@every_component
def test_traits(component):
    """Beside what `own.declared` finds of any component, which is tested of ours as well."""
    held = any(v.lowest_of or v.highest_of for v in declared(component))
    assert held or component.keeps != EXTREMES  # an integrator may hold extremes as well
    assert component.origin in (PUBLISHED, MIXED, OWN)
    assert bool(component.accuracy) == (component.keeps == MOTION)  # the others are exact: a test below
    assert set(component.unsteady) <= {v.name for v in declared(component) if v.causality == "parameter"}


@every_component
def test_every_usual_source_is_an_output_of_the_standard_loom(component):
    for name, source in usual_wires({"damper_1": facts_of(component)}).items():
        sink = name.removeprefix("damper_1.")
        owner, variable = source.split(".")
        feeding = COMPONENTS[COMPONENT_OF[stem(owner)]]
        units_of = {v.name: v.unit for v in declared(feeding) if v.causality == "output"}
        assert units_of[variable] == next(v.unit for v in declared(component) if v.name == sink)


@pytest.mark.few(2, each="component")
@every_component
@pytest.mark.parametrize("seed", range(5))
def test_what_keeps_no_motion_shows_what_its_inputs_ask_for(component, seed):
    """Whatever came before; only the extremes that it holds may differ."""
    if component.keeps == MOTION:
        return
    rng = random.Random(seed)
    parameters = drawn_parameters(component, rng)
    if component.keeps == EXTREMES:
        parameters["inputs_at_step_end"] = True  # as our master sets it: nothing is carried over a step
    used, fresh = component(**parameters), component(**parameters)
    if used.initialize(0.0) != 0:
        return
    for step in range(9):
        assign(used, drawn_inputs(component, rng))
        if used.step(0.01 * step, 0.01) != 0:
            return
    assign(fresh, values(used, "input"))
    fresh.initialize(0.08)
    assert fresh.step(0.08, 0.01) == 0
    for variable in declared(component):
        if variable.causality == "output" and not (variable.lowest_of or variable.highest_of):
            # the same operations on the same numbers: no tolerance
            assert getattr(fresh, variable.name) == getattr(used, variable.name), variable.name


# Declaration


@every_component
def test_declaration(component):
    for variable in declared(component):
        assert variable.type is float or variable.variability != "continuous", variable.name
        assert math.isfinite(variable.start)
        assert variable.nominal is None or variable.nominal > 0.0


@every_component
def test_descriptions(component):
    described = [variable.description for variable in declared(component)]
    assert len(set(described)) == len(described)
    for text in described:
        assert text == text.strip() != ""
        assert not text[0].islower()
        assert "\n" not in text
        assert not text.endswith(".")
    assert component.__doc__.splitlines()[0].endswith(".")


@every_component
def test_terminals_join_variables_that_fit(component):
    # the same kind at both ends: members and units alike, outputs at one end, inputs at the other
    for terminal in component.terminals:
        ends = []
        for other in COMPONENTS.values():
            known = {variable.name: variable for variable in declared(other)}
            for end in other.terminals:
                if end.kind == terminal.kind:
                    variables = [known[name] for name in end.variables]
                    (causality,) = {variable.causality for variable in variables}
                    facts = [(variable.unit, variable.display, variable.type) for variable in variables]
                    ends.append((causality, end.members, facts))
        assert {causality for causality, *_rest in ends} == {"input", "output"}
        assert all(end[1:] == ends[0][1:] for end in ends)


@every_component
def test_problems_speak_of_variables(component):
    values_of_default = values(component())
    for problem in component.problems:
        text = problem.text.format_map(values_of_default)
        assert "\n" not in text
        assert not text.endswith(".")


# Construction


@every_component
def test_only_declared_variables_can_be_set(component):
    instance = component()
    with pytest.raises(AttributeError):
        instance.undeclared = 1.0
    assert not hasattr(instance, "__dict__")
    with pytest.raises(TypeError):
        component(undeclared=1.0)


@every_component
def test_values_outside_their_limits_are_refused(component):
    for variable in declared(component):
        if not variable.settable:
            continue
        refused = [math.nan, math.inf, -math.inf]
        if variable.minimum is not None:
            assert component(**{variable.name: variable.type(variable.minimum)})
            refused.append(variable.minimum - 1e-3 * max(abs(variable.minimum), 1.0))
        if variable.maximum is not None:
            assert component(**{variable.name: variable.type(variable.maximum)})
            refused.append(variable.maximum + 1e-3 * max(abs(variable.maximum), 1.0))
        factor = units.unit(variable.display).factor
        low = -math.inf if variable.minimum is None else variable.minimum / factor
        high = math.inf if variable.maximum is None else variable.maximum / factor
        for value in refused:
            with pytest.raises(ValueError, match=r".") as refusal:
                component(**{variable.name: value})
            message = str(refusal.value)
            assert message.startswith(f"{component.__name__}.{variable.name} = {value / factor:.7g}")
            if variable.choices:
                assert f"must be {numbered(variable.choices, range(1, len(variable.choices) + 1))}" in message
            elif math.isfinite(value):
                assert f"is outside [{low:.7g}, {high:.7g}]" in message
                assert variable.display == "1" or message.endswith(f" {variable.display}")
            else:
                assert message.endswith("is not a finite number")
            assert "\n" not in message


@pytest.mark.no_cover
@every_component
def test_every_limit_is_a_value_that_runs_or_a_problem(component, belt_in_c):
    if component is BeltDynamics:  # a stiff belt takes a second in Python until it is held
        component = belt_in_c
    for variable in declared(component):
        if not variable.settable:
            continue
        for limit in (variable.minimum, variable.maximum):
            if limit is None:
                continue
            instance = component(**{variable.name: variable.type(limit)})
            problem = instance.initialize(0.0)
            assert 0 <= problem <= len(component.problems)
            if problem != 0 and not component.problems[problem - 1].warning:
                continue
            for n in range(5):
                problem = instance.step(n * 1e-3, 1e-3)
                assert problem == 0 or component.problems[problem - 1].warning
            finite(instance)


# Running


@pytest.mark.few(2, each="component")
@every_flag
def test_runs_alone(component, given):
    instance = component(**given)
    assert instance.check() == 0
    assert instance.initialize(0.0) == 0
    finite(instance)
    for n in range(300):  # two revolutions
        assert instance.step(n * 1e-3, 1e-3) == 0
        finite(instance)
    # dropped into a tool and run, with nothing connected, it is not all zeros
    assert any(values(instance, "output").values())


@every_component
@pytest.mark.parametrize("step_size", [1e-9, 1e-3, 0.15, 0.7])
def test_runs_with_any_step(component, step_size):
    # 0.15 s is a whole revolution at the default speed
    for given in flags(component):
        instance = component(**given)
        instance.initialize(0.0)
        for n in range(5):
            assert advance(instance, n * step_size, step_size) == 0
            finite(instance)


@pytest.mark.few(2, each="component")
@every_flag
def test_a_step_of_no_length_changes_nothing(component, given):
    instance = component(**given)
    instance.initialize(0.25)
    before = values(instance, "output")
    assert instance.step(0.25, 0.0) == 0
    assert values(instance, "output") == before
    assert advance(instance, 0.25, 1e-3) == 0
    assert instance.step(0.251, 0.0) == 0
    finite(instance)


@pytest.mark.few(1, each="component")
@every_flag
@pytest.mark.parametrize("factor", [0.0, -1.0])
def test_standing_and_turning_backwards(component, given, factor):
    speeds = {
        variable.name: factor * variable.start
        for variable in declared(component)
        if variable.settable and variable.unit == "rad/s"
    }
    instance = component(**given, **speeds)
    assert instance.initialize(0.0) == 0
    for n in range(200):
        assign(instance, moved(component, n * 1e-3) | speeds)
        assert instance.step(n * 1e-3, 1e-3) == 0
        finite(instance)


@pytest.mark.few(1, each="component")
@every_flag
def test_any_inputs_give_finite_outputs(component, given):
    rng = random.Random(1)
    instance = component(**given)
    instance.initialize(0.0)
    for n in range(100):
        assign(instance, drawn_inputs(component, rng))
        problem = instance.step(n * 1e-3, 1e-3)
        assert problem == 0 or component.problems[problem - 1].warning
        finite(instance)


# State


@pytest.mark.few(1, each="component")
@pytest.mark.no_cover
@every_flag
def test_nothing_is_hidden(component, given):
    # all fields copied into a fresh instance: it goes on with the same bits
    rng = random.Random(2)
    instance = component(**given)
    instance.initialize(0.0)
    for n in range(40):
        assign(instance, drawn_inputs(component, rng))
        instance.step(n * 1e-3, 1e-3)
    copy = component()
    assign(copy, values(instance))
    for n in range(40, 80):
        drawn = drawn_inputs(component, rng)
        for each in (instance, copy):
            assign(each, drawn)
            each.step(n * 1e-3, 1e-3)
        assert values(copy) == values(instance)


@pytest.mark.few(1, each="component")
@pytest.mark.no_cover
@every_flag
def test_starting_again_forgets_everything(component, given):
    instance = component(**given)
    runs = []
    for _ in range(2):
        rng = random.Random(3)
        assign(instance, drawn_inputs(component, rng))
        problems = [instance.initialize(0.0)]
        outputs = [values(instance, "output")]
        for n in range(60):
            assign(instance, drawn_inputs(component, rng))
            problems.append(instance.step(n * 1e-3, 1e-3))
            outputs.append(values(instance, "output"))
        runs.append((problems, outputs))
    assert runs[0] == runs[1]


@every_component
def test_two_instances_do_not_meet(component):
    alone, other = component(), component()
    alone.initialize(0.0)
    other.initialize(0.0)
    before = values(other)
    for n in range(10):
        advance(alone, n * 1e-3, 1e-3)
    assert values(other) == before


# What the outputs follow from


def same(one, other, tolerance):
    for name, value in one.items():
        scale = max(abs(value), abs(other[name]), 1.0)
        assert other[name] == pytest.approx(value, abs=tolerance * scale), name


@pytest.mark.few(2, each="component")
@every_flag
@pytest.mark.parametrize("pieces", [2, 3, 10])
def test_splitting_a_step_changes_nothing(component, given, pieces):
    # with inputs of constant acceleration, given for the end of each step, nothing is left to interpolate
    if "inputs_at_step_end" in given:
        given = given | {"inputs_at_step_end": True}
    step_size = 2e-3
    whole, split = component(**given), component(**given)
    for instance in (whole, split):
        instance.initialize(0.0)
    for n in range(20):
        advance(whole, n * step_size, step_size)
        for k in range(pieces):
            advance(split, n * step_size + k * step_size / pieces, step_size / pieces)
        found, other = values(whole, "output"), values(split, "output")
        for held in [v.name for v in declared(component) if v.lowest_of or v.highest_of]:
            # the cubic between samples: steps of 5 deg know a motion of a sixth of a turn to 2e-5, where a
            # sampled extreme is off by 3e-2
            same({held: found.pop(held)}, {held: other[held]}, 1e-4)
        # times and inputs are rounded differently, to 1e-16; a second derivative from samples 0.2 ms apart
        # magnifies that by up to 60 / (0.2 ms)^2, over the largest accelerations of 1e3: 1e-9
        same(found, other, 1e-8)


@pytest.mark.few(1, each="component")
@every_flag
def test_no_sample_is_beyond_an_extreme(component, given):
    numbers = [v for v in declared(component) if v.type is float]
    held = [(v.name, v.lowest_of, min) for v in numbers if v.lowest_of]
    held += [(v.name, v.highest_of, max) for v in numbers if v.highest_of]
    if "inputs_at_step_end" in given:
        given = given | {"inputs_at_step_end": True}  # else an extreme is known a step later
    instance = component(**given)
    instance.initialize(0.0)
    far = {name: getattr(instance, followed) for name, followed, _best in held}
    for n in range(200 if held else 0):
        assert advance(instance, n * 1e-3, 1e-3) == 0
        for name, followed, best in held:
            far[name] = best(far[name], getattr(instance, followed))
            # the same sum in another order: rounding
            beyond = abs(best(far[name], getattr(instance, name)) - getattr(instance, name))
            assert beyond <= 1e-12 * abs(far[name]), name


@pytest.mark.few(2, each="component")
@every_flag
def test_inputs_at_the_start_of_a_step_are_carried_over_it(component, given):
    """What keeps nothing shows at the end of a step what inputs of that time make it show."""
    if component.keeps != NOTHING or "inputs_at_step_end" not in given:
        return
    step_size = 3e-3
    at_start, at_end = (component(**given | {"inputs_at_step_end": end}) for end in (False, True))
    for instance in (at_start, at_end):
        instance.initialize(0.0)
    for n in range(60):
        for instance in (at_start, at_end):
            advance(instance, n * step_size, step_size, QUICKENING)
        # angles of 10 rad are the same sums in another order; second rates of 1e4 magnify their rounding
        same(values(at_start, "output"), values(at_end, "output"), 1e-11)


@pytest.mark.few(2, each="component")
@every_flag
def test_rates_belong_to_their_outputs(component, given):
    check_rates(component, given, 0.02, 0.0)  # away from the points of symmetry


@every_component
def test_rates_belong_to_their_outputs_on_a_shaft_that_speeds_up(component):
    given = {"follow_shaft": True, "inputs_at_step_end": True}
    if component.keeps == NOTHING and given.keys() <= {v.name for v in declared(component)}:
        check_rates(component, given, 0.06, QUICKENING)  # while the pawl of a lock turns


def check_rates(component, given, begin, quickening):
    rated = [v for v in declared(component) if v.causality == "output" and v.rate is not None]
    step_size = 1e-5
    instance = component(**given)
    instance.initialize(0.0)
    advance(instance, 0.0, begin, quickening)
    rows = []
    for n in range(200):
        advance(instance, begin + n * step_size, step_size, quickening)
        rows.append(values(instance, "output"))
    for variable in rated:
        largest = max(abs(row[variable.rate]) for row in rows)
        for before, here, after in zip(rows, rows[1:], rows[2:], strict=False):
            numeric = (after[variable.name] - before[variable.name]) / (2.0 * step_size)
            # a difference over 20 us: exact to (5 us w)^2 for the fastest motions, w < 600 / s (a cam that
            # rises in 60 deg), and rounding of a travel of 1 m to 1e-16 / 20 us
            assert numeric == pytest.approx(here[variable.rate], abs=1e-5 * largest + 1e-10), variable.name


@pytest.mark.few(1, each="component")
@every_flag
def test_the_start_depends_on_nothing_but_what_its_source_shows(component, given):
    rng = random.Random(5)
    needs = dependencies(component).start
    knowns = [v for v in declared(component) if v.causality in ("input", "parameter") and v.name not in given]

    def started(changed, time):
        rejected = {n for n, each in enumerate(component.problems, start=1) if not each.warning}
        instance = component(**given | {k: v for k, v in changed.items() if k not in inputs_drawn})
        assign(instance, inputs_drawn | {k: v for k, v in changed.items() if k in inputs_drawn})
        return None if instance.initialize(time) in rejected else values(instance, "output")

    for _ in range(3):
        inputs_drawn = drawn_inputs(component, rng)
        one = started({}, 0.0)
        others = {v.name: started({v.name: v.type(rng.uniform(*span(v)))}, 0.0) for v in knowns}
        for name, two in {**others, TIME: started({}, 0.3)}.items():
            for output, needed in needs.items():
                if one and two and name not in needed:
                    assert one[output] == two[output], (output, name)


@pytest.mark.few(1, each="component")
@every_flag
def test_outputs_depend_on_nothing_but_what_their_source_shows(component, given):
    rng = random.Random(4)
    needs = dependencies(component).once
    kinds = ("input", "parameter") if component.keeps == NOTHING else ("input",)
    knowns = [v for v in declared(component) if v.causality in kinds and v.name not in given]
    for _ in range(3):
        start, then = drawn_inputs(component, rng), drawn_inputs(component, rng)
        one = after_a_step(component, given, start, then, 0.02)
        others = {TIME: after_a_step(component, given, start, then, 0.05)}
        for known in knowns:
            other = {known.name: known.type(rng.uniform(*span(known)))}
            if known.causality == "parameter":
                others[known.name] = after_a_step(component, given | other, start, then, 0.02)
            else:
                others[known.name] = after_a_step(component, given, start, then | other, 0.02)
        for name, two in others.items():
            for output, needed in needs.items():
                if one and two and name not in needed:
                    assert one[output] == two[output], (output, name)


def after_a_step(component, given, start, then, time):
    """The outputs after a start at 0 and a step from a time; nothing where there is a problem."""
    rejected = {n for n, each in enumerate(component.problems, start=1) if not each.warning}
    instance = component(**given)
    assign(instance, start)
    if instance.initialize(0.0) in rejected:
        return None
    assign(instance, then)
    return None if instance.step(time, 1e-3) in rejected else values(instance, "output")


@every_component
def test_what_is_constant_follows_from_the_parameters_alone(component):
    knowns = {TIME, *(v.name for v in inputs(component))}
    follow = {output for output, needed in dependencies(component).once.items() if needed.isdisjoint(knowns)}
    if component.keeps == NOTHING:  # what keeps more may go on by itself
        assert follow == {v.name for v in declared(component) if v.constant}
