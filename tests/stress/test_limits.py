"""Parameters and inputs at their limits: every component runs with finite outputs, or says what is wrong."""

import itertools
import random
from math import fabs, isfinite, nextafter, pi
from typing import Any

import mpmath
import pytest
from driving import LAWS, declared, inputs
from hypothesis import given, settings
from hypothesis import strategies as st
from whole_loom import TURN

from loomfmu.components import COMPONENTS, BeltMonitor, DobbyDrive, PatternLock
from loomfmu.declaring.variables import Component, Variable
from loomfmu.physics.belt import NO_LIMIT

MP = mpmath.mp.clone()
MP.dps = 40


def seeds(few: int, many: int) -> Any:
    """Some examples for every run of the tests, the rest on demand."""
    rest = pytest.param(range(few, many), marks=pytest.mark.slow, id="many")
    return pytest.mark.parametrize("drawn", [pytest.param(range(few), id="few"), rest])


def all_finite(component: Component) -> bool:
    return all(isfinite(getattr(component, variable.name)) for variable in declared(type(component)))


def ends_the_run(component: Component, problem: int) -> bool:
    """Return whether a problem ends the run; its text is one line about values of this component."""
    if problem == 0:
        return False
    text = component.problems[problem - 1].text.format_map(
        {variable.name: getattr(component, variable.name) for variable in declared(type(component))}
    )
    assert text and "\n" not in text
    return not component.problems[problem - 1].warning


def corner(variable: Variable, rng: random.Random) -> Any:
    """The start value, a limit, or what comes next to a limit or to nothing."""
    low, high = variable.minimum, variable.maximum
    if variable.type is bool:
        return rng.random() < 0.5
    candidates = [variable.start, variable.start]
    if low is not None and high is not None:
        candidates += [low, high, low, high]
        if variable.type is float:
            candidates += [nextafter(low, high), nextafter(high, low), rng.uniform(low, high)]
            candidates += [tiny for tiny in (5e-324, 1e-310, -1e-200, 1e-9) if low <= tiny <= high]
    return variable.type(rng.choice(candidates))


def run_at_corners(component: type[Component], seed: int, steps: int, **chosen: Any) -> None:
    """One revolution with parameters at their limits and inputs that jump between theirs."""
    rng = random.Random(seed)
    drawn = {v.name: corner(v, rng) for v in declared(component) if v.settable and rng.random() < 0.5}
    instance: Any = component(**(drawn | chosen))
    if ends_the_run(instance, instance.initialize(0.0)):
        return
    assert all_finite(instance), drawn
    speed = fabs(getattr(instance, "speed", 0.0)) or 42.0
    size = min(max(TURN / speed / steps, 1e-9), 10.0)
    for n in range(steps):
        for variable in inputs(component):
            if rng.random() < 0.2:
                setattr(instance, variable.name, corner(variable, rng))
        if ends_the_run(instance, instance.step(n * size, size)):
            return
        assert all_finite(instance), drawn


@seeds(6, 3000)
@pytest.mark.parametrize("name", [name for name in COMPONENTS if name not in ("BeltDynamics", "HealdDamper")])
def test_corners_run_or_are_refused(name, drawn):
    for seed in drawn:
        run_at_corners(COMPONENTS[name], seed, 24)


@seeds(6, 3000)
def test_corners_of_the_belt_in_motion_run_or_are_refused(belt_in_c, drawn):
    # a stiff or overloaded belt takes a second in Python until it is held
    for seed in drawn:
        run_at_corners(belt_in_c, seed, 24)


@seeds(2, 400)
def test_corners_of_the_damper_run_or_are_refused(drawn):
    # a heavy carrier, for a light one on stiff springs takes seconds until a long step is given up
    for seed in drawn:
        run_at_corners(COMPONENTS["HealdDamper"], seed, 3 if seed % 2 else 24, carrier_mass=1e3)


@seeds(8, 1500)
@pytest.mark.parametrize("law", [law for law in LAWS if law != "plateau"])
def test_corners_of_a_rotor_law_run_or_are_refused(law, drawn):
    for seed in drawn:
        run_at_corners(DobbyDrive, seed, 24, law=LAWS[law])


