"""ReedBeatUp: the published machine, exact motion, and what it refuses."""

from functools import cache
from math import degrees, hypot, log, pi, radians

import pytest
from reference import MP, RPM, Jet, six_bar

import loomfmu
from loomfmu.components.reed_beat_up import ReedBeatUp
from loomfmu.design.reed import crank_place, crank_rocker_without_quick_return, reed_dyad
from loomfmu.physics.reed import servo_turn

SPEED = float(30 * RPM)  # of the published motion
ANGLES = [2 * pi * k / 720 for k in range(720)]
# the crank before the swing instead of behind it: the front dead centre is where the coupler folds back
FOLDED = {"crank_x": 0.082762, "crank_y": 0.559301, "assembly": 1}
MACHINES = {
    "published": {},
    "backwards": {"crank_direction": -1, "beat_up_angle": 0.7},
    "folded": FOLDED,
    "bent arm": {"arm_angle": 0.2, "reed_height": 0.60},
}
every_machine = pytest.mark.parametrize("given", MACHINES.values(), ids=MACHINES)


def placed(theta: float, given: dict | None = None, **more: float) -> ReedBeatUp:
    """A reed at a shaft angle."""
    reed = ReedBeatUp(speed=SPEED, start_angle=theta, **(given or {}), **more)
    assert reed.initialize(0.0) == 0
    return reed


class Reference:
    """The six-bar in 50 digits from its closed form, its derivatives from Taylor series."""

    def __init__(self, given: dict) -> None:
        self.of = ReedBeatUp(**given)
        self.phase = MP.mpf(0)
        # the front dead centre is where the reed turns back, not where crank and coupler lie in line
        turns = [MP.findroot(lambda crank: self.reed(crank)[0].first, start) for start in self.near_ends()]
        self.front, self.back = sorted(turns, key=lambda crank: -self.reed(crank)[0].value)

    def near_ends(self) -> list[float]:
        grid = [k * 2 * pi / 90 for k in range(90)]
        values = [self.reed(crank)[0].value for crank in grid]
        return [grid[values.index(max(values))], grid[values.index(min(values))]]

    def reed(self, crank: float) -> tuple[Jet, Jet, Jet]:
        """Reed coordinate, angle of the rocker and slope of the rod at a crank angle, by that angle."""
        return six_bar(self.of, Jet(crank, 1))

    def crank(self, theta: float) -> float:
        return self.front + self.of.crank_direction * (MP.mpf(theta) - self.of.beat_up_angle)


@cache
def reference(name: str) -> Reference:
    return Reference(MACHINES[name])


every_name = pytest.mark.parametrize("name", MACHINES)


# The published machine


def test_defaults_are_the_synthesis_of_the_published_design():
    swing, rocker, slope, frame_angle = radians(13.610), 0.550, 0.1154, radians(15)
    crank, coupler, _frame, smallest = crank_rocker_without_quick_return(rocker, swing, frame_angle)
    x, y = crank_place(rocker, swing, slope, frame_angle)
    arm, rod, height = reed_dyad(0.490, 0.330, swing, slope, radians(-1.235))
    reed = placed(0.0)
    # the crank is the published one, which is 2 um shorter; the others are rounded to 1 and 10 um
    assert reed.crank_length == pytest.approx(crank, abs=2.5e-6)
    assert (reed.coupler_length, reed.crank_x, reed.crank_y) == pytest.approx((coupler, x, y), abs=1e-6)
    assert (reed.arm_length, reed.rod_length, reed.reed_height) == pytest.approx((arm, rod, height), abs=5e-6)
    assert degrees(reed.smallest_transmission_angle) == pytest.approx(degrees(smallest), abs=2e-3)


def test_takes_the_same_time_to_and_fro():
    # no quick return: half a turn on it is at the back limit; the lengths are rounded to 1 um
    reed = placed(pi)
    assert reed.position == pytest.approx(reed.back_limit, abs=1e-9)


# Exact motion


@pytest.mark.few(2)
@pytest.mark.no_cover
@every_name
def test_motion_at_720_angles(name):
    of = reference(name)
    rows = []
    for theta in ANGLES:
        reed = placed(theta, MACHINES[name])
        position, _chi, slope = of.reed(of.crank(theta))
        exact = (position.value, of.of.crank_direction * position.first, position.second, slope.value)
        by_theta = reed.velocity / SPEED
        rows.append((exact, (reed.position, by_theta, reed.acceleration / SPEED**2, reed.pressure_angle)))
    for column in range(4):
        largest = max(abs(exact[column]) for exact, _found in rows)
        worst = max(abs(found[column] - exact[column]) for exact, found in rows)
        assert worst <= 1e-12 * largest  # rounding; at most seen 3e-14


@every_name
def test_limits_are_where_the_reed_turns(name):
    of = reference(name)
    reed = placed(0.0, MACHINES[name])
    front, back = (of.reed(crank)[0].value for crank in (of.front, of.back))
    assert abs(reed.front_limit - front) < 1e-15  # rounding of lengths up to 1 m
    assert abs(reed.back_limit - back) < 1e-15
    assert reed.stroke == reed.front_limit - reed.back_limit


