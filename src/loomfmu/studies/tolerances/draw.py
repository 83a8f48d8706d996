"""`draw_looms`: the share of looms in which claims hold, while values vary as their distributions say."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...cosim.claims.arguments import Quantity
from ...cosim.claims.claims import called
from ...cosim.prepared import Prepared
from ...cosim.reading import protected
from ...cosim.run import prepare
from ...cosim.scenes.headings import heading
from ...cosim.scenes.scene import Scene
from ...display.progress import progress as progress_bar
from ...errors import LoomfmuError, shown
from ...traces.verdict import FAILS, HOLDS
from ...units import Si
from ..fitting.measured import Floats
from .distributions import Distribution, distribution_of
from .shares import ALL, Share, Shares
from .tolerances import check_asked, check_twice, tolerance_of

LOT = 100  # looms that are run at once


def draw_looms(
    scene: str | Path | Scene,
    *,
    looms: int = 1000,
    vary: Sequence[str] = (),
    set: dict[str, Any] | None = None,  # the command's own word
    seed: int = 1,
    share: float | str | None = None,
    progress: bool = False,
) -> Shares:
    """Draw looms from the tolerances of a scene, run each, and count those in which the claims hold.

    Looms are drawn independently of each other, at random: only then is the confidence of the shares known.

    Args:
        scene: path of a scene file or a system package (.ssp), or a scene that was read before
        looms: the number of looms
        vary: uniform distributions such as "belt.guide_clearance=0.2mm..0.5mm"; by default those of the
            scene's table [tolerances]
        set: values that differ from the scene's
        seed: of the drawing
        share: the share of all looms, such as "99 %", in which all claims are to hold
        progress: show a progress bar on a terminal or in a notebook

    Raises:
        LoomfmuError: no tolerances, no claims, bad input, or values that cannot be run
    """
    for name, number in (("looms", looms), ("seed", seed)):
        if isinstance(number, bool) or not isinstance(number, int) or number < 1:
            raise LoomfmuError(f"{name} = {shown(number)} must be a whole number, 1 or more")
    limits = Quantity(between=(0.0, 1.0), of="all looms")
    asked = None if share is None else limits.number(share, "share", "1")
    with prepare(scene, set=set) as loom:
        protected(loom.scene)
        keys = [vary] if isinstance(vary, str) else list(vary)
        check_asked(loom.scene, keys)
        ranges = [tolerance_of(loom.scene, key, None, None) for key in keys]
        given = {each.key: (Si(each.low), Si(each.high)) for each in ranges} or loom.scene.tolerances
        found = [distribution_of(loom.scene, *each) for each in given.items()]
        check_twice(ranges or found)
        with progress_bar("looms", looms, wanted=progress) as advance:
            return _drawn(loom, found, looms, seed, asked, advance)


def _drawn(
    loom: Prepared,
    distributions: Sequence[Distribution],
    looms: int,
    seed: int,
    asked: float | None,
    advance: Callable[[int], None],
) -> Shares:
    """Draw looms, run each, and count in how many the claims hold."""
    values = _values(distributions, looms, seed)
    words, warnings = [], tuple[str, ...]()
    for first in range(0, looms, LOT):
        rows = range(first, min(first + LOT, looms))
        settings = {
            each.key: [each.varied.setting(values[each.key][row]) for row in rows] for each in distributions
        }
        many = loom.evaluate_many(settings, errors="near")
        for place, row in enumerate(rows):
            try:
                verdicts = many.verdicts(place)
            except LoomfmuError as error:
                drawn = (f"{each.key} = {each.varied.show(values[each.key][row])}" for each in distributions)
                where = f"loom {row + 1} of {looms}, with {', '.join(drawn)}"
                raise LoomfmuError(f"{where}: {error}") from None
            warnings = warnings or many.warnings(place)
            words.append([each.word for each in verdicts])
            advance(1)
    table = np.array(words)
    names = [called(*each) for each in zip(loom.scene.claims, verdicts, strict=True)]
    claims = tuple(_share(name, table[:, [place]]) for place, name in enumerate(names))
    title = heading(loom.scene, [each.key for each in distributions])
    doubts = (doubt for each in distributions for doubt in each.doubts)
    return Shares(
        title,
        tuple(distributions),
        _share(ALL, table),
        claims,
        seed,
        asked,
        values,
        table,
        tuple(dict.fromkeys((*doubts, *warnings))),
    )


def _share(claim: str, words: Any) -> Share:
    """Return how many looms hold in all columns, and in how many that is open."""
    holding, failing = np.all(words == HOLDS, axis=1), np.any(words == FAILS, axis=1)
    return Share(claim, int(holding.sum()), int((~holding & ~failing).sum()), len(words))


def _values(distributions: Sequence[Distribution], looms: int, seed: int) -> dict[str, Floats]:
    """Values of each key, drawn independently; those measured in one file row by row."""
    generator = np.random.default_rng(seed)
    shares: dict[Any, Floats] = {}
    found = {}
    for each in distributions:
        drawn_by = each.measured or each.key
        if drawn_by not in shares:
            # open at both ends, where quantiles may be infinite
            shares[drawn_by] = np.clip(generator.random(looms), np.finfo(float).tiny, None)
        found[each.key] = np.asarray(each.quantiles(shares[drawn_by]), dtype=float)
    return found
