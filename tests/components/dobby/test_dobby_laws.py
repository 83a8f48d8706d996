"""DobbyDrive with levers, gears, a spline cam, a table or a plateau, and a HealdFrame behind it."""

from itertools import pairwise
from math import asin, cos, degrees, inf, pi, radians, sin, sqrt

import numpy as np
import pytest
from driving import LAWS, assign, values
from hypothesis import given
from hypothesis import strategies as st
from reference import MP
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from loomfmu.components import DobbyDrive, HealdFrame
from loomfmu.machines import table
from loomfmu.physics.rotor_laws.mechanisms import noncircular_gears, slotted_levers
from loomfmu.physics.rotor_laws.plateau import plateau_peaks
from loomfmu.physics.rotor_laws.rotor import rotor_law

ROTORS = [name for name in LAWS if name != "spline_cam"]
RISE = radians(170.0)  # where the frames of the air-jet loom begin to rise

LEVERS = [(0.1, 0.1, 0.04), (0.08, 0.15, 0.05), (0.3, 0.1, 0.09), (0.1, 0.2, 0.099)]
GEARS = [(-0.27, -0.13, -0.05, -0.025), (0.2, -0.3, 0.1, 0.05), (0.0, 0.0, 0.0, -0.2), (-0.5, 0.0, 0.1, 0.0)]


def dobby(law, **given):
    """A drive with its law, started."""
    needed = {f"table_{k + 1}": rotor_law(4, 2.0 * pi * k / 36, 0.5)[0] for k in range(36)}
    drive = DobbyDrive(law=LAWS[law], **((needed if law == "table" else {}) | given))
    assert drive.initialize(0.0) == 0
    return drive


def at(drive, theta, speed=1.0, acceleration=0.0):
    """The drive at a shaft angle."""
    drive.follow_shaft = drive.inputs_at_step_end = True
    drive.shaft_angle, drive.shaft_velocity, drive.shaft_acceleration = theta, speed, acceleration
    assert drive.step(0.0, 0.0) == 0
    return drive


def skewed(points, first=0.0):
    """A table that is not symmetric, and starts at an angle of choice."""
    places = 2.0 * pi * np.arange(points) / points
    shape = places - 0.35 * np.sin(places) - 0.2 * np.sin(2.0 * places + 0.7) + 0.2 * sin(0.7) + first
    return {f"table_{k}": float(angle) for k, angle in enumerate(shape, start=1)} | {"table_points": points}


def table_spline(given):
    """The same law by scipy: the deviation from an even turn."""
    points = given["table_points"]
    places = 2.0 * pi * np.arange(points + 1) / points
    ahead = np.array([given[f"table_{k}"] for k in range(1, points + 1)]) - places[:-1]
    return CubicSpline(places, np.append(ahead, ahead[0]), bc_type="periodic")


def cam_spline():
    rows = table("shed_control_points")
    angles = [radians(float(row["shaft_angle_deg"])) for row in rows]
    return CubicSpline(angles, [1e-3 * float(row["warp_height_mm"]) for row in rows], bc_type="not-a-knot")


def cam_top():
    spline = cam_spline()
    place = max(spline.derivative().roots(extrapolate=False), key=lambda x: float(spline(x)))
    return float(place), float(spline(place))


# The rotor


@pytest.mark.parametrize("law", ROTORS)
def test_every_rotor_turns_once_a_pick_and_never_back(law):
    drive = dobby(law)
    angles = []
    for step in range(-720, 1441):
        at(drive, 2.0 * pi * step / 360.0)
        assert drive.rotor_velocity > 0.0
        angles.append(drive.rotor_angle)
    assert all(before < after for before, after in pairwise(angles))
    for before, after in zip(angles, angles[360:], strict=False):
        assert after - before == pytest.approx(2.0 * pi, abs=1e-13)  # shaft angles of 25 rounded to 4e-15
    at(drive, pi)  # the slow point
    assert drive.rotor_angle == pytest.approx(0.0, abs=1e-15)
    assert drive.lift_fraction == pytest.approx(0.0, abs=1e-30)


