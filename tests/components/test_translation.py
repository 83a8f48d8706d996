"""Components as self-contained modules: the same results in plain Python, and translated to C."""

import random
import shutil

import pytest
from compiled import compiled
from driving import assign, declared, drawn_inputs, drawn_parameters, values

from loomfmu.components import COMPONENTS
from loomfmu.fmi.source import flatten

every_component = pytest.mark.parametrize("component", COMPONENTS.values(), ids=COMPONENTS)
STEPS = 120


@pytest.fixture(scope="module")
def translated(tmp_path_factory):
    """All components translated to C and compiled."""
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    return {name: compiled(each, tmp_path_factory.mktemp(name.lower())) for name, each in COMPONENTS.items()}


def in_step(component, other, seed, compare):
    """Both through the same random parameters, inputs and steps; `compare` looks at all fields after each.

    Seed 0 keeps to the default parameters.
    """
    rng = random.Random(seed)
    one = component(**drawn_parameters(component, rng)) if seed else component()
    assign(other, values(one))
    drawn = drawn_inputs(component, rng)
    for each in (one, other):
        assign(each, drawn)
    problem = one.initialize(0.0)
    assert other.initialize(0.0) == problem
    compare(one, other)
    if problem and not component.problems[problem - 1].warning:
        return
    time = 0.0
    for _ in range(STEPS):
        drawn = drawn_inputs(component, rng)
        step_size = rng.choice([1e-4, 1e-3, 3e-3])
        for each in (one, other):
            assign(each, drawn)
        problem = one.step(time, step_size)
        assert other.step(time, step_size) == problem
        compare(one, other)
        time += step_size


@pytest.mark.few(1, each="component")
@pytest.mark.no_cover
@every_component
@pytest.mark.parametrize("seed", range(4))
def test_flattened_component_gives_the_same_bits(component, seed):
    space: dict = {}
    exec(compile(flatten(component), component.__name__, "exec"), space)

    def compare(one, other):
        for variable in declared(component):
            # the same operations in the same order: no tolerance
            assert getattr(other, variable.name) == getattr(one, variable.name), variable.name

    fresh = space[component.__name__]()
    assert {variable.name: variable.start for variable in declared(component)} == vars(fresh)
    in_step(component, fresh, seed, compare)


@pytest.mark.few(1, each="component")
@pytest.mark.no_cover
@every_component
@pytest.mark.parametrize("seed", range(4))
def test_translated_component_gives_the_same_bits(translated, component, seed):
    def compare(one, other):
        for variable in declared(component):
            value, found = getattr(one, variable.name), getattr(other, variable.name)
            assert type(found) is variable.type, variable.name
            # the same operations in the same order, by the same libm: no tolerance
            assert found == value, variable.name

    fresh = translated[component.__name__]()
    for variable in declared(component):
        assert getattr(fresh, variable.name) == variable.start
    in_step(component, fresh, seed, compare)


def test_a_step_never_goes_on_for_ever(translated):
    # pieces of motion beyond number, each short against 60 kHz, are a problem to report
    damper = translated["HealdDamper"]()
    damper.spring_stiffness, damper.carrier_mass = 1e12, 1e-3
    assert damper.initialize(0.0) == 0
    assert damper.step(0.0, 3600.0) == 1
    assert "more than 10,000 contacts or pieces" in COMPONENTS["HealdDamper"].problems[0].text
