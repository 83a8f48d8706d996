"""The window grid: few steps that land on what the claims look for, as exact as very many."""

import math
from pathlib import Path

import numpy as np
import pytest
import scene_texts as texts
from scene_texts import claim, parsed, verdicts, wires
from scipy.optimize import minimize_scalar

import loomfmu
from loomfmu import Evaluation, LoomfmuError, evaluate
from loomfmu.components import COMPONENTS
from loomfmu.cosim.planning import windows
from loomfmu.cosim.scenes import scene as scenes

SIMS = Path(__file__).parents[3] / "sims"
DEMO, BELT = SIMS / "wl680_3600.toml", SIMS / "belt_alone.toml"
DEGREE = math.pi / 180.0


def judged(grid: str = "windows", **changed: object) -> Evaluation:
    # a shaft that turns backwards has no speed that could be a bound
    text = DEMO.read_text(encoding="utf-8").replace('bound = "shaft.speed"', 'bound = "600 rev/min"')
    return evaluate(parsed(text, grid=grid, **changed))


def lowest(output: str) -> float:
    """Lowest value of an output of the belt over a revolution, from components at one angle at a time."""
    scene = scenes.load(DEMO)
    weft, belt = (
        COMPONENTS[scene.instances[n].fmu.name](**scene.instances[n].values) for n in ("weft", "belt")
    )

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


TIMES = {"grid": "windows", "revolutions": 3, "shaft__speed": "600 rev/min"}
RIGID = texts.loom('weave = "10/01/10/01"\n')
DWELL = claim("dwell", heald="heald_1", at_least="80 deg")
CLAIMS = claim("lowest_margin", bound=0.1) + DWELL
CLAIMS += claim("above", signal="belt.lowest_speed_limit", bound="shaft.speed")
AT_ANGLES = claim("dwell_contains", heald="heald_1", angles=["140 deg", "180 deg", "220 deg"])


def test_a_rigid_loom_is_exact_to_1e_9_with_a_tenth_of_the_steps() -> None:
    margin, limit = lowest("margin"), lowest("speed_limit")
    found = evaluate(parsed(RIGID, CLAIMS, **TIMES))
    steps = len(found.trace.time) - 1
    # 1e-9 is what is promised; it is the curve between samples at 0.2 degrees: 1e-12
    assert abs(found.claims[0].worst - margin) < 1e-9
    assert abs(found.claims[2].worst - limit) < 1e-9 * limit
    fine = judged("uniform", steps_per_revolution=5760)
    assert abs(found.claims[1].worst - fine.claims[2].worst) < 1e-9  # the dwell, rad
    # equal steps that are as good: 720 in a revolution; half as many are not
    assert abs(judged("uniform", steps_per_revolution=360).claims[0].worst - margin) > 1e-9
    assert 10 * steps < 3 * 720


def test_with_a_damper_the_steps_are_the_scenes_own_and_the_landings() -> None:
    found, even = judged(steps_per_revolution=360), judged("uniform", steps_per_revolution=360)
    assert any(
        line.startswith("steps: 360 per revolution (damper_1 integrates), plus steps that land")
        for line in found.skipped
    )
    assert abs(found.claims[0].worst - lowest("margin")) < 1e-9
    # equal steps tell it to 2e-13; the landings move some of them by up to 0.05 degrees
    assert found.claims[5].worst == pytest.approx(even.claims[5].worst, rel=1e-9)


@pytest.mark.parametrize(
    ("weave", "changed", "reach"),
    [
        # frames that hold between two changes, on a shaft that starts up: jumps of acceleration
        (
            "1100/0110/0011/1001",
            {"shaft.ramp_duration": "0.2 s", "shaft.speed": "450 rpm", "revolutions": 5},
            1e-8,
        ),
        # equal steps of 0.25 degrees tell a peak of 36 ripples to 1e-9
        ("10/01/10/01", {"shaft.ripple_amplitude": 0.05, "shaft.ripple_order": 36}, 1e-8),
        # where two picks of this cam join the velocity jumps, which steps of another size take in another way
        ("10/01/10/01", {"dobby.law": "spline_cam", "dobby.slow_point": "170 deg"}, 1e-5),
    ],
)
def test_a_damper_is_as_good_as_with_equal_steps(
    weave: str, changed: dict[str, object], reach: float
) -> None:
    text = DEMO.read_text(encoding="utf-8").replace('"10/01/10/01"', f'"{weave}"')
    assert weave in text
    found, even = (
        verdicts(text, **{"grid": grid, "revolutions": 4, **changed})[5] for grid in ("windows", "uniform")
    )
    assert found.signal == "damper_1.peak_load"
    assert found.worst == pytest.approx(even.worst, rel=reach)


