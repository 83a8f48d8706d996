"""When things happen over the main shaft: against published and analytic angles."""

import math
import re

import numpy as np
import pytest

from loomfmu.report.occasions import Occasions, positive
from loomfmu.report.section import Subject
from loomfmu.traces import Trace

PARTS = ("dwells", "changes")  # of the revolution of a frame


def degrees(found: list[tuple[float, float]]) -> list[tuple[float, float]]:
    return [(math.degrees(low), math.degrees(high)) for low, high in found]


def test_the_window_of_risk_is_the_published_one(demo: Trace) -> None:
    intervals = Occasions(Subject([demo])).revolution(2).intervals
    (pressed, back) = degrees(intervals["belt", "outside and compressed"])
    # published for this machine: 92.5 to 103.9 deg, to a tenth; the motion is symmetric about 180 deg
    assert pressed == pytest.approx((92.5, 103.9), abs=0.05)
    assert back == pytest.approx((360.0 - 103.9, 360.0 - 92.5), abs=0.05)


def test_the_belt_is_buckled_at_and_beyond_its_critical_load(demo: Trace, fast: Trace) -> None:
    assert Occasions(Subject([demo])).revolution(2).intervals["belt", "buckled"] == []
    along, load = np.degrees(fast.shaft_angle), 1.0 - fast["belt.margin"]
    (first, last) = degrees(Occasions(Subject([fast])).revolution(1).intervals["belt", "buckled"])
    beyond = along[load >= 1.0]
    step = 0.25  # deg between samples
    for (low, high), (start, end) in ((first, (0.0, 180.0)), (last, (180.0, 360.0))):
        inside = beyond[(beyond > start) & (beyond < end)]
        assert inside[0] - step <= low <= inside[0] and inside[-1] <= high <= inside[-1] + step


def test_the_hand_over_is_that_of_its_claim(whole: Trace) -> None:
    ((low, high),) = degrees(
        Occasions(Subject([whole])).revolution(5).intervals["transfer", "heads overlap enough"]
    )
    (note,) = [each.note for each in whole.verdicts if each.signal == "transfer.overlap"]
    claimed = [float(word) for word in re.findall(r"[\d.]+(?= deg)", note)]
    # on straight lines between samples of a quarter degree, on other revolutions of a shaft that ripples
    assert (low, high) == pytest.approx(claimed, abs=0.01)
    # equal rapiers in phase: the motion is symmetric about 180 deg
    assert 0.5 * (low + high) == pytest.approx(180.0, abs=0.01)


def test_the_brake_is_opened_where_its_program_says_so(yarn: Trace, demo: Trace) -> None:
    opened = degrees(Occasions(Subject([yarn])).revolution(1).intervals["yarn", "brake opened"])
    # from 45 to 135 deg, where the share is 1 (a thousandth of the force is passed within a degree), and from
    # between 180 deg (1.5) and 195 deg (0.3) to between 255 deg (0.3) and 270 deg (2.5)
    assert opened[0] == pytest.approx((45.0, 135.0), abs=1.0)
    assert 180.0 < opened[1][0] < 195.0 and 255.0 < opened[1][1] < 270.0 and len(opened) == 2
    assert "yarn" not in {row.name for row in Occasions(Subject([demo])).rows}


def test_each_rapier_is_in_the_shed_by_its_own_belt(whole: Trace) -> None:
    occasions = Occasions(Subject([whole]))
    labels = {row.name: row.label for row in occasions.rows}
    named = [labels[name] for name in ("weft", "weft_2", "belt", "belt_2")]
    assert named == ["Giver head", "Taker head", "Giver belt", "Taker belt"]
    bars = {row.name: row.bars[0].rule for row in occasions.rows}
    assert bars["weft_2"] == ["-", "weft_2.travel", "belt_2.idle_travel"]


def test_the_dwell_is_the_one_that_the_drive_computes_and_the_frame_changes_in_the_rest(demo: Trace) -> None:
    intervals = Occasions(Subject([demo])).revolution(2).intervals
    dwells, changes = (sum(high - low for low, high in intervals["heald_1", what]) for what in PARTS)
    # both edges on straight lines between samples of a quarter degree
    assert dwells == pytest.approx(demo["dobby.dwell_angle"][-1], abs=math.radians(1e-3))
    assert dwells + changes == pytest.approx(2.0 * math.pi, rel=1e-12)


def test_curves_go_from_end_to_end_of_a_revolution(demo: Trace, whole: Trace) -> None:
    """A curve shows every eighth of 1440 samples; it ended before the last of them."""
    for trace in (demo, whole):
        found = Occasions(Subject([trace])).revolution(2)
        assert {(curve[0][0], curve[0][-1]) for curve in found.curves.values()} == {found.covered}


def test_frames_come_in_the_order_of_their_numbers(whole: Trace) -> None:
    names = [row.name for row in Occasions(Subject([whole])).rows if row.name.startswith("heald_")]
    assert names == [f"heald_{number}" for number in range(1, len(names) + 1)]


def test_a_start_in_the_middle_covers_what_there_is(whole: Trace) -> None:
    occasions = Occasions(Subject([whole]))
    last = occasions.revolution(occasions.numbers[-1])
    assert 0.0 <= last.covered[0] < last.covered[1] <= 2.0 * math.pi + 1e-9
    for found in last.intervals.values():
        assert all(last.covered[0] <= low < high <= last.covered[1] + 1e-9 for low, high in found)


def test_intervals_of_a_sine_are_its_half_waves() -> None:
    along = np.linspace(0.0, 4.0 * np.pi, 20001)
    found = positive(along, np.sin(along - 0.5))
    expected = [(0.5, 0.5 + np.pi), (0.5 + 2.0 * np.pi, 0.5 + 3.0 * np.pi)]
    np.testing.assert_allclose(found, expected, atol=1e-9)  # a chord of 6e-4 rad: off by its cube
    assert positive(np.arange(5.0), -np.ones(5)) == []
    assert positive(np.arange(5.0), np.ones(5)) == [(0.0, 4.0)]
