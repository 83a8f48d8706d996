"""`tolerances`: the worst case of every claim while values lie anywhere within their tolerances."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from ...cosim.claims.claims import called
from ...cosim.prepared import Prepared
from ...cosim.reading import protected
from ...cosim.run import prepare
from ...cosim.scenes.headings import heading
from ...cosim.scenes.scene import Scene
from ...display.progress import progress as progress_bar
from ...errors import LoomfmuError
from ...sweeps.varied import Keyed
from ..evaluations import LOT, Evaluations
from ..gradient import move_of, slopes_of
from ..polished import Floats, Measured, Tangent, differences, polished
from ..span import Span, set_twice, span_of, warnings_of
from .distributions import ends_within
from .proven import proven
from .results import SAME, Cost, Tolerances, WorstCase

Shares = tuple[float, ...]  # of the ranges, 0 to 1
CORNERS = 6  # tolerances of which all corners are tried: 2 to that power
SCATTERED = 16  # points within the box for each tolerance
LAST = 2.0**-16  # of a range: the last steps of the search from the worst point found


def tolerances(
    scene: str | Path | Scene,
    *,
    vary: Sequence[str] = (),
    set: dict[str, Any] | None = None,  # the command's own word
    prove: bool = False,
    progress: bool = False,
) -> Tolerances:
    """Search the worst case of every claim within the tolerances of a scene.

    Tried are the scene's values, the corners of the box (of up to 6 tolerances all of them), and points
    scattered in it; from the worst of these the search goes on by linear programs, with the components'
    derivatives where a scene has them.

    Args:
        scene: path of a scene file or a system package (.ssp), or a scene that was read before
        vary: tolerances such as "belt.guide_clearance=0.2mm..0.5mm"; by default those of the scene's
            table [tolerances]
        set: values that differ from the scene's
        prove: also prove the worst cases, for all shaft angles and all values within the tolerances
        progress: show a progress bar on a terminal or in a notebook

    Raises:
        LoomfmuError: no tolerances, no claims, bad input, or values within the box that cannot be run
    """
    with prepare(scene, set=set) as loom:
        protected(loom.scene)
        loaded = loom.scene
        keys = [vary] if isinstance(vary, str) else list(vary)
        check_asked(loaded, keys)
        given = [(key, None, None) for key in keys] or [
            (key, *_ends(loaded, key)) for key in loaded.tolerances
        ]
        spans = [tolerance_of(loaded, *each) for each in given]
        _check(spans)
        points = _points(spans)
        with progress_bar("worst cases", len(points) + len(loaded.claims), wanted=progress) as advance:
            found = _Box(loom, spans).searched(points, advance)
        return replace(found, proofs=proven(loom, spans, found.claims)) if prove else found


def check_asked(scene: Scene, keys: Sequence[str]) -> None:
    """Refuse a scene without tolerances, given by `keys` or by itself, or without claims."""
    if not (keys or scene.tolerances):
        raise LoomfmuError(
            f'{scene.name}: there are no tolerances; write [tolerances] "belt.guide_clearance" ='
            ' ["0.2 mm", "0.5 mm"], or --vary belt.guide_clearance=0.2mm..0.5mm'
        )
    if not scene.claims:
        raise LoomfmuError(f"{scene.name}: the scene has no claims, so there is no worst case")


def _ends(scene: Scene, key: str) -> tuple[Any, Any]:
    """The ends of a tolerance of the scene, for the worst case. Raises LoomfmuError where it has none."""
    ends = ends_within(scene, key)
    if ends is None:
        raise LoomfmuError(
            f"{scene.name}: [tolerances]: {key} is normal without ends, so it has no worst case; add"
            ' within = ["LOW", "HIGH"], or draw looms'
        )
    return ends


def tolerance_of(scene: Scene, key: str, low: Any, high: Any) -> Span:
    """A tolerance. Raises LoomfmuError for one without both ends: they cannot be guessed."""
    if low is None and "=" not in key:
        raise LoomfmuError(f"{key}: a tolerance needs both ends, such as {key}=LOW..HIGH with units")
    try:
        return span_of(scene, key, low, high)
    except LoomfmuError as error:
        raise LoomfmuError(
            f"{scene.name}: [tolerances]: {error}" if low is not None else str(error)
        ) from None


def check_twice(varied: Sequence[Keyed]) -> None:
    """Refuse two tolerances of one value. Raises LoomfmuError."""
    if twice := set_twice(varied):
        raise LoomfmuError(f"{twice[0].key} has two tolerances")


def _check(spans: Sequence[Span]) -> None:
    check_twice(spans)
    for span in spans:
        if not span.low <= span.value <= span.high:
            raise LoomfmuError(
                f"{span.key} = {span.show(span.value)} in the scene is outside its tolerance, {span.text}"
            )


def _points(spans: Sequence[Span]) -> list[Shares]:
    """The scene's own values, corners, and points scattered in the box."""
    from scipy.stats import qmc

    size = len(spans)
    own = tuple((span.value - span.low) / (span.high - span.low) for span in spans)
    if size <= CORNERS:
        corners = list(product((0.0, 1.0), repeat=size))
    else:
        corners = [
            tuple(end if place == each else own[place] for place in range(size))
            for each in range(size)
            for end in (0.0, 1.0)
        ]
    scattered = [tuple(point) for point in qmc.Halton(size, seed=1).random(SCATTERED * size).tolist()]
    return [own, *corners, *scattered]


