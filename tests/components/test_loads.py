"""Torques on the shaft and energies of the mechanisms: what one takes, the other holds."""

import random
from math import cos, pi, sin

import pytest
from driving import declared, flags, values
from hypothesis import given
from hypothesis import strategies as st

from loomfmu.components import (
    COMPONENTS,
    DetachingRoller,
    DobbyDrive,
    HealdDamper,
    HealdFrame,
    ReedBeatUp,
    WarpTension,
    WeftInsertion,
)

ANGLES = st.floats(-50.0, 50.0)
SPEEDS = st.floats(-100.0, 100.0)
ACCELERATIONS = st.floats(-2000.0, 2000.0)
SHAFT = {"follow_shaft": True, "inputs_at_step_end": True}
FRAME = {"stroke": 0.12, "frame_mass": 17.0, "gravity": 9.81, "inputs_at_step_end": True}


def on_shaft(component, theta, speed, acceleration):
    component.shaft_angle, component.shaft_velocity, component.shaft_acceleration = theta, speed, acceleration
    assert component.initialize(0.0) == 0
    return component


def driven(dobby, frame):
    """The frame behind the dobby."""
    for name in (*frame.terminals[0].variables, "rotor_ratio", "lift_slope"):
        setattr(frame, name, getattr(dobby, name))
    assert frame.initialize(0.0) == 0
    return frame


def balanced(taken, *stored):
    """The power taken from the shaft is the sum of those stored, dissipated and handed on, to rounding."""
    # a few products and sums of numbers of this size, and of the smallest there are
    size = abs(taken) + sum(abs(each) for each in stored)
    assert abs(taken - sum(stored)) <= 1e-14 * size + 1e-300


# The law of energy, d(kinetic + potential)/dt + dissipation = shaft_torque w + what the load brings


@given(ANGLES, SPEEDS, ACCELERATIONS, st.floats(-500.0, 500.0), st.sampled_from((4, 7)))
def test_frame_takes_from_the_shaft_what_it_stores_and_hands_on(theta, speed, acceleration, load, law):
    dobby = on_shaft(DobbyDrive(law=law, **SHAFT), theta, speed, acceleration)
    frame = driven(dobby, HealdFrame(load=load, follow_lift=law == 7, **FRAME))
    # terms that cancel where the frame's turns are counted off: rounding of angles up to 50 rad
    slack = 1e-12 * (17.0 * (abs(frame.acceleration) + 9.81) + abs(load)) * 0.12 * (abs(speed) + 1.0)
    stored = 17.0 * (frame.acceleration + 9.81) * frame.velocity
    assert frame.shaft_torque * speed == pytest.approx(stored - load * frame.velocity, abs=slack)
    assert frame.rotor_torque * dobby.rotor_velocity == pytest.approx(frame.shaft_torque * speed, abs=slack)
    assert frame.kinetic_energy == 0.5 * 17.0 * frame.velocity * frame.velocity
    assert frame.potential_energy == pytest.approx(17.0 * 9.81 * frame.lift, rel=1e-15)


@given(ANGLES, SPEEDS, ACCELERATIONS, st.sampled_from((1, 2, 3, 4, 5, 6, 7, 9)))  # 8 needs a table
def test_rotor_takes_from_the_shaft_what_it_stores(theta, speed, acceleration, law):
    dobby = on_shaft(DobbyDrive(law=law, rotor_inertia=0.3, **SHAFT), theta, speed, acceleration)
    velocity, second = dobby.rotor_velocity, dobby.rotor_acceleration
    if law == 7:  # the cam's shaft turns once in two picks
        velocity, second = 0.5 * speed, 0.5 * acceleration
    balanced(dobby.shaft_torque * speed, 0.3 * velocity * second)
    assert dobby.kinetic_energy == 0.5 * 0.3 * velocity * velocity
    assert dobby.rotor_torque == 0.3 * second
    assert dobby.rotor_ratio * speed == dobby.rotor_velocity
    # angles up to 50 rad are rounded to 4e-15
    assert dobby.lift_slope * speed == pytest.approx(dobby.lift_rate, abs=1e-14 * abs(speed))


@given(ANGLES, SPEEDS, ACCELERATIONS)
def test_weft_drive_takes_from_the_shaft_what_it_stores(theta, speed, acceleration):
    given_ = {"belt_mass": 0.05, "belt_length": 3.0, "wheel_inertia": 0.03}
    weft = on_shaft(WeftInsertion(**SHAFT, **given_), theta, speed, acceleration)
    mass = 0.1105 + 0.15 + 0.03 / 0.1985**2
    balanced(weft.shaft_torque * speed, mass * weft.velocity * weft.acceleration)
    assert weft.kinetic_energy == pytest.approx(0.5 * mass * weft.velocity**2, rel=1e-14)


