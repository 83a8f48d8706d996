"""WeftInsertion: motion of all published machines against 50-digit references, closure, torque."""

from math import degrees, pi, radians

import pytest
from looms import RPM
from reference import ALL_MACHINES, MP, machine
from scipy.optimize import brentq

from loomfmu.components import MainShaft, WeftInsertion
from loomfmu.machines import MACHINES, parameters

ANGLES = 720
every_machine = pytest.mark.parametrize("name", ALL_MACHINES)

# as recomputed, degrees: free length begins, positive acceleration ends
WINDOW = {
    "WL680-3400": (94.44, 104.69),
    "WL680-3600": (92.53, 103.91),
    "WL680-3800": (91.62, 104.48),
    "WL800-3600": (87.95, 102.80),
    "WL800-3800": (87.26, 102.94),
    "WL450-3600": (91.52, 104.18),
    "WL450-3800": (90.12, 103.96),
    "WL450-4000": (88.89, 104.01),
    "WL450-4600": (85.57, 106.40),
    "WL450-5400": (82.25, 106.53),
}


def weft_of(name: str, **given: float) -> WeftInsertion:
    weft = WeftInsertion(**parameters("WeftInsertion", machine=name), **given)
    assert weft.initialize(0.0) == 0
    return weft


def placed(weft: WeftInsertion, theta: float) -> WeftInsertion:
    """The weft at that shaft angle: at 1 rad/s it is the time."""
    assert weft.speed == 1.0
    assert weft.step(theta, 0.0) == 0
    return weft


@pytest.mark.few(2)
@pytest.mark.no_cover
@every_machine
def test_motion_over_a_turn(name):
    weft = weft_of(name, speed=1.0)
    worst, largest = [MP.mpf(0)] * 3, [MP.mpf(0)] * 3
    for k in range(ANGLES):
        theta = 2.0 * pi * k / ANGLES
        placed(weft, theta)
        exact = machine(name).travel(MP.mpf(theta))
        found = (weft.travel, weft.velocity, weft.acceleration)
        for i in range(3):
            worst[i] = max(worst[i], abs(found[i] - exact[i]))
            largest[i] = max(largest[i], abs(exact[i]))
    for error, scale in zip(worst, largest, strict=True):
        # closed forms, some fifty roundings of 1e-16: about 2e-15; promised is
        assert error < 1e-12 * scale


@every_machine
def test_stroke_is_the_travel_at_the_transfer(name):
    weft = placed(weft_of(name, speed=1.0), pi)
    assert weft.stroke == pytest.approx(weft.travel, rel=1e-15)  # the same formula
    assert weft.stroke > 0.0
    # half the loom's width and the idle travel, to meet the other head: within 10 %
    half, idle = float(MACHINES[name]["width_m"]) / 2, float(MACHINES[name]["idle_travel_mm"]) / 1e3
    assert weft.stroke == pytest.approx(half + idle, rel=0.1)


@every_machine
@pytest.mark.parametrize("lead", [-4.0, -0.3, 0.01, 1.5, 1.6, 3.0])
def test_a_rapier_that_leads_moves_the_head_earlier(name, lead):
    # its travel counts from its own outer dead centre, which the shaft then passes before its zero
    usual = weft_of(name, speed=1.0)
    weft = weft_of(name, speed=1.0, lead=lead)
    assert weft.stroke == usual.stroke
    for k in range(36):
        placed(weft, k * pi / 18)
        placed(usual, k * pi / 18 + lead)
        # the angle is rounded to 1e-15, the motion's steepest derivative is below 10
        assert weft.travel == pytest.approx(usual.travel, abs=2e-14)
        assert weft.velocity == pytest.approx(usual.velocity, abs=2e-14)
    assert placed(weft, -lead).travel == pytest.approx(0.0, abs=1e-14)