# Rotor laws


def drawn_law(law: str, rng: random.Random) -> dict[str, Any]:
    """Any parameters of a law, near their limits more often than not; it may be that it cannot be driven."""

    def share() -> float:
        return rng.choice(
            [0.0, 1.0, 5e-324, 1.0 - 1e-16, rng.random(), 1.0 - 10.0 ** rng.uniform(-12.0, 0.0)]
        )

    found: dict[str, Any] = {"law": LAWS[law], "slow_point": rng.uniform(-TURN, TURN), "speed": 1.0}
    if law in ("harmonic_ends", "sloped_line", "sloped_sine"):
        found["speed_reduction"] = share()
    if law == "slotted_levers":
        found |= {"lever_radius": 10.0 ** rng.uniform(-3, 1), "driven_radius": 10.0 ** rng.uniform(-3, 1)}
        found["eccentricity"] = share() * min(found["lever_radius"], found["driven_radius"])
    if law == "noncircular_gears":
        found |= {f"gear_harmonic_{n}": rng.uniform(-1.0, 1.0) * share() / n for n in range(1, 5)}
    if law == "table":
        points = rng.choice([4, 5, 17, 36])
        widths = [rng.uniform(1.0, 1.0 + 0.8 * share()) for _ in range(points)]
        sums = [sum(widths[:n]) for n in range(points)]
        start = rng.uniform(-1.0, 1.0)
        found |= {f"table_{n + 1}": start + TURN * each / sum(widths) for n, each in enumerate(sums)}
        found["table_points"] = points
    return found


@seeds(10, 600)
@pytest.mark.parametrize("law", [law for law in LAWS if law not in ("spline_cam", "plateau")])
def test_a_rotor_never_turns_back_and_goes_round_once_in_a_turn(law, drawn):
    runs = 0
    for seed in drawn:
        drive = DobbyDrive(**drawn_law(law, random.Random(seed)))
        if ends_the_run(drive, drive.initialize(0.0)):
            continue
        runs += 1
        rows = []
        for n in range(2 * 60 + 1):
            assert drive.step(TURN * n / 60.0 + 0.01, 0.0) == 0
            assert all_finite(drive)
            rows.append((drive.rotor_angle, drive.rotor_velocity, drive.rotor_acceleration))
        for before, after in itertools.pairwise(rows):
            # a slow point may be next to a standstill: rounding of an angle of 20 rad
            assert after[0] >= before[0] - 2 * 3.6e-15
            assert after[1] >= -1e-14
        for before, after in zip(rows, rows[60:], strict=False):
            assert after[0] - before[0] == pytest.approx(TURN, abs=1e-13 * max(1.0, drive.highest_speed))
            # the shaft angle is rounded to 2e-15 of 20 rad, and the rates change with it by as much as the
            # peaks of acceleration and jerk say
            assert after[1] == pytest.approx(before[1], abs=1e-13 + 4e-15 * drive.highest_acceleration)
            assert after[2] == pytest.approx(before[2], abs=1e-12 + 4e-15 * drive.highest_jerk)
            assert fabs(before[1]) <= drive.highest_speed * (1.0 + 1e-12)
    assert runs > 5


@seeds(12, 600)
def test_a_spline_cam_comes_back_after_two_picks(drawn):
    assert sum(comes_back(random.Random(seed)) for seed in drawn) > len(drawn) / 4


