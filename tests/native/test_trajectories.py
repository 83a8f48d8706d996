"""Native FMUs give the results of the components they were made from."""

import math
import random
from typing import Any

import fmpy
import numpy as np
import pytest
from driving import assign, inputs, span
from hypothesis import given
from hypothesis import strategies as st
from live_fmus import REVOLUTION
from natives import DISCARD, ERROR, MEMORYLESS, OK, SOLVED, STEPPED

import loomfmu
from loomfmu.components import COMPONENTS
from loomfmu.declaring.variables import Component, Variable, variables_of

pytestmark = pytest.mark.no_cover  # FMUs beside components, step by step: the tests of these cover them
every_fmu = pytest.mark.parametrize("name", COMPONENTS)
# the same operations in the same order; pow() of a square is a product in C, which may round otherwise
SAME = 1e-12
LARGEST_INTEGER = 2147483647


def same(found: Any, wanted: Any) -> bool:
    return bool(found == wanted or math.isclose(found, wanted, rel_tol=SAME, abs_tol=1e-300))


def value_of(variable: Variable) -> st.SearchStrategy[Any]:
    """The start of a variable, or a value where it usually lies."""
    if variable.type is bool:
        return st.booleans()
    if variable.type is int:
        low, high = int(variable.minimum or 0), int(variable.maximum or 100)
        return st.one_of(st.just(variable.start), st.integers(low, high))
    low, high = span(variable)
    return st.one_of(st.just(variable.start), st.floats(low, high, allow_subnormal=False))


def settable(component: type[Component], causality: str) -> st.SearchStrategy[dict[str, Any]]:
    return st.fixed_dictionaries(
        {v.name: value_of(v) for v in variables_of(component) if v.causality == causality}
    )


def steps(name: str) -> st.SearchStrategy[list[tuple[float, bool]]]:
    """Lengths of steps, and whether the inputs move before them."""
    sizes = [0.0, 1e-6, 1e-4, 1e-3, 3e-3, REVOLUTION / 8.0]
    if name != "BeltDynamics":  # which would take a second for it, in Python
        sizes.append(1.7 * REVOLUTION)
    return st.lists(st.tuples(st.sampled_from(sizes), st.booleans()), min_size=1, max_size=5)


def attempted(component: Component, method: str, *arguments: float) -> int | None:
    """What a call returns, a warning as 0; None where it raises.

    Where Python raises, C goes on with an infinity or NaN. Mostly it ends in an output, and is refused;
    there is no result that it could be compared with.
    """
    try:
        problem = int(getattr(component, method)(*arguments))
    except (ArithmeticError, ValueError):
        return None
    return 0 if problem and component.problems[problem - 1].warning else problem


def compare(component: Component, native: Any) -> None:
    wanted = {v.name: getattr(component, v.name) for v in variables_of(type(component))}
    if any(
        not isinstance(each, bool) and abs(each) > LARGEST_INTEGER and isinstance(each, int)
        for each in wanted.values()
    ):
        return  # FMI has no place for it
    for name, found in native.variables().items():
        assert same(found, wanted[name]), f"{name}: native {found!r}, component {wanted[name]!r}"


@pytest.mark.few(4, each="fmi")
@pytest.mark.parametrize("fmi", [2, 3])
@every_fmu
def test_random_parameters_inputs_and_steps(native, name, fmi):
    component = COMPONENTS[name]
    instance = native(name, fmi=fmi)

    @given(
        settable(component, "parameter"),
        st.lists(settable(component, "input"), min_size=6, max_size=6),
        steps(name),
    )
    def check(
        parameters: dict[str, Any], driven: list[dict[str, Any]], sizes: list[tuple[float, bool]]
    ) -> None:
        assert instance.call("Reset") == OK
        python = component(**parameters, **driven[0])
        assert (instance.set(**parameters, **driven[0]), instance.enter()) == (OK, OK), instance.texts
        problem = attempted(python, "initialize", 0.0)
        status = instance.call("ExitInitializationMode")
        if problem is None:
            return
        assert status == (OK if problem == 0 else ERROR), instance.texts
        if problem != 0:
            return
        compare(python, instance)
        time = 0.0
        for (size, moved), values in zip(sizes, driven[1:], strict=False):
            if moved:
                assign(python, values)
                assert instance.set(**values) == OK
            problem = attempted(python, "step", time, size)
            status = instance.step(time, size)
            if problem is None:
                return
            assert status == (OK if problem == 0 else DISCARD), instance.texts
            if problem != 0:
                return
            compare(python, instance)
            time += size

    check()