@every_machine
@pytest.mark.parametrize("late", [-60.0, 30.0, 60.0])
def test_a_crank_that_is_mounted_late_does_the_same_up_to_60_degrees(name, late):
    given = parameters("WeftInsertion", machine=name)
    weft = WeftInsertion(**given | {"crank_phase": given["crank_phase"] - radians(late)}, speed=1.0)
    assert weft.initialize(0.0) == 0
    other = weft_of(name, speed=1.0, lead=-radians(late))
    for k in range(36):
        # the angle is rounded to 1e-15, the motion's steepest derivative is below 10
        assert placed(weft, k * pi / 18).travel == pytest.approx(placed(other, k * pi / 18).travel, abs=2e-14)


@pytest.mark.parametrize("phase", [61.0, 90.0, 119.0, -95.0, 250.0])
def test_a_crank_phase_between_both_dead_centres_is_refused(phase):
    """From 90 deg on the other dead centre would be the nearer one, and the head would go the other way."""
    assert WeftInsertion(crank_phase=radians(phase)).initialize(0.0) == 5


@every_machine
def test_head_returns_the_way_it_came(name):
    weft = weft_of(name, speed=1.0)

    def motion(theta: float) -> tuple[float, float, float]:
        placed(weft, theta)
        return weft.travel, weft.velocity, weft.acceleration

    for k in range(1, 36):
        there, back = motion(k * pi / 36), motion(2 * pi - k * pi / 36)
        # the angle is rounded to 4e-16, the motion's steepest derivative is below 10
        assert back == pytest.approx((there[0], -there[1], there[2]), abs=2e-14)


@every_machine
def test_published_window(name):
    weft = weft_of(name, speed=1.0)
    guide = sum(parameters("BeltMonitor", machine=name).values())
    start = degrees(brentq(lambda theta: placed(weft, theta).travel - guide, 1.2, 2.0, xtol=1e-13))
    end = degrees(brentq(lambda theta: placed(weft, theta).acceleration, 1.5, 2.2, xtol=1e-13))
    assert (start, end) == pytest.approx(WINDOW[name], abs=5e-3)  # two decimals
    # the paper prints whole degrees, read off curves: 2.8 deg off for WL800-3800, 1.8 for WL450-5400
    assert start == pytest.approx(float(MACHINES[name]["published_free_start_deg"]), abs=2.8)
    assert end == pytest.approx(float(MACHINES[name]["published_accel_end_deg"]), abs=1.5)


def test_defaults_are_a_published_machine():
    default = WeftInsertion()
    for name, value in parameters("WeftInsertion", machine="WL680-3600").items():
        assert getattr(default, name) == value


# Following a shaft


def test_velocity_and_acceleration_follow_the_shaft():
    own = weft_of("WL680-3600", speed=1.0)
    weft = weft_of("WL680-3600", follow_shaft=True, inputs_at_step_end=True)
    for theta, speed, acceleration in ((0.4, 50.0, 0.0), (1.7, 60.0, 900.0), (8.0, -40.0, -300.0)):
        weft.shaft_angle, weft.shaft_velocity, weft.shaft_acceleration = theta, speed, acceleration
        assert weft.step(0.0, 1e-3) == 0
        placed(own, theta)
        assert weft.travel == own.travel
        assert weft.velocity == pytest.approx(own.velocity * speed, rel=1e-14)  # v = s' w
        # a = s'' w^2 + s' e: rounding of the terms
        exact = own.acceleration * speed**2 + own.velocity * acceleration
        assert weft.acceleration == pytest.approx(exact, rel=1e-13)


@pytest.mark.parametrize("at_end", [True, False])
def test_own_speed_and_a_shaft_of_that_speed_agree(at_end):
    shaft = MainShaft(speed=500 * RPM)
    own = weft_of("WL680-3600", speed=500 * RPM)
    follower = weft_of("WL680-3600", follow_shaft=True, inputs_at_step_end=at_end)
    shaft.initialize(0.0)
    for n in range(300):
        if at_end:
            shaft.step(n * 1e-3, 1e-3)
        follower.shaft_angle, follower.shaft_velocity = shaft.angle, shaft.velocity
        if not at_end:
            shaft.step(n * 1e-3, 1e-3)
        for weft in (own, follower):
            weft.step(n * 1e-3, 1e-3)
        # angles up to 16 rad are rounded to 2e-15, times a velocity of 70 m/s over 52 rad/s
        assert follower.travel == pytest.approx(own.travel, abs=1e-14)
        assert follower.velocity == pytest.approx(own.velocity, abs=1e-12)