@pytest.mark.parametrize(
    ("order", "amplitude"),
    [
        *[(36, 0.05), (50, 0.3), (100, 0.05)],
        *(pytest.param(order, 0.05, marks=pytest.mark.slow) for order in (48, 64, 80)),
    ],
)
def test_ripples_are_not_overlooked(order: int, amplitude: float) -> None:
    at = {"shaft.ripple_order": order, "shaft.ripple_amplitude": amplitude, "revolutions": 1}
    found, even, exact = (
        evaluate(BELT, set={"grid": grid, "steps_per_revolution": steps, **at}, errors=errors)
        for grid, steps, errors in (
            *[("windows", 1440, "all"), ("uniform", 1440, "none")],
            ("uniform", 11520, "none"),
        )
    )
    assert found.claims[0].holds == exact.claims[0].holds
    # no worse than the scene's own steps, which are off by 1e-5 at an order of 100
    worse = abs(even.claims[0].worst - exact.claims[0].worst)
    assert abs(found.claims[0].worst - exact.claims[0].worst) <= worse + 1e-9
    steps = {100: "1600 per revolution", 36: "576 per revolution"}
    if order in steps:
        wanted = f"steps: {steps[order]} (the shaft ripples {order} times in a revolution)"
        assert any(line.startswith(wanted) for line in found.skipped)


def test_a_ripple_takes_more_steps_than_the_scene_has() -> None:
    at = {"shaft.ripple_order": 7, "shaft.ripple_amplitude": 0.3, "revolutions": 1}
    few = {"steps_per_revolution": 36, "coarse_steps_per_revolution": 24}
    found = evaluate(BELT, set=few | at)
    exact = evaluate(BELT, set={"grid": "uniform", "steps_per_revolution": 11520, **at}, errors="none")
    assert found.claims[0].worst == pytest.approx(exact.claims[0].worst, abs=1e-9)
    wanted = "steps: 112 per revolution (the shaft ripples 7 times in a revolution), plus steps that land"
    assert any(line.startswith(wanted) for line in found.skipped)


@pytest.mark.parametrize("steps", [7200, 14400])
def test_steps_as_fine_as_points_are_kept_apart_stay(steps: int) -> None:
    at = {"steps_per_revolution": steps, "shaft.speed": "300 rpm", "revolutions": 4}
    found, even = (
        evaluate(SIMS / "damper.toml", set={"grid": grid, **at}) for grid in ("windows", "uniform")
    )
    assert 0.9 * even.steps < found.steps < 1.1 * even.steps
    # steps of half that size change it by 1e-12 of it
    assert found.claims[1].worst == pytest.approx(even.claims[1].worst, rel=1e-11)


def test_a_quick_start_is_not_overlooked() -> None:
    at = {"shaft.ramp_duration": "5 ms", "revolutions": 2}  # a whole one after the ramp
    found = evaluate(BELT, set={"grid": "windows", **at})
    fine = evaluate(BELT, set={"grid": "uniform", "steps_per_revolution": 5760, **at})
    assert found.claims[0].worst == pytest.approx(fine.claims[0].worst, abs=1e-9)
    assert any("steps: 320 per revolution (the shaft starts up in 0.005 s)" in line for line in found.skipped)


def test_a_pull_between_two_coarse_steps_is_not_overlooked() -> None:
    pull = wires(belt__yarn_tension=[[0.265, "0 N"], [0.27, "4 N"], [0.275, "0 N"]])
    text = f"{BELT.read_text(encoding='utf-8')}\n[inputs]\n{pull}"
    grids = {"grid": "windows"}, {"grid": "uniform", "steps_per_revolution": 72000}
    found, fine = (verdicts(text, revolutions=1, **grid)[0] for grid in grids)
    assert found.worst == pytest.approx(fine.worst, abs=1e-8)


def test_values_that_no_claim_is_about_are_as_good() -> None:
    values = ["belt.lowest_margin", "belt.lowest_speed_limit"]
    trace = evaluate(parsed(RIGID, DWELL, **TIMES), values=values).trace
    assert trace[values[0]][-1] == pytest.approx(lowest("margin"), abs=1e-9)
    assert trace[values[1]][-1] == pytest.approx(lowest("speed_limit"), rel=1e-9)


def test_steps_land_on_the_edges_of_the_windows() -> None:
    found = evaluate(parsed(RIGID, CLAIMS, AT_ANGLES, **TIMES))
    angles = found.trace.shaft_angle / DEGREE
    for wanted in (140.0, 180.0, 220.0, 500.0):  # a claim names these angles
        assert np.min(np.abs(angles - wanted)) < 1e-9
    # the belt's window: the spline through the scout's samples tells its edges to a thousandth of a degree
    length = judged(**{"steps_per_revolution": 1440}).trace
    assert np.min(np.abs(angles - 92.5292)) < 2e-3
    assert found.trace.time[-1] == pytest.approx(3 * 60 / 600, rel=1e-15)
    assert np.all(np.diff(length.time) > 0.0)


