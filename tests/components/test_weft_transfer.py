"""WeftTransfer: harmonic heads in closed form, mirrored mechanisms, all published machines."""

from math import acos, cos, pi, radians, sin

import pytest
from looms import RPM
from reference import ALL_MACHINES, MP, machine

from loomfmu.components import COMPONENTS, WeftInsertion
from loomfmu.machines import MACHINES, parameters

WeftTransfer = COMPONENTS["WeftTransfer"]
every_machine = pytest.mark.parametrize("name", ALL_MACHINES)
SPEED = 600.0 * RPM
# overlap in mid-shed as the README has it, mm
OVERLAP = {
    "WL680-3400": 109.5,
    "WL680-3600": 104.6,
    "WL680-3800": 112.0,
    "WL800-3600": 119.6,
    "WL800-3800": 47.6,
    "WL450-3600": 124.2,
    "WL450-3800": 106.6,
    "WL450-4000": 112.7,
    "WL450-4600": 103.0,
    "WL450-5400": 123.8,
}


def met(transfer, giver, taker):
    """The transfer with both heads at some travel, velocity and acceleration."""
    for head, motion in (("giver", giver), ("taker", taker)):
        for name, value in zip(("travel", "velocity", "acceleration"), motion, strict=True):
            setattr(transfer, f"{head}_{name}", value)
    assert transfer.step(0.0, 0.0) == 0
    return transfer


def head(name="WL680-3600", lead=0.0):
    """A rapier at 1 rad/s, whose crank leads by an angle; its motion at a shaft angle."""
    given = parameters("WeftInsertion", machine=name)
    weft = WeftInsertion(**given, lead=lead, speed=1.0)
    assert weft.initialize(0.0) == 0

    def motion(theta):
        assert weft.step(theta, 0.0) == 0
        return weft.travel, weft.velocity, weft.acceleration

    return motion


def test_harmonic_heads_overlap_in_closed_form():
    # s = r (1 - cos(theta + lead)) of both: the sums of the cosines in closed form
    radius, lead, separation = 1.05, radians(7.0), 4.1
    transfer = WeftTransfer(separation=separation, needed_overlap=0.03)

    def motion(theta):
        return radius * (1 - cos(theta)), radius * SPEED * sin(theta), radius * SPEED**2 * cos(theta)

    both, apart = 2.0 * radius * cos(0.5 * lead), 2.0 * radius * sin(0.5 * lead)
    for k in range(720):
        theta = 2.0 * pi * k / 720
        met(transfer, motion(theta), motion(theta + lead))
        middle = theta + 0.5 * lead
        # a few sums of terms of up to 4 m, 130 m/s and 8300 m/s2
        assert transfer.overlap == pytest.approx(2.0 * radius - both * cos(middle) - separation, abs=4e-12)
        assert transfer.closing_velocity == pytest.approx(both * SPEED * sin(middle), abs=1e-12 * 140)
        assert transfer.closing_acceleration == pytest.approx(both * SPEED**2 * cos(middle), abs=1e-12 * 9e3)
        assert transfer.offset == pytest.approx(-0.5 * apart * sin(middle), abs=4e-12)
        assert transfer.offset_velocity == pytest.approx(-0.5 * apart * SPEED * cos(middle), abs=1e-12 * 140)
    # the hand-over lasts while -cos(middle) >= share
    share = (transfer.needed_overlap + separation - 2.0 * radius) / both
    for sign in (-1.0, 1.0):
        edge = pi + sign * acos(share) - 0.5 * lead
        for beside, engaged in ((-sign * 1e-9, True), (sign * 1e-9, False)):
            met(transfer, motion(edge + beside), motion(edge + beside + lead))
            assert transfer.engaged is engaged
            assert (transfer.engaged_event >= 0.0) is engaged


@every_machine
def test_overlap_of_the_published_machines(name):
    row = MACHINES[name]
    separation = MP.mpf(row["width_m"]) + 2 * MP.mpf(row["idle_travel_mm"]) / 1000
    exact = 2 * machine(name).travel(MP.pi)[0] - separation
    transfer = met(WeftTransfer(**parameters("WeftTransfer", machine=name)), *2 * [head(name)(pi)])
    assert transfer.overlap == pytest.approx(float(exact), abs=1e-12 * 6)  # of the two travels of 3 m
    assert 1000.0 * transfer.overlap == pytest.approx(OVERLAP[name], abs=0.05)  # digits in the README
    assert transfer.engaged
