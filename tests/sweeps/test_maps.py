"""Pictures of sweeps: real ones, with units, names, and the limits where they belong."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from sweep_files import NO_TRACES, sweep_file

import loomfmu
from loomfmu.design import loom
from loomfmu.sweeps import maps

SPEEDS = '"shaft.speed" = { from = "480 rpm", to = "780 rpm", count = 16 }\n'
SPACING = 20.0  # rev/min
CLEARANCES = '"belt.guide_clearance" = ["0.2 mm", "0.3 mm", "0.5 mm"]\n'
OVER_SPEED = '[map]\nx = "shaft.speed"\nvalue = "claim_1.worst"\n'
OVER_BOTH = f'[grid]\n{SPEEDS}{CLEARANCES}{OVER_SPEED}y = "belt.guide_clearance"\n'
BUCKLES = "the belt does not buckle: lowest margin: limit"


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Runs a sweep and gives its picture, as it is on disk and as it was drawn."""
    pictures: list[Any] = []
    save = maps._Picture.save

    def kept(picture: Any, path: Path) -> None:
        pictures.append(picture)
        save(picture, path)

    monkeypatch.setattr(maps._Picture, "save", kept)

    def draw(text: str, **arguments: str) -> Any:
        path = sweep_file(text + NO_TRACES, **arguments)
        found = loomfmu.sweep(path, processes=1, output="out", restart=True)
        assert found.map == Path("out/map.png")
        with Image.open(found.map) as image:
            assert image.format == "PNG" and image.size == (1600, 1100)
            assert len(image.convert("RGB").getcolors(maxcolors=1600 * 1100) or []) > 50  # not a blank sheet
        return pictures[-1]

    return draw


def legend(picture: Any) -> list[str]:
    return (
        [text.get_text() for text in picture.figure.legends[0].get_texts()] if picture.figure.legends else []
    )


def limit(clearance: float) -> float:
    """Speed [rev/min] at which the belt buckles, at a clearance [mm]."""
    return loom.safe_speed("WL680-3600", clearance=1e-3 * clearance).speed / loom.RPM


# the margin is 1 - (speed / limit)^2: between two points of the grid a straight line misses its zero by up to
# spacing^2 / (8 speed); the limit itself is 1.2e-6 off with 90 steps
TOLERANCE = SPACING**2 / (8.0 * 480.0) + 2e-6 * 780.0


def test_two_axes_of_numbers_are_contours_with_the_limit_where_it_is(drawn: Any) -> None:
    picture = drawn(OVER_BOTH)
    assert picture.axes.get_xlabel() == "shaft.speed [rev/min]"
    assert picture.axes.get_ylabel() == "belt.guide_clearance [mm]"
    assert picture.figure.axes[1].get_ylabel() == "the belt does not buckle: lowest margin"
    assert picture.axes.get_title() == "Swept"
    assert legend(picture) == [
        BUCKLES,
        "the loom runs below its safe speed: lowest value: limit",
        "a claim fails",
    ]
    lines = [each for each in picture.axes.collections if list(getattr(each, "levels", [])) == [0.0]]
    points = np.concatenate(lines[0].get_paths()[0].to_polygons(closed_only=False))
    for clearance in (0.2, 0.3, 0.5):
        (speed,) = np.unique(points[np.abs(points[:, 1] - clearance) < 1e-12, 0].round(9))
        assert speed == pytest.approx(limit(clearance), abs=TOLERANCE)


def test_names_are_cells_and_the_limit_runs_between_those_that_hold_and_those_that_fail(drawn: Any) -> None:
    asked = '[map]\nx = "shaft.speed"\ny = "machine"\nvalue = "belt.lowest_speed_limit"\n'
    picture = drawn('[grid]\nmachine = ["WL680-3600", "WL450-3600", "WL450-5400"]\n' + SPEEDS + asked)
    assert picture.axes.get_ylabel() == "machine"
    ticks = [label.get_text() for label in picture.axes.get_yticklabels()]
    assert ticks == ["WL680-3600", "WL450-3600", "WL450-5400"]
    assert picture.figure.axes[1].get_ylabel() == "belt.lowest_speed_limit [rev/min]"
    assert picture.values[0] == pytest.approx(limit(0.3), rel=3e-6)  # off by 1.2e-6 with 90 steps
    segments = [
        segment
        for each in picture.axes.collections
        if hasattr(each, "get_segments")
        for segment in each.get_segments()
    ]
    upright = {(round(s[0][0], 6), s[0][1], s[1][1]) for s in segments if s[0][0] == s[1][0]}
    # half-way between the last speed that holds and the first that fails; the widest machine always fails
    wanted = {
        (
            SPACING * np.floor(loom.safe_speed(name).speed / loom.RPM / SPACING) + SPACING / 2,
            place - 0.5,
            place + 0.5,
        )
        for place, name in enumerate(("WL680-3600", "WL450-3600"))
    }
    assert upright == wanted
    assert all(s[0][1] == s[1][1] for s in segments if s[0][0] != s[1][0])


