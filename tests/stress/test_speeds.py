"""From 0.001 to 5,000 rev/min, both ways round: by shaft angle a loom is the same at every speed."""

from collections.abc import Iterator
from functools import cache
from math import fabs

import pytest
from driving import declared
from whole_loom import RPM, TURN, WIRES, WholeLoom, scale

from loomfmu.components import COMPONENTS
from loomfmu.physics.belt import NO_LIMIT
from loomfmu.physics.pattern_lock import UNLIMITED_TIME

SPEEDS = (0.001, 0.3, 37.0, 600.0, 5000.0)  # rev/min
STEPS, TURNS = 144, 2

# how the shaft runs; durations in radians of the shaft at full speed
WAYS: dict[str, dict[str, float]] = {
    "own speed": {},
    "main shaft": {},
    "ripple": {"ripple_amplitude": 0.05, "ripple_order": 3},
    "ramp and ripple": {"ripple_amplitude": 0.05, "ripple_order": 3, "ramp_duration": 1.0},
}


def steps() -> Iterator[tuple[float, float]]:
    """Angles at which steps begin, and their widths: uneven, and never at a place where a signal switches."""
    angle = 0.0
    for n in range(STEPS * TURNS):
        width = TURN / STEPS * (1.0 + 0.3 * (n % 5 - 2) / 2.0)
        yield angle, width
        angle += width


def turned(speed: float, way: str) -> list[dict[str, tuple[str, float]]]:
    """All outputs after each step."""
    shaft = dict(WAYS[way])
    if "ramp_duration" in shaft:
        shaft["ramp_duration"] /= fabs(speed)
    loom = WholeLoom(speed, follow=way != "own speed", **shaft)
    rows = []
    for angle, width in steps():
        loom.step(angle / fabs(speed), width / fabs(speed))
        rows.append({name: (unit, value) for name, unit, value in loom.outputs()})
    return rows


@cache
def at_one_radian(way: str, forwards: bool) -> list[dict[str, tuple[str, float]]]:
    return turned(1.0 if forwards else -1.0, way)


SLOWEST_AND_FASTEST = (SPEEDS[0], SPEEDS[-1])


def unlimited(name: str, expected: float, value: float, factor: float) -> bool:
    """Whether the value stands for none: 95,493 rev/min, or 1e6 s, at every speed of the loom."""
    none = {
        "BeltMonitor.speed_limit": NO_LIMIT,
        "BeltMonitor.lowest_speed_limit": NO_LIMIT,
        "PatternLock.available_time": UNLIMITED_TIME,
    }.get(name)
    if none is None or max(expected, value) < none:
        return False
    return value >= 0.999 * min(none, none * factor)


@pytest.mark.few(1)
@pytest.mark.parametrize("direction", [1.0, -1.0], ids=["forwards", "backwards"])
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(
    "rpm",
    [rpm if rpm in SLOWEST_AND_FASTEST else pytest.param(rpm, marks=pytest.mark.slow) for rpm in SPEEDS],
)
def test_a_loom_is_the_same_at_every_speed(rpm, way, direction):
    speed = direction * rpm * RPM
    reference = at_one_radian(way, direction > 0.0)
    largest = {
        name: max(fabs(row[name][1]) for row in reference if row[name][1] < NO_LIMIT) or 1.0
        for name in reference[0]
    }
    worst = (0.0, "")
    for one, other in zip(reference, turned(speed, way), strict=True):
        for name, (unit, expected) in one.items():
            value = other[name][1]
            factor = scale(unit, speed)
            if not isinstance(expected, float):
                assert value == expected, name
            elif not unlimited(name, expected, value, factor):
                worst = max(worst, (fabs(value / factor - expected) / largest[name], name))
    print(worst)
    # angle and time are rounded to 1e-16 of 12 rad, differently at every speed; most of what depends on them
    # changes by up to 100 times that. A contact with a stop, 300 times as stiff, and the second derivative
    # that the lowest margin is read from multiply it once more
    assert worst[0] < 1e-10, worst[1]


@pytest.mark.parametrize(
    "name", ["WeftInsertion", "DobbyDrive", "PatternLock", "ReedBeatUp", "DetachingRoller"]
)
def test_backwards_a_mechanism_shows_what_it_showed_forwards(name):
    onwards, back = (WholeLoom(speed, follow=False, names=[name]).parts[name] for speed in (2.0, -2.0))
    continuous = [
        variable
        for variable in declared(type(onwards))
        if variable.causality == "output" and variable.variability == "continuous"
    ]
    rows = []
    for angle, _width in steps():
        onwards.step(0.5 * angle, 0.0)
        back.start_angle = angle + 1.0
        back.step(0.0, 0.5)
        rows.append([(getattr(onwards, v.name), getattr(back, v.name)) for v in continuous])
    for variable, column in zip(continuous, zip(*rows, strict=True), strict=True):
        odd = variable.unit in ("m/s", "rad/s", "1/s")  # what changes its sign with the shaft
        # the drafting force is a function of the angle: backwards it drives the rollers
        odd = odd or (name, variable.name) == ("DetachingRoller", "dissipated_power")
        largest = max(fabs(one) for one, _other in column)
        for one, other in column:
            # the angle is rounded twice, to 1e-16 of 13 rad; 100 times that as above
            assert other == pytest.approx(-one if odd else one, abs=1e-12 * largest), variable.name


def test_the_loom_shows_all_that_it_can():
    rows = at_one_radian("ripple", True)
    for name in ("BeltMonitor.at_risk", "HealdFrame.moving", "HealdDamper.stop_contacts", "DobbyDrive.pick"):
        assert len({row[name][1] for row in rows}) > 1, name
    assert set(WIRES) <= set(COMPONENTS)