@pytest.mark.parametrize(
    "changed",
    [
        {"shaft__ramp_duration": "0.1 s"},
        {"shaft__ripple_amplitude": 0.05, "shaft__ripple_order": 3},
        {"belt__yarn_tension": "2 N"},
        {"weft__machine": "WL450-5400", "belt__machine": "WL450-5400", "shaft__speed": "200 rpm"},
        {"shaft__start_angle": "97 deg", "revolutions": 0.7},
        {"shaft__speed": "-600 rpm"},
    ],
)
def test_windows_are_found_wherever_they_are(changed: dict[str, object]) -> None:
    found, fine = judged(**changed), judged("uniform", **{"steps_per_revolution": 5760, **changed})
    for verdict, exact in zip(found.claims, fine.claims, strict=True):
        assert verdict.holds == exact.holds, str(verdict)
        assert verdict.worst == pytest.approx(exact.worst, rel=1e-7, nan_ok=True), str(verdict)


@pytest.mark.parametrize(
    ("rest", "why"),
    [
        (
            '[shaft]\ncomponent = "DrivenShaft"\ninertia = 0.1\n',
            "weft.shaft_torque -> shaft.torque_1 closes a loop",
        ),
        ('[shaft]\ncomponent = "DrivenShaft"\n[wires]\n"shaft.torque_1" = false\n', "shaft integrates"),
    ],
)
def test_what_integrates_takes_the_scenes_own_steps(rest: str, why: str) -> None:
    parts, at = (texts.LOOM, rest, claim("lowest_margin", bound=-1.0)), {"steps_per_revolution": 360}
    found, even = (evaluate(parsed(*parts, **at, grid=grid)) for grid in ("windows", "uniform"))
    assert f'steps: all equal, as with grid = "uniform", because {why}' in found.skipped
    assert found.claims == even.claims
    assert found.steps == even.steps == 360


def test_a_claim_that_is_judged_at_every_sample_gets_them_all() -> None:
    torque = claim("below", signal="weft.shaft_torque", bound="1000 N.m")
    assert evaluate(parsed(texts.LOOM, torque, grid="windows", steps_per_revolution=90)).steps == 90


def test_the_lowest_value_of_any_signal_with_a_rate_is_landed_on() -> None:
    claims = claim("above", signal="weft.velocity", bound=-0.1)
    claims += claim("below", signal="weft.travel", bound="1 mm", window=["300 deg", "30 deg"])
    few, many = (
        evaluate(parsed(texts.LOOM, claims, **grid))
        for grid in (
            {"grid": "windows", "coarse_steps_per_revolution": 16},
            {"grid": "uniform", "steps_per_revolution": 5760},
        )
    )
    assert len(few.trace.time) < 40
    for verdict, exact in zip(few.claims, many.claims, strict=True):
        assert verdict.worst == pytest.approx(exact.worst, rel=1e-8)


def test_a_recorded_run_is_on_the_same_grid_and_says_so(tmp_path: Path) -> None:
    result = loomfmu.run(DEMO, set={"grid": "windows"}, output=tmp_path / "windows.h5")
    np.testing.assert_array_equal(result.trace.time, judged().trace.time)
    assert result.trace.attributes["grid"] == "windows"
    assert any(
        line.startswith("steps: 1440 per revolution (damper_1 integrates), plus steps that land")
        for line in result.skipped
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[shaft]", 'grid = "windows": the scene has no claims, so there is nothing to look for'),
        (
            "coarse_steps_per_revolution = 2000\n" + claim("below", signal="shaft.velocity", bound=1),
            "coarse_steps_per_revolution = 2000 is outside [1, 1440], its steps_per_revolution",
        ),
    ],
)
def test_mistakes_are_refused(text: str, message: str) -> None:
    with pytest.raises(LoomfmuError) as raised:
        verdicts('grid = "windows"\n', text)
    assert str(raised.value) == message


def test_points_are_merged_in_order_of_their_weight() -> None:
    places = windows.Places(
        period=1.0, most=0.25, kinks=np.empty(0), points=[0.3, 0.30001, 0.5, 2.0], about=[0.29999, 0.4]
    )
    merged = windows._merged(np.linspace(0.0, 1.0, 5), places)
    assert list(merged) == [0.0, 0.25, 0.3, 0.4, 0.5, 0.75, 1.0]


def test_points_are_kept_apart_from_the_last_one_that_stays() -> None:
    close = [0.5 + 0.8e-4 * place for place in range(4)]  # 1/7200 is 1.4e-4
    places = windows.Places(period=1.0, most=0.5, kinks=np.empty(0), points=close)
    assert list(windows._merged(np.linspace(0.0, 1.0, 3), places)) == [0.0, close[0], close[2], 1.0]


def test_more_steps_than_memory_holds_are_refused_before_any_is_taken() -> None:
    scene = scenes.load(SIMS / "belt_alone.toml", {"revolutions": 1e8})
    with pytest.raises(
        LoomfmuError,
        match=r"2400000000 steps are more than the 10000000 that fit into memory; .* fewer revolutions",
    ):
        evaluate(scene)
