"""Covers: boxes that together are one, each decided or bisected until it is."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .chain import middles
from .spans import Floats

MOST = 4096  # boxes that are looked at together
LEAST = 2.0**-40
DECIDED = -1  # in a tree: a box that is not bisected


@dataclass(frozen=True)
class Decision:
    """The boxes that are `proven`; of the others the face that is enough, and how much each side matters.

    A number that only rises along a side is lowest on the face at its low end. Shapes: (boxes,), (boxes,
    sides, 2), (boxes, sides).
    """

    proven: NDArray[np.bool_]
    faces: Floats
    weights: Floats


@dataclass
class Cover:
    """A box, shape (sides, 2), and how it was taken apart.

    `tree` lists the boxes from the whole one down, each before its parts. Of each box it has a number
    `face_code` for every side of which one end is enough, then the side across which that face was bisected,
    lower half first, or `DECIDED`. `open` are those left undecided, `share` is what is proven of the whole.
    """

    whole: Floats
    tree: list[int] = field(default_factory=list)
    open: list[Floats] = field(default_factory=list)
    boxes: int = 0
    share: float = 0.0


def face_code(sides: int, side: int, upper: bool) -> int:
    """Return what says in a tree that one end of a side is enough."""
    return sides + 2 * side + upper


@dataclass
class _Node:
    """A box of a tree: what was done with it, and its halves."""

    codes: list[int] = field(default_factory=list)
    halves: tuple["_Node", ...] = ()


def cover(whole: Floats, decide: Callable[[Floats], Decision], most: int) -> Cover:
    """Take a box apart until every part is proven, or so many boxes were looked at.

    A side is bisected no further than to the share `LEAST` of its width.
    """
    found, root = Cover(whole), _Node()
    narrowest = LEAST * np.maximum(whole[:, 1] - whole[:, 0], np.finfo(float).tiny)
    waiting, nodes, shares = whole[None], [root], np.ones(1)
    while len(waiting):
        now, waiting = waiting[:MOST], waiting[MOST:]
        here, nodes = nodes[:MOST], nodes[MOST:]
        share, shares = shares[:MOST], shares[MOST:]
        decision = decide(now)
        faces, left = decision.faces, ~decision.proven
        found.boxes += len(now)
        found.share += float(share[decision.proven].sum())
        wide = (faces[..., 1] - faces[..., 0]) > narrowest
        split = left & wide.any(axis=1)
        smaller = left & ~split & (faces != now).any(axis=(1, 2))
        if found.boxes + len(waiting) + 2 * split.sum() + smaller.sum() > most:
            split[:] = smaller[:] = False
        found.open += list(now[left & ~split & ~smaller])
        _note_faces(here, now, faces, split | smaller)
        weights = np.where(wide, np.maximum(decision.weights, 0.0), -1.0)[split]
        across = weights.argmax(axis=1) if len(weights) else np.zeros(0, dtype=int)
        for place, side in zip(np.flatnonzero(split), across, strict=True):
            here[place].codes.append(int(side))
            here[place].halves = (_Node(), _Node())
            nodes += here[place].halves
        nodes += [here[place] for place in np.flatnonzero(smaller)]
        waiting = np.concatenate([waiting, halves(faces[split], across), faces[smaller]])
        shares = np.concatenate([shares, np.repeat(share[split] / 2.0, 2), share[smaller]])
    stack = [root]
    while stack:
        node = stack.pop()
        found.tree += node.codes if node.halves else [*node.codes, DECIDED]
        stack += node.halves[::-1]
    return found


def _note_faces(nodes: Sequence[_Node], boxes: Floats, faces: Floats, taken: NDArray[np.bool_]) -> None:
    """Note in the nodes of boxes which faces of them are taken."""
    changed = (faces != boxes) & taken[:, None, None]
    for box, side, end in np.argwhere(changed):
        nodes[box].codes.append(face_code(boxes.shape[1], int(side), upper=not end))


def halves(boxes: Floats, sides: NDArray[np.int_]) -> Floats:
    """Return the halves of boxes, each bisected across one of its sides, one after the other."""
    parts = np.repeat(boxes, 2, axis=0)
    rows = np.arange(len(boxes))
    cut = middles(boxes)[rows, sides]
    parts[2 * rows, sides, 1] = cut
    parts[2 * rows + 1, sides, 0] = cut
    return parts
