"""`gradient`: exact derivatives of claims and signals by parameters, without repeated runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import units
from ..cosim.claims.claims import name_of
from ..cosim.claims.expressions import is_expression
from ..cosim.claims.measures import signal_in
from ..cosim.prepared import Derived, Move, Prepared
from ..cosim.reading import requested
from ..cosim.scenes.scene import Scene
from ..display import notebook
from ..errors import LoomfmuError, shown, suggestion
from ..sweeps.varied import Varied, varied
from ..traces import Signals, Verdict
from .polished import Floats

UNKNOWN = "its derivative is not known: the samples alone show no distance from its bound"
CHANGE = 2.0**-10  # of a value: start values that follow it are found by what changes with it


@dataclass(frozen=True, repr=False)
class Gradient:
    """Derivatives of claims and signals by parameters, at a scene's values.

    A row for each of `of` and a column for each of `by`: `si` in the units of the FMUs, `values` in those
    that people read, which `units` names. `numbers` are the claims' distances from their bounds and the
    values of the signals, in SI; `warnings` are those of the scene.
    """

    title: str
    of: tuple[str, ...]
    by: tuple[str, ...]
    numbers: tuple[float, ...]
    si: NDArray[np.float64] = field(compare=False)
    values: NDArray[np.float64] = field(compare=False)
    units: tuple[tuple[str, ...], ...]
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        rows = self.rows
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows)
        return notebook.warned("\n".join([f"<Gradient of {self.title}>", *lines]), self.warnings)

    def _repr_html_(self) -> str:
        head, *rows = self.rows
        return notebook.block(self.title, notebook.table(head, rows), warnings=self.warnings)

    @property
    def rows(self) -> list[tuple[str, ...]]:
        """A table: headings, then a row for each of `of`."""
        pairs = zip(self.of, self.values.tolist(), self.units, strict=True)
        return [
            ("derivative of", *(f"by {key}" for key in self.by)),
            *(
                (name, *(f"{value:.6g} {unit}" for value, unit in zip(values, names, strict=True)))
                for name, values, names in pairs
            ),
        ]


def gradient(
    scene: str | Path | Scene,
    *,
    of: str | Sequence[str],
    by: str | Sequence[str],
    set: dict[str, Any] | None = None,  # the command's own word
) -> Gradient:
    """Derive claims and signals of a scene by parameters, at its values.

    The components' own equations are derived, states over all steps included. At a kink the derivative is
    one-sided: within a component that of the branch taken, in a claim that towards greater values. An extreme
    that a component searches is derived at the place that it found. Rounding moves that place a little: where
    the value moves the extreme in time, its derivative may be off by some 1e-4 of itself.

    Args:
        scene, set: as for `run`
        of: names of claims, whose distances from the bound are derived, and signals: one that holds an
            extreme by its name, others as "highest belt.deflection", "lowest ..." (both also of an
            expression), "mean ..." or "... at 90 deg"
        by: parameters of our components, such as "shaft.speed"; of and by may be one name or several

    Raises:
        LoomfmuError: an unknown name; a parameter, claim or FMU without derivatives; or a run that failed
    """
    of, by = ([each] if isinstance(each, str) else each for each in (of, by))
    for name, given in (("of", of), ("by", by)):
        if (
            not isinstance(given, list | tuple)
            or not given
            or not all(isinstance(each, str) for each in given)
        ):
            raise LoomfmuError(f"{name} = {shown(given)} is not a list of names")
    base = requested(scene, set, "native").scene
    claims = {name_of(each): number for number, each in enumerate(base.claims)}
    measures = [each for each in of if each not in claims]
    for each in measures:
        signal = signal_in(each)
        if not is_expression(signal) and signal.partition(".")[0] not in base.instances:
            raise LoomfmuError(f"of {shown(each)} is neither a claim nor a signal{suggestion(each, claims)}")
    with Prepared(base, None, "native", (), measures) as loom:
        parameters = [_parameter(loom, key) for key in by]
        found = loom.derived({}, [move_of(loom.scene, each) for each in parameters])
    if found.early.cut_short:
        raise LoomfmuError(f"{base.name}: {found.early.cut_short}")
    first = len(base.claims)
    places = [claims[each] if each in claims else first + measures.index(each) for each in of]
    verdicts = [found.verdicts[place] for place in places]
    for name, verdict in zip(of, verdicts, strict=True):
        if why := without_gradient(loom.scene, verdict):
            raise LoomfmuError(f"of {shown(name)}: {why}")

    def numbers(judged: Sequence[Verdict]) -> list[float]:
        return [number_of(judged[place], place < first) for place in places]

    si = np.array([each.slope(lambda trace: numbers(found.judged(trace))) for each in found.directions]).T
    for name, row in zip(of, si, strict=True):
        if not np.all(np.isfinite(row)):
            raise LoomfmuError(f"of {shown(name)}: {UNKNOWN}")
    factors = np.array([units.unit(each.display).factor for each in parameters])
    shares = np.array([each.displayed(1.0) for each in verdicts])
    return Gradient(
        loom.scene.title or loom.scene.name,
        tuple(of),
        tuple(by),
        tuple(numbers(found.verdicts)),
        si,
        si * factors * shares[:, np.newaxis],
        tuple(tuple(_per(each.label, key.shown_unit) for key in parameters) for each in verdicts),
        loom.scene.notes,
    )


def _parameter(loom: Prepared, key: str) -> Varied:
    """Return what a key sets. Raises LoomfmuError where that is no real number."""
    found = varied(loom.scene, key)
    if found.kind != "Real" or found.needs_scene:
        raise LoomfmuError(f"by {key}: it is not a real number of a component, so it has no derivative")
    return found


def move_of(scene: Scene, parameter: Varied, value: float | None = None) -> Move:
    """The settings at a value a little beside the scene's or a given one, and the change of it."""
    owner, _, name = parameter.targets[0].partition(".")
    instance = scene.instances[owner]
    port = instance.fmu.ports[instance.fmu.name_of(name)]
    at = float(instance.start(port.name) or 0.0) if value is None else value
    moved = at + CHANGE * (abs(at) or 1.0)
    if port.maximum is not None and moved > port.maximum:
        moved = at - CHANGE * (abs(at) or 1.0)
    return {parameter.key: parameter.setting(moved)}, moved - at


