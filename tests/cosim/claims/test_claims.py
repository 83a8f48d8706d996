"""Claims: every kind where it holds and where it fails, and values between the samples."""

import json
import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
import scene_texts as texts
from drawn_runs import drawn, turning
from scene_texts import claim, parsed, table, verdicts, wires
from scipy.optimize import brentq

from loomfmu import Evaluation, LoomfmuError, Trace, Verdict, evaluate, judge
from loomfmu.components import DobbyDrive
from loomfmu.cosim.claims import judging
from loomfmu.cosim.claims.arguments import Name, Quantity, argument
from loomfmu.cosim.claims.claim import AT_MOST, Claim
from loomfmu.cosim.claims.claims import kinds
from loomfmu.cosim.claims.judging import Form, Question, Run
from loomfmu.cosim.reading import checked_claims
from loomfmu.cosim.run import run
from loomfmu.design import loom as loom_figures
from loomfmu.fmi.native import compiler, platforms
from loomfmu.loom.judged import Kind
from loomfmu.physics.heald import lift_fraction
from loomfmu.physics.rotor_laws.rotor import SLOPED_SINE, rotor_law
from loomfmu.traces import Recording, Signals

TURN = 2 * math.pi
Looms = Callable[..., Trace]  # of a loom with other steps, weaves and values
LOOM = "revolutions = 3\n" + texts.LOOM + 'weave = "{weave}"\n{rest}'
DEMO = Path(__file__).parents[3] / "sims" / "wl680_3600.toml"

BOUNDED = claim("below", signal="heald_1.lift", bound=1.0) + claim(
    "below", signal="shaft.velocity", bound=1e3
)


@pytest.fixture(scope="module")
def loom(tmp_path_factory: pytest.TempPathFactory, fmu_cache: None) -> Looms:
    """Traces of a loom; the same one is run once."""
    known: dict[tuple[Any, ...], Trace] = {}
    directory = tmp_path_factory.mktemp("looms")

    def open_(steps: int = 360, weave: str = "10/01", rest: str = "", **values: Any) -> Trace:
        key = (steps, weave, rest, *values.items())
        if key not in known:
            text = LOOM.format(weave=weave, rest=rest)
            scene = replace(parsed(text, steps_per_revolution=steps, **values), name=f"loom_{len(known)}")
            known[key] = run(scene, output=directory / f"{scene.name}.h5").trace
        return known[key]

    return open_


def curve(
    time: np.ndarray,
    value: Callable[[np.ndarray], np.ndarray],
    rate: Callable[[np.ndarray], np.ndarray] | None,
    angle: Callable[[np.ndarray], np.ndarray] = lambda t: t,
) -> Recording:
    """A run of one signal `a.x`, perhaps with its rate, over the angle of a shaft."""
    signals = {"a.x": ("m", value(time), {"rate": "v"}), "a.v": ("m/s", rate(time))} if rate else {}
    signals = signals or {"a.x": ("m", value(time))}
    return drawn(time, {**signals, **turning(angle(time), np.gradient(angle(time), time), 0.0)})


# ---- above and below


def test_above_and_below_tell_the_worst_value_and_its_place() -> None:
    # x = cos(t), one turn of the shaft in 2 s, 2.5 turns
    trace = curve(np.linspace(0, 5, 51), np.cos, lambda t: -np.sin(t), lambda t: math.pi * t)
    holds = judge(trace, kind="above", signal="a.x", bound=-1.001)
    assert isinstance(holds, Verdict)
    assert holds
    assert (holds.claim, holds.signal, holds.note) == ("lowest value", "a.x", "")
    assert (holds.unit, holds.display_unit) == ("m", "mm")
    # the cubic through samples 0.1 s apart with exact rates: off by up to h^4 / 384 = 3e-7
    assert math.isclose(holds.worst, -1.0, abs_tol=3e-7)
    # where the cubic turns is off by some h^3: its rate's error over the curvature, 1
    assert math.isclose(holds.time, math.pi, abs_tol=1e-4)
    assert holds.revolution == 2
    # rounding of the angle, 10 rad, and of its polynomial's points
    assert math.isclose(holds.angle, math.pi * holds.time - TURN, abs_tol=1e-13)
    fails = judge(trace, kind="above", signal="a.x", bound="-900 mm", name="stays high")
    assert not fails
    assert fails.claim == "stays high: lowest value"
    assert (fails.worst, fails.time) == (holds.worst, holds.time)
    assert judge(trace, kind="below", signal="a.x", bound=1.0)
    assert not judge(trace, kind="below", signal="a.x", bound=0.999)
    assert judge(trace, kind="below", signal="a.x", bound=0.0).time == 0.0
    # a bound that is just reached holds
    assert judge(trace, kind="below", signal="a.x", bound="1 m")


def test_a_signal_without_its_rate_is_judged_at_the_samples_and_says_so() -> None:
    time = np.linspace(0, 7, 71)
    wavy = curve(time, np.cos, None)
    found = judge(wavy, kind="above", signal="a.x", bound=-2.0)
    assert found.note == (
        "a.x is known only at the samples; set at_samples = true in the claim to judge these alone"
    )
    assert (found.worst, found.time) == (np.cos(time).min(), time[31])
    assert (found.word, found.error) == ("undecided", math.inf)  # nobody knows what lies between
    fails = judge(wavy, kind="above", signal="a.x", bound=-0.5)
    assert (fails.word, fails.note) == ("FAILS", "a.x is known only at the samples")
    assert math.isnan(found.distance)
    assert judge(wavy, kind="above", signal="a.x", bound=-0.9).word == "FAILS"  # a sample is below
    sampled = judge(wavy, kind="above", signal="a.x", bound=-2.0, at_samples=True)
    assert (sampled.word, sampled.claim, sampled.note) == ("holds", "lowest value at the samples", "")
    window = ["2 deg", "3 deg"]  # between two samples
    between = judge(wavy, kind="above", signal="a.x", bound=-2.0, at_samples=True, window=window)
    assert (between.word, "no sample lies in that window" in between.note) == ("undecided", True)
    # samples that only fall do not show that nothing lies between them
    falling = curve(time, lambda t: -t, None)
    assert judge(falling, kind="above", signal="a.x", bound=-8.0).word == "undecided"


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize(
    ("window", "low", "high"),
    [
        (["300 deg", "60 deg"], -math.sqrt(3) / 2, math.sqrt(3) / 2),  # wraps 360
        (["-60 deg", "60 deg"], -math.sqrt(3) / 2, math.sqrt(3) / 2),  # the same, said otherwise
        (["30 deg", "150 deg"], 0.5, 1.0),
        ([0.0, "10 deg"], 0.0, math.sin(math.radians(10))),
        (["200 deg", "560 deg"], -1.0, 1.0),  # a whole turn
        ([0, "360 deg"], -1.0, 1.0),
        (["400 deg", "60 deg"], math.sin(math.radians(40)), math.sin(math.radians(60))),
    ],
)
def test_windows_of_shaft_angle(sense: int, window: list[Any], low: float, high: float) -> None:
    # x = sin(angle), 37 samples a turn: no edge lies on a sample, both ways of turning
    time = np.arange(3 * 37 + 1) * (TURN / 37)
    trace = curve(time, lambda t: sense * np.sin(t), lambda t: sense * np.cos(t), lambda t: sense * t)
    lowest = judge(trace, kind="above", signal="a.x", bound=0.0, window=window)
    highest = judge(trace, kind="below", signal="a.x", bound=0.0, window=window)
    # the cubic between samples 0.17 apart is off by up to h^4 / 384 = 2.2e-6
    assert math.isclose(lowest.worst, low, abs_tol=2.2e-6)
    assert math.isclose(highest.worst, high, abs_tol=2.2e-6)
    assert 0.0 <= lowest.angle < TURN
    for found in (lowest, highest):
        assert math.isclose(math.sin(found.angle), found.worst, abs_tol=1e-3)  # it is where it says