@given(ANGLES, SPEEDS, ACCELERATIONS, st.booleans())
def test_reed_takes_from_its_crank_what_it_stores(theta, speed, acceleration, servo):
    reed = on_shaft(ReedBeatUp(reed_mass=40.0, servo=servo, **SHAFT), theta, speed, acceleration)
    balanced(reed.crank_torque * reed.crank_velocity, 40.0 * reed.velocity * reed.acceleration)
    assert reed.kinetic_energy == 0.5 * 40.0 * reed.velocity * reed.velocity
    assert reed.shaft_torque == (0.0 if servo else reed.crank_torque)


@given(ANGLES, SPEEDS, ACCELERATIONS, st.booleans(), st.floats(-3.0, 3.0))
def test_rollers_take_from_the_shaft_what_they_store_and_draft(theta, speed, acceleration, own, ratio):
    roller = DetachingRoller(use_table=own, roller_ratio=ratio, acceleration=4000.0, **SHAFT)
    on_shaft(roller, theta, speed, acceleration)
    inertia = 2.0 * 8.0 * (135.64e-6 + 33.98e-6 * (12.5 / 12.25) ** 2)
    balanced(
        roller.shaft_torque * speed,
        inertia * roller.roller_velocity * roller.roller_acceleration,
        8.0 * roller.drafting_force * 12.5e-3 * roller.roller_velocity,
    )
    assert roller.dissipated_power == pytest.approx(8.0 * roller.drafting_torque * roller.roller_velocity)
    assert roller.kinetic_energy == pytest.approx(0.5 * inertia * roller.roller_velocity**2, rel=1e-14)


@pytest.mark.parametrize(
    ("component", "given"), [(each, given) for each in COMPONENTS.values() for given in flags(each)]
)
def test_torque_on_the_shaft_is_what_the_energies_ask_for(component, given):
    """`d(kinetic + potential)/dt + dissipated power = shaft_torque w`, by differences along a motion."""
    names = {variable.name for variable in declared(component)}
    if not {"shaft_torque", "kinetic_energy", "shaft_angle"} <= names or given.get("servo"):
        return  # what a servo drives takes nothing from the shaft
    if given.get("use_table") is False:
        return  # its motion comes from elsewhere
    rng = random.Random(7)
    instance = component(**given | {"follow_shaft": True, "inputs_at_step_end": True})
    step = 1e-5
    for _ in range(40):
        angle, speed = rng.uniform(-20.0, 20.0), rng.uniform(-60.0, 60.0)
        acceleration = rng.uniform(-2e3, 2e3)
        energies = []
        for k in (-2, -1, 1, 2, 0):  # the last sample is the one in the middle
            time = k * step
            instance.shaft_angle = angle + speed * time + 0.5 * acceleration * time * time
            instance.shaft_velocity = speed + acceleration * time
            instance.shaft_acceleration = acceleration
            assert instance.initialize(0.0) == 0
            energies.append(instance.kinetic_energy + getattr(instance, "potential_energy", 0.0))
        before, last, first, after, _here = energies
        stored = (8.0 * (first - last) - (after - before)) / (12.0 * step)
        power = instance.shaft_torque * instance.shaft_velocity - getattr(instance, "dissipated_power", 0.0)
        # over 20 us the energies, up to 1e4 J, are rounded to 1e-12 J; the fourth power of the step is less
        assert stored == pytest.approx(power, rel=1e-6, abs=1e-4 * max(energies))


# The same against the energy alone, differentiated with 50 digits


# Carrier and warp, along a motion of their frame


def swung(component, step, steps):
    """Frame at 20 rad/s through the component's time, with all its variables at each sample."""
    time, rows = 0.0, []
    for k in range(steps + 1):
        component.lift = 0.049 * (1.0 - cos(20.0 * k * step))
        component.velocity = 0.98 * sin(20.0 * k * step)
        component.acceleration = 19.6 * cos(20.0 * k * step)
        assert (component.step(time, step) if k else component.initialize(0.0)) == 0
        time = k * step
        rows.append(values(component))
    return rows


def residual(rows, step, stored, power, changes="contact"):
    """Energy gained over two steps, less the power by Simpson's rule; over the largest energy.

    Steps in which a variable changes, where the power has a jump or a kink, are left out.
    """
    worst = 0.0
    for before, here, after in zip(rows[:-2:2], rows[1::2], rows[2::2], strict=True):
        work = step / 3.0 * (power(before) + 4.0 * power(here) + power(after))
        if before.get(changes) == here.get(changes) == after.get(changes):
            worst = max(worst, abs(stored(after) - stored(before) - work))
    return worst / max(stored(row) for row in rows)


