"""WeftInsertion: motion of all published machines against 50-digit references, closure, torque."""

from math import pi, radians

import pytest
from reference import ALL_MACHINES, MP, machine

from loomfmu.components import WeftInsertion
from loomfmu.machines import MACHINES, parameters

ANGLES = 720
every_machine = pytest.mark.parametrize("name", ALL_MACHINES)


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


def test_defaults_are_a_published_machine():
    default = WeftInsertion()
    for name, value in parameters("WeftInsertion", machine="WL680-3600").items():
        assert getattr(default, name) == value


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


def test_without_a_four_bar_its_lengths_do_not_matter():
    assert WeftInsertion(planar_linkage=False, pivot_x=5.0).initialize(0.0) == 0


@pytest.mark.parametrize("assembly", [-1, 1])
def test_travel_is_positive_for_either_way_of_closing(assembly):
    weft = WeftInsertion(assembly=assembly, speed=1.0)
    assert weft.initialize(0.0) == 0
    assert placed(weft, pi).travel > 0.0