@pytest.mark.parametrize("steps", [90, 360])
def test_the_edges_of_a_window_follow_a_shaft_that_accelerates(loom: Looms, steps: int) -> None:
    trace = loom(steps, revolutions=2, shaft__ramp_duration="0.15 s")
    travel, place = loom_figures._travel("WL680-3600")[1], math.radians(90.1)
    found = judge(trace, kind="above", signal="weft.travel", bound=0.0, window=[place, "110.3 deg"])
    assert math.isclose(found.angle, place, abs_tol=1e-9)
    # the head goes on outwards, so its travel is least at the edge; the shaft's angle as a quintic is good to
    # h^6, the travel as a cubic to h^4 / 384 of its fourth rate: straight lines were off by 1e-4 at 90 steps
    assert math.isclose(found.worst, travel(place)[0], rel_tol=1e-6 if steps == 90 else 4e-9)


def test_a_windows_edges_are_found_on_samples_thousands_of_turns_away() -> None:
    # at four samples in a degree all edges are samples, or off them by the last bit
    time = np.arange(200_000) * (TURN / 1440) + 3000 * TURN
    trace = curve(time, np.sin, np.cos)
    found = judge(trace, kind="below", signal="a.x", bound=0.0, window=["10 deg", "60 deg"])
    # sin(t) at t = 19000, which is rounded to 2e-12
    assert math.isclose(found.worst, math.sin(math.radians(60)), abs_tol=4e-12)


def test_of_equal_extremes_the_first_is_named(loom: Looms) -> None:
    trace = loom(shaft__speed="600 rpm", rest="reed = true\nlocks = true\n")
    for given in (
        {"kind": "below", "signal": "weft.travel", "bound": 0.0},
        {"kind": "below", "signal": "weft.acceleration", "bound": 0.0},
        {"kind": "lowest_margin", "bound": 0.0},
        {"kind": "dwell_contains", "heald": "heald_1", "angles": ["180 deg"]},
        {"kind": "clear_shed", "heald": "heald_2", "clearance": "6 mm", "at_least": 0.0},
        {"kind": "rapier_in_open_shed", "head_height": 0.0},
        {"kind": "reed_clear_of_rapier", "clearance": 0.0},
    ):
        assert judge(trace, **given).revolution == 1, given


@pytest.mark.parametrize(
    ("samples", "word", "note"),
    [(8, "holds", ""), (2, "undecided", "the samples are too far apart to be sure; take more steps")],
)
def test_samples_that_do_not_tell_an_oscillation_do_not_make_a_claim_hold(
    samples: int, word: str, note: str
) -> None:
    # cos(8 t + 1) seen twice and eight times in an oscillation
    time = np.linspace(0.0, TURN, 8 * samples + 1)
    wave = curve(time, lambda t: np.cos(8 * t + 1), lambda t: -8 * np.sin(8 * t + 1))
    found = judge(wave, kind="below", signal="a.x", bound=1.5)
    assert (found.word, found.note) == (word, note)


@pytest.mark.parametrize(
    ("value", "kind", "window", "word"),
    [
        (math.nan, "below", None, "undecided"),
        (math.nan, "above", None, "undecided"),
        (math.nan, "below", ["10 deg", "90 deg"], "undecided"),
        (math.inf, "above", None, "undecided"),
        (math.inf, "below", None, "FAILS"),
    ],
)
def test_what_is_not_a_number_does_not_hold(
    value: float, kind: str, window: list[str] | None, word: str
) -> None:
    trace = curve(
        np.linspace(0, 7, 71), lambda t: np.where(np.abs(t - 1.0) < 1e-9, value, 0.0), lambda t: 0 * t
    )
    found = judge(trace, kind=kind, signal="a.x", bound=0.0, window=window)
    assert found.word == word
    if math.isnan(value):
        assert math.isclose(found.time, 1.0)
        assert found.note == "a.x or its rate is not finite everywhere"


def test_claims_on_the_loom_say_where_rates_are_missing(loom: Looms, monkeypatch: pytest.MonkeyPatch) -> None:
    known = loom(90, rest="reed = true\n")
    with Trace(known.path) as trace:
        monkeypatch.setattr(trace, "rate", lambda signal: None)
        said = [
            judge(trace, kind="dwell", heald="heald_1", at_least=0.0).note,
            judge(trace, kind="rapier_in_open_shed", head_height=0.0).note,
            judge(trace, kind="reed_clear_of_rapier", clearance=0.0).note,
        ]
    lacking = "{} is known only at the samples".format
    assert said == [
        lacking("heald_1.lift"),
        "; ".join(map(lacking, ("weft.travel", "heald_1.lift", "heald_2.lift"))),
        "; ".join(map(lacking, ("weft.travel", "reed.position"))),
    ]


@pytest.mark.few(12)
@pytest.mark.parametrize("share", np.linspace(0.02, 0.98, 13))
@pytest.mark.parametrize("power", [2, 3, 4, 5])
def test_a_smooth_stop_does_not_fail_at_its_bound_wherever_it_lies_between_samples(
    share: float, power: int
) -> None:
    # the curve may pass the bound, by no more than it may be off: it neither fails nor holds
    def left(t: np.ndarray) -> np.ndarray:
        return np.maximum(20.0 + share - t, 0.0)

    trace = curve(
        np.arange(41.0),
        lambda t: -(left(t) ** power),
        lambda t: power * left(t) ** (power - 1),
        lambda t: 0.16 * t,
    )
    found = judge(trace, kind="below", signal="a.x", bound=0.0)
    assert found.word == "undecided"
    assert abs(found.distance) <= found.error
    assert judge(trace, kind="below", signal="a.x", bound=found.worst + 1.001 * found.error)
    # a bound that a sample passes by more than rounding, 1e-12 of 20^5, fails
    assert judge(trace, kind="below", signal="a.x", bound=-1e-5).word == "FAILS"


def test_a_failing_sample_fails_however_far_the_curve_may_be_off() -> None:
    # six samples in a wave, of which one passes the bound
    time = np.linspace(0.0, TURN, 61)
    trace = curve(time, lambda t: np.sin(10 * t), lambda t: 10 * np.cos(10 * t), lambda t: 0.01 * t)
    passed = float(np.max(trace["a.x"])) - 1e-3
    assert judge(trace, kind="below", signal="a.x", bound=passed).word == "FAILS"