@every_machine
def test_transmission_angle_is_that_of_the_triangle(given):
    found = []
    for theta in ANGLES:
        reed = placed(theta, given)
        crank = Reference.crank(reference_of(given), theta)
        pin = hypot(
            reed.crank_x + reed.crank_length * float(MP.cos(crank)),
            reed.crank_y + reed.crank_length * float(MP.sin(crank)),
        )
        square = reed.coupler_length**2 + reed.rocker_length**2 - pin**2
        exact = MP.acos(abs(square) / (2 * MP.mpf(reed.coupler_length) * reed.rocker_length))
        assert abs(reed.transmission_angle - exact) < 1e-13
        found.append(reed.transmission_angle)
    # 720 angles miss the smallest by half a step at most
    assert reed.smallest_transmission_angle <= min(found) + 1e-15
    assert reed.smallest_transmission_angle == pytest.approx(min(found), abs=1e-4)


def reference_of(given):
    return reference(next(name for name, machine in MACHINES.items() if machine is given))


# What it refuses


@pytest.mark.parametrize(
    ("given", "problem"),
    [
        ({"crank_length": 0.15}, 1),  # longer than the coupler
        ({"coupler_length": 0.05}, 1),
        ({"rocker_length": 1.0}, 1),
        # the frame is shorter than the crank, which would take the rocker round with it
        ({"crank_length": 0.6, "coupler_length": 0.7, "rocker_length": 0.7}, 1),
        ({"crank_x": 0.0, "crank_y": 0.0}, 1),
        ({"rod_length": 0.01}, 2),
        ({"reed_height": 0.1}, 2),
        ({"reed_height": 1.2}, 2),
        ({"arm_angle": -pi / 2, "reed_height": 0.13}, 3),  # stretched
        ({"arm_angle": pi / 2, "reed_height": -0.02}, 3),  # folded
        ({"assembly": 0}, 4),
        ({"crank_direction": 0}, 4),
    ],
)
def test_refused_linkages(given, problem):
    reed = ReedBeatUp(**given)
    assert reed.check() == problem
    assert reed.initialize(0.0) == problem


# Servo

STEP = 1e-5  # rad, of the differences that give an energy
SERVOS = {"half": (pi, 0.25), "short": (0.8, 0.5), "sharp": (2.0, 0.02), "whole": (2 * pi, 0.3)}
every_servo = pytest.mark.parametrize(("run", "share"), SERVOS.values(), ids=SERVOS)


@every_servo
def test_servo_law_to_fifty_digits(run, share):
    # by another way: the speed's definition, integrated and differentiated by mpmath
    ramp = share * run
    top = 2 * MP.pi / (MP.mpf(run) - MP.mpf(ramp))

    def speed(x):
        left = MP.mpf(run) / 2 - abs(x)
        if left <= 0:
            return MP.mpf(0)
        part = min(left / MP.mpf(ramp), MP.mpf(1))
        return top * (part - MP.sin(2 * MP.pi * part) / (2 * MP.pi))

    for x in (0.0, 0.1 * run, -0.3 * run, 0.45 * run, -0.499 * run, min(0.6 * run, 3.0)):
        turn, first, second = servo_turn(x, run, ramp)
        knee = MP.sign(x) * min(abs(MP.mpf(x)), MP.mpf(run) / 2 - MP.mpf(ramp))
        stop = MP.sign(x) * min(abs(MP.mpf(x)), MP.mpf(run) / 2)
        assert turn == pytest.approx(float(MP.quad(speed, [0, knee, stop])), abs=4e-15)  # of a turn of 3
        assert first == pytest.approx(float(speed(MP.mpf(x))), abs=1e-13 * float(top) / share)
        assert second == pytest.approx(float(MP.diff(speed, MP.mpf(x))), abs=1e-13 * float(top) / ramp)


@every_servo
def test_servo_turns_once_in_every_revolution(run, share):
    for revolution in (-3, 0, 2, 1000):
        for x in (-1.0, 0.0, 0.3):
            one, other = (servo_turn(at, run, share * run) for at in (x, x + 2 * pi * revolution))
            # the angle's own rounding, times the speed and acceleration
            assert other[0] - 2 * pi * revolution == pytest.approx(one[0], abs=1e-11)
            assert other[1:] == pytest.approx(one[1:], abs=1e-9)


