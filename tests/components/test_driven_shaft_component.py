"""DrivenShaft: exact under held and rising loads, energy, steps of any size, the masses that it drives."""

import random
from itertools import pairwise
from math import cos, exp, sin

import mpmath
import numpy as np
import pytest
from driving import values
from looms import RPM

from loomfmu.components import COMPONENTS, DrivenShaft
from loomfmu.cosim.importing.facts import facts_of
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.wiring import gathered
from loomfmu.declaring.variables import variables_of
from loomfmu.errors import LoomfmuError
from loomfmu.physics.driven_shaft import driven_motion, response

MP = mpmath.mp.clone()
MP.dps = 120
FULL = DrivenShaft().speed
TORQUES = DrivenShaft.torque.names
EVEN = ("motor_power", "motor_power_rate", "motor_work", "load_work", "other_work", "kinetic_energy")


def started(load=0.0, **given):
    shaft = DrivenShaft(torque_1=load, **given)
    assert shaft.initialize(0.0) == 0
    return shaft


def run(shaft, sizes, load=None):
    """Steps of those sizes; `load` is a function of time, read where the shaft takes its inputs."""
    time = 0.0
    for size in sizes:
        if load is not None:
            shaft.torque_1 = load(time + size if shaft.inputs_at_step_end else time)
        assert shaft.step(time, size) == 0
        time += size
    return shaft


def under(load, time, shaft, rate=0.0):
    """Velocity and angle under `load + rate t` from the start at time 0, in 120 digits."""
    k, j, w0 = MP.mpf(shaft.torque_slope), MP.mpf(shaft.inertia), MP.mpf(shaft.speed)
    t, s = MP.mpf(time), MP.mpf(rate)
    w = w0 if shaft.start_at_speed else MP.mpf(0)
    if k == 0:
        return w - (load * t + s * t**2 / 2) / j, shaft.start_angle + w * t - (
            load * t**2 / 2 + s * t**3 / 6
        ) / j
    settled = w0 - (load - s * j / k) / k  # where it ends under a rising load, at t = 0
    faded = 1 - MP.exp(-k * t / j)
    return (
        settled - s * t / k + (w - settled) * (1 - faded),
        shaft.start_angle + settled * t - s * t**2 / (2 * k) + (w - settled) * faded * j / k,
    )


def drawn_sizes(seed, count=100):
    rng = random.Random(seed)
    return [10.0 ** rng.uniform(-6.0, -1.0) for _ in range(count)]


# Exact solutions


@pytest.mark.parametrize("at_speed", [False, True])
@pytest.mark.parametrize("slope", [0.0, 1e-9, 40.0, 1e9])
def test_torque_on_a_straight_line(slope, at_speed):
    shaft = started(
        10.0, torque_slope=slope, inputs_at_step_end=True, start_at_speed=at_speed, start_angle=0.7
    )
    sizes = drawn_sizes(2)
    run(shaft, sizes, lambda t: 10.0 + 300.0 * t)
    time = sum(map(MP.mpf, sizes))
    velocity, angle = under(MP.mpf(10), time, shaft, rate=300)
    # each step is rounded: by 1e-16 of what it adds, and the sums of a hundred by nothing more
    assert shaft.velocity == pytest.approx(float(velocity), rel=1e-14)
    assert shaft.angle == pytest.approx(float(angle), rel=1e-14)
    # what the motor gives, 40 N m s/rad times a velocity rounded to 1e-14, less the load; for the stiff
    # one the load is in balance but for J / k of its rate
    net = slope * (MP.mpf(shaft.speed) - velocity) - (10 + 300 * time)
    assert shaft.acceleration == pytest.approx(float(net / 2), abs=1e-12 if slope < 1e9 else 1e-5)


def test_without_load_it_keeps_its_speed_to_the_bit():
    shaft = started()
    run(shaft, drawn_sizes(3, 1000))
    assert (shaft.velocity, shaft.acceleration, shaft.motor_torque) == (FULL, 0.0, 0.0)
    # a thousand products are rounded to 1e-16 of themselves, and their sum once
    assert shaft.angle == pytest.approx(float(FULL * sum(map(MP.mpf, drawn_sizes(3, 1000)))), rel=3e-16)


# Steps of any size