@pytest.mark.parametrize("turns", [-3, 1, 1000])
def test_whole_turns_change_nothing(turns):
    weft = weft_of("WL450-4600", speed=1.0)
    near = placed(weft, 1.3).travel
    # an angle of 2 pi n is rounded to 1e-16 n
    assert placed(weft, 1.3 + 2.0 * pi * turns).travel == pytest.approx(near, abs=5e-15 * abs(turns))


# Torque


def test_torque_is_what_the_head_takes_from_the_shaft():
    weft = weft_of("WL680-3600", speed=60.0, wheel_inertia=0.02)
    radius = 0.5 * 0.397
    for k in range(1, 50):
        weft.step(k * 2e-3, 0.0)
        # virtual power: T w = m a v + J (a / r)(v / r); a few roundings
        power = 0.1105 * weft.acceleration * weft.velocity
        power += 0.02 * weft.acceleration * weft.velocity / radius**2
        assert weft.shaft_torque * 60.0 == pytest.approx(power, rel=1e-13, abs=1e-9)


def test_torque_needs_no_turning_shaft():
    weft = weft_of("WL680-3600", follow_shaft=True, inputs_at_step_end=True)
    weft.shaft_angle, weft.shaft_velocity, weft.shaft_acceleration = 1.2, 0.0, 100.0
    weft.step(0.0, 1e-3)
    assert weft.velocity == 0.0
    slope = placed(weft_of("WL680-3600", speed=1.0), 1.2).velocity
    assert weft.shaft_torque == pytest.approx(0.1105 * slope**2 * 100.0, rel=1e-14)  # m s'^2 e


# Linkages that do not close


@pytest.mark.parametrize(
    ("given", "problem"),
    [
        ({"rocker_angle": radians(60), "crank_cone": radians(61)}, 1),
        ({"rocker_angle": radians(120), "crank_cone": radians(61)}, 1),
        ({"rocker_angle": 0.0, "crank_cone": 0.0}, 1),  # at its dead point, where no derivative exists
        ({"rocker_angle": radians(60), "crank_cone": radians(60)}, 1),
        ({"coupler_length": 0.05}, 2),
        ({"coupler_length": 0.9}, 2),
        ({"pivot_x": 5.0}, 2),
        ({"output_length": 0.01}, 2),
        # a crank at rest, with crank, coupler and output in one line: a dead point again
        (
            {
                "crank_cone": 0.0,
                "rocker_angle": pi / 2,
                "rocker_offset": -pi / 2,
                "crank_length": 0.25,
                "coupler_length": 0.5,
                "output_length": 0.25,
                "pivot_x": 1.0,
                "pivot_y": 0.0,
            },
            2,
        ),
        ({"assembly": 0}, 3),
    ],
)
def test_linkages_that_do_not_close_are_refused(given, problem):
    weft = WeftInsertion(**given)
    assert weft.check() == problem
    assert weft.initialize(0.0) == problem
    assert not WeftInsertion.problems[problem - 1].warning


def test_problem_of_closure_names_both_angles():
    text = WeftInsertion.problems[0].text
    assert "rocker_angle" in text
    assert "crank_cone" in text


def test_without_a_four_bar_its_lengths_do_not_matter():
    assert WeftInsertion(planar_linkage=False, pivot_x=5.0).initialize(0.0) == 0


@pytest.mark.parametrize("assembly", [-1, 1])
def test_travel_is_positive_for_either_way_of_closing(assembly):
    weft = WeftInsertion(assembly=assembly, speed=1.0)
    assert weft.initialize(0.0) == 0
    assert placed(weft, pi).travel > 0.0
