"""Printed numbers that follow from others: the factor matrix, and the table of single ones."""

import numpy as np
import pytest

from loomfmu.machines import table
from loomfmu.validation import arithmetic

NAMES = [row["requirement"] for row in table("factor_correlations")]


def test_the_correlations_are_those_of_one_matrix():
    matrix = np.array([[float(row[name]) for name in NAMES] for row in table("factor_correlations")])
    np.testing.assert_array_equal(matrix, matrix.T)
    np.testing.assert_array_equal(np.diag(matrix), 1.0)


def test_the_factor_matrix_is_made_of_group_means():
    found = arithmetic.loads()
    for row in table("factor_matrix"):
        for factor in arithmetic.FACTORS:
            # two decimals are printed; 0.375 is printed as 0.38
            assert float(row[factor]) == pytest.approx(found[row["requirement"]][factor], abs=0.005 + 1e-12)


def test_variances_and_shares_are_exact_to_the_printed_digit():
    shown = {factor: f"{value:.3f}" for factor, value in arithmetic.variances().items()}
    assert shown == {"A": "2.843", "B": "2.930", "C": "2.659", "D": "2.351"}
    shares = {factor: f"{100 * value / 11:.2f}" for factor, value in arithmetic.variances().items()}
    assert shares == {factor: share for factor, (_variance, share) in arithmetic.FACTORS.items()}
    assert f"{100 * sum(arithmetic.variances().values()) / 11:.2f}" == "98.03"


def test_single_numbers():
    found = {row.cells[:2]: row.cells[3] for row in arithmetic.single().rows}
    missed = {name: (pair.published, round(pair.computed, 2)) for name, pair in found.items() if pair.verdict}
    assert list(missed.values()) == [("100000", 105570.0), ("4.4", 2.06)]
    ratios = [found["Table 1.3", f"{each}: energy over that of projectiles"].computed
              for each in ("air jets", "rapiers", "shuttle", "two phases")]  # fmt: skip
    assert ratios == pytest.approx([0.652 / 0.261, 0.517 / 0.261, 0.360 / 0.261, 0.303 / 0.261])
    assert sum(place == "Table 2.4" for place, _quantity in found) == 16
