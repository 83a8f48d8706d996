"""Linkages up to the edge of what closes, on one side of which they run and on the other are refused."""

import random
from collections.abc import Iterator
from math import acos as arc_cosine
from math import cos as cosine
from math import fabs, isfinite, nextafter
from typing import Any

import pytest
from driving import declared
from reference import ALL_MACHINES, MP, Jet, sector_angle, six_bar
from whole_loom import TURN

from loomfmu.components import ReedBeatUp, WeftInsertion
from loomfmu.declaring.variables import Component
from loomfmu.machines import parameters

CLEAR = 1e-9  # m or 1: how far both components stay clear of a dead point
WEFT = (
    "rocker_angle",
    "crank_cone",
    "rocker_offset",
    "crank_length",
    "coupler_length",
    "output_length",
    "pivot_x",
    "pivot_y",
)
REED = (
    "crank_length",
    "coupler_length",
    "rocker_length",
    "crank_x",
    "crank_y",
    "arm_length",
    "arm_angle",
    "rod_length",
    "reed_height",
)
SOME_MACHINES = ("WL680-3600", "WL450-5400")


def problem(component: type[Component], given: dict[str, Any]) -> int:
    return component(**given).initialize(0.0)


def edges(component: type[Component], base: dict[str, Any], name: str) -> Iterator[tuple[float, float]]:
    """Neighbouring values of a parameter: with the one the linkage closes, with the other it does not."""
    (variable,) = (each for each in declared(component) if each.name == name)
    for direction in (1.0, -1.0):
        good, step = base.get(name, variable.start), 1e-3
        bad = good
        while variable.complaint(bad) == "" and problem(component, base | {name: bad}) == 0:
            good, bad, step = bad, bad + direction * step, 1.5 * step
        if variable.complaint(bad) != "":
            continue
        while nextafter(good, bad) != bad:
            middle = 0.5 * (good + bad)
            good, bad = (middle, bad) if problem(component, base | {name: middle}) == 0 else (good, middle)
        yield good, bad


def sharpest(instance: Any, count: int) -> list[float]:
    """Shaft angles of one turn at which the acceleration is largest, and some others."""

    def acceleration(angle: float) -> float:
        assert instance.step(angle, 0.0) == 0
        for variable in declared(type(instance)):
            assert isfinite(getattr(instance, variable.name)), (variable.name, angle)
        return fabs(instance.acceleration)

    angles = [TURN * n / count for n in range(count)]
    top = max(angles, key=acceleration)
    near = sorted((top + TURN / count * n / 20.0 for n in range(-40, 41)), key=acceleration)
    return near[-3:] + random.Random(1).sample(angles, 3)


def weft_reference(given: dict[str, Any], instance: WeftInsertion, angle: float) -> Jet:
    return sector_angle(given, Jet(MP.mpf(angle), 1)) * MP.mpf(instance.travel_per_angle)


def reed_reference(given: dict[str, Any], instance: ReedBeatUp, angle: float) -> Jet:
    """Reed coordinate by the closed form of its two loops."""
    direction = instance.crank_direction
    return six_bar(instance, Jet(MP.mpf(instance.beat_up_crank) + direction * MP.mpf(angle), direction))[0]


def check_edges(component: Any, base: dict[str, Any], names: tuple[str, ...], reference: Any) -> set[int]:
    """All edges of a linkage: the problems found beyond them."""
    found = set()
    for name in names:
        for good, bad in edges(component, base, name):
            found.add(problem(component, base | {name: bad}))
            given = base | {name: good}
            instance = component(**given, speed=1.0)
            assert instance.initialize(0.0) == 0
            for angle in sharpest(instance, 500):
                instance.step(angle, 0.0)
                exact = reference(given, instance, angle)
                for value, of in ((instance.velocity, exact.first), (instance.acceleration, exact.second)):
                    # 1e-9 from a dead point the cosine of an angle is 1 - 1e-9 or so, and its rounding,
                    # some 1e-16, is 1e-7 of what the angle's derivative is divided by
                    assert fabs(float(value - of)) <= 1e-6 * (fabs(float(of)) + 1e-3), (name, good, angle)
    return found