def comes_back(rng: random.Random) -> bool:
    """Whether a cam with points at random can be driven; if so, it is as it was after two picks."""
    inner = sorted(rng.uniform(0.0, 4.0 * pi) for _ in range(4))
    heights = [rng.uniform(0.0, 0.02) for _ in range(4)]
    drive = DobbyDrive(
        law=LAWS["spline_cam"],
        speed=1.0,
        **{f"cam_angle_{n + 2}": angle for n, angle in enumerate(inner)},
        **{f"cam_height_{n + 2}": height for n, height in enumerate(heights)},
    )
    if ends_the_run(drive, drive.initialize(0.0)):
        return False
    rows = []
    for n in range(241):
        assert drive.step(4.0 * pi * n / 120.0 + 0.01, 0.0) == 0
        assert all_finite(drive)
        rows.append((drive.rotor_angle, drive.lift_fraction, drive.lift_rate, drive.lift_acceleration))
    for before, after in zip(rows, rows[120:], strict=False):
        assert after[0] - before[0] == pytest.approx(4.0 * pi, abs=1e-13)
        # the angle is rounded to 4e-15 of 25 rad
        assert after[1] == pytest.approx(before[1], abs=1e-13 + 1e-14 * drive.highest_speed)
        assert after[2] == pytest.approx(before[2], abs=1e-13 + 1e-14 * drive.highest_acceleration)
        assert before[1] <= 1.0 + 1e-12
    assert all(after[0] >= before[0] for before, after in itertools.pairwise(rows))
    return True


# The belt


@pytest.mark.parametrize("free", [0.0, 5e-324, -5e-324, 1e-310, 1e-200, 1e-16, -1e-16, 1e-12, 1e-6, -1e-3])
@pytest.mark.parametrize("tension", [0.0, 1e6, -1e6])
@pytest.mark.parametrize("clearance", [0.0, 5e-324, 0.8e-3, 0.05])
def test_a_belt_that_hardly_leaves_its_guide(free, tension, clearance):
    belt = BeltMonitor(
        head_length=0.0,
        idle_travel=0.0,
        travel=free,
        velocity=0.0,
        acceleration=400.0,
        yarn_tension=tension,
        guide_clearance=clearance,
        inputs_at_step_end=True,
    )
    assert belt.initialize(0.0) in (0, 1)
    for n in range(5):
        belt.travel = free * (n - 1.0)
        assert belt.step(n * 1e-3, 1e-3) in (0, 1)
        assert all_finite(belt)
        # no more than the load makes of a free length of three millimetres: the length factor is 1 at most
        reach = (400.0 * belt.head_mass + fabs(tension)) * max(belt.free_length, 0.0) ** 2 / (pi**2 * 0.25)
        assert fabs(belt.margin - 1.0) <= reach * (1.0 + 1e-15) + 2e-16
        assert belt.deflection >= 0.0 if belt.margin < 0.0 else belt.deflection == 0.0
        assert 0.0 <= belt.lowest_speed_limit <= NO_LIMIT


def test_the_speed_limit_falls_from_none_without_a_gap():
    # from a free length of nothing outwards: none, then as the formula says
    belt = BeltMonitor(head_length=0.0, idle_travel=0.0, prescribe_length_factor=True, acceleration=400.0)
    before = NO_LIMIT
    for n in range(400):
        belt.travel = 1e-300 * 10.0 ** (0.75 * n) if n < 396 else 0.1 * (n - 395)
        belt.initialize(0.0)
        assert belt.speed_limit <= before
        before = belt.speed_limit
    assert before < 100.0


# Others


@settings(max_examples=50)
@given(st.integers(0, 10**9))
def test_a_pawl_gets_over_at_any_corner(seed):
    rng = random.Random(seed)
    lock = PatternLock(
        **{v.name: corner(v, rng) for v in declared(PatternLock) if v.causality == "parameter"}
    )
    lock.follow_shaft = True
    lock.inputs_at_step_end = True
    lock.shaft_velocity, lock.shaft_acceleration = 10.0, 0.0
    assert lock.initialize(0.0) == 0
    span = lock.engagement_angle
    for n in range(-1, 12):
        lock.shaft_angle = lock.engagement_start + span * n / 10.0 + (1e-9 if n == 10 else 0.0)
        assert lock.step(0.0, 0.0) == 0
        assert all_finite(lock)
        if 0 <= n <= 10 and span < TURN - 1e-6:
            # from one disc to the other, and never farther
            assert -1e-12 <= lock.turn / lock.whole_turn <= 1.0 + 1e-12
    assert lock.speed_limit == min(lock.torque_speed_limit, lock.release_speed_limit)
