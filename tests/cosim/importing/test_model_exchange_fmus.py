"""FMUs for model exchange, which are solved here: against exact solutions and against fmpy's CVODE."""

import re
import zipfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from foreign_motors import library, packed
from scipy.integrate import solve_ivp

from loomfmu import LoomfmuError
from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing.built import file_of
from loomfmu.cosim.run import Result, run
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.fmi.native.platforms import host

MODELS = {"BALL": (2, 1), "OSCILLATOR": (2, 0), "DAHLQUIST": (1, 0), "STAIRS": (0, 0)}  # states, indicators
NAMES = {1: "h", 2: "v", 3: "der_h", 4: "der_v"}


def description(model: str, fmi: int) -> str:
    """The model description of one of the FMUs of exchange.c."""
    states, indicators = MODELS[model]
    real, whole = ("Float64", "Int32") if fmi == 3 else ("Real", "Integer")

    def variable(name: str, number: int, kind: str, rest: str, inner: str = "") -> str:
        if fmi == 3:
            return f'<{kind} name="{name}" valueReference="{number}" {rest} {inner}/>'
        attributes = f'name="{name}" valueReference="{number}" {rest}'
        return f"<ScalarVariable {attributes}><{kind} {inner}/></ScalarVariable>"

    output, local = 'causality="output"', 'causality="local"'
    start = "2" if model == "OSCILLATOR" else "1"
    variables = [
        variable("h", 1, real, output + ' initial="exact"', f'start="{start}"'),
        variable("v", 2, real, output + ' initial="exact"', 'start="0"'),
        variable("der_h", 3, real, local, 'derivative="1"'),
        variable("der_v", 4, real, local, 'derivative="2"'),
        variable("p", 5, real, 'causality="parameter" variability="fixed"', 'start="0.7"'),
        variable("u", 6, real, 'causality="input"', 'start="0"'),
        variable("count", 8, whole, output + ' variability="discrete"'),
    ]
    if fmi == 3:
        variables.append(
            '<Float64 name="time" valueReference="7" causality="independent" variability="continuous"/>'
        )
        rates = "".join(f'<ContinuousStateDerivative valueReference="{3 + i}"/>' for i in range(states))
        unknown = "".join(f'<Output valueReference="{r}"/>' for r in (1, 2, 8)) + rates
        unknown += '<EventIndicator valueReference="1"/>' * indicators
        head = 'fmiVersion="3.0" instantiationToken="{exchange}"'
    else:
        rates = "".join(f'<Unknown index="{3 + i}"/>' for i in range(states))
        outputs = '<Outputs><Unknown index="1"/><Unknown index="2"/><Unknown index="7"/></Outputs>'
        unknown = outputs + f"<Derivatives>{rates}</Derivatives>" * bool(states)
        head = f'fmiVersion="2.0" guid="{{exchange}}" numberOfEventIndicators="{indicators}"'
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription {head} modelName="{model}">'
        f'<ModelExchange modelIdentifier="{model}"/><ModelVariables>{"".join(variables)}</ModelVariables>'
        f"<ModelStructure>{unknown}</ModelStructure></fmiModelDescription>"
    )


def exchanged(directory: Path, model: str, fmi: int = 2, *defines: str) -> Path:
    """One of the FMUs."""
    binary = library("exchange.c", f"-DFMI={fmi}", f"-DMODEL={model}", *defines)
    folder = "linux64" if fmi == 2 else "x86_64-linux"
    return packed(directory / f"{model}.fmu", description(model, fmi), binary, model, folder)


def solved(path: Path, tables: str = "", *, isolated: bool = False, **changed: Any) -> Result:
    """A run of an FMU by itself, called `it`."""
    text = f'duration = 2.0\nstep = 0.01\nrecord = ["*"]\n[it]\nfmu = "{path.name}"\n{tables}'
    overrides = {"isolated": isolated} | {key.replace("__", "."): value for key, value in changed.items()}
    return run(scenes.parse(text, "solved", overrides, path.parent), output=path.parent / "solved.h5")


