"""Claims on what follows from the time alone: exact in few steps, whatever lies between the samples."""

import math
from pathlib import Path

import numpy as np
import pytest
import scene_texts as texts
from scene_texts import claim, parsed
from scipy.optimize import minimize_scalar

import loomfmu
from loomfmu import Evaluation, LoomfmuError, evaluate
from loomfmu.components import COMPONENTS
from loomfmu.cosim import composed
from loomfmu.cosim.composed import Composed
from loomfmu.cosim.master.grid import uniform
from loomfmu.cosim.planning.requested import Requested
from loomfmu.cosim.reading import requested
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.scene import Scene, parse
from loomfmu.cosim.tangents import Tangents

DEMO = Path(__file__).parents[2] / "sims" / "wl680_3600.toml"
DEGREE = math.pi / 180.0

LOOM = """
revolutions = 2
steps_per_revolution = 72
[loom]
machine = "WL680-3600"
weave = "10/01"
reed = true
locks = true
dampers = true
[shaft]
speed = "600 rev/min"
ripple_amplitude = 0.02
ripple_order = 2
"""
SIGNALS = [
    "weft.acceleration",
    "reed.shaft_torque",
    "heald_1.warp_height",
    "dobby.rotor_torque",
    "lock.inertia_torque",
]


def read(*parts: str) -> Scene:
    return requested(parse(LOOM + "".join(parts), "loom"), None, "native").scene


@pytest.mark.parametrize("signal", SIGNALS)
def test_a_rate_is_the_derivative_of_the_samples(signal: str) -> None:
    scene = read(claim("below", signal=signal, bound=1e9))
    fine = requested(scene, {"steps_per_revolution": 14400}, "native").scene
    tangents = _tangents(scene)
    assert tangents
    grid, step = uniform(fine), fine.step_size
    with tangents.placed():
        rows = tangents._rows(fine, grid, {}, np.ones(grid.steps), np.zeros(grid.steps))
    values, rates = rows[:, [name for name, _place in tangents._kept].index(signal)].T
    differences = (values[2:] - values[:-2]) / (2.0 * step)
    # at a corner by up to half of the jump; else by h^2 n^2 / 6 of the n-th harmonic: 8e-7 of the fifth
    off = np.abs(differences - rates[1:-1]) - 0.51 * np.abs(rates[2:] - rates[:-2])
    assert off.max() <= 1e-6 * np.abs(rates).max()


@pytest.mark.parametrize("signal", SIGNALS)
def test_the_worst_value_on_few_steps_is_as_near_the_truth_as_its_error(signal: str) -> None:
    scene = parse(LOOM + claim("below", signal=signal, bound=1e9) + claim("above", signal=signal, bound=-1e9))
    truth = loomfmu.evaluate(scene, set={"steps_per_revolution": 5760}).claims
    for verdict, true in zip(loomfmu.evaluate(scene).claims, truth, strict=True):
        assert verdict.holds and "samples" not in verdict.note
        assert abs(verdict.worst - true.worst) <= verdict.error + true.error
        # of a bound that is far away, rounding alone is more
        assert verdict.error <= 1e-9 * abs(verdict.worst) + 1.1e-12 * abs(verdict.bound)


@pytest.mark.parametrize("flavour", ["native", "live"])
def test_a_claim_holds_in_a_run_of_either_flavour(tmp_path: Path, flavour: str) -> None:
    scene = parse(LOOM + claim("below", signal="reed.shaft_torque", bound="30 N.m"), "loom")
    with loomfmu.run(scene, output=tmp_path / "run.h5", flavour=flavour).trace as trace:
        (verdict,) = trace.verdicts
        assert verdict.holds
        assert not loomfmu.judge(trace, kind="below", signal="reed.shaft_torque", bound=30.0).decided


@pytest.mark.parametrize(
    ("signal", "more"),
    [
        ("damper_1.spring_force", ""),  # what happens within a step may not show at its ends
        ("belt.deflection", ""),  # the belt may buckle within a step: the extreme is held
        ("reed.shaft_torque", 'component = "DrivenShaft"'),
        (
            "heald_1.warp_height",
            '[wires]\n"heald_1.rotor_angle" = false\n[inputs]\n"heald_1.rotor_angle" = [[0, 0], [1, 6]]\n',
        ),
    ],
)
def test_rates_of_what_has_a_memory_or_a_table_are_not_known(signal: str, more: str) -> None:
    text = LOOM.split("ripple")[0] + more + "\n" if "component" in more else LOOM + more
    judged = claim("below", signal=signal, bound=1e9)
    assert _tangents(requested(parse(text + judged, "loom"), None, "native").scene) is None


def _tangents(scene: Scene) -> Tangents | None:
    asked = Requested(scene)
    return Composed(asked, asked.claims)._tangents


# ---- the belt


