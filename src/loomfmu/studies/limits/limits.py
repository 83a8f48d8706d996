"""`limit`: where each claim of a scene begins to fail or to hold while one variable is varied.

With a second variable, there are such limits for each of its values.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import groupby, pairwise
from pathlib import Path
from typing import Any, overload

from ...cosim.claims.claims import called
from ...cosim.prepared import Prepared
from ...cosim.reading import protected
from ...cosim.run import prepare
from ...cosim.scenes.headings import heading
from ...cosim.scenes.scene import Scene
from ...display.progress import progress as progress_bar
from ...errors import LoomfmuError, listed, shown, within
from ...traces import Verdict
from ..cases import Case
from ..corners import corners_of
from ..evaluations import LOT, Evaluations
from ..span import Span, set_twice, span_of, warnings_of
from .proven import proven
from .results import Boundary, ClaimLimits, Limit, Limits, Stretch
from .search import Function, holds, near_zero, root, touching

POINTS = 41  # of the scan
CLOSE = 1e-4  # of a bracket: so near to a limit, the slope of a distance is that at the limit
MOST_POINTS = 100_001
ROUNDING = 1e-12  # of bound or value: a distance as small is 0
SAME = 1e-9  # of bound or value: a claim whose distance changes less does not depend on the variable


def limits_of(
    loom: Prepared,
    span: Span,
    points: int,
    fixed: dict[str, Any] | None = None,
    advance: Callable[[int], None] = lambda _runs: None,
    cases: Sequence[Case] = (Case(""),),
) -> Limits:
    """Find the limits of a prepared scene, in the worst of some cases.

    `fixed` are values that stay, `advance` counts points.
    """
    if not loom.scene.claims:
        raise LoomfmuError(f"{loom.scene.name}: the scene has no claims, so there is no limit to find")
    runs = _Runs(loom, [span], fixed, cases)
    own = runs.own()  # a key may set several values that differ in the scene
    of_run = runs.warnings
    grid = span.points(points)
    runs.scan(grid, advance)
    values = set(grid)
    dependent = [runs.depends(number, grid) for number in range(len(own))]
    for number, depends in enumerate(dependent):
        if depends:
            values |= set(_touched(runs.distance(number), grid))
    tried = sorted(values)
    found = [
        _claim_limits(loom.scene.claims[number], verdict, number, runs, tried, depends)
        for number, (verdict, depends) in enumerate(zip(own, dependent, strict=True))
    ]
    resolution = (span.high - span.low) / (points - 1)
    ranges, warnings = _common(found, span), warnings_of([span], of_run)
    title = _title(loom, [span.key], cases)
    return Limits(title, span, resolution, tuple(found), ranges, len(runs) + len(cases), warnings)


def _title(loom: Prepared, keys: Sequence[str], cases: Sequence[Case]) -> str:
    return heading(loom.scene, keys) + f", in the worst of {len(cases)} cases" * (len(cases) > 1)


class _Runs(Evaluations):
    """A prepared scene as functions of one variable."""

    def scan(self, grid: Sequence[float], advance: Callable[[int], None]) -> None:
        """Run all points. Raises LoomfmuError where one cannot be run, with the ones that can."""
        failed: dict[float, LoomfmuError] = {}
        for place, value in enumerate(grid):
            if place % LOT == 0:
                self.run_at((each,) for each in grid[place : place + LOT])
            try:
                self.at(value)
            except LoomfmuError as error:
                failed[value] = error
            advance(1)
        if failed:
            good = [list(each) for fails, each in groupby(grid, failed.__contains__) if not fails]
            first = next(iter(failed.values()))
            if not good:
                raise first
            (span,) = self._spans
            parts = listed(f"{span.number(each[0])} to {span.show(each[-1])}" for each in good)
            raise LoomfmuError(f"{first}; of the values tried, {parts} can be run")

    def distance(self, number: int) -> Function:
        """The distance of a claim, counted from 0, from its bound; NaN where it fails without one."""
        return lambda value: _distance(self.at(value)[number])

    def depends(self, number: int, grid: Sequence[float]) -> bool:
        """Return whether a claim depends on the variable at all."""
        verdicts = [self.at(value)[number] for value in grid]
        distances = [_distance(each) for each in verdicts]
        known = [each for each in distances if math.isfinite(each)]
        if len(known) < len(distances):  # where none is known, nothing is known of this either
            return True
        return max(known) - min(known) > SAME * max(map(_scale, verdicts))


def _scale(verdict: Verdict) -> float:
    return max(abs(verdict.worst), abs(verdict.bound))


def _distance(verdict: Verdict) -> float:
    """The distance of a verdict; what rounding makes of 0 is 0."""
    return 0.0 if abs(verdict.distance) <= ROUNDING * _scale(verdict) else verdict.distance


def _touched(distance: Function, grid: Sequence[float]) -> Iterator[float]:
    """Values beside the grid at which a claim is on the other side for less than a step of the grid."""
    for low, middle, high in zip(grid, grid[1:], grid[2:], strict=False):
        if near_zero(distance(low), distance(middle), distance(high)):
            found = touching(distance, low, middle, high)
            if found is not None:
                yield found


def _claim_limits(
    claim: dict[str, Any], verdict: Verdict, number: int, runs: _Runs, tried: Sequence[float], depends: bool
) -> ClaimLimits:
    """The limits of a claim, counted from 0, between the values that were tried."""
    distance = runs.distance(number)
    limits = [
        _limit(number, runs, low, high)
        for low, high in (pairwise(tried) if depends else ())
        if holds(distance(low)) != holds(distance(high))
    ]
    edges = [tried[0], *(each.value for each in limits), tried[-1]]
    holding = holds(distance(tried[0]))
    ranges, doubts = [], []
    for low, high in pairwise(edges):
        if holding:
            inside = [value for value in tried if low <= value <= high]
            doubt = _doubt(number, runs, inside, limits)
            ranges += _sure(number, runs, inside) if doubt else [Stretch(low, high)]
            if doubt:
                doubts.append(doubt)
        holding = not holding
    points = tuple((value, distance(value)) for value in tried)
    name = called(claim, verdict)
    return ClaimLimits(name, tuple(limits), tuple(ranges), depends, verdict, points, tuple(doubts))


def _doubt(
    number: int, runs: _Runs, inside: Sequence[float], limits: Sequence[Limit]
) -> tuple[float, str] | None:
    """Return where a claim, counted from 0, is undecided among values at which it seems to hold, and why.

    It is asked wherever it is near its bound, and where it is nearest, but not as near to a limit as that
    may be off.
    """
    clear = [
        value
        for value in inside
        if not any(abs(value - each.value) <= each.error < math.inf for each in limits)
    ]
    if not clear:
        return (inside[0], "the range is narrower than the numerical error of its limits") if inside else None
    nearest = min(clear, key=runs.distance(number))
    for value in sorted({nearest, *(each for each in clear if number in runs.near(each))}):
        verdict = runs.estimated(value)[number]
        if not verdict.holds:
            return value, verdict.note or f"numerical error {verdict.shown_error}"
    return None


def _sure(number: int, runs: _Runs, inside: Sequence[float]) -> list[Stretch]:
    """Return the ranges between values tried in which a claim, counted from 0, holds with its error."""
    parts = groupby(inside, lambda value: runs.estimated(value)[number].holds)
    found = [list(values) for holding, values in parts if holding]
    return [Stretch(each[0], each[-1]) for each in found if len(each) > 1]


def _limit(number: int, runs: _Runs, low: float, high: float) -> Limit:
    """The limit of a claim, counted from 0, in a bracket.

    Its error is that of the distance divided by the slope there.
    """
    distance = runs.distance(number)
    found = root(distance, low, high)
    begins = "to hold" if holds(distance(high)) else "to fail"
    if found.jumps:
        return Limit(*found[:3], begins, jumps=True)
    verdict = runs.estimated(found.value)[number]
    close = found.value + CLOSE * (max(low, high, key=lambda end: abs(end - found.value)) - found.value)
    steepness = abs((distance(close) - distance(found.value)) / (close - found.value))
    known = math.isfinite(verdict.error) and steepness > 0.0
    error = verdict.error / steepness if known else math.inf
    doubt = "" if known else verdict.note
    return Limit(*found[:3], begins, jumps=False, error=error, doubt=doubt, unsettled=verdict.unsettled)


def _common(claims: Sequence[ClaimLimits], span: Span) -> tuple[Stretch, ...]:
    """The ranges in which all claims hold, each with the claim that binds at its ends."""
    common = [Stretch(span.low, span.high)]
    for each in claims:
        both = ((one, two) for one in common for two in each.ranges)
        common = [
            Stretch(
                max(one.low, two.low),
                min(one.high, two.high),
                each.claim if two.low > one.low else one.below,
                each.claim if two.high < one.high else one.above,
            )
            for one, two in both
            if max(one.low, two.low) < min(one.high, two.high)
        ]
    return tuple(common)


def whole_points(points: Any, name: str = "points", least: int = 3) -> int:
    """A number of points. Raises LoomfmuError."""
    if isinstance(points, bool) or not isinstance(points, int) or not least <= points <= MOST_POINTS:
        raise LoomfmuError(f"{name} = {shown(points)} must be a whole number from {least} to {MOST_POINTS}")
    return points


ROWS = 11  # values of the second variable


@overload
def limit(
    scene: str | Path | Scene,
    *,
    vary: str,
    from_: Any = None,
    to: Any = None,
    set: dict[str, Any] | None = None,
    points: int = POINTS,
    rows: None = None,
    corners: bool = False,
    prove: bool = False,
    progress: bool = False,
) -> Limits: ...


@overload
def limit(
    scene: str | Path | Scene,
    *,
    vary: Sequence[str],
    from_: Any = None,
    to: Any = None,
    set: dict[str, Any] | None = None,
    points: int = POINTS,
    rows: int | None = None,
    corners: bool = False,
    prove: bool = False,
    progress: bool = False,
) -> Limits | Boundary: ...


def limit(
    scene: str | Path | Scene,
    *,
    vary: str | Sequence[str],
    from_: Any = None,
    to: Any = None,
    set: dict[str, Any] | None = None,  # the command's own word
    points: int = POINTS,
    rows: int | None = None,
    corners: bool = False,
    prove: bool = False,
    progress: bool = False,
) -> Limits | Boundary:
    """Find the values of a variable at which each claim of a scene begins to fail or to hold.

    Roots of the claims' distances to their bounds are found to 1e-9 of the value, between points at which
    the scene is run; extremes near 0 between them are searched for.

    Args:
        scene: path of a scene file or a system package (.ssp), or a scene that was read before
        vary: a variable such as "shaft.speed", or with its range "shaft.speed=300rpm..900rpm"; two of them
            for the limits of the first at values of the second
        from_, to: the range of the first variable, with units or in SI; by default its bounds if they are
            near, else from half to twice the scene's value
        set: values that differ from the scene's
        points: how many equally spaced values are tried first
        rows: how many values of the second variable there are, 11 by default
        corners: find limits that also hold at all corners of the scene's tolerances, of other values than
            those that vary
        prove: prove each range for all shaft angles, as `loomfmu.prove`; of one variable only
        progress: show a progress bar on a terminal or in a notebook

    Returns:
        `Limits` of one variable, a `Boundary` of two

    Raises:
        LoomfmuError: bad input, a value in the range that cannot be run, or an FMU that failed
    """
    keys = [vary] if isinstance(vary, str) else list(vary) if isinstance(vary, list | tuple) else []
    if not 1 <= len(keys) <= 2:
        raise LoomfmuError(
            f"vary = {shown(vary)} must be one variable such as 'shaft.speed', or a list of two"
        )
    if rows is not None and len(keys) == 1:
        raise LoomfmuError(
            f"rows = {shown(rows)} is how many values of a second variable are taken, but only {keys[0]} is"
            " varied; vary a second one or leave rows out"
        )
    if prove and len(keys) > 1:
        raise LoomfmuError(
            "limits are proven over one variable; loomfmu prove --over proves claims over several"
        )
    if prove and corners:
        raise LoomfmuError("limits at corners are not proven; loomfmu tolerances --prove proves worst cases")
    points, rows = whole_points(points), whole_points(ROWS if rows is None else rows, "rows", 2)
    with prepare(scene, set=set) as loom:
        protected(loom.scene)
        first = span_of(loom.scene, keys[0], from_, to)
        spans = [first, *(span_of(loom.scene, key) for key in keys[1:])]
        varying = [target for each in spans for target in each.varied.targets]
        cases = corners_of(loom.scene, varying) if corners else [Case("")]
        if len(keys) == 1:
            with progress_bar(f"limits of {first.key}", points, wanted=progress) as advance:
                found = limits_of(loom, first, points, None, advance, cases)
            return proven(loom, found) if prove else found
        second = spans[1]
        if twice := set_twice([first, second]):
            raise LoomfmuError(f"{first.key} and {second.key} both set {twice[2]}")
        with progress_bar(f"limits of {first.key}", points * rows, wanted=progress) as advance:
            return _boundary(loom, first, second, points, rows, advance, cases)


def _boundary(
    loom: Prepared,
    first: Span,
    second: Span,
    points: int,
    rows: int,
    advance: Callable[[int], None],
    cases: Sequence[Case],
) -> Boundary:
    values = second.points(rows)
    found = []
    for value in values:
        with within(f"at {second.key} = {second.show(value)}"):
            found.append(limits_of(loom, first, points, second.setting(value), advance, cases))
    title = _title(loom, [first.key, second.key], cases)
    return Boundary(title, first, second, tuple(values), tuple(found))
