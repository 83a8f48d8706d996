"""`prove`: claims for all shaft angles of a run and all values of a box, proven, refuted or left open."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import cycle, product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import units
from ...cosim.claims.claims import name_of
from ...cosim.claims.conditions import (
    FALLS,
    IN,
    OUT,
    RISES,
    UNKNOWN,
    Always,
    Condition,
    Spans,
    Sum,
    Unprovable,
    names_of,
)
from ...cosim.planning.requested import Requested
from ...cosim.prepared import Prepared
from ...cosim.reading import requested
from ...cosim.results import Evaluation
from ...cosim.scenes.scene import Scene, differing
from ...declaring.variables import Component
from ...errors import LoomfmuError, shown
from ..span import Span, set_twice, span_of, warnings_of
from .chain import SHAFT, START, Chain, Number
from .cover import Cover, Decision, cover
from .enclosed import LARGEST_BOX
from .spans import Floats

PROVEN, REFUTED, OPEN, IMPOSSIBLE = "proven", "refuted", "open", "cannot be proven"
MOST = 200_000  # boxes for one condition
LOOKED_AT = 16  # boxes left open, in whose middles runs look for a witness


@dataclass(frozen=True)
class Proof:
    """One claim over the box: its `status`, and why; `share` of the box is proven, by so many `boxes`.

    A claim that is refuted has the values of a `witness`, at which its run fails.
    """

    claim: str
    status: str
    why: str = ""
    share: float = 0.0
    boxes: int = 0
    witness: Mapping[str, str] = field(default_factory=dict)
    covers: tuple[tuple[Condition, tuple[Cover, ...]], ...] = field(default=(), repr=False)
    components: tuple[type[Component], ...] = field(default=(), repr=False)
    """Those of a proof that a certificate can confirm: over shaft angles, not over time."""

    def __bool__(self) -> bool:
        return self.status == PROVEN


@dataclass(frozen=True, repr=False)
class Proofs:
    """The proofs of a scene `over` a box; true if all claims are proven."""

    scene: Scene
    over: tuple[Span, ...]
    claims: tuple[Proof, ...]
    warnings: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.claims) and all(self.claims)

    def __repr__(self) -> str:
        proven = f"{sum(map(bool, self.claims))} of {len(self.claims)} claims proven"
        others = "".join(f"\n  {each.status}: {each.claim}" for each in self.claims if not each)
        return f"<Proofs of {self.scene.name}: {proven}{others}>"


def prove(
    scene: str | Path | Scene,
    *,
    over: Sequence[str] = (),
    set: dict[str, Any] | None = None,  # the command's own word
    claims: Sequence[str] | None = None,
    boxes: int = MOST,
) -> Proofs:
    """Prove claims of a scene for all shaft angles of its revolutions, and all values of a box.

    Proven is what the equations of the mechanisms say, in real numbers. Claims on mechanisms with a memory
    cannot be proven.

    Args:
        scene, set: as for `run`
        over: parameters that vary together, each with its range, such as "shaft.speed=300rpm..640rpm"
        claims: names of those to be proven; all of them by default
        boxes: so many are looked at for one condition, before it is left open

    Raises:
        LoomfmuError: bad input, or a claim that is not there
    """
    asked = requested(scene, set, "native")
    texts = [over] if isinstance(over, str) else list(over)
    for text in texts:
        if isinstance(text, str) and "=" not in text:
            form = "write INSTANCE.VARIABLE=LOW..HIGH, such as shaft.speed=300rpm..640rpm"
            raise LoomfmuError(f"over {text}: a proof needs a range; {form}")
    sides = [span_of(asked.scene, text, option="over") for text in texts]
    if len(sides) >= LARGEST_BOX:
        raise LoomfmuError(f"over has {len(sides)} parameters; at most {LARGEST_BOX - 1} vary together")
    for side in sides:
        if f"{SHAFT}.{START}" in side.varied.targets:
            raise LoomfmuError(f"{side.key} cannot vary in a proof: all shaft angles are proven")
    if twice := set_twice(sides):
        raise LoomfmuError(f"{twice[0].key} and {twice[1].key} both set {twice[2]}")
    for side in sides:
        _check_follows(asked.scene, side)
    names = [name_of(table) for table in asked.scene.claims]
    for name in claims or ():
        if name not in names:
            raise LoomfmuError(f"the scene has no claim {shown(name)}; it has {', '.join(names)}")
    if boxes < 1:
        raise LoomfmuError(f"boxes = {boxes} is not a number of boxes")
    wanted = [number for number, name in enumerate(names) if claims is None or name in claims]
    with Prepared(asked.scene, None, "native", ()) as loom:
        search = _Search(asked, loom, sides, boxes)
        found = [search.proof(number, names[number]) for number in wanted]
    return Proofs(asked.scene, tuple(sides), tuple(found), warnings_of(sides, asked.scene.notes))


def _check_follows(scene: Scene, span: Span) -> None:
    """Refuse what is no number of a parameter, and a value that others follow in a way that is not known."""
    if span.varied.kind != "Real" or not span.varied.targets:
        raise LoomfmuError(f"{span.key} cannot vary in a proof: it is not the value of a parameter")
    for value in (span.low, span.high):
        moved = requested(scene, {**scene.overrides, **span.setting(value)}, "native").scene
        for name, variable, _before, _after in differing(scene, moved):
            if f"{name}.{variable}" not in span.varied.targets:
                raise LoomfmuError(f"{span.key} cannot vary in a proof: {name}.{variable} changes with it")


class _Search:
    """Looks for proofs and witnesses in one box of a scene."""

    def __init__(self, asked: Requested, loom: Prepared, sides: Sequence[Span], most: int):
        self._asked, self._loom, self._sides, self._most = asked, loom, sides, most
        self._scene = asked.scene
        self._targets = {
            (target.partition(".")[0], target.partition(".")[2]): place
            for place, side in enumerate(sides, 1)
            for target in side.varied.targets
        }
        self._box = np.array([(side.low, side.high) for side in sides]).reshape(-1, 2)

    def proof(self, number: int, name: str) -> Proof:
        """Prove a claim, or refute it by a run, or say what is left open, or why it cannot be proven."""
        try:
            conditions = self._asked.claims[number].conditions(self._asked)
            chain = Chain(self._scene, names_of(conditions), self._targets)
            self._check_known(conditions, chain)
        except Unprovable as error:
            return Proof(name, IMPOSSIBLE, str(error))
        witness = self._witness(number, self._runs)
        if witness is not None:
            return Proof(name, REFUTED, witness=witness)
        covers = tuple((each, self._covers(each, chain)) for each in conditions)
        parts = [each for _condition, many in covers for each in many]
        share = math.prod(each.share for each in parts)
        boxes = sum(each.boxes for each in parts)
        left = [box for each in parts for box in each.open]
        if not left:
            return Proof(name, PROVEN, "", 1.0, boxes, {}, covers, () if chain.timed else chain.components)
        places = (self._middle(box) for box in left[:: math.ceil(len(left) / LOOKED_AT)])
        witness = self._witness(number, map(self._run, places))
        if witness is not None:
            return Proof(name, REFUTED, "", share, boxes, witness)
        return Proof(name, OPEN, f"{len(left)} of {boxes} boxes are left", share, boxes)

    def _check_known(self, conditions: Sequence[Condition], chain: Chain) -> None:
        """Refuse equations of which nothing is known at a single point: no box is small enough for them."""
        first, last = self._run_of(chain)
        place = first + 0.0637 * (last - first)
        point = np.repeat(np.array([place, *self._box.mean(axis=1)])[None, :, None], 2, axis=2)
        numbers = chain.numbers(point)
        for name in names_of(conditions):
            if not np.isfinite(chain.number(name, numbers, point).values).any():
                raise Unprovable(f"{name} is found by a search that cannot be enclosed")
        for each in conditions if chain.timed else ():
            if isinstance(each, Spans) or each.window or each.angles:
                raise Unprovable("the speed changes, or a value follows a table, and the claim names angles")

    # ---- covers

    def _run_of(self, chain: Chain) -> tuple[float, float]:
        """The first and the last shaft angle of the run, or the times of a timed chain. Raises Unprovable."""
        speeds = [abs(end) for end in self._speeds]
        if self._speeds[0] * self._speeds[1] <= 0.0:
            raise Unprovable("the speed of the shaft is 0 within the range")
        by_revolutions = self._scene.step is None
        turned = self._scene.periods * (2.0 * math.pi if by_revolutions else max(speeds))
        if chain.timed:
            return 0.0, turned / min(speeds) if by_revolutions else self._scene.periods
        start = float(self._scene.instances[SHAFT].start(START) or 0.0)
        return (start, start + turned) if self._speeds[0] > 0.0 else (start - turned, start)

    @property
    def _speeds(self) -> tuple[float, float]:
        """The lowest and the highest mean speed of the shaft."""
        place = self._targets.get((SHAFT, "speed"))
        speed = float(self._scene.instances[SHAFT].start("speed") or 0.0)
        return (speed, speed) if place is None else (self._sides[place - 1].low, self._sides[place - 1].high)

    def _covers(self, condition: Condition, chain: Chain) -> tuple[Cover, ...]:
        first, last = self._run_of(chain)
        if isinstance(condition, Spans):
            decide = partial(decide_spans, chain, condition, (first, last))
            return (cover(self._box, decide, self._most // 64),)
        ranges = [(first, last)] if chain.timed else condition.ranges(first, last)
        return tuple(
            cover(np.concatenate([[angles], self._box]), partial(decide_always, chain, condition), self._most)
            for angles in ranges
        )

    # ---- witnesses

    @cached_property
    def _runs(self) -> list[tuple[dict[str, float], Evaluation]]:
        """Runs at the ends and in the middle of the first two sides, the others along with them."""
        return [
            self._run(
                {side.key: side.at(share) for side, share in zip(self._sides, cycle(row), strict=False)}
            )
            for row in product((0.0, 0.5, 1.0), repeat=min(2, len(self._sides)))
        ]

    def _run(self, values: dict[str, float]) -> tuple[dict[str, float], Evaluation]:
        return values, self._loom.evaluate({key: units.Si(value) for key, value in values.items()})

    def _middle(self, box: Floats) -> dict[str, float]:
        """The values in the middle of a box, which may have the shaft angle before them."""
        middle = box[len(box) - len(self._sides) :].mean(axis=-1)
        return {side.key: float(value) for side, value in zip(self._sides, middle, strict=True)}

    def _witness(
        self, number: int, runs: Iterable[tuple[dict[str, float], Evaluation]]
    ) -> dict[str, str] | None:
        """Return the values of the first run in which the claim fails."""
        shown_as = {side.key: side.show for side in self._sides}
        for values, run in runs:
            if run.claims[number].decided and not run.claims[number].holds:
                return {key: shown_as[key](value) for key, value in values.items()}
        return None


def value_of(form: Sum, chain: Chain, numbers: Mapping[str, Number], boxes: Floats) -> Number:
    """Return a sum of signals and parameters over boxes."""
    total = Number.of(form.constant, boxes)
    for share, name in form.terms:
        total = total.plus(chain.number(name, numbers, boxes), share)
    return total.narrowed(boxes)


def decide_always(chain: Chain, condition: Always, boxes: Floats) -> Decision:
    """Return the boxes all over which one of the forms is not negative."""
    numbers = chain.numbers(boxes)
    forms = [value_of(form, chain, numbers, boxes) for form in condition.any_of]
    lowest = np.stack([each.values[:, 0] for each in forms])
    best = lowest.argmax(axis=0)
    rows = np.arange(len(boxes))
    slopes = np.stack([each.slopes for each in forms])[best, rows]
    return Decision(lowest[best, rows] >= 0.0, _weights(slopes, boxes))


def _weights(slopes: Floats, boxes: Floats) -> Floats:
    """Weigh the sides: by the change across each, or by its width where slopes are not known."""
    widths = boxes[..., 1] - boxes[..., 0]
    with np.errstate(invalid="ignore"):
        change: Floats = np.abs(slopes).max(axis=-1) * widths
    whole = np.max(widths, axis=0)
    unknown = ~np.isfinite(change).all(axis=1)
    change[unknown] = (widths / np.where(whole > 0.0, whole, 1.0))[unknown]
    return change


def decide_spans(chain: Chain, condition: Spans, run: tuple[float, float], boxes: Floats) -> Decision:
    """Return the boxes in which every span that the run shows whole is long enough."""
    proven = [condition.hold(*run, partial(_kinds, chain, condition.inside, box)) for box in boxes]
    widths = boxes[..., 1] - boxes[..., 0]
    return Decision(np.array(proven, dtype=bool), widths / np.maximum(widths.max(axis=0), 1e-300))


def _kinds(chain: Chain, form: Sum, box: Floats, edges: Floats) -> NDArray[np.int_]:
    """Say of each cell of angles how a form moves in it, all over a box of parameters."""
    boxes = np.empty((len(edges) - 1, 1 + len(box), 2))
    boxes[:, 0, 0], boxes[:, 0, 1] = edges[:-1], edges[1:]
    boxes[:, 1:] = box
    found = value_of(form, chain, chain.numbers(boxes), boxes)
    slope = found.slopes[:, 0]
    kinds = np.full(len(boxes), UNKNOWN)
    kinds[slope[:, 0] > 0.0] = RISES
    kinds[slope[:, 1] < 0.0] = FALLS
    kinds[found.values[:, 0] >= 0.0] = IN
    kinds[found.values[:, 1] < 0.0] = OUT
    return kinds