@pytest.mark.parametrize("points", range(4, 37))
def test_table_is_the_periodic_spline_of_scipy(points):
    given = skewed(points)
    drive = dobby("table", slow_point=0.0, **given)
    exact = table_spline(given)
    rng = np.random.default_rng(points)
    for x in [*rng.uniform(0.0, 2.0 * pi, 20), *(2.0 * pi * np.arange(points + 1) / points)]:
        at(drive, float(x))
        u = float(x) % (2.0 * pi)
        # rounding of values up to 2 pi, divided by the step, 0.17 rad, once for each derivative
        assert drive.rotor_angle == pytest.approx(float(x) + float(exact(u)), abs=1e-13)
        assert drive.rotor_velocity == pytest.approx(1.0 + float(exact(u, 1)), abs=1e-12)
        assert drive.rotor_acceleration == pytest.approx(float(exact(u, 2)), abs=1e-12)


def test_a_table_read_in_any_order_gives_the_same_bits():
    given = skewed(24)
    places = [float(x) for x in np.random.default_rng(1).uniform(-20.0, 20.0, 200)]
    forwards, backwards = dobby("table", **given), dobby("table", **given)
    one = {x: at(forwards, x).rotor_angle for x in sorted(places)}
    other = {x: at(backwards, x).rotor_angle for x in sorted(places, reverse=True)}
    assert one == other


def test_a_new_table_counts_from_the_next_start():
    drive = dobby("table", **skewed(12))
    at(drive, 4.0)
    assign(drive, skewed(12, first=0.3))
    assert drive.initialize(0.0) == 0
    fresh = dobby("table", **skewed(12, first=0.3))
    assert at(drive, 4.0).rotor_angle == at(fresh, 4.0).rotor_angle


# Peaks


def crest(function, start, end, samples=4000):
    """Largest size of a smooth function: samples, the highest refined by a parabola of neighbours."""
    x = np.linspace(start, end, samples + 1)
    y = abs(np.array([function(float(place)) for place in x]))
    k = int(np.argmax(y))
    if k in (0, samples):
        return y[k]
    before, here, after = y[k - 1 : k + 2]
    return here - (after - before) ** 2 / (8.0 * (before - 2.0 * here + after))


@pytest.mark.parametrize(("r", "b", "e"), LEVERS)
def test_peaks_of_the_levers(r, b, e):
    drive = dobby("slotted_levers", lever_radius=r, driven_radius=b, eccentricity=e)
    # (r / (r - e))^2 roundings
    assert drive.highest_speed == pytest.approx(r * b / ((r - e) * (b - e)), rel=1e-11)
    for order, found in ((2, drive.highest_acceleration), (3, drive.highest_jerk)):
        # half a turn, its quick end drawn out: pi - x from 3 down to 1e-4 in equal ratios, and the end itself
        largest = max(
            crest(lambda s, order=order: slotted_levers(pi - np.exp(s), r, b, e)[order], -9.2, 1.1),
            abs(slotted_levers(pi, r, b, e)[order]),
        )
        # the parabola over steps of 0.0026 misses by the fourth power of that, times 100
        assert found == pytest.approx(largest, rel=1e-8)


@pytest.mark.parametrize("harmonics", GEARS)
def test_peaks_of_the_gears(harmonics):
    given = {f"gear_harmonic_{k}": a for k, a in enumerate(harmonics, start=1)}
    drive = dobby("noncircular_gears", **given)
    for order, found in ((1, drive.highest_speed), (2, drive.highest_acceleration), (3, drive.highest_jerk)):
        largest = crest(lambda x, order=order: noncircular_gears(x, *harmonics)[order], -0.1, 2.0 * pi)
        assert found == pytest.approx(largest, rel=1e-9)  # as above, steps of 0.0016 of 4 waves


