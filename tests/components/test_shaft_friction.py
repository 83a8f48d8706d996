"""DrivenShaft with friction and a motor by points: against an ODE solver, at rest, energy, mirrored."""

from itertools import pairwise
from math import pi

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from loomfmu.components import DrivenShaft

BOOKS = ("load_work", "motor_work", "kinetic_energy")
BOTH_WAYS = ("angle", "velocity", "acceleration", "motor_torque", "friction_torque")


def run(loads, step=0.02, **given):
    """The shaft after each step, its load on straight lines between those values."""
    shaft = DrivenShaft(**{"inputs_at_step_end": True, "torque_1": loads[0]} | given)
    assert shaft.initialize(0.0) == 0
    seen = []
    for n, load in enumerate(loads[1:]):
        shaft.torque_1 = load
        assert shaft.step(n * step, step) == 0
        seen.append({name: getattr(shaft, name) for name in (*BOOKS, *BOTH_WAYS)})
    return seen


def solved(loads, step, speed, slope, viscous, dry, inertia, at_speed):
    """Angle and velocity after each step, from stop to stop by a solver; at rest on a fine grid."""
    state, seen = [0.0, speed if at_speed else 0.0], []
    for first, last in pairwise(loads):
        time = 0.0

        def free(t, w, first=first, last=last):
            return slope * (speed - w) - viscous * w - first - (last - first) * t / step

        while time < step:
            if state[1] == 0.0:
                grid = np.linspace(time, step, 20001)
                moves = np.abs(free(grid, 0.0)) > dry
                if not moves.any():
                    break
                time = grid[moves.argmax()]
            sense = np.sign(state[1] or free(time, 0.0))

            def stop(t, y, sense=sense):
                return sense * y[1] + (1e-9 if t <= time + 1e-9 else 0.0)  # noqa: B023

            stop.terminal, stop.direction = True, -1

            def rates(t, y, sense=sense, free=free):
                return [y[1], (free(t, y[1]) - sense * dry) / inertia]

            found = solve_ivp(
                rates, (time, step), state, events=stop, rtol=1e-10, atol=1e-11, max_step=step / 8
            )
            time, state = found.t[-1], list(found.y[:, -1])
            if found.status == 1:
                state[1] = 0.0
        seen.append(list(state))
    return np.array(seen)


@pytest.mark.no_cover
@settings(max_examples=100, deadline=None)
@given(
    st.lists(st.floats(-150.0, 150.0), min_size=3, max_size=7),
    st.floats(-5.0, 5.0),
    st.floats(0.0, 40.0),
    st.floats(0.0, 5.0),
    st.floats(0.1, 80.0),
    st.booleans(),
)
# released within the step in which it stopped
@example([0.0, 52.0, -111.0], 0.0, 0.0, 0.0, 34.0, False)
def test_stops_and_releases_against_a_solver(loads, speed, slope, viscous, dry, at_speed):
    given = {"speed": speed, "torque_slope": slope, "viscous_friction": viscous, "dry_friction": dry}
    seen = run(loads, start_at_speed=at_speed, **given)
    exact = solved(loads, 0.02, speed, slope, viscous, dry, 2.0, at_speed)
    # the solver sees a release late by 1e-6 s at most, of a net torque that has risen by 0.02 N m since then
    assert np.array([(each["angle"], each["velocity"]) for each in seen]) == pytest.approx(exact, abs=2e-6)


@given(st.lists(st.floats(-150.0, 150.0), min_size=3, max_size=7), st.floats(0.0, 80.0), st.floats(0.0, 5.0))
def test_backwards_is_the_mirror_of_forwards(loads, dry, viscous):
    given = {"dry_friction": dry, "viscous_friction": viscous}
    forwards = run(loads, speed=3.0, **given)
    backwards = run([-each for each in loads], speed=-3.0, **given)
    for there, back in zip(forwards, backwards, strict=True):
        assert [there[name] for name in BOTH_WAYS] == [-back[name] for name in BOTH_WAYS]
        assert [there[name] for name in BOOKS] == [back[name] for name in BOOKS]


@given(st.lists(st.floats(-150.0, 150.0), min_size=3, max_size=7), st.floats(0.0, 80.0), st.floats(0.0, 5.0))
def test_friction_takes_work_and_the_books_balance(loads, dry, viscous):
    kept = run(loads, speed=3.0, dry_friction=dry, viscous_friction=viscous)
    for each in kept:
        gained = each["kinetic_energy"] - 9.0  # J w^2 / 2 at the start
        # roundings of sums of some hundred joules
        assert each["motor_work"] - each["load_work"] == pytest.approx(gained, abs=1e-10)
    idle = run([0.0] * 5, speed=3.0, dry_friction=dry, torque_slope=0.0)[-1]
    # nothing else brakes a coasting shaft
    assert idle["load_work"] == pytest.approx(dry * abs(idle["angle"]), rel=1e-12, abs=1e-12)


def test_friction_holds_a_shaft_at_rest_without_creep():
    loads = [30.0 * np.sin(0.1 * n) for n in range(200)]
    seen = run(loads, torque_slope=0.0, start_at_speed=False, dry_friction=30.0)
    assert {(each["angle"], each["velocity"], each["acceleration"]) for each in seen} == {(0.0, 0.0, 0.0)}
    assert seen[20]["friction_torque"] == -loads[21]