def without_gradient(scene: Scene, verdict: Verdict) -> str:
    """Return why what a verdict is on has no derivative; an empty text if it has one."""
    owner, _, variable = verdict.signal.partition(".")
    ports = scene.instances[owner].fmu.ports if owner in scene.instances else {}
    if variable in ports and ports[variable].kind != "Real":  # a claim on two signals names a difference
        return "it counts or decides, so it has no derivative"
    return "" if math.isfinite(verdict.worst) else f"it has no value{verdict.note and f' ({verdict.note})'}"


def slopes_of(run: Derived, claims: int) -> Floats:
    """The slopes of the distances of so many claims in the directions of a run, (sides, claims, directions).

    The sides, of lesser and of greater values, differ at a kink alone. The slopes are those of the samples:
    known to about 1e-3 where the signal of a claim has no rate, and NaN where they are not known.
    """

    def distances(trace: Signals) -> list[float]:
        return [each.sense * (each.worst - each.bound) for each in run.judged(trace)[:claims]]

    return np.stack([each.sides(distances) for each in run.directions], axis=-1)


def number_of(verdict: Verdict, claim: bool = True) -> float:
    """The number that is derived: a claim's distance from its bound, or the value of a measure."""
    return verdict.distance if claim else verdict.worst


def _per(unit: str, by: str) -> str:
    """The unit of a derivative."""
    return unit if by == "1" else f"{unit}/({by})"