@pytest.mark.parametrize("isolated", [False, True])
@pytest.mark.parametrize("fmi", [2, 3])
def test_a_ball_bounces_where_it_must(tmp_path: Path, fmi: int, isolated: bool) -> None:
    path = exchanged(tmp_path, "BALL", fmi)
    trace = solved(path, "tolerance = 1e-9\np = 0.7\n", isolated=isolated).trace
    first = np.sqrt(2.0 / 9.81)
    time, start, speed = np.asarray(trace.time), 0.0, -0.0
    height, count = np.full(len(time), np.nan), np.zeros(len(time))
    for bounce in range(9):  # exact parabolas, one after the other
        length = first if bounce == 0 else 2.0 * speed / 9.81
        here = (time >= start) & (time < start + length)
        since = time[here] - start
        height[here] = (1.0 if bounce == 0 else 0.0) + speed * since - 0.5 * 9.81 * since**2
        count[here] = bounce
        start, speed = start + length, 0.7 * (9.81 * first if bounce == 0 else speed)
    known = ~np.isnan(height)
    assert np.sum(known) > 190
    # two hundred steps, each solved to 1e-9
    np.testing.assert_allclose(trace["it.h"][known], height[known], rtol=0, atol=2e-7)
    np.testing.assert_array_equal(np.asarray(trace["it.count"])[known], count[known])


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("model", ["BALL", "OSCILLATOR", "DAHLQUIST"])
def test_it_agrees_with_cvode(tmp_path: Path, model: str, fmi: int) -> None:
    path = exchanged(tmp_path, model, fmi)
    trace = solved(path, "tolerance = 1e-9\np = 0.7\n").trace
    found = fmpy.simulate_fmu(
        str(path),
        fmi_type="ModelExchange",
        stop_time=2.0,
        output_interval=0.01,
        relative_tolerance=1e-9,
        record_events=False,
        start_values={"p": 0.7},
    )
    for name in ("h", "v")[: MODELS[model][0]]:
        # each is within some 1e-8 of the solution at this tolerance; a ball's speed jumps at its bounces
        at = np.abs(np.interp(trace.time, found["time"], found[name]) - trace[f"it.{name}"])
        assert np.mean(at > 1e-6) <= (0.0 if model != "BALL" else 0.01)


def test_a_stiff_one_is_solved(tmp_path: Path) -> None:
    trace = solved(exchanged(tmp_path, "OSCILLATOR"), "tolerance = 1e-9\np = 1000.0\n").trace

    def rates(_time: float, x: np.ndarray) -> list[float]:
        return [x[1], 1000.0 * (1.0 - x[0] ** 2) * x[1] - x[0]]

    found = solve_ivp(rates, (0, 2), [2.0, 0.0], "Radau", rtol=1e-10, atol=1e-12, t_eval=trace.time)
    np.testing.assert_allclose(trace["it.h"], found.y[0], rtol=0, atol=1e-7)  # 200 steps of 1e-9, damped


def test_errors_do_not_add_up_from_step_to_step(tmp_path: Path) -> None:
    trace = solved(exchanged(tmp_path, "OSCILLATOR"), "tolerance = 1e-6\np = 1.0\n", duration="10 s").trace

    def rates(_time: float, x: np.ndarray) -> list[float]:
        return [x[1], (1.0 - x[0] ** 2) * x[1] - x[0]]

    found = solve_ivp(rates, (0, 10), [2.0, 0.0], "DOP853", rtol=1e-12, atol=1e-12, t_eval=trace.time)
    # 1000 steps; the oscillator magnifies what one of them is off by tenfold at most
    np.testing.assert_allclose(trace["it.h"], found.y[0], rtol=0, atol=1e-5)


