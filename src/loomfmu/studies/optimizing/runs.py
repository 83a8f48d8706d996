"""The designs of a search: each is run once, kept in a file as it comes, and known from there afterwards."""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from io import BufferedRandom
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...cosim.prepared import Prepared
from ...errors import LoomfmuError
from ...files import cannot_write
from ...sweeps.schedule import Pool, run_batches
from ...sweeps.varied import Value
from ...sweeps.worker import Batch, ClaimResult, Job
from ...traces import Verdict
from ..cases import Case
from ..gradient import move_of
from ..polished import Floats
from .study import Study

Point = tuple[float, ...]  # a number for each variable, see `Variable.value`


@dataclass(frozen=True)
class Design:
    """A design that was run. `heights` are its goals, each the better the smaller; `room` is how much farther
    each claim is from its bound than it must be, negative if it is nearer or fails, as a share of its scale.
    `undecided` has the note on each claim that is undecided for another reason than its error.

    NaN stands for what there is not; `error` says why there is nothing at all.
    """

    point: Point
    values: tuple[Value, ...]
    heights: Floats
    room: Floats
    distances: Floats
    holds: bool
    error: str
    undecided: tuple[str, ...] = ()

    @property
    def allowed(self) -> bool:
        """Return whether all claims hold, as far from their bounds as wanted, and all goals have values."""
        return self.holds and bool(np.all(self.room >= 0.0)) and bool(np.all(np.isfinite(self.heights)))

    @property
    def shortfall(self) -> float:
        """The sum by which its claims fall short, 0 if the design is allowed."""
        if self.error or not np.all(np.isfinite(self.heights)):
            return 10.0 + len(self.room)
        short = float(np.sum(np.where(np.isnan(self.room), 1.0, np.maximum(0.0, -self.room))))
        return 0.0 if self.allowed else max(short, 1e-12)

    @classmethod
    def worst(cls, cases: Mapping[str, "Design"]) -> "Design":
        """One design in all its cases, by their names: its worst goals, and of each claim the least room."""
        (first, *others), every = cases.values(), list(cases.values())
        if not others:
            return first
        room, distances = (
            np.array([getattr(each, name) for each in every]) for name in ("room", "distances")
        )
        least = np.argmin(np.where(np.isnan(room), -np.inf, room), axis=0), np.arange(room.shape[1])
        return replace(
            first,
            heights=np.max([each.heights for each in every], axis=0),
            room=room[least],
            distances=distances[least],
            holds=all(each.holds for each in every),
            error=next((f"in {name}: {each.error}" for name, each in cases.items() if each.error), ""),
            undecided=tuple(
                next(filter(None, notes), "")
                for notes in zip(*(each.undecided for each in every), strict=True)
            ),
        )


