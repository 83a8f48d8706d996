"""Decisions on boxes: those all over which a condition is sure to hold, and how to bisect the others."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...cosim.claims.conditions import FALLS, IN, OUT, RISES, UNKNOWN, Spans, Sum
from .chain import Chain, Number
from .cover import Decision
from .spans import Floats

SURE = 1e-6  # of the steepest slope by a side
TRIED = 4097  # angles at which something may happen


def value_of(form: Sum, chain: Chain, numbers: Mapping[str, Number], boxes: Floats) -> Number:
    """Return a sum of signals and parameters over boxes."""
    total = Number.of(form.constant, boxes)
    for share, name in form.terms:
        total = total.plus(chain.number(name, numbers, boxes), share)
    return total.narrowed(boxes)


def decide_any(chain: Chain, forms: Sequence[Sum], scale: Floats, boxes: Floats) -> Decision:
    """Return the boxes all over which one of the forms is not negative."""
    numbers = chain.numbers(boxes)
    found = [value_of(form, chain, numbers, boxes) for form in forms]
    low = np.max([each.values[:, 0] for each in found], axis=0)
    slopes = np.stack([each.slopes for each in found])
    joint = np.stack([slopes[..., 0].min(axis=0), slopes[..., 1].max(axis=0)], axis=-1)
    return decision(low >= 0.0, joint, scale, boxes)


def likely(chain: Chain, form: Sum, angles: tuple[float, float], box: Floats) -> float:
    """Return the angle, or the time, within two at which a form is highest in the middle of a box."""
    places = np.linspace(*angles, TRIED)
    points = np.tile(box.mean(axis=1), (TRIED, 1))
    boxes = np.repeat(np.column_stack([places, points])[..., None], 2, axis=-1)
    return float(places[value_of(form, chain, chain.numbers(boxes), boxes).values[:, 0].argmax()])


@dataclass
class Lowest:
    """Decides on boxes by whether a form can be lower there: its lowest value is from `low` to `high`.

    A box is done where the form cannot be lower, but by `width`, than what it reaches elsewhere.
    """

    chain: Chain
    form: Sum
    scale: Floats
    width: float
    low: float = math.inf
    high: float = math.inf

    def __call__(self, boxes: Floats) -> Decision:
        """Return the boxes that need not be taken apart."""
        found = value_of(self.form, self.chain, self.chain.numbers(boxes), boxes)
        low, reached = found.values[:, 0], np.minimum(found.middle[:, 1], found.values[:, 1])
        self.high = min(self.high, float(reached.min()))
        done = low >= self.high - self.width
        self.low = min(self.low, float(low[done].min(initial=math.inf)))
        return decision(done, found.slopes, self.scale, boxes)


def decision(proven: NDArray[np.bool_], slopes: Floats, scale: Floats, boxes: Floats) -> Decision:
    """Return a decision on boxes over which a number has these slopes.

    A side matters by how little the slope along it is known, and by its width on a `scale` (sides,): to
    bisect a narrow side again leaves the slopes as they are.
    """
    faces = boxes.copy()
    # where a slope is about 0, the arithmetic of the check may find one of either sign
    surely = SURE * np.abs(slopes).max(axis=-1)
    rises = (surely > 0.0) & (slopes[..., 0] >= surely)
    falls = (surely > 0.0) & (slopes[..., 1] <= -surely)
    faces[..., 1] = np.where(rises, boxes[..., 0], boxes[..., 1])
    faces[..., 0] = np.where(falls & ~rises, boxes[..., 1], boxes[..., 0])
    widths = faces[..., 1] - faces[..., 0]
    with np.errstate(invalid="ignore"):
        weights = (slopes[..., 1] - slopes[..., 0]) * widths * np.sqrt(widths / scale)
    unknown = ~np.isfinite(weights).all(axis=1)
    weights[unknown] = (widths / scale)[unknown]
    return Decision(proven, faces, weights)


def decide_spans(chain: Chain, condition: Spans, run: tuple[float, float], boxes: Floats) -> Decision:
    """Return the boxes in which every span that the run shows whole is long enough."""
    proven = [condition.hold(*run, partial(_kinds, chain, box)) for box in boxes]
    widths = boxes[..., 1] - boxes[..., 0]
    return Decision(np.array(proven, dtype=bool), boxes, widths / np.maximum(widths.max(axis=0), 1e-300))


def _kinds(chain: Chain, box: Floats, form: Sum, edges: Floats) -> NDArray[np.int_]:
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
