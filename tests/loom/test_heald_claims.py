"""Claims on frames and their dampers: dwells, clear sheds, loads and contacts."""

import math
from typing import Any

import numpy as np
import pytest
from claimed import DAMPED, TURN, Looms, curve
from scene_texts import claim, parsed

from loomfmu import LoomfmuError, judge
from loomfmu.components import DobbyDrive
from loomfmu.cosim.claims.judging import Run
from loomfmu.cosim.reading import checked_claims
from loomfmu.traces import Signals


def exact_dwell(tolerance: float) -> float:
    dobby = DobbyDrive(dwell_tolerance=tolerance)
    dobby.initialize(0.0)
    return dobby.dwell_angle


@pytest.mark.parametrize(("steps", "tolerance"), [(1440, 1e-9), (90, 1e-9), (45, 1e-8)])
def test_dwell_is_the_rotor_laws_own(looms: Looms, steps: int, tolerance: float) -> None:
    # off by 4e-16 rad at 1440 steps, 2.5e-11 at 90, 3e-10 at 45: the quintic's error falls as h^6
    found = judge(looms(steps), kind="dwell", heald="heald_1", at_least="80 deg")
    assert found
    assert abs(found.worst - exact_dwell(0.015)) < tolerance
    assert abs(found.worst - looms(steps)["dobby.dwell_angle"][-1]) < tolerance
    assert not judge(looms(steps), kind="dwell", heald="heald_1", at_least="86 deg")
    wider = judge(looms(steps), kind="dwell", heald="heald_2", at_least=0.0, tolerance="5 %")
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
    looms: Looms, values: dict[str, Any], heald: str, turns: int
) -> None:
    found = judge(looms(**values), kind="dwell", heald=heald, at_least=0.0)
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
    looms: Looms, values: dict[str, Any], at_least: float, word: str, note: str
) -> None:
    found = judge(looms(**values), kind="dwell", heald="heald_1", at_least=f"{at_least} deg")
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
        {"kind": "below", "signal": "abs(heald_1.lift - heald_2.lift)", "bound": "1 m"},
        {"kind": "below", "signal": "shaft.angle - heald_2.lift * 1 rad / 1 m", "bound": "100 rad"},
        {"kind": "above", "signal": "-1 * heald_1.lift", "bound": "-1 m", "at_samples": True},
    ],
)
def test_a_run_that_is_shorter_than_the_repeat_of_the_weave_shows_too_little(
    looms: Looms, claim: dict[str, Any]
) -> None:
    assert judge(looms(90, weave="1010/0101", revolutions=2), **claim)  # twice the same
    found = judge(looms(90, weave="1100/0110", revolutions=3), **claim)
    why = "the shaft turns by only 3 revolutions, and the weave repeats after 4; set revolutions = 4 or more"
    assert found.word == "undecided" and found.note.startswith(why) and math.isnan(found.worst)
    assert judge(looms(90, weave="1100/0110", revolutions=4), **claim)
    # what does not depend on the frames needs no more than a revolution
    assert judge(
        looms(90, weave="1100/0110", revolutions=1), kind="above", signal="weft.travel", bound="-1 mm"
    )


def test_a_run_that_begins_exactly_on_the_level_of_a_dwell(looms: Looms) -> None:
    # raised for one pick of three, from 30 deg before the slow point: 60 deg of dwell, or 420 deg lowered
    trace = looms(90, weave="100/010", revolutions=4, shaft__start_angle="150 deg")
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
    """The times at which `a.x` passes a level."""
    return Run(trace).passages(trace, "a.x", level)


def test_a_level_that_is_passed_twice_between_two_samples_is_passed_twice() -> None:
    # h (u - 3 u^2 + 2 u^3), which goes as far as h sqrt(3) / 18 to either side
    trace = curve(np.array([0.0, TURN]), lambda t: 0 * t, np.cos)
    for level in (0.5, -0.5):
        times = crossings(trace, level)
        assert len(times) == 2
        shares = np.roots([2.0, -3.0, 1.0, -level / TURN])
        assert np.allclose(np.sort(times), np.sort(TURN * shares[(shares > 0) & (shares < 1)]), rtol=1e-12)
    assert crossings(trace, 0.61) == []


def test_clear_shed_is_the_dwell_at_another_height(looms: Looms) -> None:
    # |warp| > 6 mm is a lift within 1/2 - 6 mm / (98 mm / 6) of the stroke from an end
    exact = exact_dwell(0.5 - 0.006 / (0.098 / 6))
    for steps in (1440, 90):
        claim = {"kind": "clear_shed", "heald": "heald_1", "clearance": "6 mm"}
        found = judge(looms(steps), **claim, at_least="120 deg")
        assert found
        assert abs(found.worst - exact) < 1e-9  # 1e-12 rad at 90 steps
        assert not judge(looms(steps), **claim, at_least="199 deg")
    with pytest.raises(LoomfmuError) as raised:
        judge(looms(), kind="clear_shed", heald="heald_1", clearance="9 mm", at_least=0.0)
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


def test_dwell_contains(looms: Looms) -> None:
    trace = looms()
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


def test_dwell_contains_needs_the_run_to_get_there(looms: Looms) -> None:
    trace = looms(90, revolutions=0.2)
    claim: dict[str, Any] = {"kind": "dwell_contains", "heald": "heald_1", "tolerance": 0.499}
    for angles in (["180 deg"], ["60 deg", "180 deg"]):
        found = judge(trace, **claim, angles=angles)
        assert (found.word, found.note) == ("undecided", "the run never reaches 180 deg")
    assert judge(looms(90, revolutions=0.2, weave="1/1"), **claim, angles=["60 deg"])


def test_peak_load(looms: Looms) -> None:
    trace = looms(**DAMPED)
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
    finer = judge(looms(5760, **DAMPED), kind="peak_load", damper="damper_1", at_most=worst)
    assert math.isclose(holds.angle, finer.angle, abs_tol=math.radians(0.25 / 20))


def test_stop_contacts(looms: Looms) -> None:
    trace = looms(**DAMPED)
    counted = trace["damper_1.stop_contacts"]
    assert counted[-1] >= 2
    holds = judge(trace, kind="stop_contacts", damper="damper_1", at_most=int(counted[-1]))
    fails = judge(trace, kind="stop_contacts", damper="damper_1", at_most=1)
    assert not fails
    assert fails.worst == counted[-1]
    assert holds and holds.time == fails.time
    place = int(np.flatnonzero(trace.time == fails.time)[0])
    assert counted[place - 1] < counted[place] == counted[-1]  # the last contact
