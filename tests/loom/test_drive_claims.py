"""Claims on the drive: motor power, speed fluctuation, energy; `test_driven_loom` has more of the last."""

import pickle

import numpy as np
import pytest
from scene_texts import LOOM, claim, parsed, verdicts

import loomfmu
from loomfmu import judge

STARTING = 'component = "DrivenShaft"\nstart_at_speed = false\n'
POWER = claim("motor_power", at_most="17.55 kW")


def claims(shaft=STARTING, skip=1, inputs="", **given):
    """Power and fluctuation of a motor, by default from rest."""
    fluctuation = claim("speed_fluctuation", at_most="5 %", skip=skip)
    usual = {"revolutions": 3, "steps_per_revolution": 180, "coupling": "iterated"}
    return loomfmu.evaluate(parsed(LOOM, "[shaft]\n", shaft, POWER, fluctuation, inputs, **usual | given))


def test_the_motors_peak_lies_at_half_its_speed():
    power, _fluctuation = claims().claims
    # the parabola k (w0 - w) w of the torque line: k w0^2 / 4, passed on the way up
    assert power.holds
    assert power.worst == pytest.approx(40.0 * (400.0 * np.pi / 30.0) ** 2 / 4.0, rel=1e-6)  # quintic
    assert (power.label, power.bound) == ("kW", 17550.0)


def test_fluctuation_is_judged_in_each_revolution_after_those_that_are_skipped():
    found = claims()
    trace = found.trace
    turns = (trace["shaft.angle"] - trace["shaft.angle"][0]) / (2.0 * np.pi)
    second = (turns >= 1.0) & (turns <= 2.0)  # the last one is not whole: the shaft has started from rest
    speed = trace["shaft.velocity"][second]
    mean = 2.0 * np.pi / np.ptp(np.interp([1.0, 2.0], turns, trace.time))
    # samples 2 deg apart miss the extremes by 1e-3 of the swing
    assert found.claims[1].worst == pytest.approx(np.ptp(speed) / mean, rel=5e-3)
    assert found.claims[1].holds == (found.claims[1].worst <= 0.05)


def test_the_error_of_a_fluctuation_includes_what_its_curve_may_be_off_by():
    """A ripple of 11 steps: its samples stand at the same places of each wave, in coarser runs, too."""
    ripple = {"shaft__ripple_amplitude": 0.1, "shaft__ripple_order": 5}
    start = {"shaft__speed": "600 rev/min", "shaft__start_angle": "269.2463868230665 deg"}
    text = claim("speed_fluctuation", at_most=0.199995)
    (found,) = verdicts(text, revolutions=1, steps_per_revolution=55, **ripple, **start)
    assert found.word == "undecided" and found.error > 0.2 - found.worst > 0.0  # twice the amplitude


def test_an_unfinished_revolution_counts_by_what_the_run_shows_of_it():
    """A driven shaft turns by less than the nominal revolutions: a load in the last one was never judged."""
    text = 'component = "DrivenShaft"\n'
    load = '[inputs]\n"shaft.torque_32" = [[0, 0], [1.3, 0], [1.4, 800], [1.5, 0]]\n'
    loaded, whole = (claims(text, 0, load, revolutions=each).claims[1] for each in (1.9, 2.5))
    assert (loaded.word, whole.word) == ("FAILS", "FAILS")
    # over the highest speed, not over the mean that the whole revolution will have: never too much
    assert loaded.revolution == 2 and 0.9 * whole.worst < loaded.worst < whole.worst


def test_a_run_without_a_whole_revolution_is_not_judged():
    found = claims(revolutions=0.5).claims[1]
    assert not found.holds
    assert found.note == "the run has no whole revolution to judge"


def test_a_skip_that_leaves_no_revolution_is_named():
    found = claims('component = "DrivenShaft"\n', 5).claims[1]
    assert found.word == "undecided"
    assert found.note.startswith("skip = 5 leaves none of the whole revolutions of the run: it has ")
    assert found.note.endswith(" and needs 6; raise revolutions")