class Runs:
    """Runs designs in a pool. What the file `path` has of an earlier search is not run again.

    `loom` is the study's scene, for derivatives.
    """

    def __init__(
        self,
        study: Study,
        job: Job,
        pool: Pool,
        path: Path,
        limits: "Limits",
        advance: Callable[[int], None],
        loom: Prepared,
    ):
        self.study = study
        self.designs: dict[tuple[Value, ...], Design] = {}  # in the order in which they were first wanted
        self.ran = 0  # now, and not in an earlier search
        self._job, self._pool, self.limits, self._advance = job, pool, limits, advance
        self._loom, real = loom, [study.variables[place].varied for place in study.continuous]
        self.derived = loom.has_derivatives and not any(each.needs_scene for each in real)
        self._path, self._results = path, _read(path)
        try:
            self._file: BufferedRandom = path.open("r+b" if path.exists() else "w+b")
        except OSError as error:
            raise cannot_write(path, error) from None
        self._file.truncate(sum(map(len, _whole_lines(path))))  # a kill may have left half a line
        self._file.seek(0, 2)

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def at(self, points: Sequence[Point]) -> list[Design]:
        """The designs at points, run unless they were."""
        variables = self.study.variables
        wanted = [
            tuple(each.value(number) for each, number in zip(variables, point, strict=True))
            for point in points
        ]
        rows = (row for values in dict.fromkeys(wanted) for row in self._rows(values))
        if left := [row for row in rows if row not in self._results]:
            self._run(left)
        for point, values in zip(points, wanted, strict=True):
            if values not in self.designs:
                self.designs[values] = self._worst(point, values)
                self._advance(1)
        return [self.designs[values] for values in wanted]

    def _rows(self, values: tuple[Value, ...]) -> list[tuple[Value, ...]]:
        """The rows of a design: its values, and in a study with cases the number of each."""
        cases = range(len(self.study.cases))
        return [(*values, number) for number in cases] or [values]

    def _settings(self, row: tuple[Value, ...]) -> dict[str, Any]:
        size = len(self.study.variables)
        return self._set(row[:size], self.study.situations[int(row[size]) if len(row) > size else 0])

    def _set(self, values: Sequence[Value], case: Case) -> dict[str, Any]:
        return {**self.study.fixed, **self.study.setting(values), **case.settings}

    def slopes(self, point: Point) -> Floats | None:
        """The derivatives of goals and of the room at claims, by the shares of the ranges.

        Shape (goals + claims, ranges), in each row that of the worst case. None where one is not known.
        """
        if not self.derived:
            return None
        try:
            found = [self._derived(point, case) for case in self.study.situations]
        except LoomfmuError:
            return None
        numbers, slopes = (np.array(each) for each in zip(*found, strict=True))
        goals = len(self.study.goals)
        sides = np.where(np.arange(numbers.shape[1]) < goals, 1.0, -1.0)
        worst = np.argmax(np.nan_to_num(sides * numbers, nan=np.inf), axis=0)
        of_worst: Floats = slopes[worst, np.arange(len(worst))]
        return of_worst if np.all(np.isfinite(of_worst)) else None

    def _derived(self, point: Point, case: Case) -> tuple[Floats, Floats]:
        """Goals and room in a case, and their derivatives by the shares of the ranges."""
        study = self.study
        values = [each.value(number) for each, number in zip(study.variables, point, strict=True)]
        moves, rates = [], []
        for place in study.continuous:
            variable = study.variables[place]
            _settings, change = move_of(self._loom.scene, variable.varied, float(values[place]))
            rates.append(variable.range.rate(point[place]) if variable.range else 0.0)
            moved = [*values[:place], float(values[place]) + change, *values[place + 1 :]]
            moves.append((self._set(moved, case), change / rates[-1]))
        found = self._loom.derived(self._set(values, case), moves)
        if found.early.cut_short:
            raise LoomfmuError(found.early.cut_short)

        def numbers(verdicts: Sequence[Verdict]) -> Floats:
            claims, first = verdicts[: len(study.scene.claims)], len(study.scene.claims)
            signals = [each.worst for each in verdicts[first : first + len(study.measures)]]
            bounds, distances = (np.array([getattr(c, n) for c in claims]) for n in ("bound", "distance"))
            return np.concatenate(self._sizes(values, signals, list(map(bool, claims)), bounds, distances))

        slopes = np.stack(
            [each.slope(lambda trace: numbers(found.judged(trace))) for each in found.directions], axis=1
        )
        for row, goal in enumerate(study.goals):
            if goal.kind == "variable" and goal.place in study.continuous:
                column = study.continuous.index(goal.place)
                slopes[row, column] = goal.sign * rates[column]
        return numbers(found.verdicts), slopes

    def _worst(self, point: Point, values: tuple[Value, ...]) -> Design:
        cases = zip(self.study.situations, self._rows(values), strict=True)
        return Design.worst(
            {case.name: self._design(point, values, self._results[row]) for case, row in cases}
        )

    def _run(self, left: list[tuple[Value, ...]]) -> None:
        def settings(rows: range) -> list[dict[str, Any]]:
            return [self._settings(left[row]) for row in rows]

        def keep(rows: range, batch: Batch) -> None:
            try:
                for row, result in zip(rows, batch.results, strict=True):
                    self._results[left[row]] = result
                    self._file.write(json.dumps([left[row], result]).encode() + b"\n")
                self._file.flush()
            except OSError as error:
                raise cannot_write(self._path, error) from None
            self.ran += len(rows)

        run_batches(self.study.scene, settings, self._job, [range(len(left))], self._pool, keep)

    def _design(self, point: Point, values: tuple[Value, ...], result: list[Any]) -> Design:
        study = self.study
        signals, claims = result[: len(study.measures)], result[len(study.measures) :]
        size = len(ClaimResult._fields)
        parts = range(0, size * len(study.scene.claims), size)
        found = [ClaimResult(*claims[part : part + size]) for part in parts]
        holds = [bool(each.holds) or not needed for each, needed in zip(found, study.required, strict=True)]
        bounds, distances = _numbers(each.bound for each in found), _numbers(each.distance for each in found)
        heights, room = self._sizes(values, _numbers(signals), holds, bounds, distances)
        error = result[-1] or ""
        undecided = tuple("" if each.decided or each.error else each.note or "" for each in found)
        return Design(point, values, heights, room, distances, all(holds) and not error, error, undecided)

    def _sizes(
        self,
        values: Sequence[Value],
        signals: Sequence[float] | Floats,
        holds: Sequence[bool],
        bounds: Floats,
        distances: Floats,
    ) -> tuple[Floats, Floats]:
        """The goals of a design, and the room at its claims."""
        of_kind: dict[str, Any] = {"signal": signals, "claim": distances, "variable": values}
        heights = [goal.sign * float(of_kind[goal.kind][goal.place]) for goal in self.study.goals]
        return np.array(heights), self.limits.room(holds, bounds, distances)


@dataclass(frozen=True)
class Limits:
    """The distances that claims must keep from their bounds: shares of these, and amounts, with `scales`.

    Those that are not `required` always have room.
    """

    required: NDArray[np.bool_]
    shares: Floats
    amounts: Floats
    scales: Floats

    def room(self, holds: Sequence[bool], bounds: Floats, distances: Floats) -> Floats:
        """Return how much farther each claim is from its bound than it must be, as a share of its scale."""
        rest = (distances - self.shares * np.abs(bounds) - self.amounts) / self.scales
        known = np.where(np.isnan(distances), np.where(holds, 0.0, np.nan), rest)
        return np.where(self.required, known, 1.0)


def _numbers(given: Any) -> Floats:
    return np.array([math.nan if each is None else float(each) for each in given], dtype=np.float64)


def _whole_lines(path: Path) -> list[bytes]:
    """The lines of a file without one that a kill cut off."""
    try:
        return [line for line in path.read_bytes().splitlines(keepends=True) if line.endswith(b"\n")]
    except FileNotFoundError:
        return []
    except OSError as error:
        raise cannot_write(path, error) from None


def _read(path: Path) -> dict[tuple[Value, ...], list[Any]]:
    """The results of a file by the values of their designs. Raises LoomfmuError for one that is damaged."""
    try:
        return {tuple(values): result for values, result in map(json.loads, _whole_lines(path))}
    except (ValueError, TypeError) as error:
        raise LoomfmuError(f"{path}: is damaged ({error}); --restart runs all designs again") from None
