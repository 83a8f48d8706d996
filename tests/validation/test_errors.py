"""The figures on verdicts of random scenes: those of the file, and what the documents say of them."""

from pathlib import Path

import pytest

from loomfmu.validation import errors

ROOT = Path(__file__).parents[2]


def test_the_rows_add_up() -> None:
    *rows, total = errors.figures()
    assert tuple(total) == errors.HEADS and total["family"] == "all"
    assert {row["family"] for row in rows} | {"all"} == set(errors.FAMILIES)
    for name in ("verdicts", "false_holds", "false_fails", "wrong_from_1440", "undecided", "too_small"):
        for of_family in (True, False):
            counts = [int(row[name]) for row in rows if bool(row["claim"]) != of_family]
            assert sum(counts) == int(total[name])


@pytest.mark.parametrize("page", ["README.md", "docs/how_sure.md"])
def test_the_documents_say_what_the_figures_say(page: str) -> None:
    text = " ".join((ROOT / page).read_text(encoding="utf-8").split())
    assert errors.sentence() in text