@pytest.mark.skipif(find_spec("ziglang") is None, reason="ziglang is not installed: no native FMU")
@pytest.mark.parametrize("fmi", [2, 3])
def test_a_state_starts_with_the_value_that_is_given(tmp_path: Path, fmi: int) -> None:
    path = exchanged(tmp_path, "DAHLQUIST", fmi)  # linear: all values are three times as large
    usual, given = (np.asarray(solved(path, more).trace["it.h"]) for more in ("", "h = 3.0\n"))
    assert given[0] == 3.0
    np.testing.assert_allclose(given, 3.0 * usual, rtol=1e-5)  # tolerance 1e-6 for each of the two


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", ["DobbyDrive", "DetachingRoller"])
def test_ours_give_what_they_give_in_co_simulation(tmp_path: Path, name: str, fmi: int) -> None:
    """They refuse every call in a mode that the standard does not allow it in."""
    file, traces = file_of(COMPONENTS[name], "native", (host(),), fmi), []
    for left_out in ("CoSimulation", "ModelExchange"):
        path = tmp_path / f"without_{left_out}.fmu"
        with zipfile.ZipFile(file) as source, zipfile.ZipFile(path, "w") as target:
            for each in source.namelist():
                content = source.read(each)
                if each == "modelDescription.xml":
                    element = f"<{left_out}\\b[^>]*/>|<{left_out}\\b.*?</{left_out}>"
                    content = re.sub(element, "", content.decode(), flags=re.DOTALL).encode()
                target.writestr(each, content)
        traces.append(solved(path, duration=0.6, step=0.003).trace)
    solved_here, stepped = traces
    for signal in stepped:
        np.testing.assert_array_equal(solved_here[signal], stepped[signal], err_msg=signal)


@pytest.mark.parametrize("fmi", [2, 3])
def test_inputs_are_held_over_a_step_and_jump_between(tmp_path: Path, fmi: int) -> None:
    path = exchanged(tmp_path, "DAHLQUIST", fmi)
    tables = 'tolerance = 1e-9\np = 2.0\n[inputs]\n"it.u" = [[0, 0], [1, 1]]\n'
    trace = solved(path, tables).trace
    exact = [1.0]
    for step in range(200):
        given = min(1.0, 0.01 * (step + 1))  # the value at the end of the step
        exact.append(given / 2.0 + (exact[-1] - given / 2.0) * np.exp(-2.0 * 0.01))
    # two hundred steps, each solved to 1e-9
    np.testing.assert_allclose(trace["it.h"], exact, rtol=0, atol=1e-7)


@pytest.mark.parametrize("fmi", [2, 3])
def test_events_come_in_time_and_one_may_end_the_run(tmp_path: Path, fmi: int) -> None:
    result = solved(exchanged(tmp_path, "STAIRS", fmi))
    time, count = np.asarray(result.trace.time), np.asarray(result.trace["it.count"])
    np.testing.assert_array_equal(count[:-1], np.floor(time[:-1] / 0.2 + 1e-6))
    assert "it ended the simulation at 1.8 s; the run would have gone on to 2 s" in result.warnings


def test_between_communication_points_events_are_found(tmp_path: Path) -> None:
    path = exchanged(tmp_path, "STAIRS")
    trace = solved(path, step=0.3, duration=1.5).trace
    assert list(trace["it.count"]) == [0, 1, 3, 4, 6, 7]


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_loop_is_iterated_from_saved_states(tmp_path: Path, fmi: int) -> None:
    exchanged(tmp_path, "DAHLQUIST", fmi)
    text = 'coupling = "iterated"\nduration = 1\nstep = 0.1\n[it]\nfmu = "DAHLQUIST.fmu"\np = 2.0\n'
    text += 'tolerance = 1e-10\n[wires]\n"it.u" = "it.h"\n'
    scene = scenes.parse(text, "loop", {"isolated": False}, tmp_path)
    found = run(scene, output=tmp_path / "loop.h5").trace["it.h"]
    decay = np.exp(-2.0 * 0.1)  # h1 = u / p + (h0 - u / p) decay, and u is h1
    exact = (decay / (1.0 - (1.0 - decay) / 2.0)) ** np.arange(11)
    np.testing.assert_allclose(found, exact, rtol=1e-8)  # ten steps, each solved to 1e-10


@pytest.mark.parametrize(
    ("tables", "defines", "said"),
    [
        ("", ["-DFAILS_AT=0.5"], r"it at 0\.5 s: fmi2GetDerivatives returned fmi2Error: no reason given"),
        ("", ["-DFAILS_AT=0.5", "-DRETURNED=OK"],
         r"it at 0\.5 s: .* derivatives at 0\.50\d* s are not finite"),
        ("tolerance = 1e-15", [],
         "it.tolerance = 1e-15 must be at least 1e-12 for an FMU for model exchange"),
    ],
)  # fmt: skip
def test_failures_have_one_line(tmp_path: Path, tables: str, defines: list[str], said: str) -> None:
    with pytest.raises(LoomfmuError, match=said):
        solved(exchanged(tmp_path, "OSCILLATOR", 2, *defines), tables)
