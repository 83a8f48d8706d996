"""Claims on belt, rapier, reed, locks and roller: where they hold, fail, or samples do not tell."""

import math
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from claimed import DEMO, Looms, judged
from scene_texts import claim, parsed, table, verdicts, wires
from scipy.optimize import brentq

from loomfmu import Verdict, evaluate, judge
from loomfmu.design import loom as loom_figures
from loomfmu.physics.heald import lift_fraction
from loomfmu.physics.rotor_laws.rotor import SLOPED_SINE, rotor_law

FAR_APART = "the samples are too far apart to be sure; take more steps"


def test_lowest_margin(looms: Looms) -> None:
    trace = looms(shaft__speed="600 rpm")
    holds = judge(trace, kind="lowest_margin", bound=0.1)
    assert holds
    assert holds.worst == trace["belt.lowest_margin"][-1]
    assert not judge(trace, kind="lowest_margin", bound="23 %")
    # it is the continuous curve's: not above any sample, and next to the place that it names
    assert holds.worst <= trace["belt.margin"].min()
    place = int(np.argmin(np.abs(trace.time - holds.time)))
    assert math.isclose(trace["belt.margin"][place], holds.worst, abs_tol=1e-3)
    coarse = judge(looms(90, shaft__speed="600 rpm"), kind="lowest_margin", bound=0.1)
    assert abs(coarse.worst - holds.worst) < 1e-5  # the quintic between samples 4 degrees apart


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


@pytest.mark.parametrize("steps", [1, 2, 3, 4, 6, 8, 12, 16, 19])
def test_no_claim_holds_on_samples_that_may_miss_the_belts_window_of_risk(steps: int) -> None:
    """At 700 rev/min the belt buckles; its window of risk lies between any 6 samples in a revolution."""
    found = evaluate(DEMO, set={"shaft.speed": "700 rpm", "steps_per_revolution": steps})
    assert found.claims[0].worst < 0.0 > found.claims[1].distance  # by the mechanisms' own functions
    assert all(FAR_APART in claim.note for claim in found.claims[2:])
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
