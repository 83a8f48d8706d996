"""Derivatives of claims and signals beside differences of runs, components with memory included."""

from pathlib import Path

import numpy as np
import pytest

from loomfmu import LoomfmuError, gradient
from loomfmu.cosim.prepared import Prepared
from loomfmu.studies.gradient import move_of, number_of
from loomfmu.sweeps.varied import varied

SIMS = Path(__file__).parents[2] / "sims"
STEP = 1e-4  # of a value, either way
# of a derivative: a central difference is off by the square of its step times the curvature
SMOOTH = 5e-6
STARTING = 2e-4  # where the ramp moves the extreme in time: rounding moves the place at which it is found

SAFE = "the loom runs below its safe speed"
STOPS = "the stops withstand the carrier"
SCENES = {
    "belt": (
        "wl680_3600",
        [SAFE, "belt.lowest_margin"],
        {"shaft.speed": 63.0, "belt.guide_clearance": 4e-4, "belt.yarn_tension": 3.0},
    ),
    "damper": ("wl680_3600", [STOPS], {"shaft.speed": 62.8, "damper_1.spring_stiffness": 11e3}),
    "carrier on springs": (
        "damper",
        ["the peak load of the sprung carrier stays low"],
        {"shaft.speed": 60.0},
    ),
    "mean, angle": (
        "yarn_tension",
        ["mean belt.margin", "lowest belt.margin", "belt.axial_force at 130 deg"],
        {"belt.yarn_tension": 9.0},
    ),
    "weft tension": (
        "weft_tension",
        ["yarn.highest_tension", "yarn.highest_snatch", "belt.lowest_margin"],
        {"shaft.speed": 62.0, "yarn.linear_density": 3.1e-5, "yarn.brake_force": 0.21},
    ),
    "start from rest": (
        "start_up",
        ["belt.lowest_margin"],
        {"shaft.speed": 68.0, "shaft.ramp_duration": 0.5},
    ),
    "belt in motion": (
        "belt_motion",
        ["the belt stays within the 2 mm that the source allows, up to the transfer"],
        {"belt_motion.belt_mass": 0.05, "belt_motion.bow": 3e-4, "shaft.speed": 62.0},
    ),
}


@pytest.mark.parametrize("case", SCENES)
def test_derivatives_are_those_that_differences_of_runs_approach(case):
    name, of, values = SCENES[case]
    scene = SIMS / f"{name}.toml"
    with Prepared(scene, None, "native", (), [each for each in of if " " not in each or "." in each]) as loom:
        claims = [each.get("name") for each in loom.scene.claims]
        measures = [each for each in of if each not in claims]
        si = {key: varied(loom.scene, key).setting(value) for key, value in values.items()}
        found = gradient(scene, of=of, by=list(values), set=si)

        def numbers(changed):
            run = loom.evaluate(si | changed, errors="none")
            return [
                number_of(run.claims[claims.index(each)])
                if each in claims
                else run.measured[measures.index(each)].worst
                for each in of
            ]

        near = STARTING if name == "start_up" else SMOOTH
        assert found.numbers == tuple(numbers({}))
        for column, (key, value) in enumerate(si.items()):
            step = STEP * value
            ends = [numbers({key: type(value)(value + side * step)}) for side in (1.0, -1.0)]
            differences = [(after - before) / (2.0 * step) for after, before in zip(*ends, strict=True)]
            # rounding of the numbers is the rest of a difference
            scale = [1e-12 * abs(number) / step for number in found.numbers]
            for got, wanted, rounding in zip(found.si[:, column], differences, scale, strict=True):
                assert got == pytest.approx(wanted, rel=near, abs=rounding)


def test_at_a_kink_the_derivative_is_that_towards_greater_values():
    with Prepared(SIMS / "wl680_3600.toml", None, "native", ("belt.margin",), ()) as loom:
        found = loom.derived({}, [move_of(loom.scene, varied(loom.scene, "shaft.speed"))])
    (direction,), here = found.directions, found.recording["belt.margin"]

    def folded(trace):
        kink = np.abs(trace["belt.margin"] - here)
        return np.stack([kink, -kink])

    smooth = direction.slope(lambda trace: trace["belt.margin"])
    # samples move by 8e-6 of the largest, so that rounding of them counts by 1e-11 of the largest slope
    near = 1e-9 * np.max(np.abs(smooth))
    np.testing.assert_allclose(direction.slope(folded), [np.abs(smooth), -np.abs(smooth)], atol=near)
    assert np.count_nonzero(smooth) > 100


def test_an_extreme_that_is_held_has_a_derivative_though_its_moved_samples_rise_and_fall():
    found = gradient(SIMS / "wl680_3600.toml", of="belt.lowest_margin", by="belt.yarn_tension")
    assert found.si[0, 0] == pytest.approx(0.0, abs=1e-9)  # the head turns there; after that no weft pushes


def test_it_shows_a_table_with_the_units_that_people_read():
    found = gradient(SIMS / "wl680_3600.toml", of=["belt.lowest_margin", SAFE], by=["shaft.speed"])
    assert found.units == (("1/(rev/min)",), ("rev/min/(rev/min)",))
    assert found.values[1, 0] == pytest.approx(-1.0, abs=1e-9)  # its bound is the speed
    assert "by shaft.speed" in repr(found) and "1/(rev/min)" in found._repr_html_()


def test_a_claim_whose_samples_alone_show_no_distance_is_refused(tmp_path):
    claim = 'name = "gentle"\nkind = "below"\nsignal = "heald_1.acceleration"\nbound = "300 m/s2"\n'
    path = tmp_path / "gentle.toml"
    path.write_text((SIMS / "wl680_3600.toml").read_text() + f"[[claims]]\n{claim}")
    with pytest.raises(LoomfmuError, match="of 'gentle': its derivative is not known"):
        gradient(path, of="gentle", by="shaft.speed", set={"revolutions": 2})


@pytest.mark.parametrize(
    ("scene", "of", "by", "message"),
    [
        ("wl680_3600", "no", "shaft.speed", "of 'no' is neither a claim nor a signal"),
        ("wl680_3600", SAFE, "shaft.sped", "shaft.sped"),
        ("wl680_3600", SAFE, "dobby.law", "by dobby.law: it is not a real number"),
        ("damper", "the carrier never touches its stops", "shaft.speed", "it counts or decides"),
        ("light_shaft", "weft.travel", "shaft.speed", "closes a loop"),
    ],
)
def test_what_has_no_derivative_is_refused_in_a_line(scene, of, by, message):
    with pytest.raises(LoomfmuError, match=message):
        gradient(SIMS / f"{scene}.toml", of=[of], by=[by])
