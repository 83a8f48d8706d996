"""The search for the parameters with which a scene comes closest to a measurement.

How much of a residual counts is said by a loss, one of those of scipy's `least_squares`, by its name.
"""

import contextlib
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...cosim.prepared import Prepared
from ...errors import LoomfmuError
from ...traces import Signals
from ..gradient import move_of
from ..span import Span
from .curves import Compared, compared
from .measured import Measured

Floats = NDArray[np.float64]


class Loss(NamedTuple):
    """A loss rho(z) of the squared residual z, with its first two derivatives, shape (3, n).

    `scale` is the residual, in standard errors, for which z is 1: with normal noise intervals are then as
    wide as those of least squares whose data are fewer by 5 %.
    """

    scale: float
    rho: Callable[[Floats], Floats]

    def weighed(self, residuals: Floats) -> tuple[Floats, Floats]:
        """Slope and curvature of half the loss at residuals, given in standard errors."""
        z = (residuals / self.scale) ** 2
        _value, slope, bend = self.rho(z)
        return residuals * slope, slope + 2.0 * z * bend


def _linear(z: Floats) -> Floats:
    return np.array([z, np.ones_like(z), np.zeros_like(z)])


def _soft_l1(z: Floats) -> Floats:
    root = np.sqrt(1.0 + z)
    return np.array([2.0 * (root - 1.0), 1.0 / root, -0.5 / root**3])


def _huber(z: Floats) -> Floats:
    root = np.sqrt(np.maximum(z, 1.0))
    return np.where(z <= 1.0, _linear(z), [2.0 * root - 1.0, 1.0 / root, -0.5 / root**3])


def _cauchy(z: Floats) -> Floats:
    return np.array([np.log1p(z), 1.0 / (1.0 + z), -1.0 / (1.0 + z) ** 2])


def _arctan(z: Floats) -> Floats:
    return np.array([np.arctan(z), 1.0 / (1.0 + z**2), -2.0 * z / (1.0 + z**2) ** 2])


LEAST_SQUARES = "linear"
LOSSES = {
    LEAST_SQUARES: Loss(1.0, _linear),
    "soft_l1": Loss(1.2871, _soft_l1),
    "huber": Loss(1.3450, _huber),
    "cauchy": Loss(2.3849, _cauchy),
    "arctan": Loss(2.5714, _arctan),
}


TRIED = 4  # scattered starts for each parameter: the best of them and the scene's own values are refined
ROUGH = 1e-2  # relative changes at which that is said to be enough to tell the better of the two
PROBE = 1e-3  # of the range, to see whether a parameter changes anything
PRECISE = 1e-13  # relative changes at which the search ends
ROUNDS = 20  # of weighing columns by what is left of them
SETTLED = 1e-3  # relative change of weights that ends it
ROUNDING = 1e-12  # of a signal's spread: data without noise
MEDIAN = 1.4826  # times the median size of normal errors is their standard deviation


class Found(NamedTuple):
    """The end of a search: shares of the ranges, shape (p,), which are at a bound, and the curves there.

    `residuals`, computed less measured, are weighed, shape (n,), and so are their `slopes` by the shares,
    shape (n, p), and by an offset of the places, the `drift`.
    """

    shares: Floats
    at_bound: Any
    residuals: Floats
    slopes: Floats
    drift: Floats
    curves: tuple[Compared, ...]


def settings(spans: Sequence[Span], values: Sequence[float]) -> dict[str, Any]:
    """Return the settings of a scene for some values, without an offset of the data."""
    pairs = zip(spans, values, strict=True)
    return {
        key: each for span, value in pairs if span.varied.targets for key, each in span.setting(value).items()
    }