def test_one_axis_is_a_line_with_its_limit_and_crosses_where_claims_fail(drawn: Any) -> None:
    picture = drawn("[grid]\n" + SPEEDS + OVER_SPEED)
    curve, first, second, crosses = picture.axes.get_lines()
    assert len(curve.get_xdata()) == 16
    assert first.get_xdata()[0] == pytest.approx(limit(0.3), abs=TOLERANCE)
    # the second claim compares the speed itself: straight lines meet
    assert second.get_xdata()[0] == pytest.approx(limit(0.3), rel=3e-6)
    assert list(crosses.get_xdata()) == pytest.approx(list(range(700, 781, 20)))
    assert legend(picture)[-1] == "a claim fails"
    assert picture.axes.get_ylabel() == "the belt does not buckle: lowest margin"


def test_a_second_axis_of_the_grid_makes_more_lines(drawn: Any) -> None:
    picture = drawn("[grid]\n" + SPEEDS + CLEARANCES + OVER_SPEED)
    assert len(picture.axes.get_lines()) == 4  # and the crosses
    assert legend(picture)[:3] == [f"belt.guide_clearance [mm] {value}" for value in ("0.2", "0.3", "0.5")]


def test_other_axes_stand_at_the_value_that_was_picked(drawn: Any) -> None:
    picked = 'at = { "belt.guide_clearance" = "0.5 mm" }\n'
    picture = drawn("[grid]\n" + SPEEDS + CLEARANCES + OVER_SPEED + picked)
    assert picture.axes.get_title() == "Swept\nbelt.guide_clearance = 0.5 mm"
    assert picture.axes.get_lines()[1].get_xdata()[0] == pytest.approx(limit(0.5), abs=TOLERANCE)


def test_long_titles_and_claims_fit_into_the_picture(
    drawn: Any,
) -> None:
    picture = drawn(OVER_BOTH)
    picture._legend("a claim whose name is far longer than the picture is wide " * 4)
    picture.axes.set_title("")
    picture.save(Path("long.png"))
    (box,) = (each.get_window_extent() for each in picture.figure.legends[-1:])
    assert box.x0 >= 0.0 and box.x1 <= 800.0


def test_a_sample_is_points(drawn: Any) -> None:
    ranges = '"shaft.speed" = ["500 rpm", "780 rpm"]\n"belt.bending_stiffness" = '
    text = "[sample]\ncount = 25\nseed = 1\n" + ranges + "{ from = 0.1, to = 1.0, logarithmic = true }\n"
    asked = '[map]\nx = "shaft.speed"\ny = "belt.bending_stiffness"\nvalue = "belt.lowest_speed_limit"\n'
    picture = drawn(text + asked)
    (points,) = picture.axes.collections
    assert points.get_offsets().shape == (25, 2)
    assert picture.axes.get_yscale() == "log"
    assert picture.axes.get_ylabel() == "belt.bending_stiffness [N.m2]"
    assert legend(picture) == ["a claim fails"]
    alone = drawn(text + '[map]\nx = "shaft.speed"\nvalue = "belt.lowest_speed_limit"\n')
    assert len(alone.axes.get_lines()[0].get_xdata()) == 25


def test_what_could_not_be_run_is_left_blank_and_said(drawn: Any) -> None:
    coupler = '"weft.coupler_length" = ["245 mm", "250 mm", "500 mm"]\n'
    asked = '[map]\nx = "shaft.speed"\ny = "weft.coupler_length"\nvalue = "belt.lowest_speed_limit"\n'
    picture = drawn("[grid]\n" + SPEEDS + coupler + asked)
    assert np.isnan(picture.values).sum() == 16
    assert "could not be run" in legend(picture)


def test_a_value_that_is_the_same_everywhere_can_be_drawn(drawn: Any) -> None:
    head = 'title = "Costs $5 and $6"\nscene = "scene.toml"\nvalues = ["weft.stroke"]\n'
    picture = drawn(OVER_BOTH.replace("claim_1.worst", "weft.stroke"), head=head)
    assert picture.axes.get_title() == "Costs $5 and $6"


def test_a_claim_that_counts_flips_half_way() -> None:
    nan, inf = np.nan, np.inf
    for beyond, wanted in (
        ([0.0, 0.0, 1.0], [-0.5, -0.5, 0.5]),
        ([-1.0, inf, nan], [-0.5, 0.5, nan]),
        ([-0.2, 0.3, nan], [-0.2, 0.3, nan]),
    ):
        np.testing.assert_array_equal(maps._crossing(np.array(beyond)), wanted)
