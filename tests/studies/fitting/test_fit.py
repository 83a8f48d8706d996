"""Fits: known values found again, intervals that cover them, published tests, what is refused."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import loomfmu
from loomfmu import LoomfmuError, fit
from loomfmu.cli import main
from loomfmu.design.buckling import fit_length_factor
from loomfmu.machines import table

SIMS = Path(__file__).parents[3] / "sims"
HEADING = "time [s],belt.critical_force [N]"
# a belt whose free length is as many metres as the time is seconds
BELT = """
step = 0.01
duration = 1
[belt]
component = "BeltMonitor"
prescribe_length_factor = true
head_length = 0.0
idle_travel = 0.0
[inputs]
"belt.travel" = [[0.0, 0.0], [1.0, 1.0]]
"""
BENT = np.pi**2 * 0.25  # N m2, of which a length factor makes loads


def written(folder: Path, rows: list[tuple[Any, ...]], heading: str = HEADING) -> tuple[Path, Path]:
    """A scene of a belt and a measurement of it."""
    scene, data = folder / "belt.toml", folder / "data.csv"
    scene.write_text(BELT)
    with data.open("w", newline="") as file:
        file.write(f"# measured somewhere\n{heading}\n")
        csv.writer(file).writerows(rows)
    return scene, data


def test_published_buckling_tests_give_the_length_factor_of_the_closed_form(tmp_path: Path) -> None:
    """Zhu 2021, Tables 2 and 3: the fit over runs is that of `design.fit_length_factor` over the equation."""
    tests = [
        (float(row["free_length_mm"]) / 1e3, float(row["c_0.30"]))
        for row in table("belt_buckling_experiment")
    ]
    scene, data = written(tmp_path, tests)
    found = fit(scene, data, vary="belt.prescribed_length_factor=0.5..2")
    closed = fit_length_factor(*zip(*tests, strict=True))
    (factor,) = found.parameters
    # lengths lie between samples 10 mm apart: the cubic through 1 / l^2 is off by less than 1e-6
    assert factor.value == pytest.approx(closed.factor, rel=1e-6)
    assert factor.value == pytest.approx(0.80, abs=0.005)  # as printed
    # a linear model of the factor around the result against one of its inverse square: alike to first order
    half = (factor.high - factor.low) / 2.0
    assert half == pytest.approx(
        4.302653 * closed.standard_error, rel=1e-3
    )  # Student's t, 2 degrees of freedom
    assert found.curves[0].rms == pytest.approx(np.sqrt(np.mean(np.square(closed.residuals))), rel=1e-5)


def test_values_that_made_the_data_are_found_again(tmp_path: Path) -> None:
    """A damper in a whole loom, over the shaft angle of the last revolution, in display units."""
    made = {"damper_1.spring_stiffness": "7.1 N/mm", "damper_1.damping_ratio": 0.12}
    fixed = {"damper_1.free_travel": "300 mm", "steps_per_revolution": 360, "revolutions": 2}
    run = loomfmu.evaluate(SIMS / "wl680_3600.toml", set=fixed | made, values=["damper_1.displacement"]).trace
    last = slice(360, None)
    degrees, values = np.degrees(run.shaft_angle[last]) - 360.0, run["damper_1.displacement"][last]
    rows = [(a, 1e3 * v) for a, v in zip(degrees, values, strict=True)]
    data = written(tmp_path, rows, "shaft_angle [deg],damper_1.displacement [mm]")[1]
    vary = ["damper_1.spring_stiffness=1N/mm..20N/mm", "damper_1.damping_ratio=0..0.5"]
    found = fit(SIMS / "wl680_3600.toml", data, vary=vary, set=fixed)
    # 3-point slopes of shares of the ranges leave 1e-10 of them
    assert [each.value for each in found.parameters] == pytest.approx([7100.0, 0.12], rel=1e-9)
    assert found.curves[0].rms < 1e-12
    assert loomfmu.evaluate(SIMS / "wl680_3600.toml", set=fixed | found.values)


@pytest.mark.no_cover
def test_intervals_cover_the_truth_as_often_as_they_say(tmp_path: Path) -> None:
    random = np.random.default_rng(2026)
    lengths = np.linspace(0.3, 0.9, 25)
    covered, tries = 0, 200
    for _try in range(tries):
        loads = BENT / (0.8 * lengths) ** 2 + random.normal(0.0, 0.5, len(lengths))
        scene, data = written(tmp_path, list(zip(lengths, loads, strict=True)))
        (found,) = fit(scene, data, vary="belt.prescribed_length_factor=0.5..2").parameters
        covered += found.low <= 0.8 <= found.high
    # 190 are expected; binomial with p = 0.95 leaves 180 to 198 in all but 1 of 500 draws
    assert 180 <= covered <= 198


def test_several_signals_are_weighed_by_their_own_noise(tmp_path: Path) -> None:
    random = np.random.default_rng(7)
    lengths = np.linspace(0.3, 0.9, 61)
    loads = BENT / (0.8 * lengths) ** 2 + random.normal(0.0, 0.01, 61)
    lying = 1e3 * lengths * 1.05 + random.normal(0.0, 50.0, 61)  # mm: 5 % too long
    rows = list(zip(lengths, loads, lying, strict=True))
    scene, data = written(tmp_path, rows, f"{HEADING},belt.free_length [mm]")
    vary = ["belt.prescribed_length_factor=0.5..2", "belt.idle_travel=0mm..100mm"]
    factor, idle = fit(scene, data, vary=vary).parameters
    assert factor.low < 0.8 < factor.high and factor.high - factor.low < 1e-3
    # what the lying lengths ask for, -30 mm, counts little against the exact loads
    assert idle.low < 0.0 < idle.high < 1e-3


@pytest.mark.slow
def test_intervals_cover_with_two_signals_of_different_size(tmp_path: Path) -> None:
    """The smaller signal has 12 values, two of whose degrees of freedom the parameters may take."""
    random = np.random.default_rng(11)
    lengths = np.linspace(0.3, 0.9, 60)
    few = np.arange(60) % 5 == 2
    covered, tries = np.zeros(2), 100
    for _try in range(tries):
        loads = BENT / (0.8 * (lengths - 0.02)) ** 2 + random.normal(0.0, 0.5, 60)
        free = 1e3 * (lengths - 0.02) + random.normal(0.0, 2.0, 60)
        rows = [(a, b, c if here else "") for a, b, c, here in zip(lengths, loads, free, few, strict=True)]
        vary = ["belt.prescribed_length_factor=0.5..2", "belt.idle_travel=0mm..100mm"]
        found = fit(*written(tmp_path, rows, f"{HEADING},belt.free_length [mm]"), vary=vary).parameters
        covered += [each.low <= true <= each.high for each, true in zip(found, (0.8, 0.02), strict=True)]
    # 95 are expected; binomial with p = 0.95 leaves 88 or more in all but 1 of 500 draws, and the noise of
    # twelve values, known to a fifth, costs some
    assert np.all(covered >= 86)


def test_the_scene_with_the_fitted_values_runs_and_keeps_its_comments(tmp_path: Path) -> None:
    rows = [(length, BENT / (0.83 * length) ** 2) for length in (0.4, 0.5, 0.6)]
    scene, data = written(tmp_path, rows)
    scene.write_text(BELT.replace("[belt]", "[belt] # the new one"))
    found = fit(scene, data, vary="belt.prescribed_length_factor=0.5..2")
    path = found.write(tmp_path / "fitted.toml")
    assert "[belt] # the new one" in path.read_text()
    assert f"{found.scene.file.name} with " in path.read_text() and "fitted to data.csv." in path.read_text()
    again = loomfmu.prepare(path).scene.instances["belt"].effective()["prescribed_length_factor"]
    assert again == found.parameters[0].value
    assert scene.read_text() == BELT.replace("[belt]", "[belt] # the new one")


def test_warnings_of_the_scene_and_of_ranges_are_printed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, data = written(tmp_path, [(0.1 * k, BENT / (0.1 * k) ** 2) for k in range(1, 9)])
    with scene.open("a") as file:
        file.write('[drive]\ncomponent = "WeftInsertion"\nfollow_shaft = true\nspeed = "300 rpm"\n')
    assert main(["fit", str(scene), str(data), "--vary", "belt.prescribed_length_factor=0.5..2"]) == 0
    assert "warning: drive.speed has no effect: set drive.follow_shaft = false" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("vary", "said"),
    [
        (["belt.head_mass=0.1kg..0.2kg"], "belt.head_mass changes none of the measured signals"),
        (["belt.bending_stiffness=0.1..0.4", "belt.prescribed_length_factor=0.5..2"],
         "cannot tell belt.bending_stiffness and belt.prescribed_length_factor apart"),
        (["belt.prescribed_length_factor=2..0.5"], "is empty"),
        (["belt.prescribed_length_factor=0.5..2", "belt.prescribed_length_factor=0.5..2"], "is varied twice"),
        (["belt.length_faktor=0.5..2"], "length_factor"),
        ([], "name at least one parameter"),
    ],
)  # fmt: skip
def test_what_cannot_be_fitted_is_refused(tmp_path: Path, vary: list[str], said: str) -> None:
    rows = [(length, BENT / (0.8 * length) ** 2 + 0.1 * length) for length in np.linspace(0.3, 0.9, 9)]
    scene, data = written(tmp_path, rows)
    with pytest.raises(LoomfmuError, match=said):
        fit(scene, data, vary=vary)


def test_too_few_values_and_places_outside_of_the_run_are_refused(tmp_path: Path) -> None:
    vary = "belt.prescribed_length_factor=0.5..2"
    with pytest.raises(LoomfmuError, match="1 value cannot determine 1 parameter with"):
        fit(*written(tmp_path, [(0.4, 20.0)]), vary=vary)
    with pytest.raises(LoomfmuError, match=r"measured from 0\.4 to 1\.4 s, but the run goes from 0 to 1 s"):
        fit(*written(tmp_path, [(0.4, 20.0), (1.4, 5.0)]), vary=vary)
    rows = [(a, BENT / (0.8 * a) ** 2, 1e3 * a if a < 0.5 else "") for a in np.linspace(0.3, 0.9, 25)]
    with pytest.raises(LoomfmuError, match=r"belt\.free_length has 8 values, but .* at least 11"):
        fit(*written(tmp_path, rows, f"{HEADING},belt.free_length [mm]"), vary=vary)
    angles = written(tmp_path, [(10.0, 20.0), (20.0, 5.0)], "shaft_angle [deg],belt.critical_force [N]")
    with pytest.raises(LoomfmuError, match="no shaft turns in this scene"):
        fit(*angles, vary=vary)


def test_coarse_steps_are_noted(tmp_path: Path) -> None:
    rows = [(length, BENT / (0.8 * length) ** 2) for length in np.linspace(0.305, 0.895, 20)]
    scene, data = written(tmp_path, rows)
    scene.write_text(BELT.replace("step = 0.01", "step = 0.1"))
    found = fit(scene, data, vary="belt.prescribed_length_factor=0.5..2")
    assert "interpolation is off by" in found.notes[0] and found.notes[0].endswith("take more steps")


def test_the_command_prints_and_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = [(length, BENT / (0.8 * length) ** 2 + 0.1 * length) for length in np.linspace(0.3, 0.9, 25)]
    scene, data = written(tmp_path, rows)
    words = ["fit", str(scene), str(data), "--vary", "belt.prescribed_length_factor=0.5..2"]
    outputs = ["--output", str(tmp_path / "fitted.toml"), "--picture", str(tmp_path / "fit.svg")]
    assert main([*words, *outputs]) == 0
    said = capsys.readouterr().out
    assert "belt.prescribed_length_factor" in said and "rms over 25 values" in said
    assert (tmp_path / "fit.svg").read_text().startswith("<?xml")
    assert main([*words, "--output", str(scene)]) == 2
    assert "is an input of this command" in capsys.readouterr().err
    assert main([*words, "--output", str(tmp_path / "fitted.txt")]) == 2
    assert "a scene is written as .toml" in capsys.readouterr().err


def test_an_accuracy_is_refused(tmp_path: Path) -> None:
    data = tmp_path / "data.csv"
    data.write_text("shaft_angle [deg],damper_1.spring_force [N]\n10,1\n20,2\n30,3\n")
    scene = Path(__file__).parents[3] / "sims" / "wl680_3600.toml"
    with pytest.raises(
        LoomfmuError, match=r"accuracy = 0\.001 chooses steps by .*; set steps_per_revolution"
    ):
        fit(scene, data, vary="damper_1.stiffness=500N/m..2kN/m", set={"accuracy": 1e-3})