@pytest.mark.parametrize("samples", [20, 63, 200])
def test_a_bound_that_the_motion_passes_between_samples_fails(samples: int) -> None:
    time = np.linspace(0.0, TURN, samples + 1)
    trace = curve(time, lambda t: np.sin(t - 0.3), lambda t: np.cos(t - 0.3))
    # the cubic is off by h^4 / 384, and held to be off by h^4 / 16: beyond that nothing is hidden
    doubt = (TURN / samples) ** 4 / 16
    for kind, sign in (("below", 1.0), ("above", -1.0)):
        assert judge(trace, kind=kind, signal="a.x", bound=sign * (1.0 - 1.5 * doubt)).word == "FAILS"
        assert judge(trace, kind=kind, signal="a.x", bound=sign * (1.0 + 1.5 * doubt))


def test_where_one_extreme_is_in_doubt_another_one_still_counts() -> None:
    # a stop at 1 within an interval, which the cubic passes by some percent, then a clear excess of 0.001
    def x(t: np.ndarray) -> np.ndarray:
        return np.where(t < 10.4, 1.0 - np.maximum(10.4 - t, 0.0) ** 2, 1.0) + 1e-3 * np.where(
            t > 20.0, np.sin(0.1 * (t - 20.0)) ** 4, 0.0
        )

    def rate(t: np.ndarray) -> np.ndarray:
        wave = 4e-4 * np.sin(0.1 * (t - 20.0)) ** 3 * np.cos(0.1 * (t - 20.0))
        return 2.0 * np.maximum(10.4 - t, 0.0) + np.where(t > 20.0, wave, 0.0)

    trace = curve(np.arange(41.0), x, rate)
    found = judge(trace, kind="below", signal="a.x", bound=1.0011)
    assert (found.word, found.worst > 1.02) == ("undecided", True)
    assert not judge(trace, kind="below", signal="a.x", bound=1.0009)


@pytest.mark.few(2)
@pytest.mark.parametrize("steps", [90, 360, 1000])
@pytest.mark.parametrize("grid", ["uniform", "windows"])
def test_a_start_up_stays_below_its_speed_and_frames_within_their_stroke(
    loom: Looms, steps: int, grid: str
) -> None:
    start = loom(steps, grid=grid, shaft__speed="153 rpm", shaft__ramp_duration="0.02 s", rest=BOUNDED)
    assert judge(start, kind="below", signal="shaft.velocity", bound="shaft.speed").word != "FAILS"
    assert judge(start, kind="below", signal="shaft.velocity", bound="152.99 rpm").word != "holds"
    held = loom(steps, "1100", grid=grid, shaft__start_angle="10 deg", rest=BOUNDED)
    for kind, signal, bound in (
        ("above", "heald_1.lift", 0.0),
        ("below", "heald_1.lift", "heald_1.stroke"),
        ("above", "weft.travel", 0.0),
    ):
        assert judge(held, kind=kind, signal=signal, bound=bound).word != "FAILS"
    assert not judge(held, kind="above", signal="heald_1.lift", bound="1e-3 mm")


def test_a_window_that_the_run_never_enters_is_not_judged() -> None:
    trace = curve(np.linspace(0, 1, 11), np.cos, lambda t: -np.sin(t))
    found = judge(trace, kind="above", signal="a.x", bound=-9.0, window=["180 deg", "200 deg"])
    assert found.word == "undecided"
    assert found.note == "the run never passes through the whole window"
    assert found.as_dict()["worst"] is None
    assert "nan" not in json.dumps(found.as_dict()).lower()


# ---- the belt


def test_lowest_margin(loom: Looms) -> None:
    trace = loom(shaft__speed="600 rpm")
    holds = judge(trace, kind="lowest_margin", bound=0.1)
    assert holds
    assert holds.worst == trace["belt.lowest_margin"][-1]
    assert not judge(trace, kind="lowest_margin", bound="23 %")
    # it is the continuous curve's: not above any sample, and next to the place that it names
    assert holds.worst <= trace["belt.margin"].min()
    place = int(np.argmin(np.abs(trace.time - holds.time)))
    assert math.isclose(trace["belt.margin"][place], holds.worst, abs_tol=1e-3)
    coarse = judge(loom(90, shaft__speed="600 rpm"), kind="lowest_margin", bound=0.1)
    assert abs(coarse.worst - holds.worst) < 1e-5  # the quintic between samples 4 degrees apart


# ---- the healds


def exact_dwell(tolerance: float) -> float:
    dobby = DobbyDrive(dwell_tolerance=tolerance)
    dobby.initialize(0.0)
    return dobby.dwell_angle


@pytest.mark.parametrize(("steps", "tolerance"), [(1440, 1e-9), (90, 1e-9), (45, 1e-8)])
def test_dwell_is_the_rotor_laws_own(loom: Looms, steps: int, tolerance: float) -> None:
    # off by 4e-16 rad at 1440 steps, 2.5e-11 at 90, 3e-10 at 45: the quintic's error falls as h^6
    found = judge(loom(steps), kind="dwell", heald="heald_1", at_least="80 deg")
    assert found
    assert abs(found.worst - exact_dwell(0.015)) < tolerance
    assert abs(found.worst - loom(steps)["dobby.dwell_angle"][-1]) < tolerance
    assert not judge(loom(steps), kind="dwell", heald="heald_1", at_least="86 deg")
    wider = judge(loom(steps), kind="dwell", heald="heald_2", at_least=0.0, tolerance="5 %")
    assert abs(wider.worst - exact_dwell(0.05)) < tolerance
    assert wider.claim == "dwell within 5 % of the stroke"


HOLDING = {"weave": "1100/0110"}
UNEQUAL = {"weave": "1000/0111"}
STILL = {"steps": 90, "weave": "1/10"}
SLOW = {"shaft__start_angle": "180 deg"}  # the slow point, in the middle of a dwell


@pytest.mark.parametrize(
    ("values", "heald", "turns"),
    [
        (HOLDING | {"revolutions": 9}, "heald_1", 1),
        (HOLDING | {"revolutions": 9}, "heald_2", 1),
        (UNEQUAL | {"revolutions": 9}, "heald_1", 0),  # the shortest dwell counts
        # one that is under way at the start is judged where the run has a whole one
        (SLOW | {"revolutions": 2}, "heald_1", 0),
        ({"shaft__start_angle": "150 deg", "revolutions": 2}, "heald_1", 0),
        ({"shaft__speed": "-600 rpm"}, "heald_1", 0),
    ],
)
def test_a_dwell_lasts_as_long_as_its_frame_is_held(
    loom: Looms, values: dict[str, Any], heald: str, turns: int
) -> None:
    found = judge(loom(**values), kind="dwell", heald=heald, at_least=0.0)
    assert found and 0.0 <= found.angle < TURN
    assert abs(found.worst - (turns * TURN + exact_dwell(0.015))) < 1e-9
    assert "weave" in values or found.note == ""


ONE_IS_CUT = "one is cut off by an end of the run and may be shorter; run longer or start elsewhere"
CUT_OFF = UNEQUAL | {"steps": 90, "revolutions": 4, "shaft__start_angle": "160 deg"}


