"""`fit`: parameters of a scene from measured curves, by bounded least squares."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import notebook
from ...cosim.prepared import Prepared
from ...cosim.reading import checked
from ...cosim.run import prepare
from ...cosim.scenes.scene import Scene
from ...errors import LoomfmuError, listed
from .. import rewritten
from ..span import Span, set_twice, span_of, warnings_of
from . import measured
from .curves import Compared, compared
from .measured import Measured

Floats = NDArray[np.float64]
TRIED = 12  # scattered starts for each parameter: the best of them and the scene's own values are refined
PROBE = 1e-3  # of the range, to see whether a parameter changes anything
PRECISE = 1e-13  # relative changes at which the search ends
ROUNDS = 20  # of weighing columns by what is left of them
SETTLED = 1e-3  # relative change of weights that ends it
SURE = 0.95  # probability of the intervals
MORE = 10  # values than parameters, of each of several signals: else its noise is not known
ROUNDING = 1e-12  # of a signal's spread: data without noise
ALIKE = 1e-9  # share of the strongest direction below which parameters cannot be told apart
HEADINGS = ("parameter", "fitted", "95 % interval", "in the scene")


@dataclass(frozen=True)
class Fitted:
    """A fitted parameter (SI): its value and its 95 % interval, NaN for one that ended `at_bound`."""

    span: Span
    value: float
    low: float
    high: float
    at_bound: bool


@dataclass(frozen=True, repr=False)
class Fit:
    """Parameters of a scene that come closest to a measurement.

    `correlations`, shape (p, p), are those of the parameters' errors, NaN for one at its bound. `curves` has
    for each signal what was measured, what is computed there and the root mean square of the difference.
    """

    scene: Scene
    data: Measured
    parameters: tuple[Fitted, ...]
    correlations: Floats = field(compare=False)
    curves: tuple[Compared, ...]
    runs: int
    notes: tuple[str, ...]
    warnings: tuple[str, ...] = ()

    @property
    def values(self) -> dict[str, Any]:
        """What sets the fitted values, for `loomfmu.run(scene, set=...)`."""
        return {
            key: value for each in self.parameters for key, value in each.span.setting(each.value).items()
        }

    def write(self, path: str | Path, overwrite: bool = False) -> Path:
        """Write the scene with the fitted values as a TOML file. Raises LoomfmuError."""
        keys = listed(each.span.key for each in self.parameters)
        origin = f"{rewritten.check(self.scene).name} with {keys} fitted to {self.data.path.name}."
        return rewritten.write(self.scene, self.values, Path(path), overwrite, origin)

    def __repr__(self) -> str:
        found = ", ".join(f"{each.span.key} = {each.span.show(each.value)}" for each in self.parameters)
        return f"<Fit of {self.scene.name} to {self.data.path}: {found}>"

    def _repr_html_(self) -> str:
        return notebook.block(
            f"{self.scene.title}: {self.data.path}",
            notebook.table(HEADINGS, rows(self)),
            *map(notebook.line, self.notes),
        )


def rows(found: Fit) -> list[tuple[str, str, str, str]]:
    """A row of the table for each parameter, below `HEADINGS`."""
    return [
        (each.span.key, each.span.show(each.value), _interval(each), each.span.show(each.span.value))
        for each in found.parameters
    ]


def _interval(each: Fitted) -> str:
    if each.at_bound:
        return "none: at the end of its range"
    return f"{each.span.number(each.low)} to {each.span.show(each.high)}"


def fit(
    scene: str | Path | Scene,
    data: str | Path,
    *,
    vary: str | Sequence[str],
    signals: Sequence[str] = (),
    set: dict[str, Any] | None = None,  # the command's own word
) -> Fit:
    """Find the parameters of a scene with which it comes closest to measured curves.

    Bounded least squares, from the scene's own values and from the best of scattered ones. Several signals
    are weighed by what remains of each, so their noise need not be known. Intervals are those of a linear
    model around the result, with normal errors of unknown size.

    Args:
        scene: path of a scene file or a system package (.ssp), or a scene that was read before
        data: CSV whose header gives names and units, such as `shaft_angle [deg],heald_1.displacement [mm]`,
            or a trace. Shaft angles from 0 to 360 deg are those of the last whole revolution of the run,
            others count from its start.
        vary: parameters such as "damper_1.stiffness=500N/m..2kN/m"
        signals: what is fitted of the data; all columns of a CSV file by default
        set: values that differ from the scene's

    Raises:
        LoomfmuError: bad input, a parameter that changes nothing measured, parameters that the data cannot
            tell apart, or a run that failed
    """
    keys = [vary] if isinstance(vary, str) else list(vary)
    if not keys:
        raise LoomfmuError("name at least one parameter to fit, such as damper_1.stiffness")
    loaded = replace(checked(scene, set, "native"), claims=[])
    if loaded.accuracy is not None:
        raise LoomfmuError(
            f"{loaded.name}: accuracy = {loaded.accuracy:g} chooses steps by the errors of claims, and a fit"
            " judges none; set steps_per_revolution instead"
        )
    found = measured.read(data, loaded, signals)
    spans = [span_of(loaded, key) for key in keys]
    _check(spans, found)
    with prepare(loaded, values=tuple(found.columns)) as loom:
        return _Search(loom, found, spans).result()


def _check(spans: Sequence[Span], data: Measured) -> None:
    if twice := set_twice(spans):
        raise LoomfmuError(f"{twice[2]} is varied twice")
    for signal, values in data.columns.items() if len(data.columns) > 1 else ():
        if (count := int(np.isfinite(values).sum())) < len(spans) + MORE:
            raise LoomfmuError(
                f"{data.path}: {signal} has {count} values, but several signals with {len(spans)} parameters"
                f" take at least {len(spans) + MORE} values of each, to weigh them; leave it out"
            )
    if data.count <= len(spans):
        raise LoomfmuError(
            f"{data.path}: {data.count} value{'s' * (data.count != 1)} cannot determine {len(spans)}"
            f" parameter{'s' * (len(spans) != 1)} with intervals"
        )


class _Search:
    """A prepared scene against a measurement; parameters are shares of their ranges, 0 to 1."""

    def __init__(self, loom: Prepared, data: Measured, spans: Sequence[Span]):
        self._loom, self._data, self._spans = loom, data, spans
        self._runs = 0
        self._weights = np.array([1.0 / (_spread(values) or 1.0) for values in data.columns.values()])

    def result(self) -> Fit:
        """Search, and say how sure the result is."""
        found = self._refined(self._starts())
        for _round in range(ROUNDS if len(self._data.columns) > 1 else 0):
            weights = 1.0 / self._noise(found)
            settled = np.allclose(weights, self._weights, rtol=SETTLED, atol=0.0)
            self._weights = weights
            found = self._refined([found.x])
            if settled:
                break
        curves = self._at(found.x)
        parameters, correlations = self._sure(found)
        notes = tuple(note for each in curves if (note := each.note))
        warnings = warnings_of(self._spans, self._loom.evaluate().warnings)
        return Fit(
            self._loom.scene, self._data, parameters, correlations, tuple(curves), self._runs, notes, warnings
        )

    def _noise(self, found: Any) -> Floats:
        """The standard error of each signal, from what remains of it.

        A fit takes up as much of a signal's noise as its values weigh in the fit, their leverages; the rest
        are its degrees of freedom.
        """
        free = np.flatnonzero(found.active_mask == 0)
        directions = np.linalg.qr(found.jac[:, free])[0]
        leverages = np.sum(directions**2, axis=1)
        columns = self._data.columns.values()
        ends = np.cumsum([np.isfinite(values).sum() for values in columns])[:-1]
        noise = []
        for values, weight, rest, taken in zip(
            columns, self._weights, np.split(found.fun, ends), np.split(leverages, ends), strict=True
        ):
            freedom = len(rest) - float(np.sum(taken))
            exact = ROUNDING * (_spread(values) or 1.0)
            noise.append(max(float(np.linalg.norm(rest)) / weight / math.sqrt(freedom), exact))
        return np.array(noise)

    def _setting(self, shares: Floats) -> dict[str, Any]:
        return {
            key: value
            for span, share in zip(self._spans, shares, strict=True)
            for key, value in span.setting(span.at(share)).items()
        }

    def _at(self, shares: Floats) -> list[Compared]:
        """What is measured and what is computed with these parameters."""
        self._runs += 1
        return compared(self._data, self._loom.evaluate(self._setting(shares), errors="none").trace)

    def _residuals(self, shares: Floats) -> Floats:
        pairs = zip(self._at(shares), self._weights, strict=True)
        return np.concatenate([(each.computed - each.measured) * weight for each, weight in pairs])

    def _starts(self) -> list[Floats]:
        """The scene's own values, and the best of scattered ones; refuses what changes nothing."""
        from scipy.stats import qmc

        own = np.array([min(max((s.value - s.low) / (s.high - s.low), 0.0), 1.0) for s in self._spans])
        there = self._residuals(own)
        scattered = qmc.Halton(len(own), seed=1).random(TRIED * len(own))
        ranked = []
        changed = np.zeros(len(own), bool)
        for number, span in enumerate(self._spans):
            for share in (own[number] + (PROBE if own[number] < 0.5 else -PROBE), 0.0, 0.5, 1.0):
                moved = own.copy()
                moved[number] = share
                changed[number] |= bool(np.any(self._residuals(moved) != there))
            if not changed[number]:
                raise LoomfmuError(f"{span.key} changes none of the measured signals between {span.text}")
        for shares in scattered:
            with contextlib.suppress(LoomfmuError):  # not every combination can be run
                ranked.append((float(np.sum(self._residuals(shares) ** 2)), tuple(shares)))
        return [own, *(np.array(shares) for _cost, shares in sorted(ranked)[:1])]

    def _refined(self, starts: Sequence[Floats]) -> Any:
        """The best of the least squares from these starts."""
        from scipy.optimize import least_squares

        ends = [
            least_squares(
                self._residuals, np.clip(start, 1e-9, 1.0 - 1e-9), jac="3-point", bounds=(0.0, 1.0),
                xtol=PRECISE, ftol=PRECISE, gtol=PRECISE,
            )
            for start in starts
        ]  # fmt: skip
        return min(ends, key=lambda each: float(each.cost))

    def _sure(self, found: Any) -> tuple[tuple[Fitted, ...], Floats]:
        """The parameters with their intervals, and the correlations of their errors."""
        from scipy.special import stdtrit

        free = np.flatnonzero(found.active_mask == 0)
        size = len(self._spans)
        covariance = np.full((size, size), math.nan)
        if len(free):
            self._check_apart(found.jac[:, free], [self._spans[each] for each in free.tolist()])
            rest = len(found.fun) - len(free)
            inverse = np.linalg.pinv(found.jac[:, free].T @ found.jac[:, free])
            covariance[np.ix_(free, free)] = inverse * 2.0 * found.cost / rest
        errors = np.sqrt(np.diag(covariance))
        with np.errstate(invalid="ignore"):
            correlations = covariance / np.outer(errors, errors)
        reach = stdtrit(len(found.fun) - len(free), 0.5 + 0.5 * SURE) * errors
        parameters = []
        for span, share, half, mask in zip(self._spans, found.x, reach, found.active_mask, strict=True):
            value, width = span.at(share), half * (span.high - span.low)
            parameters.append(Fitted(span, value, value - width, value + width, bool(mask)))
        return tuple(parameters), correlations

    def _check_apart(self, slopes: Floats, spans: Sequence[Span]) -> None:
        """Refuse parameters whose effects on the data are the same."""
        lengths = np.linalg.norm(slopes, axis=0)
        if not np.all(lengths):
            weakest = lengths.tolist().index(0.0)
            raise LoomfmuError(f"{spans[weakest].key} changes none of the measured signals at the result")
        _left, strengths, directions = np.linalg.svd(slopes / lengths, full_matrices=False)
        if strengths[-1] <= ALIKE * strengths[0]:
            weak = [span.key for span, part in zip(spans, directions[-1], strict=True) if abs(part) > 0.1]
            raise LoomfmuError(
                f"{self._data.path}: the data cannot tell {listed(weak)} apart; vary one of them"
            )


def _spread(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(np.std(known) or np.max(np.abs(known))) if len(known) else 0.0
