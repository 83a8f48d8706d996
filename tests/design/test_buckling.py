"""Length factors fitted to buckling tests, and the speed that a permitted deflection allows."""

import numpy as np
import pytest
from mpmath import ellipe, ellipk, findroot, mpf, workdps
from reference import MP, machine
from scipy.optimize import curve_fit

from loomfmu.design import loom
from loomfmu.design.buckling import fit_length_factor
from loomfmu.errors import LoomfmuError
from loomfmu.machines import table
from loomfmu.physics.belt import LARGEST_BEND, MOST_BENT, bent_load_ratio, elastica_deflection

LENGTHS = [1e-3 * float(row["free_length_mm"]) for row in table("belt_buckling_experiment")]


@pytest.mark.parametrize("row", table("length_factor"), ids=lambda row: row["clearance_mm"])
def test_published_factors(row):
    column = f"c_{row['clearance_mm'] if row['clearance_mm'] != '0.00' else '0'}"
    loads = [float(each[column]) for each in table("belt_buckling_experiment")]
    fit = fit_length_factor(LENGTHS, loads)
    # the source fits by a method that it does not name; its factors are within 2 % of least squares
    assert fit.factor == pytest.approx(float(row["length_factor"]), rel=0.02)
    # another method: scipy's Levenberg-Marquardt on mu itself, with its own covariance
    found, spread = curve_fit(
        lambda length, mu: np.pi**2 * 0.25 / (mu * length) ** 2, LENGTHS, loads, p0=[0.9]
    )
    assert fit.factor == pytest.approx(found[0], rel=1e-6)  # its tolerance
    # its covariance leaves out the curvature in mu, which counts by the residuals over the loads: 2 %
    assert fit.standard_error == pytest.approx(np.sqrt(spread[0, 0]), rel=0.02)


def test_exact_loads_give_the_factor_back():
    loads = np.pi**2 * 0.31 / (0.777 * np.array(LENGTHS)) ** 2
    fit = fit_length_factor(LENGTHS, loads, stiffness=0.31)
    assert fit.factor == pytest.approx(0.777, rel=1e-15)  # rounding
    assert fit.standard_error < 1e-15
    assert max(map(abs, fit.residuals)) < 1e-13


@pytest.mark.parametrize(
    ("lengths", "loads", "message"),
    [
        ([0.4], [29], "1 lengths and 1 loads: give as many of each, and at least two"),
        ([0.4, 0.5], [29], "2 lengths and 1 loads"),
        ([0.4, -0.5], [29, 20], r"lengths\[1\] = -0.5 m must be positive and finite"),
        ([0.4, 0.5], [29, float("nan")], r"loads\[1\]"),
        ([414, 514, 665], [22, 15, 9], r"length_factor = 0\.000801362 is outside \[0\.1, 2\]"),  # in mm
    ],
)
def test_tests_that_say_nothing_are_refused(lengths, loads, message):
    with pytest.raises(LoomfmuError, match=message):
        fit_length_factor(lengths, loads)


# Deflection


def test_constants_of_the_most_bent_column():
    with workdps(50):
        k = findroot(
            lambda k: 2 * ellipk(k * k) * (1 - k * k) - ellipe(k * k),
            (mpf("0.82"), mpf("0.85")),
            solver="anderson",
        )
        assert pytest.approx(float(k.real), abs=1e-15) == MOST_BENT
        assert pytest.approx(float((k / ellipk(k * k)).real), abs=1e-15) == LARGEST_BEND


@pytest.mark.parametrize("bend", [1e-6, 1e-3, 0.0115, 0.1, 0.3, 0.4])
def test_load_of_a_deflection_to_fifty_digits(bend):
    with workdps(50):
        k = findroot(lambda k: k - mpf(bend) * ellipk(k * k), (mpf(bend), mpf(2 * bend)), solver="secant")
        expected = float(((2 / MP.pi * ellipk(k * k)) ** 2).real)
    assert bent_load_ratio(bend) == pytest.approx(expected, rel=1e-14)  # 60 halvings, then rounding
    # near the critical load the deflection goes with the root of what the load exceeds it by
    assert elastica_deflection(expected, 1.0) == pytest.approx(bend, rel=1e-15 / bend**2 + 1e-12)


def test_no_deflection_and_one_out_of_reach():
    assert bent_load_ratio(0.0) == 1.0
    assert bent_load_ratio(0.4032) == np.inf
    assert bent_load_ratio(0.4031) < 1.75


@pytest.mark.parametrize(("name", "bow"), [("WL680-3600", 2e-3), ("WL680-3600", 0.032), ("WL450-5400", 0.2)])
def test_speed_for_a_deflection_against_the_component_s_elastica(name, bow):
    # another way: the deflection at a speed, largest over the window, on a fine grid of fifty-digit travels
    of = machine(name)
    angles = np.linspace(float(of.free_start()) + 1e-5, float(of.push_end()), 400)
    motion = [tuple(map(float, of.travel(angle))) for angle in angles]

    def largest(speed):
        found = 0.0
        for travel, _first, second in motion:
            length = travel - float(of.guide)
            load = float(of.mass) * second * speed**2 * (0.8 * length) ** 2 / (np.pi**2 * 0.25)
            found = max(found, elastica_deflection(load, length))
        return found

    speed = loom.safe_speed(name, length_factor=0.8, deflection=bow).speed
    # the grid's worst place is off by up to 1/800 of the window, the speed there by about the square of that
    assert largest(speed * (1 - 1e-5)) <= bow
    assert largest(speed * (1 + 1e-4)) >= bow


def test_a_deflection_beyond_the_belt_is_refused():
    with pytest.raises(
        LoomfmuError, match="deflection = 150 mm: the belt of WL680-3600 is too short to bend more than 105"
    ):
        loom.safe_speed("WL680-3600", deflection="150 mm")


def test_no_deflection_changes_no_bit():
    of = [loom.safe_speed("WL800-3800", tension=3.0, **more).speed for more in ({}, {"deflection": 0.0})]
    assert of[0] == of[1]