def lowest(output: str, **values: float) -> float:
    """Lowest value of an output of the belt over a revolution, from components at one angle at a time."""
    scene = scenes.load(DEMO)
    weft, belt = (
        COMPONENTS[scene.instances[n].fmu.name](**scene.instances[n].values) for n in ("weft", "belt")
    )
    for name, value in values.items():
        setattr(belt, name, value)

    def at(angle: float) -> float:
        for component in (weft, belt):
            component.shaft_angle, component.shaft_velocity = angle, scene.speed
            component.shaft_acceleration = 0.0
        weft.initialize(0.0)
        belt.travel, belt.velocity, belt.acceleration = weft.travel, weft.velocity, weft.acceleration
        belt.initialize(0.0)
        return float(getattr(belt, output))

    nearest = min(np.arange(0.0, 360.0, 0.5) * DEGREE, key=at)
    bracket = (nearest - 0.5 * DEGREE, nearest, nearest + 0.5 * DEGREE)
    return float(minimize_scalar(at, bracket=bracket, tol=1e-10).fun)


CLAIMS = claim("lowest_margin", bound=0.1) + claim(
    "above", signal="belt.lowest_speed_limit", bound="shaft.speed"
)
RIGID = texts.loom('weave = "10/01/10/01"\n', CLAIMS)


def rigid(steps: int, **changed: object) -> Evaluation:
    usual = {"revolutions": 3, "shaft__speed": "600 rev/min", "steps_per_revolution": steps}
    return evaluate(parsed(RIGID, **usual | changed))


@pytest.mark.parametrize("steps", [24, 72, 1440])
def test_a_belts_margin_and_limit_are_exact_on_any_steps_in_one_run(steps: int) -> None:
    found = rigid(steps)
    for verdict, output in zip(found.claims, ("margin", "speed_limit"), strict=True):
        exact = lowest(output)
        # Brent's method finds the minimum to the root of rounding, its value to rounding: 1e-12
        assert abs(verdict.worst - exact) <= verdict.error + 1e-12 * abs(exact)
        assert verdict.error <= 1e-9 * abs(exact)
    assert found.claims == rigid(steps).claims


