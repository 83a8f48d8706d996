"""`limit`: the limits of a scene over one variable, or over one for each value of another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, overload

from ...cosim.prepared import Prepared
from ...cosim.reading import protected
from ...cosim.run import prepare
from ...cosim.scenes.headings import heading
from ...cosim.scenes.scene import Scene
from ...display.progress import progress as progress_bar
from ...errors import LoomfmuError, shown
from ..span import Span, set_twice, span_of
from .limits import POINTS, limits_of, whole_points
from .results import Boundary, Limits

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
    points, rows = whole_points(points), whole_points(ROWS if rows is None else rows, "rows", 2)
    with prepare(scene, set=set) as loom:
        protected(loom.scene)
        first = span_of(loom.scene, keys[0], from_, to)
        if len(keys) == 1:
            with progress_bar(f"limits of {first.key}", points, wanted=progress) as advance:
                return limits_of(loom, first, points, advance=advance)
        second = span_of(loom.scene, keys[1])
        if twice := set_twice([first, second]):
            raise LoomfmuError(f"{first.key} and {second.key} both set {twice[2]}")
        with progress_bar(f"limits of {first.key}", points * rows, wanted=progress) as advance:
            return _boundary(loom, first, second, points, rows, advance)


def _boundary(
    loom: Prepared, first: Span, second: Span, points: int, rows: int, advance: Callable[[int], None]
) -> Boundary:
    values = second.points(rows)
    found = []
    for value in values:
        try:
            found.append(limits_of(loom, first, points, second.setting(value), advance))
        except LoomfmuError as error:
            raise LoomfmuError(f"at {second.key} = {second.show(value)}: {error}") from None
    return Boundary(heading(loom.scene, [first.key, second.key]), first, second, tuple(values), tuple(found))
