"""`prove`: claims for all shaft angles of a run and all values of a box, proven, refuted or left open."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import cycle, product
from pathlib import Path
from typing import Any

import numpy as np

from ... import units
from ...cosim.claims.conditions import Always, Condition, Linear, Spans, names_of
from ...cosim.planning.requested import Requested
from ...cosim.prepared import Prepared
from ...cosim.reading import requested
from ...cosim.results import Evaluation
from ...cosim.scenes.scene import Scene
from ...errors import LoomfmuError, shown
from ...sweeps.varied import Varied, varied
from .chain import SHAFT, START, Chain, Number
from .cover import Cover, Decision, cover
from .enclosed import LARGEST_BOX
from .spans import Floats

PROVEN, REFUTED, OPEN, IMPOSSIBLE = "proven", "refuted", "open", "cannot be proven"
MOST = 200_000  # boxes for one condition
FINEST = 2.0**-12  # rad: a span whose end is not found this closely is left to smaller boxes
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
    covers: tuple[tuple[Condition, tuple[Cover, ...]], ...] = ()

    def __bool__(self) -> bool:
        return self.status == PROVEN


@dataclass(frozen=True)
class Proofs:
    """What was proven of a scene `over` a box; true if all claims are proven."""

    scene: Scene
    over: Mapping[str, tuple[str, str]]
    claims: tuple[Proof, ...]
    warnings: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.claims) and all(self.claims)


def prove(
    scene: str | Path | Scene,
    *,
    over: Mapping[str, tuple[Any, Any]] | None = None,
    set: dict[str, Any] | None = None,  # the command's own word
    claims: Sequence[str] | None = None,
    boxes: int = MOST,
    progress: bool = False,
) -> Proofs:
    """Prove claims of a scene for all shaft angles of its revolutions, and all values of a box.

    Proven is what the equations of the mechanisms say, in real numbers. Claims on mechanisms with a memory,
    with a table of inputs, or on a shaft of changing speed cannot be proven.

    Args:
        scene, set: as for `run`
        over: the lowest and the highest value of parameters that vary together, by key
        claims: names of those to be proven; all of them by default
        boxes: so many are looked at for one condition, before it is left open

    Raises:
        LoomfmuError: bad input, or a claim that is not there
    """
    asked = requested(scene, set, "native")
    sides = [_side(asked.scene, key, ends) for key, ends in (over or {}).items()]
    if len(sides) >= LARGEST_BOX:
        raise LoomfmuError(f"over has {len(sides)} parameters; at most {LARGEST_BOX - 1} vary together")
    names = [str(table.get("name") or table["kind"]) for table in asked.scene.claims]
    for name in claims or ():
        if name not in names:
            raise LoomfmuError(f"the scene has no claim {shown(name)}; it has {', '.join(names)}")
    wanted = [number for number, name in enumerate(names) if claims is None or name in claims]
    with Prepared(asked.scene, None, "native", ()) as loom:
        search = _Search(asked, loom, sides, boxes)
        found = [search.proof(number, names[number]) for number in wanted]
    texts = {side.varied.key: (side.varied.show(side.low), side.varied.show(side.high)) for side in sides}
    return Proofs(asked.scene, texts, tuple(found), asked.scene.notes)


@dataclass(frozen=True)
class Side:
    """A parameter of the box, from its lowest to its highest value in SI."""

    varied: Varied
    low: float
    high: float

    @property
    def targets(self) -> list[tuple[str, str]]:
        """Return the instances and variables that take its value."""
        return [
            (name, variable) for name, _dot, variable in (each.partition(".") for each in self.varied.targets)
        ]


def _side(scene: Scene, key: str, ends: tuple[Any, Any]) -> Side:
    """One side of the box. Raises LoomfmuError for what cannot vary, and for an empty range."""
    found = varied(scene, key)
    if found.kind != "Real" or found.needs_scene or not found.targets:
        raise LoomfmuError(f"{key} cannot vary in a proof: it is not the value of a parameter")
    low, high = (float(found.read(end)) for end in ends)
    if not low < high:
        raise LoomfmuError(f"{key}: the range from {ends[0]} to {ends[1]} is empty")
    for value in (low, high):
        moved = requested(scene, {key: found.setting(value)}, "native").scene
        _check_follows(scene, moved, found, value)
    return Side(found, low, high)


def _check_follows(scene: Scene, moved: Scene, of: Varied, value: float) -> None:
    """Refuse a value that others follow in a way that is not known."""
    for name, each in moved.instances.items():
        for variable in {*each.values, *scene.instances[name].values}:
            if each.start(variable) != scene.instances[name].start(variable):
                if f"{name}.{variable}" not in of.targets and each.start(variable) != value:
                    raise LoomfmuError(f"{of.key} cannot vary in a proof: {name}.{variable} changes with it")


class _Search:
    """Looks for proofs and witnesses in one box of a scene."""

    def __init__(self, asked: Requested, loom: Prepared, sides: Sequence[Side], most: int):
        self._asked, self._loom, self._sides, self._most = asked, loom, sides, most
        self._scene = asked.scene
        self._targets = {target: place for place, side in enumerate(sides, 1) for target in side.targets}
        self._box = np.array([(side.low, side.high) for side in sides]).reshape(-1, 2)

    def proof(self, number: int, name: str) -> Proof:
        """Prove a claim, or refute it by a run, or say what is left open, or why it cannot be proven."""
        try:
            conditions = self._asked.claims[number].conditions(self._asked)
            chain = Chain(self._scene, names_of(conditions), self._targets)
        except LoomfmuError as error:
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
            return Proof(name, PROVEN, "", 1.0, boxes, covers=covers)
        places = (self._middle(box) for box in left[:: math.ceil(len(left) / LOOKED_AT)])
        witness = self._witness(number, map(self._run, places))
        if witness is not None:
            return Proof(name, REFUTED, "", share, boxes, witness)
        return Proof(name, OPEN, f"{len(left)} of {boxes} boxes are left", share, boxes, covers=covers)

    # ---- covers

    def _covers(self, condition: Condition, chain: Chain) -> tuple[Cover, ...]:
        start = float(self._scene.instances[SHAFT].start(START) or 0.0)
        if isinstance(condition, Spans):
            decide = partial(decide_spans, chain, condition, start, self._turned)
            return (cover(self._box, decide, self._most // 64),) if len(self._box) else (_alone(decide),)
        return tuple(
            cover(np.concatenate([[angles], self._box]), partial(decide_always, chain, condition), self._most)
            for angles in self._angles(condition, start)
        )

    @property
    def _turned(self) -> float:
        """The angle by which the shaft turns in the run."""
        return 2.0 * math.pi * self._scene.periods

    def _angles(self, condition: Always, start: float) -> list[tuple[float, float]]:
        """The ranges of the shaft angle that a condition is about, for all revolutions of the run."""
        return angles_of(condition, start, start + self._turned)

    # ---- witnesses

    @cached_property
    def _runs(self) -> list[tuple[dict[str, float], Evaluation]]:
        """Runs at the ends and in the middle of the first two sides, the others along with them."""
        shares = np.linspace(0.0, 1.0, 3)
        return [
            self._run(
                {
                    side.varied.key: side.low + share * (side.high - side.low)
                    for side, share in zip(self._sides, cycle(row), strict=False)
                }
            )
            for row in product(shares, repeat=min(2, len(self._sides)))
        ]

    def _run(self, values: dict[str, float]) -> tuple[dict[str, float], Evaluation]:
        return values, self._loom.evaluate({key: units.Si(value) for key, value in values.items()})

    def _middle(self, box: Floats) -> dict[str, float]:
        """The values in the middle of a box, which may have the shaft angle before them."""
        middle = box[len(box) - len(self._sides) :].mean(axis=-1)
        return {side.varied.key: float(value) for side, value in zip(self._sides, middle, strict=True)}

    def _witness(
        self, number: int, runs: Iterable[tuple[dict[str, float], Evaluation]]
    ) -> dict[str, str] | None:
        """Return the values of the first run in which the claim fails."""
        shown_as = {side.varied.key: side.varied.show for side in self._sides}
        for values, run in runs:
            if run.claims[number].holds is False:
                return {key: shown_as[key](value) for key, value in values.items()}
        return None


def angles_of(condition: Always, first: float, last: float) -> list[tuple[float, float]]:
    """Return the ranges of the shaft angle between two angles that a condition is about [rad]."""
    turn = 2.0 * math.pi
    if condition.window is None and not condition.angles:
        return [(first, last)]
    ranges = [(angle, 0.0) for angle in condition.angles]
    if condition.window is not None:
        ranges = [(condition.window.start, condition.window.width)]
    found = []
    for start, width in ranges:
        for number in range(math.floor((first - start - width) / turn), math.ceil((last - start) / turn) + 1):
            low, high = max(first, start + turn * number), min(last, start + turn * number + width)
            if low <= high:
                found.append((low, high))
    return found


def value_of(form: Linear, chain: Chain, numbers: Mapping[str, Number], boxes: Floats) -> Number:
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
    """How much each side matters: the change across it, or its width where slopes are not known."""
    widths = boxes[..., 1] - boxes[..., 0]
    with np.errstate(invalid="ignore"):
        change = np.abs(slopes).max(axis=-1) * widths
    whole = np.max(widths, axis=0)
    unknown = ~np.isfinite(change).all(axis=1)
    change[unknown] = (widths / np.where(whole > 0.0, whole, 1.0))[unknown]
    return change


def decide_spans(chain: Chain, condition: Spans, start: float, turned: float, boxes: Floats) -> Decision:
    """Return the boxes in which every span that the run shows whole is long enough."""
    proven = [spans_last(chain, condition, start, turned, box) for box in boxes]
    widths = boxes[..., 1] - boxes[..., 0]
    return Decision(np.array(proven, dtype=bool), widths / np.maximum(widths.max(axis=0), 1e-300))


def _alone(decide: Callable[[Floats], Decision]) -> Cover:
    """A cover of no sides."""
    proven = bool(decide(np.zeros((1, 0, 2))).proven[0])
    return Cover(np.zeros((0, 2)), [-1], [] if proven else [np.zeros((0, 2))], 1, float(proven))


OUT, RISES, FALLS, IN, UNKNOWN = range(5)


def spans_last(chain: Chain, condition: Spans, start: float, turned: float, box: Floats) -> bool:
    """Return whether all spans of one box last long enough: angles are bisected where they begin and end."""
    edges = np.linspace(start, start + turned, max(2, math.ceil(turned / 0.05)) + 1)
    while True:
        kinds = _kinds(chain, condition.inside, edges, box)
        doubtful = _doubtful(kinds, edges, condition.at_least)
        if not doubtful.any():
            return True
        narrow = np.diff(edges) < FINEST
        if (doubtful & narrow).any():
            return False
        middle = 0.5 * (edges[:-1] + edges[1:])[doubtful]
        edges = np.sort(np.concatenate([edges, middle]))


def _kinds(chain: Chain, form: Linear, edges: Floats, box: Floats) -> Floats:
    """What a form does in each cell of angles, all over a box of parameters."""
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


def _doubtful(kinds: Floats, edges: Floats, at_least: float) -> Floats:
    """The cells that keep a span from being long enough: those about it that are not surely inside."""
    doubtful = np.zeros(len(kinds), dtype=bool)
    inside = np.flatnonzero(np.concatenate([[True], kinds == OUT, [True]]))
    for before, after in zip(inside[:-1], inside[1:], strict=True):
        cells = slice(before, after - 1)
        group = kinds[cells]
        if not len(group) or before == 0 or after == len(kinds) + 1:
            # an end of the run cuts it off; but another span may hide there
            cut = group == UNKNOWN
            doubtful[cells] = cut
            continue
        sure = np.flatnonzero(group == IN)
        if not len(sure):
            # from outside to outside: nothing, if it only rises or only falls
            doubtful[cells] = not (np.all(group == RISES) or np.all(group == FALLS))
            continue
        first, last = sure[0], sure[-1]
        whole = bool(np.all(group[first : last + 1] == IN))
        ends = bool(np.all(group[:first] == RISES) and np.all(group[last + 1 :] == FALLS))
        length = float(np.diff(edges)[cells][first : last + 1].sum()) * (1.0 - 1e-12)
        if not (whole and ends and length >= at_least):
            doubtful[cells] = group != IN
    return doubtful