def test_no_coarser_run_is_made_for_claims_that_need_none(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = list[int]()
    stepping = loomfmu.cosim.planning.plan.Stepping
    usual = stepping.in_memory
    monkeypatch.setattr(stepping, "in_memory", lambda *given: (runs.append(1), usual(*given))[1])
    assert all(each.error > 0.0 for each in rigid(72).claims)
    assert len(runs) == 1


@pytest.mark.parametrize(
    "changed",
    [
        {"shaft__ramp_duration": "5 ms"},
        {"shaft__ripple_amplitude": 0.05, "shaft__ripple_order": 3},
        {"belt__yarn_tension": "2 N"},
        {"belt__yarn_tension": "2 N", "belt__taker": True},
        {"weft__machine": "WL450-5400", "belt__machine": "WL450-5400", "shaft__speed": "200 rpm"},
        {"shaft__start_angle": "97 deg", "revolutions": 1.5},
    ],
)
def test_it_is_exact_wherever_the_windows_are(changed: dict[str, object]) -> None:
    few, fine = rigid(360, **changed), rigid(5760, **changed)
    for verdict, output in zip(few.claims, ("belt.lowest_margin", "belt.lowest_speed_limit"), strict=True):
        held = float(fine.trace[output][-1])  # by the component, which knows its inputs to 1e-11 there
        assert abs(verdict.worst - held) <= verdict.error + 5e-9 * abs(held)
        assert verdict.error <= 1e-9 * abs(held)


def test_a_window_of_risk_between_two_samples_is_found() -> None:
    """The head leaves the guide a moment before it pulls: for 1.6 deg alone the belt is pushed."""
    idle = lowest_push() - 0.012
    found = rigid(24, belt__idle_travel=idle)
    exact = lowest("margin", idle_travel=idle)
    assert 0.99 < exact < 0.9999999
    assert abs(found.claims[0].worst - exact) <= found.claims[0].error + 1e-12


def lowest_push() -> float:
    """The travel at which the head's acceleration becomes negative, less the length of the head [m]."""
    scene = scenes.load(DEMO)
    weft = COMPONENTS["WeftInsertion"](**scene.instances["weft"].values)
    head = scene.instances["belt"].values["head_length"]
    for angle in np.arange(20.0, 180.0, 0.01) * DEGREE:
        weft.shaft_angle, weft.shaft_velocity, weft.shaft_acceleration = float(angle), scene.speed, 0.0
        weft.initialize(0.0)
        if weft.acceleration < 0.0:
            return float(weft.travel) - float(head)
    raise AssertionError("the head is never pulled")


@pytest.mark.parametrize("start", [0.0, 40.3, 212.907])
def test_a_beat_up_shorter_than_a_step_is_not_missed(start: float) -> None:
    scene = read(
        "[reed]\nweaving_resistance = 1.0\nresistance_reach = '0.51 mm'\ncloth_stiffness = 1e8\n",
        claim("below", signal="reed.beat_up_force", bound="200 N"),
    )
    values = {"shaft.ripple_amplitude": 0.0, "shaft.start_angle": f"{start} deg"}
    (verdict,) = evaluate(scene, set={**values, "steps_per_revolution": 180}).claims
    assert not verdict.holds and verdict.worst == pytest.approx(238.095, rel=1e-5)  # K (1/0.2 - 1/0.21) / mm
    (verdict,) = evaluate(scene, set={**values, "steps_per_revolution": 1440}).claims
    assert verdict.word == "FAILS"


def test_no_steps_are_too_long_for_what_follows_from_the_time() -> None:
    """Eight ripples of the shaft in a revolution, on three steps each."""
    scene = read(
        claim("below", signal="reed.shaft_torque", bound=1e4),
        claim("dwell", heald="heald_1", tolerance=0.05, at_least="10 deg"),
    )
    values = {"shaft.ripple_order": 8, "steps_per_revolution": 24}
    few, unshown = evaluate(scene, set=values).claims
    fine, shown = evaluate(scene, set={**values, "steps_per_revolution": 5760}).claims
    assert few.holds and abs(few.worst - fine.worst) <= few.error + fine.error <= 1e-7
    assert shown.decided and not unshown.decided and "the shaft ripples 8 times" in unshown.note


def test_a_scene_that_runs_by_seconds_is_divided_by_what_turns_in_it() -> None:
    """With a step for a second, a servo of 20 deg of a shaft that turns 50 times in it is passed by."""
    reed = '[reed]\nservo = true\nrun_angle = "20 deg"\nbeat_up_angle = "190 deg"\n'
    judged = claim("below", signal="reed.velocity", bound=1e4)
    by_seconds = 'duration = "0.1 s"\nstep = "2.5 ms"\n[shaft]\nspeed = "3000 rpm"\n'
    by_turns = "revolutions = 5\nsteps_per_revolution = 1440\n[shaft]\nspeed = '3000 rpm'\n"
    (few,), (fine,) = (evaluate(parse(length + reed + judged)).claims for length in (by_seconds, by_turns))
    assert few.decided and abs(few.worst - fine.worst) <= few.error + fine.error


def test_a_run_of_more_samples_than_are_usual_is_divided_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run of a thousand revolutions began with so many samples that none were left to divide its steps."""
    monkeypatch.setattr(composed, "MOST", 1000)
    (margin, _limit), (usual, _) = (rigid(24, revolutions=turns).claims for turns in (10, 1))
    assert abs(margin.worst - usual.worst) <= margin.error < 1e-8


def test_a_window_may_begin_where_the_run_does() -> None:
    scene = read(claim("below", signal="weft.travel", bound="5 m", window=["0 deg", "30 deg"]))
    (verdict,) = evaluate(scene, set={"revolutions": 0.5}).claims
    assert verdict.holds


def test_inputs_of_the_start_of_a_step_depend_on_the_steps() -> None:
    with loomfmu.prepare(DEMO) as loom:
        late = loom.evaluate({"weft.inputs_at_step_end": False}).claims[0]
        exact = loom.evaluate().claims[0]
    assert late.holds and exact.error < 1e-10 < late.error < 1e-6
    assert abs(late.worst - exact.worst) <= late.error


@pytest.mark.parametrize("window", [["80.3 deg", "95.2 deg"], ["95.2 deg", "80.3 deg"]])
def test_the_edges_of_a_window_are_those_of_the_shaft(window: list[str]) -> None:
    """The head is on its way there, so that the worst values lie at an edge."""
    text = texts.loom(claim("above", signal="weft.acceleration", bound=-1e4, window=window))
    text += claim("below", signal="weft.velocity", bound=1e3, window=window)
    ripple = {"shaft__ripple_amplitude": 0.05, "shaft__ripple_order": 3, "shaft__speed": "600 rev/min"}
    few, fine = (evaluate(parsed(text, steps_per_revolution=steps, **ripple)) for steps in (90, 5760))
    for one, other in zip(few.claims, fine.claims, strict=True):
        assert abs(one.worst - other.worst) <= one.error + other.error
        assert one.error <= 1e-9 * abs(one.bound)


@pytest.mark.parametrize("key", ["grid", "coarse_steps_per_revolution"])
def test_a_key_of_the_window_grid_is_refused_with_what_to_do(key: str) -> None:
    said = f"{key} is no longer a key: all steps are equal"
    with pytest.raises(LoomfmuError, match=said):
        parse(f'{key} = "windows"\n{DEMO.read_text()}')
    with pytest.raises(LoomfmuError, match=said):
        evaluate(DEMO, set={key: "windows"})