def test_levers_peak_in_fifty_digits():
    r, b, e = (MP.mpf(text) for text in ("0.1", "0.1", "0.04"))

    def lever(x, q):
        return x - MP.atan2(e * MP.sin(x), q + e * MP.cos(x))

    def second(x):
        return MP.diff(lambda t: lever(lever(t, r), b), x, 2)

    place = MP.findroot(lambda x: MP.diff(second, x), MP.mpf("2.7"))
    drive = dobby("slotted_levers")
    # golden sections find the value at a crest to rounding, terms up to 30
    assert drive.highest_acceleration == pytest.approx(float(second(place)), rel=1e-13)


@pytest.mark.parametrize("points", [4, 5, 12, 36])
def test_peaks_of_a_table(points):
    given = skewed(points)
    drive = dobby("table", **given)
    exact = table_spline(given)
    crests = exact.derivative(2).roots(extrapolate=False)
    knots = exact.x
    # rounding, once over the step for each derivative
    assert drive.highest_speed == pytest.approx(1.0 + max(exact(np.append(crests, knots), 1)), abs=1e-12)
    assert drive.highest_acceleration == pytest.approx(max(abs(exact(knots, 2))), abs=1e-12)
    assert drive.highest_jerk == pytest.approx(max(abs(exact.c[0] * 6.0)), abs=1e-11)


def test_peaks_of_the_plateau():
    for reduction in (0.0, 0.5, 1.0):
        drive = dobby("plateau", speed_reduction=reduction, plateau_angle=1.6, ramp_angle=0.7)
        expected = plateau_peaks(reduction, 0.8, 0.7)
        assert (drive.highest_speed, drive.highest_acceleration, drive.highest_jerk) == expected


# Dwells


@pytest.mark.parametrize(
    ("reduction", "dwell"), [("0.3", "80.40"), ("0.4", "93.80"), ("0.5", "111.62"), ("0.7", "141.36")]
)
def test_dwell_of_the_plateau_in_fifty_digits(reduction, dwell):
    z, p, r = MP.mpf(float(reduction)), MP.pi / 4, MP.mpf(radians(40.9))
    gain = z * MP.pi / (MP.pi - p - r / 2)
    reach = 4 * MP.asin(MP.sqrt(MP.mpf(0.015)))

    def angle(x):
        u = (x - p) / r
        bent = r * (u * u / 2 - (1 - MP.cos(2 * MP.pi * u)) / (4 * MP.pi**2)) if u > 0 else 0
        return (1 - z) * x + gain * bent

    exact = 2 * MP.findroot(lambda x: angle(x) - reach, (0.5, 1.2), solver="anderson", tol=1e-40)
    drive = dobby("plateau", speed_reduction=float(reduction))
    assert drive.dwell_angle == pytest.approx(float(exact), abs=2e-15 / (1.0 - float(reduction)))  # rounding
    assert degrees(drive.dwell_angle) == pytest.approx(float(dwell), abs=0.005)  # two decimals


def crossing(spline, target):
    """Shaft angle at which the law of a spline of the deviation has an angle."""
    return brentq(lambda x: x + float(spline(x % (2.0 * pi))) - target, -2.0 * pi, 2.0 * pi, xtol=1e-14)


@pytest.mark.parametrize("first", [0.0, 0.4, -0.9])
@pytest.mark.parametrize("tolerance", [1e-6, 0.015, 0.5])
def test_dwell_of_a_law_that_is_not_symmetric(first, tolerance):
    given = skewed(24, first)
    drive = dobby("table", dwell_tolerance=tolerance, clear_fraction=tolerance, **given)
    exact = table_spline(given)
    reach = 4.0 * asin(sqrt(tolerance))
    dwell = crossing(exact, reach) - crossing(exact, -reach)
    assert drive.dwell_angle == pytest.approx(dwell, abs=1e-13)  # the root finder's 1e-14, and rounding
    assert drive.clear_shed_angle == drive.dwell_angle


