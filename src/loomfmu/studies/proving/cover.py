"""Covers: boxes that together are one, each decided or bisected until it is."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .chain import middles
from .spans import Floats

MOST = 4096  # boxes that are looked at together
DECIDED = -1  # in a tree: a box that is not bisected


@dataclass(frozen=True)
class Decision:
    """The boxes that are `proven`, and how much each side of the others matters (boxes, sides)."""

    proven: NDArray[np.bool_]
    weights: Floats


@dataclass
class Cover:
    """A box, shape (sides, 2), and how it was bisected: the side of each bisected box, lower half first.

    `tree` lists the boxes from the whole one down, each before its halves: the side across which it was
    bisected, or `DECIDED`. `open` are those left undecided, `share` is what is proven of the whole.
    """

    whole: Floats
    tree: list[int] = field(default_factory=list)
    open: list[Floats] = field(default_factory=list)
    boxes: int = 0
    share: float = 0.0

    @property
    def proven(self) -> bool:
        """Return whether all of the box is proven."""
        return not self.open


def cover(whole: Floats, decide: Callable[[Floats], Decision], most: int, least: float = 2.0**-40) -> Cover:
    """Bisect a box until every part is proven, or so many boxes were looked at.

    A side is bisected no further than to the share `least` of its width.
    """
    found = Cover(whole)
    widths = np.maximum(whole[:, 1] - whole[:, 0], np.finfo(float).tiny)
    sides, halves = [DECIDED], [(0, 0)]  # of each box, by its number
    waiting, numbers = whole[None], np.array([0])
    shares = np.ones(1)
    while len(waiting):
        now, waiting = waiting[:MOST], waiting[MOST:]
        ids, numbers = numbers[:MOST], numbers[MOST:]
        share, shares = shares[:MOST], shares[MOST:]
        decision = decide(now)
        found.boxes += len(now)
        found.share += float(share[decision.proven].sum())
        wide = (now[..., 1] - now[..., 0]) > least * widths
        weights = np.where(wide, np.maximum(decision.weights, 0.0), -1.0)
        split = ~decision.proven & wide.any(axis=1)
        if found.boxes + len(waiting) + 2 * split.sum() > most:
            split[:] = False
        found.open += list(now[~decision.proven & ~split])
        across = weights.argmax(axis=1) if len(whole) else np.zeros(len(now), dtype=int)
        for place in np.flatnonzero(split):
            sides[ids[place]] = int(across[place])
            halves[ids[place]] = (len(sides), len(sides) + 1)
            sides += [DECIDED, DECIDED]
            halves += [(0, 0), (0, 0)]
        parts = np.repeat(now[split], 2, axis=0)
        rows, side = np.arange(len(parts)), np.repeat(across[split], 2)
        cut = middles(now[split])[np.arange(split.sum()), across[split]]
        parts[rows[::2], side[::2], 1] = cut
        parts[rows[1::2], side[1::2], 0] = cut
        waiting = np.concatenate([waiting, parts])
        numbers = np.concatenate([numbers, np.array([n for i in ids[split] for n in halves[i]], dtype=int)])
        shares = np.concatenate([shares, np.repeat(share[split] / 2.0, 2)])
    stack = [0]
    while stack:
        box = stack.pop()
        found.tree.append(sides[box])
        if sides[box] != DECIDED:
            stack += [halves[box][1], halves[box][0]]
    return found