@pytest.mark.parametrize("law", [1, 2, 3, 4, 5, 6, 7, 9])  # 8 needs a table
def test_every_law_of_the_dobby(native, law):
    given = {"law": law, "speed_reduction": 0.6, "speed": 31.0}
    component, instance = COMPONENTS["DobbyDrive"](**given), native("DobbyDrive").start(**given)
    assert component.initialize(0.0) == 0
    for step in range(300):
        time, size = 0.002 * step, 0.002
        assert component.step(time, size) == 0 and instance.step(time, size) == OK
        compare(component, instance)


@pytest.mark.few(4)
@every_fmu
def test_long_runs(native, name):
    # states that live from step to step: a difference would grow
    component = COMPONENTS[name]()
    instance = native(name).start()
    assert component.initialize(0.0) == 0
    rng = random.Random(1)
    time = 0.0
    for _ in range(800):
        size = rng.choice([1e-4, 3e-4, 2e-3])
        values = {v.name: rng.uniform(*span(v)) for v in inputs(COMPONENTS[name])}
        assign(component, values)
        assert instance.set(**values) == OK
        problem = attempted(component, "step", time, size)
        assert instance.step(time, size) == (OK if problem == 0 else DISCARD), instance.texts
        time += size
        if problem:
            break
    compare(component, instance)


@pytest.mark.parametrize(
    ("name", "fmi", "kind"),
    [
        *((name, fmi, STEPPED) for name in COMPONENTS for fmi in (2, 3)),
        *((name, 3, SOLVED) for name in MEMORYLESS),  # of FMI 2: see test_model_exchange.py
    ],
)
def test_fmpy_simulates_it_as_the_component_steps(package, name, fmi, kind):
    found = fmpy.simulate_fmu(
        package(name, fmi).path, stop_time=0.02, output_interval=1e-3, fmi_type=kind, validate=False
    )
    component = COMPONENTS[name]()
    assert component.initialize(0.0) == 0
    for sample, time in enumerate(found["time"]):
        if kind == SOLVED:
            assert component.step(float(time), 0.0) == 0
        for output in found.dtype.names[1:]:
            assert same(found[output][sample], getattr(component, output)), output
        if kind == STEPPED and sample + 1 < len(found):
            assert attempted(component, "step", float(time), float(found["time"][sample + 1] - time)) == 0


def test_a_scene_gives_the_same_trace_with_either_flavour(built, tmp_path):
    coarse = {"steps_per_revolution": 360}  # which change neither flavour's equations
    runs = {
        flavour: loomfmu.run(
            "sims/wl680_3600.toml", set=coarse, output=tmp_path / f"{flavour}.h5", flavour=flavour
        )
        for flavour in ("live", "native")
    }
    live, native = runs["live"].trace, runs["native"].trace
    assert list(native) == list(live)
    for signal in live:
        np.testing.assert_allclose(native[signal], live[signal], rtol=SAME, atol=0.0, err_msg=signal)
    assert [bool(v) for v in runs["native"].claims] == [bool(v) for v in runs["live"].claims]
    sums = {flavour: run.trace.attributes["fmu_BeltMonitor_sha256"] for flavour, run in runs.items()}
    assert sums["native"] == built["BeltMonitor"].sha256 != sums["live"]