@pytest.mark.parametrize(
    ("values", "at_least", "word", "note"),
    [
        # the short dwell lies across the ends of the run; the long one alone was judged, and held
        (CUT_OFF, 150, "undecided", ONE_IS_CUT),
        (CUT_OFF, 20, "holds", ""),  # both parts last longer
        # raised for a turn and half a dwell, lowered for half a dwell, or for a turn more
        (HOLDING | SLOW | {"revolutions": 4}, 40, "holds", ""),
        (HOLDING | SLOW | {"revolutions": 2}, 300, "undecided", ONE_IS_CUT),
        (
            *(HOLDING | SLOW | {"revolutions": 3}, 300, "undecided"),
            "; cut off by an end of the run: it lasts at least this long",
        ),
        (HOLDING | SLOW | {"revolutions": 2}, 440, "undecided", "; none begins and ends within the run"),
        (STILL, 80, "holds", "the frame stays there throughout the run"),
        (
            *(STILL | {"revolutions": 0.2}, 80, "undecided"),
            "; the frame stays there all the time, but the run is too short to tell",
        ),
    ],
)
def test_what_a_run_shows_of_a_dwell_that_it_cuts_off_is_the_least_that_it_lasts(
    loom: Looms, values: dict[str, Any], at_least: float, word: str, note: str
) -> None:
    found = judge(loom(**values), kind="dwell", heald="heald_1", at_least=f"{at_least} deg")
    assert found.word == word
    assert found.note.endswith(note)
    if values == STILL:
        assert math.isclose(found.worst, 3 * TURN, rel_tol=1e-14)
    if values == CUT_OFF and word == "undecided":
        assert found.worst > math.radians(800.0)


@pytest.mark.parametrize(
    "claim",
    [
        {"kind": "dwell", "heald": "heald_1", "at_least": "80 deg"},
        {"kind": "dwell_contains", "heald": "heald_1", "angles": ["140 deg"]},
        {"kind": "above", "signal": "heald_1.lift", "bound": "-1 mm", "window": ["90 deg", "180 deg"]},
    ],
)
def test_a_run_that_is_shorter_than_the_repeat_of_the_weave_shows_too_little(
    loom: Looms, claim: dict[str, Any]
) -> None:
    assert judge(loom(90, weave="1010/0101", revolutions=2), **claim)  # twice the same
    found = judge(loom(90, weave="1100/0110", revolutions=3), **claim)
    why = "the shaft turns by only 3 revolutions, and the weave repeats after 4; set revolutions = 4 or more"
    assert found.word == "undecided" and found.note.startswith(why) and math.isnan(found.worst)
    assert judge(loom(90, weave="1100/0110", revolutions=4), **claim)
    # what does not depend on the frames needs no more than a revolution
    assert judge(
        loom(90, weave="1100/0110", revolutions=1), kind="above", signal="weft.travel", bound="-1 mm"
    )


def test_a_run_that_begins_exactly_on_the_level_of_a_dwell(loom: Looms) -> None:
    # raised for one pick of three, from 30 deg before the slow point: 60 deg of dwell, or 420 deg lowered
    trace = loom(90, weave="100/010", revolutions=4, shaft__start_angle="150 deg")
    stroke, begin = trace.parameter("heald_1.stroke"), float(trace["heald_1.lift"][0])
    tolerance = (stroke - begin) / stroke
    for _ in range(100):  # the one whose level is the first sample to the last bit
        if (level := stroke - tolerance * stroke) == begin:
            break
        tolerance = math.nextafter(tolerance, 0.0 if level < begin else 1.0)
    assert stroke - tolerance * stroke == begin
    found = judge(trace, kind="dwell", heald="heald_1", at_least=0.0, tolerance=tolerance)
    assert math.isclose(found.worst, math.radians(60), abs_tol=1e-9)  # the quintic at 90 steps


def crossings(trace: Signals, level: float) -> list[float]:
    """The times at which `a.x` passes a level, as a claim on the transfer takes them."""
    return Run(trace).landings(trace, Question("transfer_speed", [], ["a.x"], [0.0, level]))


def test_a_level_that_is_passed_twice_between_two_samples_is_passed_twice() -> None:
    # h (u - 3 u^2 + 2 u^3), which goes as far as h sqrt(3) / 18 to either side
    trace = curve(np.array([0.0, TURN]), lambda t: 0 * t, np.cos)
    for level in (0.5, -0.5):
        times = crossings(trace, level)
        assert len(times) == 2
        shares = np.roots([2.0, -3.0, 1.0, -level / TURN])
        assert np.allclose(np.sort(times), np.sort(TURN * shares[(shares > 0) & (shares < 1)]), rtol=1e-12)
    assert crossings(trace, 0.61) == []


def test_clear_shed_is_the_dwell_at_another_height(loom: Looms) -> None:
    # |warp| > 6 mm is a lift within 1/2 - 6 mm / (98 mm / 6) of the stroke from an end
    exact = exact_dwell(0.5 - 0.006 / (0.098 / 6))
    for steps in (1440, 90):
        claim = {"kind": "clear_shed", "heald": "heald_1", "clearance": "6 mm"}
        found = judge(loom(steps), **claim, at_least="120 deg")
        assert found
        assert abs(found.worst - exact) < 1e-9  # 1e-12 rad at 90 steps
        assert not judge(loom(steps), **claim, at_least="199 deg")
    with pytest.raises(LoomfmuError) as raised:
        judge(loom(), kind="clear_shed", heald="heald_1", clearance="9 mm", at_least=0.0)
    assert str(raised.value) == (
        "claim 'clear_shed' of heald_1: clearance = 9 mm is outside (0, 8.166667) mm,"
        " how far the warp moves to either side"
    )


@pytest.mark.parametrize("given", [{}, {"heald_1__warp_ratio": 0.1}])
def test_a_clearance_beyond_the_warp_is_rejected_before_the_run(given: dict[str, float]) -> None:
    reach = 98.0 / 2 * given.get("heald_1__warp_ratio", 1 / 6)
    shed = claim("clear_shed", heald="heald_1", at_least=0, clearance="9 mm")
    with pytest.raises(LoomfmuError, match=rf"clearance = 9 mm is outside \(0, {reach:.7g}\) mm"):
        checked_claims(parsed('[loom]\nweave = "10"\n', shed, **given))


def test_dwell_contains(loom: Looms) -> None:
    trace = loom()
    claim = {"kind": "dwell_contains", "heald": "heald_2"}
    holds = judge(trace, **claim, angles=["140 deg", "180 deg", "220 deg"])
    assert holds
    assert holds.claim == "dwell at 140 deg, 180 deg, 220 deg"
    # the middle of the dwell is at 180 deg: a share of the dwell's own width further out the lift is
    # at the tolerance itself, on the quintic through samples 0.25 degrees apart
    edge = math.pi - 0.5 * exact_dwell(0.015)
    assert math.isclose(judge(trace, **claim, angles=[edge]).worst, 0.015, abs_tol=1e-12)
    assert judge(trace, **claim, angles=[edge + 1e-6])
    fails = judge(trace, **claim, angles=["140 deg", "240 deg"])
    assert not fails
    assert math.isclose(math.degrees(fails.angle), 240.0, abs_tol=1e-9)
    assert judge(trace, **claim, angles=["240 deg"], tolerance="10 %")
    # angles of another turn are the same angles
    assert judge(trace, **claim, angles=["-220 deg"]).worst == pytest.approx(
        judge(trace, **claim, angles=["140 deg"]).worst, abs=1e-14
    )


