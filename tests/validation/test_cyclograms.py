"""Cyclograms: the harmonic motion that is inferred, and phases that close."""

import math
from itertools import pairwise

import pytest

from loomfmu.machines import table
from loomfmu.validation import cyclograms


def test_needles_reach_the_tape_where_a_harmonic_motion_has_done_3_of_11_4_mm():
    for begin, end in ((10.0, 90.0), (270.0, 350.0)):
        found = cyclograms.needle_place(3.0 / 11.4, begin, end)
        share = 0.5 * (1.0 - math.cos(math.pi * (found - begin) / (end - begin)))
        assert 11.4 * share == pytest.approx(3.0, rel=1e-14)  # rounding
    # a straight line would be flush at 31 deg, a cycloid at 40: the printed 37 is that of the harmonic motion
    assert cyclograms.needle_place(3.0 / 11.4, 10.0, 90.0) == pytest.approx(37.0, abs=0.5)


@pytest.mark.parametrize(("part", "degrees"), [("tape", 720.0), ("needles", 720.0), ("knives", 714.0)])
def test_phases_of_a_part_follow_one_another(part, degrees):
    rows = [row for row in table("cyclograms") if (row["dobby"], row["part"]) == ("KRU-20", part)]
    for before, after in pairwise(rows):
        assert before["to_deg"] == after["from_deg"]
    assert cyclograms.total("KRU-20", part) == degrees
