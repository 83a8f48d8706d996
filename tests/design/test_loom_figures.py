"""Design figures against the published tables and against themselves."""

import math

import pytest

from loomfmu.cosim.scenes import scene as scenes
from loomfmu.design import loom
from loomfmu.errors import LoomfmuError
from loomfmu.machines import HEADS, MACHINES

RPM = loom.RPM


@pytest.mark.parametrize("machine", list(MACHINES))
def test_speed_scales_with_length_factor_and_mass(machine):
    """n ~ 1/mu and n ~ m^-1/2 follow from (9), whatever the linkage. Rounding of the minimum only: 1e-12."""
    base = loom.safe_speed(machine, length_factor=0.8).speed
    assert loom.safe_speed(machine, length_factor=1.0).speed == pytest.approx(0.8 * base, rel=1e-12)
    heavy = loom.safe_speed(machine, length_factor=0.8, mass=4 * float(HEADS["G6300 left"]["mass_g"]) / 1e3)
    assert heavy.speed == pytest.approx(base / 2, rel=1e-12)


def test_inverse_problems_return_what_gives_the_speed():
    speed = 650 * RPM
    clearance = loom.clearance_for(speed, "WL680-3600")
    mass = loom.mass_for(speed, "WL680-3600")
    stiffness = loom.stiffness_for(speed, "WL680-3600")
    # brentq stops at 1e-12 of the unknown; the speed depends on it with a slope of order 1
    assert loom.safe_speed("WL680-3600", clearance=clearance).speed == pytest.approx(speed, rel=1e-9)
    assert loom.safe_speed("WL680-3600", mass=mass).speed == pytest.approx(speed, rel=1e-9)
    assert loom.safe_speed("WL680-3600", stiffness=stiffness).speed == pytest.approx(speed, rel=1e-9)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: loom.clearance_for(1000 * RPM, "WL680-3600"),
         r"no guide clearance gives 1000 rev/min: .* 779\.\d+ to 545\.\d+"),
        (lambda: loom.clearance_for("540 rpm", "WL680-3600"),
         r"the belt is safe at 540 rev/min with any guide clearance from 0 mm to 0\.8 mm"),
        (lambda: loom.clearance_for("600 rpm", "WL680-3600", length_factor=0.8),
         "length_factor cannot be set"),
        (lambda: loom.mass_for("600 rpm", "WL680-3600", mass=0.1),
         "mass cannot be set: the function solves for the mass"),
        (lambda: loom.mass_for("-650 rpm", "WL680-3600"), "speed = -650 rev/min is outside"),
        (lambda: loom.mass_for("9000 rpm", "WL680-3600"),
         "no head mass gives 9000 rev/min: between 1 g and 10000"),
        (lambda: loom.mass_for("600 rpm", "WL680-3600", mas=0.1), "mas is unknown; did you mean 'mass'?"),
        (lambda: loom.safe_speed("WL680-3600", clearance="0.5 mm", length_factor=0.8),
         "give either clearance or length_factor"),
        (lambda: loom.safe_speed("WL680-3600", tension=5000.0),
         "WL680-3600: a weft tension of 5000 N buckles the belt at any speed"),
        (lambda: loom.safe_speed("WL680-360"), "there is no machine 'WL680-360'; did you mean 'WL680-3600'"),
        *((lambda name=name: loom.safe_speed(name), "there is no machine") for name in (3, None, ["a"])),
        *((lambda name=name: loom.safe_speed("WL680-3600", name), "there is no head") for name in (3, ["a"])),
    ],
)  # fmt: skip
def test_what_cannot_be_had_is_refused(call, said):
    with pytest.raises(LoomfmuError, match=f"^{said}"):
        call()


def test_productivity():
    rate = loom.weft_insertion_rate(3.6, 600 * RPM)
    assert rate == pytest.approx(36.0, rel=1e-12)  # 3.6 m ten times a second
    assert loom.productivity_coefficient(3.6, 600 * RPM) == pytest.approx(36.0 / math.sqrt(3.6), rel=1e-12)


def test_spare_part_cost():
    assert loom.spare_part_cost(9.0, 100.0, 2.0, 0.5) == pytest.approx(106.0, rel=1e-12)
    assert loom.spare_part_cost(0.0) == 59.8  # the constants of an air-jet loom, US dollars
    # 3.3 exp(1.22 ln 10) by hand: 10^1.22 = 16.595869
    assert loom.spare_part_cost(10.0) == pytest.approx(59.8 + 3.3 * 16.595869, abs=1e-5)
    for years in (-1.0, math.nan):
        with pytest.raises(LoomfmuError, match=r"years = .* must be 0 or more"):
            loom.spare_part_cost(years)


# ---- quantities


def test_quantities_are_given_in_si_or_with_units():
    # the units' factors are not exact in binary: rounding
    assert loom.safe_speed("WL680-3600", clearance="0.5 mm", mass="120 g", tension="50 cN").speed == (
        pytest.approx(
            loom.safe_speed("WL680-3600", clearance=0.5e-3, mass=0.12, tension=0.5).speed, rel=1e-12
        )
    )
    assert loom.clearance_for("650 rpm", "WL680-3600") == pytest.approx(
        loom.clearance_for(650 * RPM, "WL680-3600"), rel=1e-12
    )
    assert loom.weft_insertion_rate("360 cm", "600 rpm") == pytest.approx(36.0, rel=1e-12)


@pytest.mark.parametrize(
    ("given", "variable"),
    [
        ({"clearance": "90 mm"}, "guide_clearance"),
        ({"clearance": -3.0}, "guide_clearance"),
        ({"mass": -3.0}, "head_mass"),
        ({"stiffness": 0.0}, "bending_stiffness"),
        ({"stiffness": math.nan}, "bending_stiffness"),
        ({"tension": "2000 kN"}, "yarn_tension"),
        ({"length_factor": 3}, "prescribed_length_factor"),
        ({"clearance": "0.5 s"}, "guide_clearance"),
        ({"mass": [1]}, "head_mass"),
    ],
)
def test_limits_and_messages_are_those_of_a_scene(given, variable):
    ((name, value),) = given.items()
    with pytest.raises(LoomfmuError) as in_scene:
        scenes.parse("[belt]", overrides={f"belt.{variable}": value})
    with pytest.raises(LoomfmuError) as in_design:
        loom.safe_speed("WL680-3600", **given)
    assert str(in_design.value) == str(in_scene.value).replace(f"belt.{variable}", name)