def test_dwell_contains_needs_the_run_to_get_there(loom: Looms) -> None:
    trace = loom(90, revolutions=0.2)
    claim: dict[str, Any] = {"kind": "dwell_contains", "heald": "heald_1", "tolerance": 0.499}
    for angles in (["180 deg"], ["60 deg", "180 deg"]):
        found = judge(trace, **claim, angles=angles)
        assert (found.word, found.note) == ("undecided", "the run never reaches 180 deg")
    assert judge(loom(90, revolutions=0.2, weave="1/1"), **claim, angles=["60 deg"])


# ---- the dampers

DAMPED = {"rest": "[damper_1]\n", "shaft__speed": "600 rpm"}


def test_peak_load(loom: Looms) -> None:
    trace = loom(**DAMPED)
    worst = trace["damper_1.peak_load"][-1]
    holds = judge(trace, kind="peak_load", damper="damper_1", at_most=worst)
    assert holds
    assert (holds.worst, holds.unit, holds.display_unit) == (worst, "N", "N")
    assert not judge(trace, kind="peak_load", damper="damper_1", at_most=f"{worst / 1001} kN")
    # it is the continuous curve's: not below any sample
    assert worst >= np.max(np.abs(trace["damper_1.transmitted_force"]))
    # reached within the step before the sample that has it first
    place = int(np.argmax(trace["damper_1.peak_load"] == worst))
    assert trace.time[place - 1] <= holds.time <= trace.time[place]
    # and where finer steps have it: the parabola through samples 0.25 deg apart
    finer = judge(loom(5760, **DAMPED), kind="peak_load", damper="damper_1", at_most=worst)
    assert math.isclose(holds.angle, finer.angle, abs_tol=math.radians(0.25 / 20))


def test_stop_contacts(loom: Looms) -> None:
    trace = loom(**DAMPED)
    counted = trace["damper_1.stop_contacts"]
    assert counted[-1] >= 2
    holds = judge(trace, kind="stop_contacts", damper="damper_1", at_most=int(counted[-1]))
    fails = judge(trace, kind="stop_contacts", damper="damper_1", at_most=1)
    assert not fails
    assert fails.worst == counted[-1]
    assert holds and holds.time == fails.time
    place = int(np.flatnonzero(trace.time == fails.time)[0])
    assert counted[place - 1] < counted[place] == counted[-1]  # the last contact


# ---- in Python, in the scene, in the file


def test_a_verdict_as_a_person_reads_it(loom: Looms) -> None:
    trace = loom(shaft__speed="700 rpm")
    said = str(judge(trace, kind="lowest_margin", bound=0.1, name="no buckling"))
    assert said.startswith("FAILS: no buckling: lowest margin (belt.lowest_margin), -0.05")
    assert said.endswith(" deg, rev. 1, bound 0.1")
    said = str(judge(trace, kind="dwell", heald="heald_1", at_least="80 deg"))
    assert said.startswith("holds: dwell within 1.5 % of the stroke (heald_1.lift), 85.92125 deg at ")
    assert said.endswith(", bound 80 deg")


def test_a_verdicts_numbers_stand_beside_their_own_units(loom: Looms) -> None:
    trace = loom()
    found = judge(trace, kind="above", signal="belt.lowest_speed_limit", bound="600 rpm")
    assert (found.unit, found.display_unit) == ("rad/s", "rev/min")
    assert math.isclose(found.bound, 20 * math.pi, rel_tol=1e-15)
    stored = found.as_dict()
    assert (stored["bound"], stored["worst"], stored["unit"]) == (found.bound, found.worst, "rad/s")
    shown = stored["display"]
    assert shown["unit"] == "rev/min"
    assert math.isclose(shown["bound"], 600.0, rel_tol=1e-14)
    assert math.isclose(shown["worst"], found.worst * 30 / math.pi, rel_tol=1e-14)
    # what pytest prints of a failing assert
    assert repr(judge(trace, kind="below", signal="belt.lowest_speed_limit", bound="600 rpm")) == (
        "<Verdict FAILS: highest value (belt.lowest_speed_limit), 95492.97 rev/min at 0 s, 0.000 deg, rev. 1,"
        " bound 600 rev/min>"
    )
    dwelling = judge(trace, kind="dwell_contains", heald="heald_2", angles=["180 deg"])
    assert (dwelling.unit, dwelling.display_unit, dwelling.bound) == ("1", "%", 0.015)
    assert dwelling.as_dict()["display"]["bound"] == 1.5


def test_a_verdict_comes_back_from_its_file(loom: Looms) -> None:
    for given in (
        {"kind": "above", "signal": "belt.lowest_speed_limit", "bound": "600 rpm"},
        {"kind": "dwell_contains", "heald": "heald_1", "angles": ["180 deg"], "tolerance": "0.1 %"},
        {"kind": "stop_contacts", "damper": "damper_1", "at_most": 9},
    ):
        found = judge(loom(**DAMPED), **given)
        stored = json.loads(json.dumps(found.as_dict()))
        assert str(Verdict.of(stored)) == str(found)
        assert Verdict.of(stored).as_dict() == stored
        # as version 0.1.0 stored them
        old = {key: value for key, value in stored.items() if key != "display"}
        assert str(Verdict.of(old | {"unit": found.display_unit})) == str(found)


def test_a_run_without_a_shaft_tells_the_time_alone() -> None:
    text = 'duration = "1 s"\nstep = "0.01 s"\n' + table("shaft_2", component="MainShaft", speed="60 rpm")
    found = evaluate(parsed(text, claim("below", signal="shaft_2.angle", bound="90 deg")))
    assert str(found.claims[0]) == "FAILS: highest value (shaft_2.angle), 360 deg at 1 s, bound 90 deg"
    stored = found.claims[0].as_dict()
    assert stored["angle"] is stored["revolution"] is None
    with pytest.raises(LoomfmuError, match=r"the claim needs shaft angles, but shaft\.angle is not recorded"):
        judge(found.trace, kind="below", signal="shaft_2.angle", bound=1.0, window=[0.0, 1.0])