class _Box(Evaluations):
    """A prepared scene as a function of the places in its tolerances."""

    def __init__(self, loom: Prepared, spans: Sequence[Span]):
        super().__init__(loom, spans)
        self._slopes: dict[Shares, Floats] = {}

    def searched(self, points: Sequence[Shares], advance: Callable[[int], None]) -> Tolerances:
        """The worst case of each claim."""
        for first in range(0, len(points), LOT):
            lot = self._at_once(points[first : first + LOT])
            for point in lot:
                self.at(*self._values(point))
                advance(1)
        found = []
        for number in range(len(self._loom.scene.claims)):
            found.append(self._worst_case(number, points))
            advance(1)
        title = heading(self._loom.scene, [each.key for each in self._spans])
        runs, warnings = len(self) + len(self._slopes), warnings_of(self._spans, self.warnings)
        return Tolerances(title, self._spans, tuple(found), runs, warnings)

    def _at_once(self, points: Sequence[Shares]) -> Sequence[Shares]:
        """Run points together, and return them."""
        self.run_at(tuple(self._values(point)) for point in points)
        return points

    def _worst_case(self, number: int, points: Sequence[Shares]) -> WorstCase:
        def distance(point: Shares) -> float:
            found = self.at(*self._values(point))[number].distance
            return -math.inf if math.isnan(found) else found  # it fails without one

        ranked = sorted(points, key=distance)
        least, most = distance(ranked[0]), distance(ranked[-1])
        bound = self.at(*self._values(points[0]))[number].bound
        alike = least == most or most - least <= SAME * abs(bound)
        worst = points[0] if alike else min(ranked[0], self._descended(number, ranked[0]), key=distance)
        own, verdict = (self.estimated(*self._values(place))[number] for place in (points[0], worst))
        costs = []
        for place, span in enumerate(self._spans):
            restored = (*worst[:place], points[0][place], *worst[place + 1 :])
            if (given_back := distance(restored) - distance(worst)) > SAME * abs(verdict.bound):
                costs.append(Cost(span.key, given_back))
        name = called(self._loom.scene.claims[number], own)
        values = dict(zip((span.key for span in self._spans), self._values(worst), strict=True))
        costs.sort(key=lambda each: -each.distance)
        return WorstCase(name, own, verdict, values, tuple(costs), not alike)

    def _descended(self, number: int, point: Shares) -> Shares:
        """A point near that one where a claim, counted from 0, is nearer to its bound, if there is one."""
        scale = abs(self.at(*self._values(point))[number].bound) or 1.0

        def near(points: Sequence[Floats]) -> list[Measured | None]:
            self._at_once([tuple(each.tolist()) for each in points])
            distances = (self.at(*self._values(each.tolist()))[number].distance for each in points)
            return [
                Measured(np.array([each / scale]), np.array([])) if math.isfinite(each) else None
                for each in distances
            ]

        def tangent(x: Floats) -> Tangent | None:
            (here,), slopes = near([x]), self._slopes_at(tuple(x.tolist()))
            if here is None or slopes is None or not np.all(np.isfinite(slopes[number])):
                return differences(near, x)
            return Tangent.of(x, here, slopes[[number]] / scale, np.zeros((0, len(x))))

        return tuple(polished(tangent, np.array(point), LAST).tolist())

    def _slopes_at(self, point: Shares) -> Floats | None:
        """The slopes of all distances by the shares of the tolerances; None where there are none."""
        if not self._loom.has_derivatives:
            return None
        if point not in self._slopes:
            scene, values = self._loom.scene, self._values(point)
            moves = [
                (settings, change / (span.high - span.low))
                for span, value in zip(self._spans, values, strict=True)
                for settings, change in [move_of(scene, span.varied, value)]
            ]
            try:
                run = self._loom.derived(self._settings(values), moves)
            except LoomfmuError:
                return None
            _below, self._slopes[point] = slopes_of(run, len(scene.claims))
        return self._slopes[point]

    def _values(self, point: Shares) -> list[float]:
        return [span.at(share) for span, share in zip(self._spans, point, strict=True)]