def energy(steps=360, fittings="", shaft=""):
    keys = f'weave = "10/01"\nreed = true\n{fittings}\n[shaft]\ncomponent = "DrivenShaft"\n'
    times = {"revolutions": 1, "steps_per_revolution": steps, "coupling": "iterated"}
    return loomfmu.evaluate(parsed(LOOM, keys, shaft, "\n", claim("energy_balance"), **times))


def altered(trace, signal, factor):
    """A run in which one signal is another multiple: as a mechanism with a wrong torque would show it."""
    copied = pickle.loads(pickle.dumps(trace))
    copied[signal][:] *= factor
    return copied


# the larger the steps, the less of the work of a torque its samples show
@pytest.mark.parametrize(
    ("fittings", "steps", "share"),
    [("", 90, 0.05), ("", 360, 1e-3), ("", 1440, 2e-4), ("dampers = true\nwarps = true", 360, 1e-3)],
)
def test_a_torque_that_does_not_do_the_work_that_is_stated_fails(fittings, steps, share):
    trace = energy(steps, fittings).trace
    assert judge(trace, kind="energy_balance")
    torques = [signal for signal in trace if signal.endswith(".shaft_torque")]
    assert len(torques) == 5
    for signal in torques:
        for factor in (1.0 + share, 1.0 - share, -1.0, 0.0):
            verdict = judge(altered(trace, signal, factor), kind="energy_balance")
            assert not verdict, (signal, factor)
            assert verdict.signal == signal
            assert f"J off {signal.replace('torque', 'work')}; the steps explain" in verdict.note
    # work and torque wrong alike: the shaft has not exchanged that
    assert not judge(altered(trace, "weft.shaft_work", 1.001), kind="energy_balance")


@pytest.mark.parametrize("shaft", ['[wires]\n"shaft.work_1" = false\n', "use_work_1 = false"])
def test_a_load_whose_work_does_not_count_is_integrated_from_its_torque(shaft):
    found = energy(shaft=shaft)
    (balance,) = found.claims
    assert balance.holds
    assert balance.worst < 1e-10  # what two ends of the loop differ by
    assert balance.note == "work by the torque alone, of second order in the step: weft.shaft_torque"
    assert found.trace["shaft.other_work"][-1] != 0.0


def test_a_torque_that_is_passed_on_is_integrated_from_it():
    (balance,) = energy(fittings="dampers = true", shaft='[wires]\n"heald_2.load_work" = false\n').claims
    assert balance.holds
    assert balance.note == "work by the torque alone, of second order in the step: heald_2.passed_torque"


def test_a_trace_that_does_not_have_its_wires_is_judged_as_one_with_all():
    trace = energy().trace
    whole = judge(trace, kind="energy_balance")
    assert trace.wires["shaft.work_1"] == "weft.shaft_work"
    trace.wires = {}
    assert judge(trace, kind="energy_balance") == whole


def test_a_work_that_the_shaft_counts_but_that_is_not_wired_fails():
    trace = energy().trace
    trace.wires = {sink: source for sink, source in trace.wires.items() if sink != "shaft.work_1"}
    verdict = judge(trace, kind="energy_balance")
    assert not verdict
    assert verdict.note == "shaft.use_work_1 = true, but shaft.work_1 is not wired"


def test_a_start_from_rest_that_fails_names_its_steps():
    from_rest = 'start_at_speed = false\nspeed = "300 rev/min"'
    (coarse,), (fine,) = (energy(steps, shaft=from_rest).claims for steps in (90, 1440))
    assert not coarse
    assert coarse.note == "the steps may be too coarse for the start from rest: take more"
    assert fine
    assert fine.note == ""


@pytest.mark.parametrize(
    ("law", "note"),
    [
        ("uniform", "take more steps: the gap shrinks if the torque is right"),
        ("spline_cam", "the velocity of a spline_cam jumps: its impulse is in the work, but in no torque"),
    ],
)
def test_a_gap_between_torque_and_work_names_what_may_cause_it(law, note):
    trace = energy(fittings='[dobby]\nlaw = "' + law + '"').trace
    verdict = judge(altered(trace, "heald_2.shaft_torque", 0.5), kind="energy_balance")
    assert not verdict
    assert verdict.note.endswith(f"; {note}")
