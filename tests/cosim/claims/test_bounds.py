"""Claims that a signal stays above or below a bound: the worst value, also between the samples."""

import json
import math
from typing import Any

import numpy as np
import pytest
from claimed import TURN, Looms, curve
from scene_texts import claim

from loomfmu import Trace, Verdict, judge
from loomfmu.design import loom as loom_figures

BOUNDED = claim("below", signal="heald_1.lift", bound=1.0) + claim(
    "below", signal="shaft.velocity", bound=1e3
)


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
def test_the_edges_of_a_window_follow_a_shaft_that_accelerates(looms: Looms, steps: int) -> None:
    trace = looms(steps, revolutions=2, shaft__ramp_duration="0.15 s")
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


def test_of_equal_extremes_the_first_is_named(looms: Looms) -> None:
    trace = looms(shaft__speed="600 rpm", rest="reed = true\nlocks = true\n")
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


def test_claims_on_the_loom_say_where_rates_are_missing(
    looms: Looms, monkeypatch: pytest.MonkeyPatch
) -> None:
    known = looms(90, rest="reed = true\n")
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
def test_a_start_up_stays_below_its_speed_and_frames_within_their_stroke(looms: Looms, steps: int) -> None:
    start = looms(steps, shaft__speed="153 rpm", shaft__ramp_duration="0.02 s", rest=BOUNDED)
    assert judge(start, kind="below", signal="shaft.velocity", bound="shaft.speed").word != "FAILS"
    assert judge(start, kind="below", signal="shaft.velocity", bound="152.99 rpm").word != "holds"
    held = looms(steps, "1100", shaft__start_angle="10 deg", rest=BOUNDED)
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
