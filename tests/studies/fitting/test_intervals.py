"""Tests of residuals: against dense matrices, by hand, and how often they err."""

import numpy as np
import pytest

from loomfmu.studies.fitting.intervals import residuals_of, shift_of


def left(noise: np.ndarray, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The residuals of a linear fit, and the covariance of its parameters for noise of 1."""
    covariance = np.linalg.inv(slopes.T @ slopes)
    return noise - slopes @ (covariance @ (slopes.T @ noise)), covariance


def test_mean_of_durbin_watson_is_that_of_the_dense_quadratic_form() -> None:
    slopes = np.stack([np.ones(12), np.linspace(0.0, 1.0, 12) ** 2], axis=1)
    residuals, covariance = left(np.random.default_rng(1).normal(size=12), slopes)
    steps = np.diff(np.eye(12), axis=0)
    rest = np.eye(12) - slopes @ covariance @ slopes.T
    found = residuals_of("x", residuals, slopes, covariance)
    assert found.expected_durbin_watson == pytest.approx(np.trace(rest @ steps.T @ steps) / 10.0, rel=1e-12)
    steps_made = residuals[1:] - residuals[:-1]
    assert found.durbin_watson == pytest.approx(np.sum(steps_made**2) / np.sum(residuals**2), rel=1e-12)


def test_runs_by_hand() -> None:
    found = residuals_of(
        "x", np.array([1.0, 2.0, -1.0, 0.0, -3.0, 1.0]), np.ones((6, 1)), np.ones((1, 1)) / 6.0
    )
    assert (found.runs, found.expected_runs) == (3, pytest.approx(1.0 + 2.0 * 3.0 * 2.0 / 5.0))
    alike = residuals_of("x", np.ones(6), np.ones((6, 1)), np.ones((1, 1)) / 6.0)
    assert alike.runs == 1 and alike.chance_of_runs == 1.0  # signs that are all alike say nothing


@pytest.mark.parametrize("count", [12, 60])
def test_independent_noise_is_doubted_as_often_as_stated(count: int) -> None:
    random, places = np.random.default_rng(5), np.linspace(0.0, 1.0, count)
    slopes = np.stack([np.ones(count), places], axis=1)
    durbin_watson, shift = [], []
    for _try in range(2000):
        residuals, covariance = left(random.normal(size=count), slopes)
        durbin_watson.append(residuals_of("x", residuals, slopes, covariance).chance_of_durbin_watson)
        shift.append(shift_of(residuals, slopes, covariance, np.cos(7.0 * places)).chance)
    for chances in (durbin_watson, shift):
        # 100 are expected of 2000; binomial with p = 0.05 leaves 70 to 131 in all but 1 of 500 draws
        assert 70 <= np.sum(np.array(chances) < 0.05) <= 131


def test_an_offset_is_measured_and_what_it_moves() -> None:
    places = np.linspace(0.0, 6.0, 200)
    slopes = np.stack([np.sin(places), places], axis=1)
    drift = np.cos(places) + 0.3 * np.sin(places)
    noise = -0.02 * drift + 1e-3 * np.random.default_rng(2).normal(size=200)
    residuals, covariance = left(noise, slopes)
    found = shift_of(residuals, slopes, covariance, drift)
    assert found.size == pytest.approx(0.02, abs=4.0 * found.error) and found.chance < 1e-6
    moved = np.linalg.lstsq(slopes, -drift, rcond=None)[0]
    assert found.moved == pytest.approx(moved, rel=1e-9)
    # a parameter that does the same hides it
    hidden = shift_of(residuals, np.stack([drift, places], axis=1), covariance, drift)
    assert hidden.chance < 1.0 or hidden.error == np.inf