def test_servo_stands_at_the_back_and_beats_up_in_time():
    servo = {"servo": True, "run_angle": radians(120.0), "beat_up_angle": 0.3}
    beat_up = placed(0.3, servo)
    assert beat_up.position == pytest.approx(beat_up.front_limit, abs=1e-15)
    for degrees_on in (60.1, 90.0, 180.0, 270.0, 299.9):
        reed = placed(0.3 + radians(degrees_on), servo)
        # lengths rounded to 1 um: half a turn
        assert reed.position == pytest.approx(reed.back_limit, abs=1e-7)
        assert (reed.velocity, reed.acceleration, reed.crank_torque) == (0.0, 0.0, 0.0)
    # at its front the crank turns at 2 pi / (120 deg less a ramp of 30 deg): four times as fast as the shaft
    assert beat_up.crank_velocity == pytest.approx(4.0 * SPEED, rel=1e-15)
    assert beat_up.acceleration == pytest.approx(16.0 * placed(0.0).acceleration, rel=1e-12)


@every_servo
def test_servo_delivers_the_power_of_the_masses_and_the_shaft_none(run, share):
    given = {"servo": True, "run_angle": run, "ramp_share": share, "rocker_inertia": 0.3, "reed_mass": 2.0}
    for x in (0.2 * run, -0.45 * run, 0.4 * run):
        reed = placed(x, given)
        # kinetic energy from differences of positions alone, good to 1e-16 / 1e-5 and the square of the steps

        def energy(at):
            near = [placed(at + side * STEP, given) for side in (-1, 1)]
            arm = [
                each.rocker(each.beat_up_crank + servo_turn(at + side * STEP, run, share * run)[0], 1.0)[0]
                for each, side in zip(near, (-1, 1), strict=True)
            ]
            rates = (near[1].position - near[0].position, arm[1] - arm[0])
            return 0.5 * (2.0 * rates[0] ** 2 + 0.3 * rates[1] ** 2) * (SPEED / (2 * STEP)) ** 2

        power = (energy(x + 1e-3) - energy(x - 1e-3)) / 2e-3 * SPEED
        assert reed.crank_torque * reed.crank_velocity == pytest.approx(power, rel=2e-3, abs=1e-4)
        assert reed.shaft_torque == 0.0


# Beat-up


CLOTH = {"weaving_resistance": 0.2}
# J, of a pick's resistance from 2 mm down to 0.5 mm, 0.3 mm at least
TAKEN = 0.2 * (log(1.7 / 0.2) - 1.5 / 1.7)


@pytest.mark.parametrize("more", [{}, {"servo": True}, {"reed_mass": 0.0, "crank_direction": -1}], ids=str)
def test_in_a_revolution_the_crank_gives_what_the_picks_resistance_takes(more):
    count = 36000
    # the reed is in touch for some 20 deg of the crank; the rectangle rule's error is that of its two corners
    reed, work, given = placed(0.0, CLOTH | more), 0.0, 0.0
    for k in range(count):
        reed.start_angle = 2 * pi * (k + 0.5) / count
        reed.step(0.0, 0.0)
        work += reed.crank_torque * reed.crank_velocity / SPEED * 2 * pi / count
        given += reed.passed_torque * 2 * pi / count
    assert work == pytest.approx(TAKEN, rel=1e-5)
    assert given == pytest.approx(0.0 if "servo" in more else TAKEN, abs=1e-5)


def test_the_force_at_the_front_is_the_resistance_at_the_spacing():
    reed = placed(0.0, CLOTH)
    assert reed.beat_up_force == pytest.approx(0.2 * (1 / 0.2e-3 - 1 / 1.7e-3), rel=1e-9)
    assert reed.fell_displacement == pytest.approx(reed.beat_up_force / 5.25e5, rel=1e-14)
    assert placed(pi, CLOTH).beat_up_force == placed(0.0).beat_up_force == 0.0


@pytest.mark.parametrize("spacing", [0.3e-3, 2e-3])
def test_a_spacing_outside_of_the_resistance_is_refused(spacing):
    assert ReedBeatUp(pick_spacing=spacing).initialize(0.0) == 6


def test_a_motor_beats_up(tmp_path):
    """Its work is in the shaft's books, and a claim finds the force between the samples."""
    (tmp_path / "loom.toml").write_text(
        "revolutions = 4\nsteps_per_revolution = 701\ncoupling = 'iterated'\nrecord = ['shaft.*', 'reed.*']\n"
        "[loom]\nmachine = 'WL680-3600'\nreed = true\n[shaft]\ncomponent = 'DrivenShaft'\n"
        "start_angle = '90 deg'\n[reed]\nweaving_resistance = 0.2\n"
        "[[claims]]\nname = 'ledger'\nkind = 'energy_balance'\n"
        "[[claims]]\nname = 'force'\nkind = 'below'\nsignal = 'reed.beat_up_force'\nbound = '900 N'\n"
    )
    result = loomfmu.evaluate(tmp_path / "loom.toml", values=["shaft.other_work"])
    ledger, force = result.claims
    assert ledger.holds and force.holds
    assert force.worst == pytest.approx(0.2 * (1 / 0.2e-3 - 1 / 1.7e-3), rel=1e-4)
    # the shaft takes the force for straight between its samples, ten of them in touch with the fell
    assert result.trace["shaft.other_work"][-1] == pytest.approx(4.0 * TAKEN, rel=1e-3)
