"""Designs near one, their values given as shares of their ranges: measured, and with tangents."""

from collections.abc import Callable, Sequence

import numpy as np

from ..polished import Floats, Measured, Tangent, differences
from .runs import Design, Point, Runs

Pieces = Callable[[Floats], Floats]  # of the goals of a design; affine


class Near:
    """The designs that differ from one in the values of its ranges."""

    def __init__(self, runs: Runs, design: Design, pieces: Pieces):
        self._runs, self._design, self._pieces = runs, design, pieces

    def at(self, shares: Sequence[Floats]) -> list[Measured | None]:
        """The measures of several of them, run at once; None of one that has none."""
        return [
            Measured(self._pieces(each.heights), np.where(np.isnan(each.room), -1.0, each.room))
            if not each.error and np.all(np.isfinite(each.heights))
            else None
            for each in self._runs.at(list(map(self._point, shares)))
        ]

    def tangent(self, x: Floats) -> Tangent | None:
        """The tangent there: by the components' derivatives, or by differences where they have none."""
        (here,) = self.at([x])
        slopes = None if here is None else self._runs.slopes(self._point(x))
        if here is None or slopes is None:
            return differences(self.at, x)
        (design,), goals = self._runs.at([self._point(x)]), len(self._design.heights)
        moved = [self._pieces(design.heights + each) - here.heights for each in slopes[:goals].T]
        return Tangent.of(x, here, np.stack(moved, axis=1), slopes[goals:])

    def _point(self, shares: Floats) -> Point:
        point = list(self._design.point)
        for place, share in zip(self._runs.study.continuous, shares.tolist(), strict=True):
            point[place] = share
        return tuple(point)