@pytest.mark.parametrize("law", ROTORS)
@pytest.mark.parametrize("tolerance", [0.001, 0.015, 0.2])
def test_frame_is_within_the_tolerance_just_during_the_dwell(law, tolerance):
    drive = dobby(law, slow_point=0.0, dwell_tolerance=tolerance)
    # all laws here are symmetric: half the dwell to either side; 1e-13 times a rate of at most 2
    for side in (-0.5, 0.5):
        assert at(drive, side * drive.dwell_angle).lift_fraction == pytest.approx(tolerance, abs=1e-12)


# The spline cam


def test_spline_cam_lifts_by_its_spline():
    drive, exact, (_place, height) = dobby("spline_cam", slow_point=RISE), cam_spline(), cam_top()
    for x in np.linspace(-15.0, 30.0, 500):
        at(drive, RISE + float(x), speed=3.0, acceleration=5.0)
        share, slope, bend = (float(exact(float(x) % (4.0 * pi), order)) / height for order in range(3))
        # shaft angles up to 30 are rounded to 4e-15; slopes and bends below 1
        assert drive.lift_fraction == pytest.approx(share, abs=1e-13)
        assert drive.lift_rate == pytest.approx(3.0 * slope, abs=1e-13)
        assert drive.lift_acceleration == pytest.approx(9.0 * bend + 5.0 * slope, abs=1e-12)


def test_phase_of_the_spline_cam():
    drive, (top, _height) = dobby("spline_cam", slow_point=RISE), cam_top()
    assert drive.cam_top == pytest.approx(top, abs=1e-13)  # of scipy's root, rounding over a bend of 0.1
    assert degrees(top) == pytest.approx(366.44, abs=5e-3)
    for x, phase in (
        (0.0, 0.0),
        (top, 2.0 * pi),
        (4.0 * pi, 4.0 * pi),
        (4.0 * pi + top, 6.0 * pi),
        (-1.0, None),
    ):
        at(drive, RISE + x, speed=2.0)
        if phase is not None:
            assert drive.rotor_angle == pytest.approx(phase, abs=1e-13)  # angles of 25, rounded
        inside = x % (4.0 * pi) <= drive.cam_top
        assert drive.rotor_acceleration == 0.0
        if x not in (0.0, top, 4.0 * pi, 4.0 * pi + top):
            rate = 2.0 * pi / (top if inside else 4.0 * pi - top)
            assert drive.rotor_velocity == pytest.approx(2.0 * rate, rel=1e-12)  # that of the top


def test_dwells_of_the_spline_cam_are_the_crossings_of_its_spline():
    exact, (_place, height) = cam_spline(), cam_top()
    drive = dobby("spline_cam", clear_fraction=1.0 - 0.015 / height)  # the published 15 mm
    for level, found in ((0.985 * height, drive.dwell_angle), (0.015, drive.clear_shed_angle)):
        crossings = exact.solve(level, extrapolate=False)
        assert found == pytest.approx(np.ptp(crossings), abs=1e-12)  # rounding over a slope of 0.005
    assert degrees(drive.dwell_angle) == pytest.approx(60.66, abs=5e-3)


# The frame