@pytest.mark.parametrize("machine", ALL_MACHINES)
def test_the_weft_insertion_runs_up_to_the_edge(machine):
    base = dict(parameters("WeftInsertion", machine=machine))
    found = check_edges(WeftInsertion, base, WEFT, weft_reference)
    assert found == ({1, 2} if base["planar_linkage"] else {1})


def test_the_reed_runs_up_to_the_edge():
    start = {variable.name: variable.start for variable in declared(ReedBeatUp) if variable.name in REED}
    assert check_edges(ReedBeatUp, start, REED, reed_reference) == {1, 2, 3}


@pytest.mark.parametrize("cone", [1e-3, 0.5, 1.4])
@pytest.mark.parametrize("clear", [2.0 * CLEAR, 1.01 * CLEAR, 0.99 * CLEAR, 0.0, -1e-12, -1e-9])
def test_how_near_a_dead_point_the_crank_may_come(cone, clear):
    # the margin is |cos b| - |cos g|, rounded to 1e-16
    weft = WeftInsertion(
        rocker_angle=arc_cosine(cosine(cone) - clear), crank_cone=cone, planar_linkage=False, speed=1.0
    )
    assert weft.initialize(0.0) == (1 if clear < CLEAR else 0)


@pytest.mark.parametrize("machine", SOME_MACHINES)
@pytest.mark.parametrize("name", WEFT)
def test_a_little_more_of_a_length_changes_little(machine, name):
    base = dict(parameters("WeftInsertion", machine=machine))

    def outputs(share: float) -> list[float]:
        weft = WeftInsertion(**(base | {name: base[name] * (1.0 + share)}), speed=1.0)
        assert weft.initialize(0.0) == 0
        rows = []
        for n in range(120):
            weft.step(TURN * n / 120.0, 0.0)
            rows += [weft.travel, weft.velocity, weft.acceleration]
        return rows

    middle = outputs(0.0)
    scale = max(map(fabs, middle))
    if base[name] == 0.0:
        return
    slopes = {}
    for share in (1e-4, -1e-4, 1e-6, 1e-9, -1e-9, 1e-12, -1e-12):
        slopes[share] = [(one - other) / share for one, other in zip(outputs(share), middle, strict=True)]
    steepest = max(map(fabs, slopes[1e-6]))
    for share, slope in slopes.items():
        # curvature: as much again for a change of the whole length, a thousand times near a dead point; and
        # rounding of travel and derivatives, some 30 * 1e-16, over the share
        slack = 1e3 * fabs(share - 1e-6) * steepest + 100 * 1.1e-16 * scale / fabs(share)
        worst = max(fabs(one - other) for one, other in zip(slope, slopes[1e-6], strict=True))
        assert worst <= slack, share


@pytest.mark.parametrize("factor", [1e-2, 1e-1, 10.0])
def test_a_linkage_of_any_size_is_similar(factor):
    # all lengths scaled: angles and so the velocity of the sector as before
    base = dict(parameters("WeftInsertion", machine="WL680-3600"))
    lengths = ("crank_length", "coupler_length", "output_length", "pivot_x", "pivot_y")
    one, other = (
        WeftInsertion(**(base | {name: base[name] * scale for name in lengths}), speed=1.0)
        for scale in (1.0, factor)
    )
    assert one.initialize(0.0) == other.initialize(0.0) == 0
    for n in range(100):
        for each in (one, other):
            each.step(TURN * n / 100.0, 0.0)
        # as many roundings, of other numbers, over 0.1 for the nearest dead point
        assert other.travel == pytest.approx(one.travel, abs=1e-13)
        assert other.acceleration == pytest.approx(one.acceleration, abs=1e-12)