def test_claims_of_a_scene_are_judged_stored_and_the_signals_they_need_recorded(tmp_path: Path) -> None:
    rest = claim(
        "above", name="fast enough", signal="weft.velocity", bound="0 m/s", window=["20 deg", "160 deg"]
    )
    rest += claim("dwell", heald="heald_2", at_least="90 deg") + claim(
        "peak_load", damper="damper_1", at_most="1 N"
    )
    text = "record = []\n" + LOOM.format(weave="10/01", rest="dampers = true\n" + rest)
    result = run(parsed(text), output=tmp_path / "claims.h5")
    assert [bool(verdict) for verdict in result.claims] == [True, False, False]
    assert not result.holds
    with Trace(tmp_path / "claims.h5") as trace:
        assert trace.verdicts == list(result.claims)
        assert trace.verdicts[0].claim == "fast enough: lowest value between 20 deg and 160 deg"
        assert {"weft.velocity", "weft.acceleration", "heald_2.lift", "heald_2.acceleration"} <= set(trace)
        assert "damper_1.peak_load" in trace
        assert "weft.travel" not in trace and "heald_1.lift" not in trace
        # judging the file anew gives the same, without the error, which takes other runs
        again = judge(trace, kind="dwell", heald="heald_2", at_least="90 deg")
        assert math.isnan(again.error)
        assert again == replace(trace.verdicts[1], error=again.error)


TRAVEL = {"kind": "above", "signal": "weft.travel", "bound": 0}
ROOM = {"kind": "rapier_in_open_shed", "head_height": 0.0}
WHOLE_TURN = "is empty; a whole revolution is [0 deg, 360 deg]"


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"kind": "abov", "signal": "weft.travel"}, "claim kind = 'abov' is unknown; did you mean 'above'?"),
        ({"kind": "above", "signal": "weft.travel"}, "claim 'above' needs 'bound'"),
        (TRAVEL | {"bond": 1}, "claim 'above' has no 'bond'; did you mean 'bound'?"),
        (TRAVEL | {"bound": "1 N"}, "claim 'above': bound: '1 N' is in N, which does not fit m"),
        (TRAVEL | {"bound": math.inf}, "claim 'above': bound = inf is not finite"),
        *(
            (TRAVEL | {"window": window}, f"claim 'above': window {said}")
            for window, said in (
                (["1 deg"], '= [\'1 deg\'] must be two shaft angles, such as ["330 deg", "30 deg"]'),
                (["90 deg", "90 deg"], f"= [90 deg, 90 deg] {WHOLE_TURN}"),
                (["360 deg", 0], f"= [360 deg, 0 deg] {WHOLE_TURN}"),
                ([0, "400 deg"], "= [0 deg, 400 deg] is longer than a revolution"),
                ([355, 5], 'has 355 rad, more than a revolution; did you mean "355 deg"?'),
                (["350", "20"], 'has 350 rad, more than a revolution; did you mean "350 deg"?'),
                ([350.0, 10.0], 'has 350.0 rad, more than a revolution; did you mean "350.0 deg"?'),
            )
        ),
        (
            {"kind": "dwell_contains", "heald": "heald_1", "angles": []},
            "claim 'dwell_contains': angles = [] must be a list of shaft angles, such as [\"140 deg\"]",
        ),
        (
            {"kind": "dwell", "heald": "heald_1", "at_least": 1, "tolerance": 0.5},
            "claim 'dwell': tolerance = 0.5 is outside (0, 0.5) of the stroke",
        ),
        ({"kind": "dwell", "heald": 5, "at_least": 1}, "claim 'dwell': heald = 5 is not a name in quotes"),
        (
            {"kind": "peak_load", "damper": "damper_1", "at_most": "1 mm"},
            "claim 'peak_load': at_most: '1 mm' is in mm, which does not fit N",
        ),
        (
            {"kind": "dwell", "heald": "heald_9", "at_least": 1},
            "loom_0.h5: signal 'heald_9.lift' is not recorded; did you mean 'heald_2.lift'?",
        ),
        *(
            (ROOM | {"healds": healds}, f"claim 'rapier_in_open_shed': healds = {healds!r} {said}")
            for healds, said in (
                *((each, 'must be a list of names, such as ["heald_1"]') for each in (5, "heald_1", [1])),
                ([], "names nothing; leave it out to judge all"),
            )
        ),
    ],
)
def test_a_claim_that_cannot_be_judged_is_refused_with_its_name(
    loom: Looms, given: dict[str, Any], said: str
) -> None:
    with pytest.raises(LoomfmuError) as raised:
        judge(loom(), **given)
    assert str(raised.value).replace(loom().path.name, "loom_0.h5") == said


def test_every_verdict_has_a_signed_distance_to_its_bound(loom: Looms) -> None:
    trace = loom(shaft__speed="600 rpm")
    for kind, way in (("above", 1.0), ("below", -1.0)):
        found = judge(trace, kind=kind, signal="weft.travel", bound="1 m")
        assert found.distance == way * (found.worst - 1.0)
        assert bool(found) == (found.distance >= 0.0)
        assert found.relative_distance == found.distance  # of a bound of 1 m
        stored = json.loads(json.dumps(found.as_dict()))
        assert Verdict.of(stored).distance == found.distance == stored["distance"]
        assert stored["display"]["distance"] == found.displayed(found.distance)
    # the bound of a share of the stroke is the most that is allowed, that of a margin the least
    contains = judge(trace, kind="dwell_contains", heald="heald_1", angles=["180 deg"])
    assert contains.distance == 0.015 - contains.worst > 0.0
    margin = judge(trace, kind="lowest_margin", bound="90 %")
    assert margin.distance == margin.worst - 0.9 < 0.0
    # nothing was judged, or a trace of an earlier version does not say
    short = judge(loom(90, revolutions=0.2), kind="dwell_contains", heald="heald_1", angles=["180 deg"])
    assert math.isnan(short.distance)
    old = {key: value for key, value in margin.as_dict().items() if key != "sense"}
    assert math.isnan(Verdict.of(old).distance)
    # no share of a bound of 0, and no distance where the samples, not the bound, make a claim fail
    zero = judge(trace, kind="above", signal="weft.travel", bound="0 m")
    assert zero and zero.distance >= 0.0 and math.isnan(zero.relative_distance)
    assert zero.as_dict()["relative_distance"] is None
    assert [each.shown_distance for each in (margin, zero, short)] == [
        f"{100.0 * margin.relative_distance:+.4g} %",
        f"{zero.distance:+.4g} m",
        "-",
    ]
    coarse = judge(loom(16), kind="lowest_margin", bound=-100.0)
    assert not coarse and coarse.worst > coarse.bound and math.isnan(coarse.distance)


@pytest.fixture
def kept_kinds() -> Iterator[None]:
    """The kinds of claims, as they were after the test."""
    before = dict(kinds())
    yield
    kinds().clear()
    kinds().update(before)


