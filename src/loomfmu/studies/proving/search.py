"""The search for proofs: a claim is covered by boxes that prove it, or refuted by a run."""

import math
from collections.abc import Iterable, Sequence
from functools import cached_property, partial
from itertools import cycle, product
from typing import Any

import numpy as np

from ... import units
from ...cosim.claims.conditions import Always, Condition, Sometime, Spans, Unprovable, names_of
from ...cosim.prepared import Prepared
from ...cosim.reading import requested
from ...cosim.results import Evaluation
from ..span import Span
from .chain import Chain
from .cover import Cover, cover
from .decisions import Lowest, decide_any, decide_spans, likely
from .proofs import IMPOSSIBLE, OPEN, PROVEN, REFUTED, Proof
from .sides import SHAFT, START
from .spans import Ends, Floats

MOST = 200_000  # boxes for one condition
FINE = 1 / 400  # of a revolution: so narrow must a box be that a mechanism is in one of its phases
LOOKED_AT = 16  # boxes left open, in whose middles runs look for a witness


class Search:
    """Looks for proofs and witnesses in one box of a scene."""

    def __init__(self, loom: Prepared, sides: Sequence[Span], most: int = MOST):
        self._loom, self._sides, self._most = loom, sides, most
        self._asked = requested(loom.scene, None, "native")
        self._scene = self._asked.scene
        self._targets = {
            (target.partition(".")[0], target.partition(".")[2]): place
            for place, side in enumerate(sides, 1)
            for target in side.varied.targets
        }
        self._box = np.array([(side.low, side.high) for side in sides]).reshape(-1, 2)

    def proof(self, number: int, name: str) -> Proof:
        """Prove a claim, or refute it by a run, or say what is left open, or why it cannot be proven."""
        try:
            conditions, chain = self._stated(number)
        except Unprovable as error:
            return Proof(name, number, IMPOSSIBLE, str(error))
        witness = self._witness(number, self._runs)
        if witness is not None:
            return Proof(name, number, REFUTED, witness=witness)
        if doubt := self._doubt(number):
            return Proof(name, number, IMPOSSIBLE, doubt)
        covers = tuple((each, self._covers(each, chain)) for each in conditions)
        parts = [each for _condition, many in covers for each in many]
        share = math.prod(each.share for each in parts)
        boxes = sum(each.boxes for each in parts)
        left = [box for each in parts for box in each.open]
        shown: tuple[Any, ...] = covers, () if chain.timed else chain.components, self._run_of(chain)
        if not left:
            return Proof(name, number, PROVEN, "", 1.0, boxes, {}, *shown)
        places = (self._middle(box) for box in left[:: math.ceil(len(left) / LOOKED_AT)])
        witness = self._witness(number, map(self._run, places))
        if witness is not None:
            return Proof(name, number, REFUTED, "", share, boxes, witness)
        return Proof(name, number, OPEN, f"{len(left)} of {boxes} boxes are left", share, boxes, {}, *shown)

    def lowest_distance(self, number: int, width: float) -> Ends | None:
        """Enclose the lowest distance of a claim from its bound, no wider than this.

        None for a claim that is not about the lowest value of one number, or whose lowest is not found.
        """
        try:
            conditions, chain = self._stated(number)
        except Unprovable:
            return None
        (condition,) = conditions if len(conditions) == 1 else (None,)
        if not isinstance(condition, Always) or len(condition.any_of) > 1 or self._doubt(number):
            return None
        if (chain.timed or self._scene.step is not None) and self._speeds[0] != self._speeds[1]:
            return None  # runs end at different times: the lowest value may come after the end of some
        found = Lowest(chain, condition.any_of[0], self._scale(chain), width)
        for box in self._boxes(condition, chain):
            if cover(box, found, self._most).open:
                return None
        return found.low, found.high

    def fails(self, number: int, values: dict[str, float]) -> bool:
        """Return whether a claim is decided and fails in a run with these values (SI)."""
        return self._witness(number, [self._run(values)]) is not None

    def _stated(self, number: int) -> tuple[tuple[Condition, ...], Chain]:
        """Return the conditions of a claim, and the mechanisms that they are about. Raises Unprovable."""
        conditions = self._asked.claims[number].conditions(self._asked)
        chain = Chain(self._scene, names_of(conditions), self._targets)
        self._check_known(conditions, chain)
        return conditions, chain

    def _check_known(self, conditions: Sequence[Condition], chain: Chain) -> None:
        """Refuse equations of which nothing is known at a single point: no box is small enough for them."""
        first, last = self._run_of(chain)
        place = first + 0.0637 * (last - first)
        point = np.repeat(np.array([place, *self._box.mean(axis=1)])[None, :, None], 2, axis=2)
        numbers = chain.numbers(point)
        for name in names_of(conditions):
            if not np.isfinite(chain.number(name, numbers, point).values).any():
                raise Unprovable(f"{name} is found by a search that cannot be enclosed")
        for each in conditions:
            if not chain.timed:
                if not isinstance(each, Spans):
                    each.ranges(first, last)
                elif self._scene.step is not None and self._speeds[0] != self._speeds[1]:
                    raise Unprovable(
                        "at each speed the run ends at another angle, where it may cut off a dwell"
                    )
            elif isinstance(each, Spans) or each.window or each.angles:
                raise Unprovable("the speed changes, or a value follows a table, and the claim names angles")

    # ---- covers

    def _run_of(self, chain: Chain) -> tuple[float, float]:
        """The first and the last shaft angle of the run, or the times of a timed chain. Raises Unprovable."""
        speeds = [abs(end) for end in self._speeds]
        if self._speeds[0] * self._speeds[1] <= 0.0:
            raise Unprovable("the speed of the shaft is 0 within the range")
        by_revolutions = self._scene.step is None
        turned = self._scene.extent * (2.0 * math.pi if by_revolutions else max(speeds))
        if chain.timed:
            return 0.0, turned / min(speeds) if by_revolutions else self._scene.extent
        start = float(self._scene.instances[SHAFT].start(START) or 0.0)
        return (start, start + turned) if self._speeds[0] > 0.0 else (start - turned, start)

    @property
    def _speeds(self) -> tuple[float, float]:
        """The lowest and the highest mean speed of the shaft."""
        place = self._targets.get((SHAFT, "speed"))
        speed = float(self._scene.instances[SHAFT].start("speed") or 0.0)
        return (speed, speed) if place is None else (self._sides[place - 1].low, self._sides[place - 1].high)

    def _covers(self, condition: Condition, chain: Chain) -> tuple[Cover, ...]:
        if isinstance(condition, Spans):
            decide = partial(decide_spans, chain, condition, self._run_of(chain))
            return (cover(self._box, decide, self._most // 64),)
        decide = partial(decide_any, chain, condition.forms, self._scale(chain))
        return tuple(cover(box, decide, self._most) for box in self._boxes(condition, chain))

    def _boxes(self, condition: Always | Sometime, chain: Chain) -> list[Floats]:
        """Return the box with all ranges of the angle, or of the time, that a condition is about.

        Where one angle of a range is enough, the range is the one at which the condition most likely holds.
        """
        first, last = self._run_of(chain)
        ranges = [(first, last)] if chain.timed else condition.ranges(first, last)
        if isinstance(condition, Sometime):
            ranges = [(likely(chain, condition.form, each, self._box),) * 2 for each in ranges]
        return [np.concatenate([[each], self._box]) for each in ranges]

    def _scale(self, chain: Chain) -> Floats:
        """Return the widths at which the sides of a box are equally wide, where nothing else is known."""
        first, last = self._run_of(chain)
        return np.array([(last - first) * FINE / self._scene.extent, *(self._box[:, 1] - self._box[:, 0])])

    # ---- witnesses

    @cached_property
    def _runs(self) -> list[tuple[dict[str, float], Evaluation]]:
        """Runs at the ends and in the middle of the first two sides, the others along with them, and at all
        corners."""
        count = len(self._sides)
        rows = [*product((0.0, 0.5, 1.0), repeat=min(2, count))]
        rows += product((0.0, 1.0), repeat=count) if count > 2 else ()
        shares = (zip(self._sides, cycle(row), strict=False) for row in rows)
        return [self._run({side.key: side.at(share) for side, share in each}) for each in shares]

    def _run(self, values: dict[str, float]) -> tuple[dict[str, float], Evaluation]:
        return values, self._loom.evaluate({key: units.Si(value) for key, value in values.items()})

    def _middle(self, box: Floats) -> dict[str, float]:
        """The values in the middle of a box, which may have the shaft angle before them."""
        middle = box[len(box) - len(self._sides) :].mean(axis=-1)
        return {side.key: float(value) for side, value in zip(self._sides, middle, strict=True)}

    def _doubt(self, number: int) -> str:
        """Return why a run does not show what is claimed: not that it is too near its bound."""
        for _values, run in self._runs:
            verdict = run.claims[number]
            if not (verdict.decided or abs(verdict.worst - verdict.bound) <= verdict.error < math.inf):
                return f"a run leaves it undecided: {verdict.note}"
        return ""

    def _witness(
        self, number: int, runs: Iterable[tuple[dict[str, float], Evaluation]]
    ) -> dict[str, str] | None:
        """Return the values of the first run in which the claim fails."""
        shown_as = {side.key: side.show for side in self._sides}
        for values, run in runs:
            if run.claims[number].decided and not run.claims[number].holds:
                return {key: shown_as[key](value) for key, value in values.items()}
        return None
