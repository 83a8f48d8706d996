"""`fit`: parameters of a scene from measured curves, by bounded least squares, and cautions about them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from ... import units
from ...cosim.provenance import texts
from ...cosim.reading import checked, protected
from ...cosim.run import prepare
from ...cosim.scenes.headings import heading
from ...cosim.scenes.scene import Scene
from ...display import notebook
from ...errors import LoomfmuError, listed, shown, suggestion
from .. import rewritten
from ..span import Span, set_twice, span_of, warnings_of
from . import measured
from .curves import Compared
from .intervals import Fitted, Sure, doubtful, sure
from .measured import DISPLAY, Measured, offset_of
from .search import LEAST_SQUARES, LOSSES, Search, settings

HEADINGS = ("parameter", "fitted", "95 % interval", "in the scene")
MORE = 10  # values than parameters, of each signal whose noise must be known
UNTRUSTED = "not to be trusted"  # of an interval
REACH = 2.0  # standard errors: what the residuals would not show
LARGEST = 2.0 * math.pi  # offset that is worth a word [rad or s]: a revolution
STRONG = 0.9  # correlation that is worth a word


@dataclass(frozen=True, repr=False)
class Fit(Sure):
    """Parameters of a scene that come closest to a measurement.

    It is false where a signal is hardly explained, or a parameter ended at an end of its range. `curves` has
    for each signal what was measured, what is computed there and the root mean square of the difference.
    """

    scene: Scene
    data: Measured
    curves: tuple[Compared, ...]
    loss: str
    runs: int
    warnings: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        explained = all(each.explained for each in self.curves)
        return explained and not any(each.at_bound for each in self.parameters)

    @property
    def title(self) -> str:
        """The heading of the loom, without the values that were found."""
        return heading(self.scene, [each.span.key for each in self.parameters])

    @property
    def trusted(self) -> bool:
        """Return whether the intervals can be trusted: no test rejects independent residuals."""
        return all(each.trusted for each in self.parameters)

    @property
    def notes(self) -> tuple[str, ...]:
        """Cautions: residuals that are not noise, ends of ranges, correlations, coarse steps."""
        return tuple(_cautions(self))

    @property
    def values(self) -> dict[str, Any]:
        """The fitted values, for `loomfmu.run(scene, set=...)`; without the offset of the data."""
        return settings([each.span for each in self.parameters], [each.value for each in self.parameters])

    def write(self, path: str | Path, overwrite: bool = False) -> Path:
        """Write the scene with the fitted values, and in its description what to be careful about, as a TOML
        file. Raises LoomfmuError.
        """
        given = [f"{key} = {value}" for key, value in texts(self.scene.overrides).items()]
        fixed = f", and with {listed(given)}" if given else ""
        name = rewritten.check(self.scene).name
        origin = f"{name} with {listed(self.values)} fitted to {self.data.path.name}{fixed}."
        about = "\n".join([origin, *self.notes])
        return rewritten.write(self.scene, self.values, Path(path), overwrite, about)

    def __repr__(self) -> str:
        found = ", ".join(f"{each.span.key} = {each.span.show(each.value)}" for each in self.parameters)
        return notebook.warned(f"<Fit of {self.scene.name} to {self.data.path}: {found}>", self.warnings)

    def _repr_html_(self) -> str:
        return notebook.block(
            f"{self.title}: {self.data.path}",
            notebook.table(HEADINGS, rows(self)),
            *map(notebook.line, self.notes),
            warnings=self.warnings,
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
    doubt = "" if each.trusted else f", {UNTRUSTED}"
    return f"{each.span.number(each.low)} to {each.span.show(each.high)}{doubt}"


def fit(
    scene: str | Path | Scene,
    data: str | Path,
    *,
    vary: str | Sequence[str],
    signals: Sequence[str] = (),
    offset: str | None = None,
    loss: str = LEAST_SQUARES,
    set: dict[str, Any] | None = None,  # the command's own word
) -> Fit:
    """Find the parameters of a scene with which it comes closest to measured curves.

    Bounded least squares, from the scene's own values and from the best of scattered ones. Several signals
    are weighed by what remains of each, so their noise need not be known. Intervals are those of a linear
    model around the result, with independent errors of unknown size; `trusted` is false where the residuals
    are not independent.

    Args:
        scene: path of a scene file or a system package (.ssp), or a scene that was read before
        data: CSV whose header gives names and units, such as `shaft_angle [deg],damper_1.displacement [mm]`,
            or a trace. Shaft angles from 0 to 360 deg are those of the last whole revolution of the run,
            others count from its start.
        vary: parameters such as "damper_1.spring_stiffness=500N/m..2kN/m"
        signals: what is fitted of the data; all columns of a CSV file by default
        offset: range of a further parameter, which is added to all times or shaft angles of the data, such as
            "-2ms..2ms"
        loss: how residuals count: "linear" for least squares; "soft_l1", "huber", "cauchy" or "arctan" where
            some values may be far off
        set: values that differ from the scene's

    Raises:
        LoomfmuError: bad input, a parameter that changes nothing measured, parameters that the data cannot
            tell apart, or a run that failed
    """
    keys = [vary] if isinstance(vary, str) else list(vary)
    if not keys:
        raise LoomfmuError("name at least one parameter to fit, such as damper_1.spring_stiffness")
    if loss not in LOSSES:
        raise LoomfmuError(
            f"loss = {shown(loss)} is not one of {listed(LOSSES)}{suggestion(str(loss), LOSSES)}"
        )
    loaded = replace(protected(checked(scene, set, "native")), claims=[])
    if loaded.accuracy is not None:
        raise LoomfmuError(
            f"{loaded.name}: accuracy = {loaded.accuracy:g} chooses steps by the errors of claims, and a fit"
            " judges none; set steps_per_revolution instead"
        )
    found = measured.read(data, loaded, signals)
    spans = [span_of(loaded, key) for key in keys]
    if offset is not None:
        spans.append(offset_of(found, offset))
        found = replace(found, shifts=(spans[-1].low, spans[-1].high))
    _check(spans, found, loss)
    with prepare(loaded, values=tuple(found.columns)) as loom:
        search = Search(loom, found, spans, loss)
        ended = search.found()
        known = sure(found, spans, ended, LOSSES[loss])
        warnings = warnings_of(spans, loom.evaluate().warnings)
    return Fit(
        **vars(known),
        scene=loom.scene,
        data=found,
        curves=ended.curves,
        loss=loss,
        runs=search.runs,
        warnings=warnings,
    )


def _check(spans: Sequence[Span], data: Measured, loss: str) -> None:
    if twice := set_twice(spans):
        raise LoomfmuError(f"{twice[2]} is varied twice")
    several = len(data.columns) > 1
    for signal, values in data.columns.items() if several or loss != LEAST_SQUARES else ():
        if (count := int(np.isfinite(values).sum())) < len(spans) + MORE:
            what, why = (
                ("several signals", "weigh them") if several else (f"loss = {loss}", "know their noise")
            )
            raise LoomfmuError(
                f"{data.path}: {signal} has {count} values, but {what} with {len(spans)}"
                f" parameter{'s' * (len(spans) != 1)} take{'s' * (not several)} at least {len(spans) + MORE}"
                f" values of each signal, to {why};"
                f" {'leave it out' if several else 'take least squares'}"
            )
    if data.count <= len(spans):
        raise LoomfmuError(
            f"{data.path}: {data.count} value{'s' * (data.count != 1)} cannot determine {len(spans)}"
            f" parameter{'s' * (len(spans) != 1)} with intervals"
        )


def _cautions(found: Fit) -> Iterator[str]:
    unexplained = [each for each in found.curves if not each.explained]
    for curve in unexplained:
        yield f"{curve.signal}: the fit {_explains(curve.share)}; check the units and the rest of the scene"
    yield from _dependent(found)
    for each in found.parameters:
        if each.high - each.low > each.span.high - each.span.low:
            yield (
                f"the data do not determine {each.span.key}: its interval is wider than the range that was"
                " searched"
            )
    remedy = "" if unexplained else ": widen it"
    for each in found.parameters:
        if each.at_bound:
            yield f"{each.span.key} ended at {each.span.show(each.value)}, the end of its range{remedy}"
    for one, two in combinations(range(len(found.parameters)), 2):
        correlation = float(found.correlations[one, two])
        if abs(correlation) >= STRONG:
            names = listed(found.parameters[each].span.key for each in (one, two))
            yield f"errors of {names} are correlated ({correlation:.3f}): the data barely tell them apart"
    yield from (curve.note for curve in found.curves if curve.note)


def _explains(share: float) -> str:
    """Say how little a fit explains that leaves this share of the variation of the data."""
    if math.isinf(share):
        return "does not reach the data, which do not vary"
    if share >= 1.0:
        return "explains nothing of the variation of the data"
    return f"leaves {100.0 * share:.3g} % of the variation of the data unexplained"


def _dependent(found: Fit) -> Iterator[str]:
    """Yield evidence against independent residuals, and the consequences."""
    doubts = doubtful(found.residuals, found.shift)
    for each in found.residuals:
        if each in doubts:
            yield (
                f"{each.signal}: residuals are not independent: Durbin-Watson {each.durbin_watson:.2f} where"
                f" {each.expected_durbin_watson:.2f} is expected, {each.runs} runs of one sign where"
                f" {each.expected_runs:.0f} are; the intervals are {UNTRUSTED}: the scene lacks something, or"
                " the noise is filtered"
            )
        elif each.count < len(found.parameters) + MORE:
            yield f"{each.signal}: {each.count} values are too few to see whether residuals are independent"
    if found.shift is None:
        return
    if found.shift in doubts:
        size, error = (_offset(found, value) for value in (found.shift.size, REACH * found.shift.error))
        yield (
            f"the residuals show an offset of the data, {size} +- {error} to be added to all places; the"
            f" intervals are {UNTRUSTED}: --offset fits it"
        )
        return
    for one in found.parameters:
        if one.shift < min(REACH * found.shift.error, LARGEST):
            yield (
                f"{one.span.key}: an offset of the data of {_offset(found, one.shift)} moves it to the end of"
                " its interval, and the residuals would not show it: --offset allows for it"
            )


def _offset(found: Fit, value: float) -> str:
    return units.show(float(f"{value:.2g}"), DISPLAY[found.data.over])