@pytest.mark.usefixtures("fmu_cache")
def test_without_the_library_a_scene_with_claims_is_refused_before_it_runs(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(platforms, "SHIPPED", tmp_path)
    monkeypatch.setattr(platforms, "compiler", lambda: None)
    monkeypatch.setattr(compiler, "compiler", lambda: None)
    judging.library.cache_clear()
    with pytest.raises(LoomfmuError) as raised:
        run(DEMO, output=tmp_path / "run.h5")
    said = 'this needs a compiler, which is not installed: pip install "loomfmu[native]"'
    assert str(raised.value) == f"claims cannot be judged: {said}"
    assert not list(tmp_path.iterdir())
    judging.library.cache_clear()


@pytest.mark.usefixtures("kept_kinds", "fmu_cache")
def test_a_new_kind_of_claim_is_one_class() -> None:
    class EndsNear(Claim):
        """A signal of a frame ends near a height."""

        heald: str = argument(Name())
        height: float = argument(Quantity("m", "mm", usual=0.05, low=0.0))

        needs = ("heald.lift",)
        sense, unit = AT_MOST, ("m", "mm")

        def question(self, trace: Signals) -> Question:
            signal = f"{self.heald}.lift"
            worst, time = float(trace[signal][-1]), float(trace.time[-1])
            numbers = [self.height, worst, time, 0.0]
            return Question("given", [self.form("ends near", signal)], [signal], numbers)

    def evaluated(height: Any, **values: Any) -> Evaluation:
        ends = claim("ends_near", heald="heald_1", height=height)
        return evaluate(parsed("record = []\n", LOOM.format(weave="10/01", rest=ends), **values))

    found = evaluated("200 mm")
    assert found and found.claims[0].claim == "ends near"
    assert "heald_1.lift" in found.trace and "heald_2.lift" not in found.trace
    # its usual value, its unit and its limit are known, and the window grid leaves no step out
    assert "height = 50" in evaluated(50).warnings[0]
    with pytest.raises(LoomfmuError, match=r"claim 'ends_near': height: '1 N' is in N, which does not fit m"):
        evaluated("1 N")
    assert evaluated(1, grid="windows").steps >= 3 * 1440


WHOLE_LOOM = texts.loom('weave = "10/01"\nreed = true\nlocks = true\n')


def judged(kind: str, given: Any = (), **values: Any) -> Verdict:
    """The one verdict of a claim on a small loom."""
    usual = {"revolutions": 2, "steps_per_revolution": 180, "heald__warp_ratio": 0.35}
    usual["shaft__speed"] = "600 rev/min"
    (found,) = verdicts(WHOLE_LOOM, claim(kind, **dict(given)), **usual | values)
    return found


LIMIT = {"signal": "belt.lowest_speed_limit"}


@pytest.mark.parametrize(
    ("bound", "message"),
    [
        ("shaft.sped", "claim: bound = 'shaft.sped' is not a parameter; did you mean 'shaft.speed'?"),
        ("belt.head_mass", "claim: bound belt.head_mass is in kg, but belt.lowest_speed_limit is in rad/s"),
    ],
)
def test_a_bound_that_does_not_fit_its_signal_is_refused(bound: str, message: str) -> None:
    with pytest.raises(LoomfmuError, match=re.escape(message)):
        judged("above", LIMIT | {"bound": bound})


def test_the_rapier_head_needs_its_height_in_the_shed() -> None:
    open_enough, too_high = (
        judged("rapier_in_open_shed", {"head_height": height}) for height in ("18 mm", "20 mm")
    )
    assert open_enough.holds
    assert not too_high.holds
    assert re.fullmatch(r"2 \|heald_[12]\.warp_height\|", open_enough.signal)
    # the head enters and leaves at the same distance from the transfer, where the sheds are as open:
    # 0.35 * 98 mm * |1/2 - f| * 2 with the lift fraction f of the law at that angle
    assert open_enough.worst == pytest.approx(too_high.worst, rel=1e-12)
    _guide, travel = loom_figures._travel("WL680-3600")
    entry = brentq(lambda angle: travel(angle)[0] - 0.243, 0.1, math.pi, xtol=1e-14)
    angle = rotor_law(SLOPED_SINE, entry + math.pi, 0.5)[0]  # from the slow point half a turn before
    opening = 2 * 0.35 * 0.098 * abs(0.5 - lift_fraction(angle, 0.0, 0.0)[0])
    # samples of 2 deg joined by quintics: better than 1e-9 of the stroke
    assert open_enough.worst == pytest.approx(opening, abs=1e-9)


def test_the_reed_is_clear_of_the_rapier() -> None:
    kind = "reed_clear_of_rapier"
    assert judged(kind, {"clearance": "40 mm"}).holds
    near = judged(kind, {"clearance": "60 mm"})
    assert not near.holds
    assert near.signal == "reed.front_limit - reed.position"
    # the head enters at about 60 deg, when the reed has gone back 53 mm
    assert 0.045 < near.worst < 0.060
    # as much in a run that never comes to the beat-up
    short = judged(kind, {"clearance": "40 mm"}, revolutions=0.75, shaft__start_angle="45 deg")
    assert short.holds
    assert short.worst == pytest.approx(near.worst, abs=1e-9)  # the quintic, between samples 2 deg apart


def test_the_pattern_locks_are_in_time_up_to_their_speed_limit() -> None:
    """By torque the limit is 825 rev/min: at 850 the claim fails, at 800 it holds."""
    fails, holds, backwards = (
        judged("locks_in_time", shaft__speed=f"{speed} rev/min") for speed in (850, 800, -850)
    )
    assert (fails.holds, holds.holds, backwards.holds) == (False, True, False)
    assert str(fails).startswith("FAILS: highest speed of the shaft (shaft.velocity), 850 rev/min at 0 s")
    assert str(fails).endswith(", bound 824.6588 rev/min")


def test_the_locks_are_judged_by_the_shafts_speed_between_the_samples() -> None:
    """A ripple of 5 % on 800 rev/min reaches 840, between the samples where these are as far apart as it."""
    ripple = {"shaft__speed": "800 rev/min", "shaft__ripple_amplitude": 0.05, "shaft__ripple_order": 8}
    coarse, fine = (judged("locks_in_time", steps_per_revolution=steps, **ripple) for steps in (8, 360))
    assert not coarse.holds
    assert coarse.note.startswith(FAR_APART)
    assert not fine.holds
    # the cubics through 45 samples of an oscillation: (2 pi / 45)^4 / 384 = 1e-6 of its amplitude
    assert math.isclose(fine.worst, 80 / 3 * math.pi * 1.05, rel_tol=1e-7)
    assert fine.note == ""


def test_a_lock_that_turns_by_itself_is_judged_at_the_samples_and_says_so() -> None:
    own = {"lock__follow_shaft": False, "lock__speed": "540 rev/min", "shaft__speed": "850 rev/min"}
    found = judged("locks_in_time", **own)
    assert found.word == "undecided"
    assert found.note == (
        "lock.in_time is known only at the samples: the lock does not follow shaft.velocity"
    )


def test_a_frame_that_crosses_the_closed_shed_between_samples_leaves_no_opening() -> None:
    # the shed closes at 70 deg as the head comes in; at the nearest samples, 15 deg apart, 0.8 mm are open
    room = {"head_height": "0.5 mm"}
    fine, coarse = (
        judged("rapier_in_open_shed", room, steps_per_revolution=steps, dobby__slow_point="250 deg")
        for steps in (720, 24)
    )
    assert coarse.worst == fine.worst == 0.0
    assert math.isclose(coarse.angle, fine.angle, abs_tol=1e-3)  # the quintic's, 15 deg apart
    assert not coarse.holds


FAR_APART = "the samples are too far apart to be sure; take more steps"


@pytest.mark.parametrize("steps", [1, 2, 3, 4, 6, 8, 12, 16, 19])
@pytest.mark.parametrize("rest", ["", 'grid = "windows"\ncoarse_steps_per_revolution = {steps}\n'])
def test_no_claim_holds_on_samples_that_may_miss_the_belts_window_of_risk(steps: int, rest: str) -> None:
    """At 700 rev/min the belt buckles; its window of risk lies between any 6 samples in a revolution."""
    fewest = {"steps_per_revolution": 24 if rest else steps}
    found = evaluate(parsed(rest.format(steps=steps), DEMO.read_text(), shaft__speed="700 rpm", **fewest))
    if rest:  # a coarse grid may still land close enough
        assert found.claims[0].worst < 0.0 or FAR_APART in found.claims[0].note
    else:
        assert all(FAR_APART in claim.note for claim in found.claims)
    assert not any(found.claims[:2])


@pytest.mark.parametrize(
    ("machine", "rpm"), [("WL680-3600", 300), ("WL680-3600", 750), ("WL450-3600", 450), ("WL450-4000", 400)]
)
def test_the_lowest_margin_is_known_where_the_samples_are_near_enough_to_judge_it(
    machine: str, rpm: int
) -> None:
    coarse, fine = (
        evaluate(DEMO, set={"machine": machine, "shaft.speed": f"{rpm} rpm", "steps_per_revolution": steps})
        for steps in (20, 2880)
    )
    assert FAR_APART not in coarse.claims[0].note
    # a quintic over 18 deg where the margin falls steeply; 1.5e-3 was the most of all machines
    assert math.isclose(coarse.claims[0].worst, fine.claims[0].worst, abs_tol=2e-3)


def test_a_run_that_never_reaches_the_belts_risk_says_so() -> None:
    short = evaluate(DEMO, set={"revolutions": 0.25}).claims[0]
    assert (short.word, short.note) == (
        "undecided",
        "the shaft turns by only 0.25 revolutions, and the claim takes a whole one;"
        " the belt is never at risk in this run",
    )
    assert evaluate(DEMO).claims[0].note == ""
    never = evaluate(DEMO, set={"belt.head_length": "2 m"}).claims[0]
    assert (never.holds, never.worst, never.note) == (True, 1.0, "the belt is never at risk in this run")


def test_a_negative_speed_is_refused_as_a_bound(loom: Looms) -> None:
    said = r'bound shaft.speed = -800 rev/min is negative, .*, such as bound = "800 rev/min"'
    with pytest.raises(LoomfmuError, match=said):
        evaluate(DEMO, set={"shaft.speed": "-800 rpm"})
    backwards = loom(shaft__speed="-800 rpm")
    with pytest.raises(LoomfmuError, match=said):
        judge(backwards, kind="above", signal="belt.lowest_speed_limit", bound="shaft.speed")
    assert not judge(backwards, kind="above", signal="belt.lowest_speed_limit", bound="800 rpm")


def test_a_limit_of_speed_that_turns_negative_in_a_page_is_not_compared(loom: Looms) -> None:
    trace = loom(90)
    question = kinds()["above"](signal="belt.lowest_speed_limit", bound="shaft.speed").question(trace)
    negative = question._replace(numbers=[-80.0, *question.numbers[1:]])
    found = Run(trace).verdict(trace, negative)
    assert found.word == "undecided"
    assert found.note == "the bound is negative, but a limit of speed is positive"


@pytest.mark.parametrize("start", [0, 45])
@pytest.mark.parametrize("way", [1, -1])
def test_revolutions_are_counted_from_1_the_way_that_the_shaft_turns(
    loom: Looms, start: int, way: int
) -> None:
    trace = loom(360, shaft__speed=f"{600 * way} rpm", shaft__start_angle=f"{start * way} deg")
    steps = [round(360 * revolutions) for revolutions in (0.0, 0.3, 1.3, 2.6)]
    form = Form("", "shaft.angle", ("rad", "deg"), 1)
    asked = [
        Question("given", [form], [form.signal], [0.0, 1.0, float(trace.time[step]), 0.0]) for step in steps
    ]
    found = [Run(trace).verdict(trace, each) for each in asked]
    assert [each.revolution for each in found] == [1, 1, 2, 3]
    expected = [(way * (start + turned)) % 360 for turned in (0, 108, 108, 216)]
    assert [math.degrees(each.angle) for each in found] == pytest.approx(expected, abs=1e-9)


def roller_verdict(nip: Mapping[str, Any] = {"at_samples": True}, **values: Any) -> Verdict:
    text = table("shaft", speed="300 rev/min") + table("roller", component="DetachingRoller")
    (found,) = verdicts(
        text, claim("nip_holds", **nip), **{f"roller__{key}": each for key, each in values.items()}
    )
    return found


@pytest.mark.parametrize(
    ("force", "holds", "bound"),
    [(60.0, False, 2.0), (48.0, True, 2.0), (35.0, True, 3.0), (30.0, False, 3.0)],
)
def test_the_nip_holds_two_to_three_times_the_drafting_force(force: float, holds: bool, bound: float) -> None:
    steady = {"use_table": False, "acceleration": 1000.0, "fibre_share": 1.0}
    verdict = roller_verdict(**steady, prescribe_drafting_force=True, largest_drafting_force=force)
    # friction of 0.33 * 300 N less the top roller's inertia J2 r1 / r2^2 e, section 2 of the source
    expected = (99.0 - 33.98e-6 * 12.5e-3 / 12.25e-3**2 * 1000.0) / force
    assert (verdict.holds, verdict.bound) == (holds, bound)
    assert verdict.worst == pytest.approx(expected, rel=1e-14)  # rounding


def test_by_its_own_drafting_force_the_nip_holds_twice_as_much() -> None:
    assert 2.0 <= roller_verdict().worst < 2.1
    assert roller_verdict(use_table=False, acceleration=0.0, fibre_share=1.0).worst == 2.0
    without = roller_verdict(use_table=False, fibre_share=0.0)
    assert not without.holds and "no fibres are drafted in this run" in without.note


@pytest.mark.parametrize("at_least", [1.0, 2.5])
def test_a_nip_is_undecided_unless_the_samples_alone_are_judged(at_least: float) -> None:
    found = roller_verdict({"at_least": at_least})
    assert (found.word, "known only at the samples" in found.note) == ("undecided", True)


def test_the_type_of_kinds_names_all_kinds() -> None:
    assert sorted(get_args(Kind)) == sorted(Claim.kinds)


def test_a_frame_counts_whatever_it_is_called() -> None:
    """One that was not called heald_3 dropped out of the shed, and the claim held on the others."""
    found = []
    for name in ("heald_3", "extra_1"):
        frame = table(name, component="HealdFrame", pattern="10", stroke="20 mm")
        fed = {f"{name}__{each}": f"dobby.{each}" for each in ("rotor_ratio", "lift_slope")}
        room = claim("rapier_in_open_shed", head_height="1 mm")
        loom = '[loom]\nweave = "10/01"\n', frame, room, "[wires]\n", wires(**fed)
        found += evaluate(parsed(*loom, revolutions=2, steps_per_revolution=180), errors="none").claims
    named, other = found
    assert other.worst == named.worst
    assert "extra_1" in other.signal and "heald_3" in named.signal