@pytest.mark.parametrize("law", ROTORS)
@pytest.mark.parametrize("pegs", [(1, 2), (2, 2), (0b0011, 4), (0b0001, 4), (0b01101, 5)])
def test_frame_that_follows_the_lift_moves_as_by_the_rotor(law, pegs):
    drive = dobby(law, speed=50.0)
    pattern, length = pegs
    given = {"pattern_1": pattern, "pattern_length": length, "inputs_at_step_end": True}
    crank, follower = HealdFrame(**given), HealdFrame(follow_lift=True, **given)
    for step in range(400):
        drive.step(0.003 * step, 0.003)
        for frame in (crank, follower):
            for name in ("angle", "velocity", "acceleration"):
                setattr(frame, f"rotor_{name}", getattr(drive, f"rotor_{name}"))
            frame.lift_fraction, frame.lift_rate = drive.lift_fraction, drive.lift_rate
            frame.lift_acceleration = drive.lift_acceleration
            frame.step(0.003 * step, 0.003)
        # rotor angles up to 60 are rounded to 7e-15; the lift's rates reach 50 and 1e4
        assert follower.lift == pytest.approx(crank.lift, abs=1e-15)
        assert follower.velocity == pytest.approx(crank.velocity, abs=1e-12)
        assert follower.acceleration == pytest.approx(crank.acceleration, abs=1e-10)
        assert follower.moving == crank.moving


def followed(drive, frame, step_size, steps):
    """The frame behind the drive, at rows of time, lift, velocity and acceleration."""
    rows = []
    for step in range(steps):
        drive.step(step * step_size, step_size)
        frame.rotor_angle, frame.rotor_velocity = drive.rotor_angle, drive.rotor_velocity
        frame.rotor_acceleration = drive.rotor_acceleration
        frame.lift_fraction, frame.lift_rate = drive.lift_fraction, drive.lift_rate
        frame.lift_acceleration = drive.lift_acceleration
        frame.step(step * step_size, step_size)
        rows.append((drive.lift_fraction, frame.lift, frame.velocity, frame.acceleration, drive.lift_rate))
    return rows


def test_frame_under_the_cam_in_plain_weave_has_the_cams_lift():
    drive = dobby("spline_cam", slow_point=RISE, start_angle=RISE, speed=radians(3000.0))
    frame = HealdFrame(follow_lift=True, inputs_at_step_end=True, pattern_1=2, stroke=0.09817)
    for share, lift, velocity, _second, rate in followed(drive, frame, 1e-4, 4000):
        # 1 - (1 - share) is rounded to 1e-16
        assert lift == pytest.approx(0.09817 * share, abs=1e-16)
        assert velocity == pytest.approx(0.09817 * rate, abs=1e-15)


def test_frames_under_the_cam_hold_and_go_the_other_way():
    # up at once, in the falling half of the cam; then held over two picks
    drive = dobby("spline_cam", slow_point=RISE, start_angle=RISE, speed=radians(3000.0))
    frame = HealdFrame(follow_lift=True, inputs_at_step_end=True, pattern_1=0b1100, pattern_length=4)
    rows = followed(drive, frame, 1e-4, 4800)
    turn = round(drive.cam_top / drive.speed / 1e-4)
    assert {row[1] for row in rows[: turn - 1]} == {0.0}  # lowered at peg 0, and asked to be at peg 1
    assert rows[turn + 1000][1] == pytest.approx(0.098 * (1.0 - rows[turn + 1000][0]), abs=1e-16)
    assert {row[1] for row in rows[2402 : 2400 + turn - 1]} == {0.098}
    assert rows[-1][1] == pytest.approx(0.098 * rows[-1][0], abs=1e-16)


# What is refused


