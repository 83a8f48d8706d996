"""A worker, which evaluates rows one after the other, in instances that it keeps.

It imports no more than a run does; tables are made where the sweep was started.
"""

import hashlib
import math
import threading
import time
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

from .. import machines
from ..cosim.claims.claims import called
from ..cosim.importing.fmus import Flavour
from ..cosim.many import Rows
from ..cosim.prepared import Errors, Prepared
from ..cosim.reading import read
from ..cosim.scenes.scene import Scene
from ..errors import LoomfmuError, described
from ..traces import Verdict
from .header import Header

# the threads of one process share the instances that rest between runs: they take turns
_turn = threading.Lock()


@dataclass(frozen=True)
class Job:
    """The common settings of all rows of a sweep; `identity` is the digest of the scene and its FMUs."""

    path: Path
    fixed: tuple[tuple[str, Any], ...]
    flavour: Flavour
    values: tuple[str, ...]
    identity: str
    errors: Errors = "near"
    measures: tuple[str, ...] = ()


@dataclass(frozen=True)
class Label:
    """The label of a claim: its words and signal, the unit of its values and the one to show them in."""

    claim: str
    signal: str
    unit: str
    display_unit: str


class ClaimResult(NamedTuple):
    """The columns that a row has for each claim, in this order; all None if the row could not be run."""

    holds: bool | None = None
    worst: float | None = None
    bound: float | None = None
    distance: float | None = None
    note: str | None = None
    decided: bool | None = None
    error: float | None = None


@dataclass(frozen=True)
class Batch:
    """Results of some rows, each: final values and measures, then a `ClaimResult` of each claim, whether all
    hold, the first claim that does not, warnings, and what went wrong.

    None stands for what there is not.

    `labels` are empty if no row could be run. `seconds` each row took on average.
    """

    results: list[list[Any]]
    labels: tuple[Label, ...]
    seconds: float


def job_of(head: Header, values: tuple[str, ...] = ()) -> Job:
    """Return the job of the workers of a sweep or a search; `values` are signals whose final values count."""
    known = identity(head.scene, head.flavour)
    return Job(head.path.absolute(), tuple(head.fixed.items()), head.flavour, values, known)


def identity(scene: Scene, flavour: str) -> str:
    """A digest of all that the results of a scene depend on: texts, files, FMUs, versions."""
    parts = [version("loomfmu"), flavour, scene.text, repr(machines.MACHINES), repr(machines.HEADS)]
    parts += [scene.package_sha256] if scene.package else []
    parts += [repr(sorted(scene.texts.items()))] if scene.texts else []  # the Python files of claims
    for name, each in scene.instances.items():  # weaves and other files have become values
        parts += [name, each.fmu.in_flavour(flavour).sha256, repr(sorted(each.values.items()))]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def run_rows(job: Job, settings: list[dict[str, Any]]) -> Batch:
    """Evaluate rows. A row that cannot be run says why; only a worker that differs raises LoomfmuError."""
    with _turn:
        loom = _prepared(job)
        begun = time.perf_counter()
        labels: tuple[Label, ...] = ()
        results: list[list[Any]] = [[]] * len(settings)
        for rows in _alike(settings):
            columns = {key: [settings[row][key] for row in rows] for key in settings[rows[0]]}
            many = loom.evaluate_many(columns, errors=job.errors)
            for place, row in enumerate(rows):
                results[row], verdicts = _row(job, many, place)
                labels = labels or tuple(map(_label, loom.scene.claims, verdicts))
        return Batch(results, labels, (time.perf_counter() - begun) / len(settings))


def _alike(settings: list[dict[str, Any]]) -> list[list[int]]:
    """Return the rows that set the same keys, together."""
    found: dict[tuple[str, ...], list[int]] = {}
    for row, each in enumerate(settings):
        found.setdefault(tuple(each), []).append(row)
    return list(found.values())


def _label(claim: dict[str, Any], verdict: Verdict) -> Label:
    """Return the label of a claim: its name, or its kind and signal."""
    named = verdict.claim if claim.get("name") else called(claim, verdict)
    return Label(named, verdict.signal, verdict.unit, verdict.display_unit)


def run_trace(job: Job, settings: dict[str, Any], path: Path) -> None:
    """Run a row with a full trace. What is there under its name is a sweep's, and no trace."""
    with _turn:
        _prepared(job).run(settings, output=path, overwrite=True)


@lru_cache(maxsize=4)
def _prepared(job: Job) -> Prepared:
    """The scene as this worker sees it, prepared."""
    scene = read(job.path, dict(job.fixed))
    if identity(scene, job.flavour) != job.identity:
        raise LoomfmuError(
            f"{job.path}: a worker has another version of loomfmu, or the file has changed since the start"
        )
    return Prepared(scene, None, job.flavour, job.values, job.measures)


def _row(job: Job, many: Rows, row: int) -> tuple[list[Any], tuple[Verdict, ...]]:
    """The result of one row and the verdicts on it."""
    try:
        verdicts = many.verdicts(row)
        values = [many.values[signal][row].item() for signal in job.values]
        values += map(_measured, many.single[row].measured if job.measures else ())
    except LoomfmuError as error:
        return failed(job, many.scene, str(error)), ()
    except Exception as error:
        return failed(job, many.scene, described(error)), ()
    first = None
    for claim, verdict in zip(many.scene.claims, verdicts, strict=True):
        values += ClaimResult(
            verdict.holds,
            _finite(verdict.worst),
            _finite(verdict.bound),
            _finite(verdict.distance),
            verdict.note or None,
            verdict.decided,
            _finite(verdict.error),
        )
        if not verdict.holds and first is None:
            first = called(claim, verdict)
    return [*values, all(verdicts), first, "; ".join(many.warnings(row)) or None, None], verdicts


def _measured(verdict: Verdict) -> float | None:
    """The number of a measure. Raises LoomfmuError where the steps do not show it."""
    if math.isinf(verdict.error):
        raise LoomfmuError(f"{verdict.signal}: {verdict.note}")
    return _finite(verdict.worst)


def failed(job: Job, scene: Scene, reason: str) -> list[Any]:
    """The result of a row that has none."""
    empty = [None] * len((*job.values, *job.measures))
    return [*empty, *[*ClaimResult()] * len(scene.claims), None, None, None, reason]


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