@pytest.mark.no_cover
def test_carrier_holds_what_frame_and_warp_bring():
    damper = HealdDamper(inputs_at_step_end=True, carrier_mass=15.0, warp_force=-60.0)

    def power(row):
        brought = row["warp_force"] * (row["velocity"] + row["rate"])
        return brought - row["transmitted_force"] * row["velocity"] - row["dissipated_power"]

    rows = swung(damper, 1e-5, 40000)
    assert {row["contact"] for row in rows} >= {-1, 0, 1}
    stored = residual(rows, 1e-5, lambda row: row["kinetic_energy"] + row["potential_energy"], power)
    done = residual(
        rows, 1e-5, lambda row: row["frame_work"], lambda row: -row["transmitted_force"] * row["velocity"]
    )
    # Simpson's rule: (w h)^5 / 90 with w = 365 1/s on a stop, and rounding; the quintic through the samples
    # follows the frame to 1e-15
    assert stored < 1e-12
    assert done < 1e-12


@pytest.mark.parametrize(("creep", "relaxation"), [(5.0, 10.0), (0.0, 0.0), (8.0, 8.0), (3.0, 0.0)])
@pytest.mark.parametrize("pretension", [0.15, 0.0])
def test_threads_hold_what_their_healds_bring(creep, relaxation, pretension):
    warp = WarpTension(
        inputs_at_step_end=True, creep_rate=creep, relaxation_rate=relaxation, pretension=pretension
    )

    def power(row):
        return -row["frame_load"] * row["velocity"] - row["dissipated_power"]

    rows = swung(warp, 1e-4, 4000)
    # Simpson's rule: (w h)^5 / 90 with w = 40 1/s and its harmonics, and rounding
    assert residual(rows, 1e-4, lambda row: row["potential_energy"], power) < 1e-9
    brought = (lambda row: row["frame_work"], lambda row: -row["frame_load"] * row["velocity"])
    assert residual(rows, 1e-4, *brought, changes="slack") < 1e-9


@pytest.mark.no_cover
@pytest.mark.parametrize("follower", [HealdDamper, WarpTension])
def test_work_of_a_frame_is_of_sixth_order_in_the_step(follower):
    works = [swung(follower(inputs_at_step_end=True), 0.4 / n, n)[-1]["frame_work"] for n in (80, 160, 8000)]
    coarse, fine = (abs(each - works[-1]) for each in works[:-1])
    # power and frame run on quintics; 2^6 but for terms of the next order
    assert coarse / fine > 40.0
    assert fine < 1e-10 * abs(works[-1])


@pytest.mark.no_cover
def test_work_of_a_frame_on_threads_is_that_of_the_carrier_with_them():
    damper = HealdDamper(inputs_at_step_end=True, thread_count=1260)
    works = [swung(damper, 0.4 / n, n)[-1]["frame_work"] for n in (80, 8000)]
    # as good as the load of the threads, a cubic over pieces of 0.05 rad: (0.05)^4 / 384
    assert works[0] == pytest.approx(works[1], rel=2e-8)


def test_slack_threads_take_no_work():
    # they are slack from a quarter of the stroke to three quarters; found within the step
    works = [
        swung(WarpTension(inputs_at_step_end=True, pretension=0.0), 0.4 / n, n)[-1]["frame_work"]
        for n in (80, 160, 8000)
    ]
    coarse, fine = (abs(each - works[-1]) for each in works[:-1])
    assert fine < 1e-8 * abs(works[-1])
    assert coarse / fine > 12.0


def test_a_frame_states_the_work_on_its_load_only_if_it_knows_it():
    dobby = on_shaft(DobbyDrive(**SHAFT), 1.0, 40.0, 0.0)
    without, with_work = (
        driven(dobby, HealdFrame(load=-100.0, load_work=3.0, use_load_work=use, **FRAME))
        for use in (False, True)
    )
    stored = without.kinetic_energy + without.potential_energy
    assert (without.shaft_work, with_work.shaft_work) == (stored, stored + 3.0)
    assert with_work.shaft_torque == without.shaft_torque
    assert (without.passed_torque != 0.0, with_work.passed_torque) == (True, 0.0)


# Where nothing moves


def test_a_standing_shaft_still_carries_the_frames_weight():
    dobby = on_shaft(DobbyDrive(slow_point=0.0, **SHAFT), 0.5 * pi, 0.0, 0.0)
    frame = driven(dobby, HealdFrame(pattern_1=2, load=-100.0, **FRAME))
    assert frame.drive_force == 17.0 * 9.81 + 100.0
    # virtual work: H/4 sin(S/2) S'
    lever = 0.12 * dobby.lift_slope
    assert frame.shaft_torque == pytest.approx(frame.drive_force * lever, rel=1e-14)
    assert frame.shaft_torque > 0.0


def test_a_frame_that_holds_takes_no_torque():
    dobby = on_shaft(DobbyDrive(slow_point=0.0, **SHAFT), 2.0, 40.0, 100.0)
    for follow in (False, True):
        frame = driven(dobby, HealdFrame(pattern_1=3, load=-100.0, follow_lift=follow, **FRAME))
        assert frame.drive_force == pytest.approx(17.0 * 9.81 + 100.0)
        assert (frame.rotor_torque, frame.shaft_torque) == (0.0, 0.0)
