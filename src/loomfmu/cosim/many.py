"""Many runs of a prepared scene at once: in C as far as they go there, the others one by one."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..errors import LoomfmuError, shown
from ..traces import Verdict
from ..traces.verdict import FAILS, HOLDS, UNDECIDED
from ..units import Si
from .claims.claim import Claim
from .claims.judging import FIELDS, verdict_of
from .master.master import Interrupted
from .results import Evaluation
from .rows import Ran, RowsInC
from .scenes.scene import Scene

WORDS = (HOLDS, FAILS, UNDECIDED)  # by the code of each
SPREAD = FIELDS.index("spread")
NONE = -1  # the code of a verdict that there is not
FEW = 4  # rows that are run one by one sooner
FIRST = 16  # rows that show whether it is worth to run others in C

# what runs some values, and the scene with these; it raises LoomfmuError for values that are not possible
MakesReady: TypeAlias = Callable[[dict[str, Any]], tuple[RowsInC, Scene]]


class Rows:
    """Many runs of a prepared scene, each with the verdicts and values that `evaluate` gives.

    `worst`, `distance` and `codes` have a row for each run and a column for each claim, `values` the last
    values of signals for each run; `codes` count in `WORDS`. A run that failed has NaN, `NONE` and zeros, and
    `errors` say why by its number. `single` are the runs that were made one by one.
    """

    def __init__(
        self,
        scene: Scene,
        claims: Sequence[Claim],
        parts: Sequence[Ran],
        places: NDArray[np.int64],
        single: Mapping[int, Evaluation],
        errors: Mapping[int, Exception],
        signals: Mapping[str, Any],
    ):
        self.scene, self.single, self.errors = scene, single, errors
        self._claims, self._parts, self._places = claims, parts, places
        shape = (len(places), len(claims))
        self.worst, self.distance, self.codes = (
            np.full(shape, np.nan),
            np.full(shape, np.nan),
            np.full(shape, NONE),
        )
        self.values = {signal: np.zeros(len(places), dtype=kind) for signal, kind in signals.items()}
        for number, ran in enumerate(parts):
            rows = np.flatnonzero(places[:, 0] == number)
            self._fill(rows, ran, places[rows, 1])
        for row, found in single.items():
            self.worst[row] = [each.worst for each in found.claims]
            self.distance[row] = [each.distance for each in found.claims]
            self.codes[row] = [WORDS.index(each.word) for each in found.claims]
            for signal, values in self.values.items():
                values[row] = found.trace[signal][-1]

    def _fill(self, rows: NDArray[np.int64], ran: Ran, places: NDArray[np.int64]) -> None:
        """Take the columns of a part, as `Verdict` has them."""
        numbers = ran.judged.verdicts[places][:, : len(self._claims)]
        holds, decided, form, bound, worst = (numbers[:, :, place] for place in range(5))
        for place, forms in enumerate(ran.forms[: len(self._claims)]):
            sense = np.array([each.sense for each in forms])[form[:, place].astype(int)]
            distance = sense * (worst[:, place] - bound[:, place]) + 0.0
            error = numbers[:, place, 8]
            known = np.where(decided[:, place] > 0.0, distance < 0.0, np.isfinite(error))
            kept = (sense != 0) & ((holds[:, place] > 0.0) | known)
            self.distance[rows, place] = np.where(kept, distance, np.nan)
        self.worst[rows] = worst
        self.codes[rows] = np.where(holds > 0.0, 0, np.where(decided > 0.0, 1, 2))
        for signal, values in self.values.items():
            values[rows] = ran.held[signal][places]

    def __len__(self) -> int:
        return len(self.codes)

    def __repr__(self) -> str:
        return f"<Rows {self.scene.name}: {len(self)} runs, {len(self.errors)} of them failed>"

    def verdicts(self, row: int) -> tuple[Verdict, ...]:
        """The verdicts on the claims in a run. Raises what it failed with."""
        if row in self.errors:
            raise self.errors[row]
        if row in self.single:
            return self.single[row].claims
        return self._verdicts(row, range(len(self._claims)))

    def _verdicts(self, row: int, numbers: Iterable[int]) -> tuple[Verdict, ...]:
        part, place = self._places[row].tolist()
        ran = self._parts[part]
        found = []
        for number in numbers:
            values = ran.judged.verdicts[place, number].tolist()
            note = ran.judged.notes.get((place, number), "")
            verdict = verdict_of(values, ran.forms[number], ran.names[number], note)
            found.append(replace(verdict, spread=values[SPREAD]) if ran.exact[place, number] else verdict)
        return tuple(found)

    def near(self, row: int) -> frozenset[int]:
        """The claims, counted from 0, that are so near their bounds that a numerical error may matter."""
        if row in self.single:
            return self.single[row].near
        part, place = self._places[row]
        return frozenset(np.flatnonzero(self._parts[part].near[place]).tolist())

    def warnings(self, row: int) -> tuple[str, ...]:
        """The warnings of a run that did not fail."""
        return self.single[row].warnings if row in self.single else self.scene.notes


class Many:
    """The values of many runs: a sequence for each key, all of one length, numbers in SI."""

    def __init__(self, values: Mapping[str, Any]):
        """Take the values. Raises LoomfmuError unless they are sequences of equal length."""
        if not isinstance(values, Mapping):
            raise LoomfmuError(
                f"the values must be a mapping, not {type(values).__name__}:"
                ' write {"shaft.speed": [60.0, 70.0]}, a sequence for each key'
            )
        self._values = {key: _listed(key, given) for key, given in values.items()}
        lengths = {key: len(given) for key, given in self._values.items()}
        if len(set(lengths.values())) > 1:
            counts = ", ".join(f"{count} of {key}" for key, count in lengths.items())
            raise LoomfmuError(f"the values differ in number: {counts}")
        self.count = next(iter(lengths.values()), 0)
        self._parts: list[Ran] = []
        self._places = np.full((self.count, 2), NONE)

    def settings(self, row: int) -> dict[str, Any]:
        """The values of a run, as `evaluate` takes them."""
        return {key: given[row] for key, given in self._values.items()}

    def run_in_c(
        self, ready: MakesReady, takes: Callable[[str], bool], signals: Sequence[str], near: bool
    ) -> None:
        """Run in C what goes there, and keep the last values of some signals.

        `ready` gives what runs some values, `takes` says which keys may differ from run to run; `near` leaves
        out runs with a verdict near its bound.
        """
        varied = [key for key, given in self._values.items() if takes(key) and all(map(_is_number, given))]
        groups: dict[str, list[int]] = {}
        for row in range(self.count):
            fixed = {key: given[row] for key, given in self._values.items() if key not in varied}
            groups.setdefault(repr(fixed), []).append(row)
        for group in groups.values():
            for lot in (group[:FIRST], group[FIRST:]):
                if len(lot) >= FEW:
                    self._take(lot, varied, ready, signals, near)

    def _take(
        self,
        lot: Sequence[int],
        varied: Sequence[str],
        ready: MakesReady,
        signals: Sequence[str],
        near: bool,
    ) -> None:
        """Run in C, if that is worth it, rows that differ in the values of some keys alone."""
        columns = {key: np.array([self._values[key][each] for each in lot], dtype=float) for key in varied}
        for row in lot[:FIRST]:
            try:  # values of one of the rows, which must be possible and start the FMUs
                rows, scene = ready(self.settings(row))
                if not (varied and rows.worth and not rows.unfit and all(map(rows.takes, varied))):
                    return
                ran = rows.run(columns, scene, signals, near)
            except LoomfmuError:
                continue
            if ran is not None:
                final = ran.clean & ~(near & ran.near & ~ran.exact).any(axis=1)
                rows.count(final)
                self._places[np.array(lot)[final], 0] = len(self._parts)
                self._places[np.array(lot)[final], 1] = np.flatnonzero(final)
                self._parts.append(ran)
            return

    def judged(
        self,
        scene: Scene,
        claims: Sequence[Claim],
        signals: Mapping[str, Any],
        evaluate: Callable[[dict[str, Any]], Evaluation],
    ) -> Rows:
        """Run all others one by one, and return all; `signals` have the types of their values."""
        single, errors = dict[int, Evaluation](), dict[int, Exception]()
        for row in np.flatnonzero(self._places[:, 0] == NONE).tolist():
            try:
                single[row] = evaluate(self.settings(row))
                single[row].check_end()
            except (OSError, MemoryError):  # of the machine, not of the row
                raise
            except Interrupted:
                raise KeyboardInterrupt("interrupted") from None
            except Exception as error:  # one row of thousands must not end the others
                single.pop(row, None)
                errors[row] = error
        return Rows(scene, claims, self._parts, self._places, single, errors, signals)


def _listed(key: str, given: Any) -> list[Any]:
    """Return the values of a key as a list; floats are in SI."""
    if isinstance(given, str) or not isinstance(given, Sequence | np.ndarray):
        raise LoomfmuError(f"{key} = {shown(given)} is not a sequence of values")
    values = given.tolist() if isinstance(given, np.ndarray) else list(given)
    return [Si(each) if isinstance(each, float) else each for each in values]


def _is_number(value: Any) -> bool:
    return isinstance(value, float | int) and not isinstance(value, bool)