class Search:
    """A prepared scene against a measurement; parameters are shares of their ranges, 0 to 1."""

    def __init__(self, loom: Prepared, data: Measured, spans: Sequence[Span], loss: str):
        self._loom, self._data, self._spans = loom, data, spans
        self._loss, self._name = LOSSES[loss], loss
        self.runs = 0
        self._derived = loom.has_derivatives
        self._curves: dict[tuple[float, ...], list[Compared]] = {}
        self._derivatives: dict[tuple[float, ...], Floats] = {}
        self._weights = np.array([1.0 / (_spread(values) or 1.0) for values in data.columns.values()])

    def found(self) -> Found:
        """Search, weighing several signals, and with a robust loss each, by what remains of it."""
        ended = self._refined(self._starts())
        weighed = len(self._data.columns) > 1 or self._name != LEAST_SQUARES
        for _round in range(ROUNDS if weighed else 0):
            weights = 1.0 / self._noise(ended)
            settled = np.allclose(weights, self._weights, rtol=SETTLED, atol=0.0)
            self._weights = weights
            ended = self._refined([ended.x])
            if settled:
                break
        # slopes that no loss has weighed
        here = self._least_squares(ended.x, LEAST_SQUARES, max_nfev=1)
        curves = tuple(self._at(ended.x))
        drift = self._weighed([each.drift for each in curves])
        return Found(ended.x, ended.active_mask != 0, here.fun, here.jac, drift, curves)

    def _values(self, shares: Floats) -> tuple[list[float], float]:
        """Return the values of all parameters in SI, and the offset of the data among them."""
        values = [span.at(share) for span, share in zip(self._spans, shares.tolist(), strict=True)]
        pairs = zip(self._spans, values, strict=True)
        return values, sum(value for span, value in pairs if not span.varied.targets)

    def _at(self, shares: Floats) -> list[Compared]:
        """Return measured and computed values with these parameters."""
        place = tuple(shares.tolist())
        if place not in self._curves:
            self.runs += 1
            values, offset = self._values(shares)
            run = self._loom.evaluate(settings(self._spans, values), errors="none")
            run.check_end()
            self._curves[place] = compared(self._data, run.trace, offset)
        return self._curves[place]

    def _residuals(self, shares: Floats) -> Floats:
        return self._weighed([each.computed - each.measured for each in self._at(shares)])

    def _weighed(self, parts: Sequence[Floats]) -> Floats:
        """The parts that belong to each signal, by its weight, in the rows of all."""
        return np.concatenate([weight * each for weight, each in zip(self._weights, parts, strict=True)])

    def _slopes(self, shares: Floats) -> Floats:
        """The derivatives of the residuals by the shares, shape (n, p)."""
        place = tuple(shares.tolist())
        if place not in self._derivatives:
            self._derivatives[place] = self._derived_at(shares)
        return self._weighed([self._derivatives[place][rows] for rows in self._data.rows.values()])

    def _derived_at(self, shares: Floats) -> Floats:
        """The derivatives of the computed values."""
        values, offset = self._values(shares)
        pairs = [pair for pair in zip(self._spans, values, strict=True) if pair[0].varied.targets]
        moves = [move_of(self._loom.scene, span.varied, value) for span, value in pairs]
        found = self._loom.derived(settings(self._spans, values), moves)
        self.runs += 1

        def computed(trace: Signals) -> Floats:
            return np.concatenate([each.computed for each in compared(self._data, trace, offset)])

        slopes = {
            span.key: each.slope(computed)
            for (span, _value), each in zip(pairs, found.directions, strict=True)
        }
        drift = np.concatenate([each.drift for each in compared(self._data, found.recording, offset)])
        columns = [(span.high - span.low) * slopes.get(span.key, drift) for span in self._spans]
        return np.stack(columns, axis=1)

    def _noise(self, ended: Any) -> Floats:
        """The standard error of each signal, from what remains of it; by the median with a robust loss.

        A fit takes up as much of a signal's noise as its values weigh in the fit, their leverages; the rest
        are its degrees of freedom.
        """
        free = np.flatnonzero(ended.active_mask == 0)
        leverages = np.sum(np.linalg.qr(ended.jac[:, free])[0] ** 2, axis=1)
        noise = []
        for (name, rows), weight in zip(self._data.rows.items(), self._weights, strict=True):
            rest, exact = ended.fun[rows] / weight, ROUNDING * (_spread(self._data.columns[name]) or 1.0)
            robust = MEDIAN * float(np.median(np.abs(rest)))
            size = float(np.sqrt(np.mean(rest**2))) if self._name == LEAST_SQUARES else robust
            noise.append(max(size / math.sqrt(1.0 - float(np.mean(leverages[rows]))), exact))
        return np.array(noise)

    def _starts(self) -> list[Floats]:
        """The scene's own values, and the best of scattered ones; refuses what changes nothing."""
        from scipy.stats import qmc

        own = np.array([min(max((s.value - s.low) / (s.high - s.low), 0.0), 1.0) for s in self._spans])
        there = self._residuals(own)
        scattered = qmc.Halton(len(own), seed=1).random(TRIED * len(own))
        ranked = []
        changed = np.any(self._slopes(own) != 0.0, axis=0) if self._derived else np.zeros(len(own), bool)
        for number, span in enumerate(self._spans):
            if changed[number]:
                continue
            for share in (own[number] + (PROBE if own[number] < 0.5 else -PROBE), 0.0, 0.5, 1.0):
                moved = own.copy()
                moved[number] = share
                changed[number] |= bool(np.any(self._residuals(moved) != there))
            if not changed[number]:
                raise LoomfmuError(f"{span.key} changes none of the measured signals from {span.text}")
        for shares in scattered:
            with contextlib.suppress(LoomfmuError):  # not every combination can be run
                ranked.append((float(np.sum(self._residuals(shares) ** 2)), tuple(shares)))
        return [own, *(np.array(shares) for _cost, shares in sorted(ranked)[:1])]

    def _refined(self, starts: Sequence[Floats]) -> Any:
        """The best of the searches from these starts."""
        if len(starts) > 1:
            ends = [self._least_squares(start, self._name, ROUGH) for start in starts]
            starts = [min(ends, key=lambda each: float(each.cost)).x]
        return self._least_squares(starts[0], self._name)

    def _least_squares(self, start: Floats, loss: str, precision: float = PRECISE, **options: Any) -> Any:
        from scipy.optimize import least_squares

        return least_squares(
            self._residuals,
            np.clip(start, 1e-9, 1.0 - 1e-9),
            jac=self._slopes if self._derived else "3-point",
            bounds=(0.0, 1.0),
            xtol=precision,
            ftol=precision,
            gtol=PRECISE,
            loss=loss,
            f_scale=LOSSES[loss].scale,
            **options,
        )


def _spread(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(np.std(known) or np.max(np.abs(known))) if len(known) else 0.0
