"""The figures on estimated and true errors: those of the code, and what they say."""

import csv

import pytest

from loomfmu.validation import errors


def figures() -> list[dict[str, str]]:
    with errors.FIGURES.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_every_true_error_is_covered_and_no_decided_verdict_is_wrong() -> None:
    *rows, total = figures()
    assert total["scene"] == "all" and len(rows) > 15
    for name in ("verdicts", "covered", "compared", "far", "undecided", "wrong"):
        assert sum(int(row[name]) for row in rows) == int(total[name])
    assert total["covered"] == total["verdicts"] and total["wrong"] == "0"
    assert errors.SCENES >= 200


def test_the_same_seed_draws_the_same_scenes() -> None:
    assert list(errors.drawn(1, 10)) == list(errors.drawn(1, 10)) != list(errors.drawn(2, 10))


@pytest.mark.slow
def test_measured_anew_the_figures_say_the_same() -> None:
    # counts at a threshold may differ by a few where rounding differs from machine to machine
    for row, old in zip(errors.measured(), figures(), strict=True):
        new = dict(zip(errors.HEADS, row, strict=True))
        assert (new["scene"], new["claim"], new["verdicts"]) == (old["scene"], old["claim"], old["verdicts"])
        for name in ("covered", "compared", "far", "undecided"):
            assert abs(int(new[name]) - int(old[name])) <= 10
        assert new["wrong"] == "0"