@pytest.mark.few(24)
@pytest.mark.parametrize("at_end", [False, True])
@pytest.mark.parametrize("size", [10.0**n for n in range(-9, 4)])
@pytest.mark.parametrize(("slope", "inertia"), [(40.0, 2.0), (0.0, 2.0), (1e9, 1e-6), (1e-6, 1e6)])
def test_stable_and_exact_at_every_step_size(slope, inertia, size, at_end):
    shaft = started(7.0, torque_slope=slope, inertia=inertia, start_at_speed=False, inputs_at_step_end=at_end)
    run(shaft, [size] * 100)
    velocity, angle = under(MP.mpf(7), 100 * MP.mpf(size), shaft)
    # the sums hold what rounding leaves over, so a hundred steps err by no more than some of them
    assert shaft.velocity == pytest.approx(float(velocity), rel=3e-15, abs=1e-25)
    assert shaft.angle == pytest.approx(float(angle), rel=3e-15, abs=1e-30)
    # no more than the first step had, but for a rounding of the motor's torque
    assert abs(shaft.acceleration) <= (slope * FULL + 7.0) / inertia * (1.0 + 1e-14)


@pytest.mark.no_cover
def test_nothing_is_lost_in_steps_that_are_too_small_to_be_seen():
    # 1e-6 N m take 5e-16 rad/s in 1 ns, of 42 rad/s: a plain sum rounds each of them away
    shaft = started(1e-6)
    run(shaft, [1e-9] * 20000)
    velocity, angle = under(MP.mpf(1e-6), 20000 * MP.mpf(1e-9), shaft)
    assert shaft.velocity == pytest.approx(float(velocity), rel=2.3e-16)  # the last digit
    assert shaft.angle == pytest.approx(float(angle), rel=3e-16)
    gained, *_means = driven_motion(FULL, -1e-6, 0.0, 0.0, response(1e-9, 2.0, 40.0))
    assert FULL + gained == FULL != shaft.velocity


@pytest.mark.parametrize(("at_end", "order"), [(False, 1), (True, 2)])
def test_order_for_a_load_that_is_not_straight(at_end, order):
    swing, frequency, end = 80.0, 84.0, 0.3
    # J y' + k y = -swing sin(w t), y = velocity - speed, from y = 0
    gain = -swing / complex(40.0, 2.0 * frequency)
    exact = (
        FULL
        + (gain * complex(cos(frequency * end), sin(frequency * end))).imag
        - gain.imag * exp(-20.0 * end)
    )
    errors = []
    for steps in (256, 512, 1024, 2048):
        shaft = started(inputs_at_step_end=at_end)
        run(shaft, [end / steps] * steps, lambda t: swing * sin(frequency * t))
        errors.append(abs(shaft.velocity - exact))
    for coarse, fine in pairwise(errors):
        assert coarse / fine == pytest.approx(2.0**order, rel=0.1)  # the next order, of w h = 0.1 and less
    # the chord of a sine lies (w h)^2 / 12 of the swing off it on average; its response is gain
    step = frequency * end / 2048
    assert errors[-1] < abs(gain) * (step * step / 12.0 if at_end else step)


# Torques and energy


def test_energy_is_balanced():
    # a load that jumps, rises and falls, the motor from rest: its work is in the masses or in the load
    shaft = started(start_at_speed=False, inputs_at_step_end=True)
    rng = random.Random(4)
    motor_work = load_work = 0.0
    for n in range(40):
        shaft.torque_1, before = rng.uniform(-50.0, 200.0), shaft.torque_1
        end = shaft.torque_1
        powers = [(shaft.motor_torque * shaft.velocity, before * shaft.velocity)]
        for part in range(1, 9):
            shaft.torque_1 = before + (end - before) * part / 8
            shaft.step(0.0, 0.01 / 8)
            powers.append((shaft.motor_torque * shaft.velocity, shaft.load_torque * shaft.velocity))
        weights = np.array([989, 5888, -928, 10496, -4540, 10496, -928, 5888, 989]) / 28350  # Newton, Cotes
        motor, load = 0.01 * weights @ np.array(powers)
        motor_work, load_work = motor_work + motor, load_work + load
        kinetic = 0.5 * shaft.inertia * shaft.velocity**2
        # the weights are exact to z^10 / 1e10, z = 0.2; rounding of works up to 5 kJ in 40 steps
        assert motor_work - load_work == pytest.approx(kinetic, abs=1e-10), n
        books = (shaft.motor_work, shaft.load_work, shaft.other_work, shaft.kinetic_energy)
        assert books == pytest.approx((motor_work, load_work, load_work, kinetic), abs=1e-10)
    assert motor_work > 1e3


def test_all_torques_count_alike_and_every_output_feels_them():
    outputs = [v.name for v in variables_of(DrivenShaft) if v.causality == "output"]
    for at_end in (False, True):
        undisturbed = run(started(inputs_at_step_end=at_end, viscous_friction=1.0), [1e-3])
        found = []
        for name in TORQUES:
            shaft = started(inputs_at_step_end=at_end, viscous_friction=1.0)
            setattr(shaft, name, 10.0)
            shaft.step(0.0, 1e-3)
            found.append(values(shaft, "output"))
        assert all(each == found[0] for each in found)
        assert all(found[0][name] != getattr(undisturbed, name) for name in outputs)
    shaft = DrivenShaft(torque_1=1.0, torque_2=2.0, torque_3=4.0, torque_4=8.0)
    shaft.initialize(0.0)
    assert (shaft.load_torque, shaft.acceleration) == (15.0, -7.5)