EVEN = {f"table_{k + 1}": 2.0 * pi * k / 36 for k in range(36)}
# points that rise all the way, with a spline between them that does not
STEPS = (0.0, 0.01, 0.02, 3.0, 3.01, 3.02, 6.0, 6.01)
RISING = {f"table_{k}": angle for k, angle in enumerate(STEPS, start=1)} | {"table_points": 8}
REFUSED = [
    *(("slotted_levers", {"lever_radius": 0.1, "eccentricity": e}, "eccentricity") for e in (0.1, 0.11, 1.0)),
    *(
        ("slotted_levers", {"lever_radius": 2.0, "driven_radius": 0.1, "eccentricity": e}, "driven_radius")
        for e in (0.1, 0.11, 1.0)
    ),
    ("table", EVEN, "law = table has no table: "),
    ("table", EVEN | {"table_5": EVEN["table_3"]}, "table"),
    ("table", RISING, "its lowest speed is -"),
    ("table", {f"table_{k + 1}": 2.0 * pi * k / 12 for k in range(12)}, "36 points"),  # meant for fewer
    ("plateau", {"plateau_angle": 4.0, "ramp_angle": 1.2}, "ramp_angle"),
    ("spline_cam", {"cam_angle_3": 1.0}, "must rise from 0 to 720"),
    ("spline_cam", {"cam_angle_1": 0.1}, "must rise from 0 to 720"),
    ("spline_cam", {"cam_angle_6": 12.5}, "must rise from 0 to 720"),
    ("spline_cam", {"cam_height_6": 0.001}, "cam_height_6"),
    ("spline_cam", {f"cam_height_{k}": 0.0 for k in range(1, 7)}, "rises by"),
]


@pytest.mark.parametrize(("law", "given", "said"), REFUSED)
def test_a_law_that_no_rotor_can_follow_is_refused(law, given, said):
    drive = DobbyDrive(law=LAWS[law], **given)
    problem = drive.initialize(0.0)
    assert problem == drive.check() != 0
    assert not DobbyDrive.problems[problem - 1].warning
    assert said in DobbyDrive.problems[problem - 1].text.format(**values(drive))


def test_the_rising_table_turns_back_between_its_points():
    assert min(1.0 + table_spline(RISING)(np.linspace(0.0, 2.0 * pi, 1000), 1)) < 0.0


SUNK = {f"cam_height_{k}": height for k, height in enumerate((-0.002, -0.015, -0.0145, -0.0015), start=2)}


@pytest.mark.parametrize(
    ("law", "given"),
    [
        ("slotted_levers", {"eccentricity": 0.0999}),
        ("plateau", {"plateau_angle": pi, "ramp_angle": 0.5 * pi}),  # the highest speed at one point only
        ("spline_cam", SUNK),  # it rises by the little that the published one sinks
    ],
)
def test_a_law_that_can_just_be_followed_is_not(law, given):
    dobby(law, **given)


@given(st.tuples(*4 * [st.integers(-100, 100).map(lambda hundredths: hundredths / 100)]))
def test_gears_that_turn_back_are_refused(harmonics):
    given = {f"gear_harmonic_{k}": a for k, a in enumerate(harmonics, start=1)}
    drive = DobbyDrive(law=LAWS["noncircular_gears"], **given)
    grid = [2.0 * pi * k / 3600 for k in range(1801)]
    slowest = min(1.0 + sum(a * cos(k * x) for k, a in enumerate(harmonics, start=1)) for x in grid)
    if drive.initialize(0.0) == 0:
        assert slowest > 0.0
        assert drive.highest_speed > 0.0
    else:
        # the grid comes within (0.9 mrad)^2 / 8 of the largest curvature, 30, of the true minimum
        assert slowest < 1e-5
        assert drive.problems[1].text.startswith("the rotor would stop or reverse: with gear_harmonic_1")
        assert drive.check() == 2


@pytest.mark.parametrize(
    ("law", "shortest", "what"),
    [
        ("plateau", 0.3, "the ramp of the plateau"),
        ("table", 4.0 * pi / 36, "what a point of the table does to the rotor"),
        ("spline_cam", 0.25, "a part of the cam"),
        ("sloped_sine", inf, ""),
    ],
)
def test_the_shortest_event_of_a_law(law, shortest, what):
    cam = zip(range(1, 7), (0.0, 0.5, 0.75, 1.5, 2.5, 3.0), strict=True)
    known = {"law": LAWS[law], "ramp_angle": 0.3, "table_points": 36}
    known |= {f"cam_angle_{number}": angle for number, angle in cam}
    found, said = DobbyDrive.shortest_event(known.__getitem__)
    assert found == pytest.approx(shortest, rel=1e-15) and said == what