def test_a_coasting_shaft_stops_where_its_energy_is_used_up():
    last = run([0.0] * 300, torque_slope=0.0, speed=10.0 * pi, dry_friction=20.0)[-1]
    assert last["velocity"] == 0.0
    assert last["angle"] == pytest.approx((10.0 * pi) ** 2 / 20.0, rel=1e-13)  # J w^2 / 2 over R
    # viscous alone: J w / b in the end
    far = run([0.0] * 300, torque_slope=0.0, speed=10.0 * pi, viscous_friction=40.0)[-1]
    assert far["angle"] == pytest.approx(2.0 * 10.0 * pi / 40.0, rel=1e-13)
    assert far["load_work"] == pytest.approx((10.0 * pi) ** 2, rel=1e-12)


def test_a_turn_of_the_speed_far_from_rest_keeps_the_stated_work():
    shaft = DrivenShaft(inputs_at_step_end=True, use_work_1=True, torque_1=100.0, dry_friction=20.0)
    assert shaft.initialize(0.0) == 0
    shaft.torque_1, shaft.work_1 = -100.0, 1.0  # slower first, then faster again
    assert shaft.step(0.0, 0.01) == 0
    assert shaft.load_work - shaft.other_work == pytest.approx(1.0, rel=1e-12)  # roundings of some 40 J


# an induction motor: from rest over pull-up and breakdown to its no-load speed, and as a brake beyond it
INDUCTION = {
    "speed": 44.0,
    "torque_slope": 0.0,
    "motor_points": 5,
    "inertia": 2.0,
} | {
    f"point_{what}_{number}": value
    for number, row in enumerate([(0.0, 90.0), (10.0, 70.0), (36.0, 160.0), (40.0, 120.0), (44.0, 0.0)], 1)
    for what, value in zip(("speed", "torque"), row, strict=True)
}


@pytest.mark.parametrize(("steps", "dry", "viscous"), [(9, 0.0, 0.0), (40, 8.0, 0.2), (333, 0.0, 1.0)])
def test_a_start_over_the_breakdown_torque_against_a_solver(steps, dry, viscous):
    # whatever the step: load on a straight line, from light to what pulls the motor back below its breakdown
    step = 4.5 / steps
    ramp = [5.0 + 40.0 * n * step for n in range(steps + 1)]
    speeds, torques = ([INDUCTION[f"point_{what}_{n}"] for n in range(1, 6)] for what in ("speed", "torque"))
    seen = run(ramp, step, start_at_speed=False, dry_friction=dry, viscous_friction=viscous, **INDUCTION)

    def rates(t, y):
        motor = np.interp(y[1], speeds, torques)
        if y[1] > 44.0:
            motor = -30.0 * (y[1] - 44.0)
        rubbed = viscous * y[1] + dry
        return [y[1], (motor - rubbed - 5.0 - 40.0 * t) / 2.0, motor * y[1], rubbed * y[1]]

    times = step * np.arange(1, steps + 1)

    def stop(t, y):
        return y[1] if t > 0.1 else 1.0

    stop.terminal = True
    exact = solve_ivp(
        rates, (0.0, 4.5), [0.0] * 4, "DOP853", times, events=stop, rtol=1e-9, atol=1e-9, max_step=0.01
    ).y.T
    shown = np.array([(s["angle"], s["velocity"], s["motor_work"]) for s in seen])
    assert 36.0 < max(shown[:, 1]) < 44.0
    # the solver's tolerance and its steps over the points
    assert shown[: len(exact)] == pytest.approx(exact[:, :3], rel=1e-6, abs=1e-5)
    balance = [s["motor_work"] - s["load_work"] - s["kinetic_energy"] for s in seen]
    assert balance == pytest.approx([0.0] * steps, abs=1e-9)  # roundings of some thousand joules


def test_steps_of_any_length_pass_the_points_alike():
    whole = run([30.0] * 2, 1.5, start_at_speed=False, viscous_friction=1.0, **INDUCTION)[-1]
    pieces = run([30.0] * 1001, 1.5e-3, start_at_speed=False, viscous_friction=1.0, **INDUCTION)[-1]
    for name, value in whole.items():
        assert value == pytest.approx(pieces[name], rel=1e-10, abs=1e-8), name  # a thousand sums


def test_a_motor_by_points_backwards_is_the_mirror_of_forwards():
    loads = [30.0, 60.0, 250.0, 150.0, 0.0, -80.0]
    forwards = run(loads, 0.1, dry_friction=15.0, **INDUCTION)
    backwards = run([-each for each in loads], 0.1, dry_friction=15.0, **INDUCTION | {"speed": -44.0})
    for there, back in zip(forwards, backwards, strict=True):
        assert [there[name] for name in BOTH_WAYS] == [-back[name] for name in BOTH_WAYS]
        assert [there[name] for name in BOOKS] == [back[name] for name in BOOKS]


def test_two_points_on_the_line_are_the_line():
    loads = [0.0, 50.0, 120.0, -30.0]
    given = {"motor_points": 2, "point_speed_2": 40.0, "point_torque_1": 1600.0}
    for points, line in zip(run(loads, speed=40.0, **given), run(loads, speed=40.0), strict=True):
        assert points == pytest.approx(line, rel=1e-13, abs=1e-11)


@pytest.mark.parametrize("given", [{"motor_points": 1}, {"motor_points": 3, "point_speed_2": 5.0}])
def test_points_that_do_not_rise_are_refused(given):
    assert DrivenShaft(**given).initialize(0.0) == 1