def test_a_jump_of_the_load_turns_up_in_the_acceleration_alone():
    shaft = run(started(20.0, inputs_at_step_end=True), [0.01] * 10)
    before = values(shaft)
    shaft.torque_1 = 120.0
    shaft.step(0.1, 0.0)
    after = values(shaft)
    changed = {name for name in before if after[name] != before[name]}
    assert changed == {"torque_1", "load_torque", "acceleration", "motor_power_rate"}
    assert after["acceleration"] == pytest.approx(before["acceleration"] - 50.0, abs=1e-13)  # rounding
    # and the next step begins from the load after the jump
    shaft.step(0.1, 1e-3)
    assert shaft.velocity - before["velocity"] == pytest.approx(
        before["acceleration"] * 1e-3 - 50.0 * (1.0 - exp(-0.02)) / 20.0, rel=1e-2
    )


# In a scene


MECHANISMS = {
    "shaft": facts_of(DrivenShaft),
    "weft": facts_of(COMPONENTS["WeftInsertion"]),
    "belt": facts_of(COMPONENTS["BeltMonitor"]),
    "heald_1": facts_of(COMPONENTS["HealdFrame"]),
    "reed": facts_of(COMPONENTS["ReedBeatUp"]),
}


def test_every_mechanism_with_a_torque_has_the_next_free_place():
    assert gathered("shaft", MECHANISMS, {}) == {
        "shaft.torque_1": "weft.shaft_torque",
        "shaft.work_1": "weft.shaft_work",
        "shaft.torque_2": "heald_1.shaft_torque",
        "shaft.work_2": "heald_1.shaft_work",
        "shaft.passed_torque_2": "heald_1.passed_torque",
        "shaft.torque_3": "reed.shaft_torque",
        "shaft.work_3": "reed.shaft_work",
        "shaft.passed_torque_3": "reed.passed_torque",
    }
    assert gathered("reed", MECHANISMS, {}) == {}


def test_a_place_that_is_taken_is_passed_over_and_a_torque_counts_once():
    given = {"shaft.torque_1": 60.0, "shaft.torque_2": "reed.shaft_torque"}
    found = gathered("shaft", MECHANISMS, given)
    assert set(found) == {
        *(f"shaft.{n}" for n in ("torque_3", "work_3", "torque_4", "work_4", "passed_torque_4"))
    }


def test_where_the_wire_of_a_torque_is_cut_its_work_does_not_count():
    found = gathered("shaft", MECHANISMS, {"shaft.torque_1": False})
    assert found["shaft.torque_1"] == "weft.shaft_torque"  # for the scene to cut
    assert "shaft.work_1" not in found


def test_more_mechanisms_than_places_are_refused():
    frames = {f"heald_{n}": facts_of(COMPONENTS["HealdFrame"]) for n in range(1, 34)}
    with pytest.raises(
        LoomfmuError, match="has free inputs for 32 mechanisms, but 33 have an output shaft_t"
    ):
        gathered("shaft", {"shaft": facts_of(DrivenShaft)} | frames, {})


def test_a_scene_takes_it_for_its_shaft():
    text = (
        'revolutions = 1\n[loom]\nweave = "10"\nreed = true\n[shaft]\ncomponent = "DrivenShaft"\n'
        'speed = "300 rpm"\ninertia = "1.5 kg.m2"\ntorque_slope = "30 N.m.s/rad"\ntorque_4 = "25 N.m"\n'
    )
    scene = scenes.parse(text)
    shaft = scene.instances["shaft"]
    assert shaft.fmu.name == "DrivenShaft"
    wanted = {"inertia": 1.5, "torque_slope": 30.0, "torque_4": 25.0, "inputs_at_step_end": True}
    wanted |= {f"use_work_{n}": True for n in (1, 2, 3, 5)}
    assert shaft.values == wanted | {"speed": pytest.approx(300 * RPM, rel=1e-15)}
    wires = {str(wire) for wire in scene.wires}
    assert "weft.shaft_torque -> shaft.torque_1" in wires
    assert "dobby.shaft_torque -> shaft.torque_2" in wires
    assert "heald_1.shaft_work -> shaft.work_3" in wires
    assert "reed.shaft_torque -> shaft.torque_5" in wires
    assert "shaft.acceleration -> weft.shaft_acceleration" in wires
    # 1 revolution of 0.2 s: the time of a scene is that of the nominal speed
    assert scene.steps * scene.step_size == pytest.approx(0.2, rel=1e-15)
