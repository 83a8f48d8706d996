"""Looms drawn from distributions: closed forms, exact intervals, values measured together, refusals."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scene_texts import SAFE, claim, loom, table
from scipy import stats

from loomfmu import LoomfmuError, draw_looms, tolerances
from loomfmu.cli import main
from loomfmu.cosim.scenes.scene import Scene, parse
from loomfmu.design import loom as design
from loomfmu.studies.tolerances.distributions import distribution_of
from loomfmu.studies.tolerances.draw import _values
from loomfmu.studies.tolerances.shares import Share, rows

TEXT = "revolutions = 1\nsteps_per_revolution = 90\n" + loom(
    table("shaft", speed="600 rev/min"), SAFE, claim("lowest_margin", bound=0.1)
)
CLEARANCE = '"belt.guide_clearance" = {}'


def scene(*tolerances: str, folder: Path = Path()) -> Scene:
    return parse(TEXT + "[tolerances]\n" + "\n".join(tolerances), "loom", {}, folder)


def test_the_share_is_that_of_the_closed_form() -> None:
    safe = design.safe_speed("WL680-3600", clearance=0.3e-3).speed  # of the scene's belt
    found = draw_looms(scene('"shaft.speed" = ["600 rpm", "800 rpm"]'), looms=200, seed=4)
    # the scene's clearance is that of a new belt, 0.3 mm; its limit of speed is constant
    speeds = found.values["shaft.speed"]
    counted = int(np.sum(speeds <= safe)), int(np.sum(speeds <= safe * math.sqrt(0.9)))
    assert [each.holding + each.undecided for each in found.claims] == pytest.approx(counted, abs=1)
    assert found.claims[0].undecided <= 1 and found.all.holding == min(each.holding for each in found.claims)
    true = (safe * math.sqrt(0.9) - 600.0 * math.pi / 30.0) / (200.0 * math.pi / 30.0)
    assert found.all.low <= true <= found.all.high
    assert not found and np.array_equal(
        found.values["shaft.speed"],
        draw_looms(scene('"shaft.speed" = ["600 rpm", "800 rpm"]'), looms=200, seed=4).values["shaft.speed"],
    )


@given(st.integers(1, 400).flatmap(lambda of: st.tuples(st.integers(0, of), st.just(of))))
def test_ends_of_the_interval_are_where_such_a_count_has_a_probability_of_a_fortieth(
    count: tuple[int, int],
) -> None:
    holding, of = count
    share = Share("c", holding, 0, of)
    assert share.low <= share.share <= share.high
    # roots of a polynomial of degree up to 400, found to a relative 1e-12 or so in the share
    if holding:
        assert stats.binom.sf(holding - 1, of, share.low) == pytest.approx(0.025, rel=1e-6)
    if holding < of:
        assert stats.binom.cdf(holding, of, share.high) == pytest.approx(0.025, rel=1e-6)


def test_undecided_looms_widen_the_interval() -> None:
    sure, open_ = Share("c", 90, 0, 100), Share("c", 90, 5, 100)
    assert open_.low == sure.low and open_.high == Share("c", 95, 0, 100).high > sure.high


@pytest.mark.parametrize(
    ("given", "wanted"),
    [
        ('{ normal = ["0.35 mm", "0.05 mm"] }', stats.norm(0.35e-3, 0.05e-3)),
        ('["0.2 mm", "0.5 mm"]', stats.uniform(0.2e-3, 0.3e-3)),
        ('{ uniform = ["0.2 mm", "0.5 mm"] }', stats.uniform(0.2e-3, 0.3e-3)),
        (
            '{ normal = ["0.3 mm", "0.1 mm"], within = ["0.2 mm", "0.5 mm"] }',
            stats.truncnorm(-1.0, 2.0, 0.3e-3, 0.1e-3),
        ),
    ],
)
def test_values_are_distributed_as_stated(given: str, wanted: Any) -> None:
    stated = scene(CLEARANCE.format(given))
    found = distribution_of(stated, *next(iter(stated.tolerances.items())))
    (values,) = _values([found], 4000, seed=3).values()
    # a right distribution fails this in one of a thousand drawings; the seed is fixed
    assert stats.kstest(values, wanted.cdf).pvalue > 1e-3


def test_measured_values_are_drawn_as_often_as_they_occur_and_row_by_row(tmp_path: Path) -> None:
    (tmp_path / "worn.csv").write_text(
        "# as found in the mill\nbelt.guide_clearance [mm],belt.head_mass [g]\n"
        "0.2,105\n0.3,110\n0.3,111\n0.5,116\n"
    )
    stated = scene(
        CLEARANCE.format('{ measured = "worn.csv" }'),
        '"belt.head_mass" = { measured = "worn.csv" }',
        folder=tmp_path,
    )
    found = draw_looms(stated, looms=40)
    pairs = set(zip(*(np.round(each * 1e6).tolist() for each in found.values.values()), strict=True))
    assert pairs == {(200, 105e3), (300, 110e3), (300, 111e3), (500, 116e3)}
    assert "as 4 values measured in worn.csv, 0.2 mm to 0.5 mm" in found.distributions[0].text
    worst = tolerances(stated)  # between the least and the largest measured value
    assert [(each.low, each.high) for each in worst.spans] == [(0.2e-3, 0.5e-3), (0.105, 0.116)]


def test_a_worst_case_needs_ends() -> None:
    with pytest.raises(LoomfmuError, match=r"is normal without ends, so it has no worst case; add within = "):
        tolerances(scene(CLEARANCE.format('{ normal = ["0.35 mm", "0.02 mm"] }')))
    within = '{ normal = ["0.3 mm", "0.05 mm"], within = ["0.2 mm", "0.4 mm"] }'
    (span,) = tolerances(scene(CLEARANCE.format(within))).spans
    assert (span.low, span.high) == (0.2e-3, 0.4e-3)


@pytest.mark.parametrize(
    ("given", "why"),
    [
        ('{ normal = ["0.35 mm", "0.05 mm"], uniform = [0, 1] }',
         "must be either normal, perhaps within two"),
        ('{ measured = "x.csv", within = [0, 1] }', "must be either normal, perhaps within two ends, or"),
        ('{ normal = ["0.35 mm", "0.05 mm"], withn = [0, 1] }', "has no 'withn'; did you mean 'within'?"),
        ('{ normal = "0.35 mm" }', "normal = '0.35 mm' must be a mean and a standard deviation such as"),
        ('{ measured = ["a.csv"] }', "measured = ['a.csv'] must be the name of a CSV file"),
        ('{ uniform = ["0.5 mm", "0.2 mm"] }', "the range from 0.5 mm to 0.2 mm is empty"),
        ('{ normal = ["0.35 mm", "0 mm"] }', "the standard deviation 0 mm must be positive"),
        ('{ normal = ["0.35 mm", "3 g"] }', "'3 g' is in g, which does not fit m"),
        ('{ normal = ["0.9 mm", "1 mm"], within = ["0.2 mm", "0.5 mm"] }',
         "the mean 0.9 mm is not within 0.2"),
        ('{ measured = "none.csv" }', "none.csv: cannot be read"),
        ('{ measured = "other.csv" }', "it has belt.head_mass, but none is called belt.guide_clearance"),
        ('{ measured = "plain.csv" }',
         "'belt.guide_clearance' has no unit; write it in brackets, such as 'belt.guide_clearance [mm]'"),
        ('{ norml = ["0.35 mm", "0.05 mm"] }', "belt.guide_clearance has no 'norml'; did you mean 'normal'?"),
        ('{ measured = "grams.csv" }', "is in 'g', which does not fit m"),
        ('{ measured = "gap.csv" }', "belt.guide_clearance has no value in some row"),
        ('{ measured = "negative.csv" }', "belt.guide_clearance = -0.3 mm is outside"),
        ('{ normal = ["0.35 mm", "0.3 mm"] }', "loom 10 of 20, with belt.guide_clearance = -"),
    ],
)  # fmt: skip
def test_what_is_not_a_distribution_is_refused_in_one_line(tmp_path: Path, given: str, why: str) -> None:
    for name, heading, row in (
        ("other", "belt.head_mass [g]", "105"),
        ("plain", "belt.guide_clearance", "0.3"),
        ("grams", "belt.guide_clearance [g]", "0.3"),
        ("gap", "belt.guide_clearance [mm],belt.head_mass [g]", ",105"),
        ("negative", "belt.guide_clearance [mm]", "-0.3"),
    ):
        (tmp_path / f"{name}.csv").write_text(f"{heading}\n{row}\n")
    with pytest.raises(LoomfmuError) as error:
        draw_looms(scene(CLEARANCE.format(given), folder=tmp_path), looms=20, seed=1)
    assert why in str(error.value) and "\n" not in str(error.value)


def test_the_command_says_the_shares_and_whether_enough_hold(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "loom.toml"
    path.write_text(TEXT + "[tolerances]\n" + CLEARANCE.format('["0.2 mm", "0.4 mm"]'))
    assert main(["tolerances", str(path), "--looms", "40", "--share", "80 %"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "belt.guide_clearance uniform, 0.2 mm to 0.4 mm" in said
    # 0.025 ** (1 / 40) = 0.9119: of 40 all hold
    assert (
        "All claims hold in 100 % of 40 looms, with 95 % confidence in 91.19 % to 100 % of all;"
        " at least 80 % is shown." in said
    )
    assert main(["tolerances", str(path), "--looms", "40", "--share", "99 %"]) == 1
    assert "at least 99 % is not shown" in capsys.readouterr().out
    assert main(["tolerances", str(path), "--looms", "40"]) == 0
    assert rows(draw_looms(path, looms=2))[1][0] == "safe"
    for wrong, why in (
        (["--share", "80 %"], "add --looms N"),
        (["--looms", "0"], "looms = 0 must be a whole number, 1 or more"),
        (["--looms", "5", "--share", "120 %"], "share = 1.2 is outside (0, 1) of all looms"),
        (["--looms", "5", "--prove"], "leave out --looms"),
    ):
        capsys.readouterr()
        assert main(["tolerances", str(path), *wrong]) == 2
        assert why in capsys.readouterr().err
