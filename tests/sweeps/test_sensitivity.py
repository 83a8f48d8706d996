"""Sensitivity: indices against their closed forms, what is written and printed, what is refused."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from sweep_files import sweep_file, swept

from loomfmu import LoomfmuError, evaluate, sweep
from loomfmu.cli import main

# 1 - margin = mass speed^2 / stiffness, times what stays: a product of powers of independent values
RANGES = """
"belt.head_mass" = ["90 g", "130 g"]
"shaft.speed" = ["500 rpm", "700 rpm"]
"belt.bending_stiffness" = [0.2, 0.3]
"""
POWERS = {
    "belt.head_mass": (90.0, 130.0, 1),
    "shaft.speed": (500.0, 700.0, 2),
    "belt.bending_stiffness": (0.2, 0.3, -1),
}
WANTED = '[sensitivity]\nmethod = "{method}"\nsamples = {samples}\nseed = 3\noutputs = ["claim_1.distance"]\n'


def test_indices_of_sobol_are_those_of_the_product() -> None:
    found = swept(WANTED.format(method="sobol", samples=256) + RANGES)
    assert found.rows == 256 * 5 and not found.traces
    means, squares = [], []
    for low, high, power in POWERS.values():
        x = np.linspace(low, high, 100001)
        means.append(float(np.mean(x**power)))
        squares.append(float(np.mean(x ** (2 * power))))
    variance = math.prod(squares) - math.prod(means) ** 2
    assert found.sensitivity is not None
    (influence,) = found.sensitivity.outputs
    for place in range(3):
        own = squares[place] - means[place] ** 2
        others = [each for each in range(3) if each != place]
        first = own * math.prod(means[each] ** 2 for each in others) / variance
        total = own * math.prod(squares[each] for each in others) / variance
        # the estimate's own 95 % interval; a seed that is fixed cannot fail by chance
        assert abs(influence.indices["S1"][place] - first) <= influence.indices["S1_conf"][place]
        assert abs(influence.indices["ST"][place] - total) <= influence.indices["ST_conf"][place]
        assert influence.indices["ST_conf"][place] < 0.1
    assert found.sensitivity.brief[0][1].startswith("shaft.speed 0.")
    files = "sensitivity.csv sensitivity.png sweep.json table.parquet"
    assert sorted(each.name for each in Path("out").iterdir()) == files.split()


def test_mean_changes_of_morris_are_those_of_the_product() -> None:
    found = swept(WANTED.format(method="morris", samples=100) + RANGES)
    assert found.rows == 100 * 4
    assert found.sensitivity is not None
    (influence,) = found.sensitivity.outputs
    grids = {key: np.linspace(low, high, 4) ** power for key, (low, high, power) in POWERS.items()}
    # what stays: the margin at the scene's own values

    own = 1.0 - evaluate(Path("scene.toml")).claims[0].worst
    mass, speed, stiffness = 110.5, 600.0, 0.25
    stays = own * stiffness / (mass * speed**2)
    for place, (key, values) in enumerate(grids.items()):
        change = 0.75 * (values[2] + values[3] - values[0] - values[1])  # mean of two steps of 2/3, per range
        others = math.prod(float(np.mean(grid)) for other, grid in grids.items() if other != key)
        expected = -stays * change * others
        spread = influence.indices["sigma"][place] / math.sqrt(100)
        assert influence.indices["mu"][place] == pytest.approx(expected, abs=4.0 * spread)
        assert influence.indices["mu_star"][place] == pytest.approx(abs(expected), abs=4.0 * spread)


def test_the_command_prints_what_matters_and_what_does_not(capsys: pytest.CaptureFixture[str]) -> None:
    text = '[sensitivity]\nmethod = "morris"\nsamples = 8\n"shaft.speed" = ["500 rpm", "600 rpm"]\n'
    path = sweep_file(text + '"weft.moving_mass" = ["90 g", "120 g"]\n')
    for _again in range(2):  # from the rows that are there
        assert main(["sweep", str(path), "--processes", "1"]) == 0
    said = capsys.readouterr().out
    assert "belt.lowest_speed_limit: depends on none of them" in said
    assert "distance of the belt does not buckle" in said and "shaft.speed 0." in said
    assert "weft.moving_mass changes none of these outputs." in said
    assert "mu_star: mean change over its range, with its 95 % interval" in said
    with Path("results/swept/sensitivity.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["range"] for row in rows[:2]] == ["shaft.speed", "weft.moving_mass"]
    assert rows[0]["note"] == "depends on none of them" and rows[2]["mu_star"] != ""


def test_an_output_without_a_value_in_some_rows_says_so() -> None:
    scene = (
        'title = "x"\nrevolutions = 2\nsteps_per_revolution = 90\n[loom]\nmachine = "WL680-3600"\n'
        'head = "G6300 left"\nweave = "10/01"\n[[claims]]\nkind = "clear_shed"\nheald = "heald_1"\n'
        'clearance = "6 mm"\nat_least = "90 deg"\n'
    )
    text = '[sensitivity]\nmethod = "morris"\nsamples = 8\n"heald.stroke" = ["10 mm", "98 mm"]\n'
    ranges = '"dobby.speed_reduction" = [0.4, 0.6]\n'
    found = swept(text + ranges, scene=scene, head='scene = "scene.toml"\n')
    assert found.sensitivity is not None and found.errors > 0
    assert f"no indices: no value in {found.errors} of 24 rows" == found.sensitivity.outputs[0].note


SPEEDS = '"shaft.speed" = ["500 rpm", "600 rpm"]'


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"method = 'sobel'\nsamples = 8{RANGES}",
         "sensitivity.method = 'sobel' is unknown; did you mean 'sobol'?"),
        (f"samples = 100{RANGES}", "sensitivity.samples = 100 must be a power of 2 for sobol, such as 128"),
        (f"method = 'morris'{RANGES}", "sensitivity.samples is missing"),
        (f"samples = 8\noutputs = ['claim_7.distance']{RANGES}",
         "'claim_7.distance' is not a column of results"),
        (f"samples = 8\noutputs = []{RANGES}", "is not a list such as"),
        (f"samples = 8\nmethods = 'sobol'{RANGES}", "'methods' cannot be set"),
        (f"samples = 8\n{SPEEDS}", "sensitivity needs two ranges or more"),
        (f"samples = 8{RANGES}[grid]\n'belt.guide_clearance' = ['0.2 mm']",
         "[sensitivity] chooses the rows itself; leave out [grid]"),
        ('samples = 8\n"shaft.speed" = ["600 rpm", "500 rpm"]',
         "sensitivity.shaft.speed: 600 rev/min is not below 500 rev/min"),
        ('samples = 8\n"dobby.law" = ["uniform", "table"]', "has no instance 'dobby'"),
    ],
)  # fmt: skip
def test_what_is_refused(text: str, said: str) -> None:
    with pytest.raises(LoomfmuError) as caught:
        sweep(sweep_file(f"[sensitivity]\n{text}"))
    assert said in str(caught.value) and str(caught.value).startswith("swept.toml: ")
