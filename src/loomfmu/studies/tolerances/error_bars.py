"""Error bars of verdicts by the tolerances of a scene, to first order: by the gradients of the claims."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ...cosim.prepared import Derived, Move, Notes
from ...cosim.scenes.scene import Scene
from ...errors import LoomfmuError
from ...traces import Verdict
from ...traces.verdict import remarked
from ..gradient import move_of, slopes_of, without_gradient
from ..polished import Floats
from ..span import port_of
from .distributions import Distribution, distribution_of
from .results import SAME
from .tolerances import check_twice

Derive = Callable[[Sequence[Move]], Derived]
SHARES = (np.arange(10_000) + 0.5) / 10_000  # of all looms, by which a deviation is known to 1 %
NONE = "no error bar by tolerances"
UNKNOWN = "it has no distance from its bound with a derivative"


@dataclass(frozen=True)
class _Bar:
    """The most that tolerances may take from the distance of a claim or add to it, and its deviation."""

    loss: float
    gain: float
    deviation: float

    def on(self, verdict: Verdict) -> Verdict:
        """The verdict with this bar, which its note shows."""
        loss = self.loss if math.isfinite(self.loss) else math.nan
        return replace(*remarked([verdict], {0: self._text(verdict)}), loss=loss, deviation=self.deviation)

    def _text(self, verdict: Verdict) -> str:
        def share(size: float) -> str:
            return f"{100.0 * size / abs(verdict.bound):.2g} %" if verdict.bound else verdict.shown(size, 2)

        if max(self.loss, self.gain) <= SAME * (abs(verdict.bound) or abs(verdict.worst)):
            return "tolerances do not move it (first order)"
        loss, gain, deviation = map(share, (self.loss, self.gain, self.deviation))
        if not math.isfinite(self.loss + self.gain):
            return f"standard deviation {deviation} by tolerances (first order)"
        ends = f"+-{loss}" if loss == gain else f"-{loss} to +{gain}"
        return f"{ends} by tolerances (first order), standard deviation {deviation}"


def error_bars(scene: Scene, derive: Derive, claims: int) -> Notes:
    """Return what gives the verdicts on a scene's claims their error bars, or notes why one has none.

    Raises LoomfmuError for tolerances that cannot be read.
    """
    found = [distribution_of(scene, *each) for each in scene.tolerances.items()]
    check_twice(found)
    values = [port_of(scene, each.varied)[1] for each in found]
    for each, value in zip(found, values, strict=True):
        if not each.ends[0] <= value <= each.ends[1]:
            return _without(claims, f"{each.key} = {each.varied.show(value)} is outside its tolerance")
    try:
        slopes = slopes_of(derive([move_of(scene, each.varied) for each in found]), claims)
    except LoomfmuError as error:
        return _without(claims, str(error))
    drawn = [np.asarray(each.quantiles(SHARES)) for each in found]
    bars = [_bar(found, values, drawn, slopes[:, number]) for number in range(claims)]
    known = np.all(np.isfinite(slopes), axis=(0, 2)).tolist()

    def why(number: int, verdict: Verdict) -> str:
        if found := without_gradient(scene, verdict):
            return found
        return "" if known[number] and math.isfinite(verdict.distance) else UNKNOWN

    def barred(verdicts: tuple[Verdict, ...]) -> tuple[Verdict, ...]:
        whys = {number: why(number, each) for number, each in enumerate(verdicts)}
        noted = remarked(verdicts, {number: f"{NONE}: {text}" for number, text in whys.items() if text})
        return tuple(each if whys[number] else bars[number].on(each) for number, each in enumerate(noted))

    return barred


def _without(claims: int, why: str) -> Notes:
    return partial(remarked, remarks=dict.fromkeys(range(claims), f"{NONE}: {why}"))


def _bar(
    found: Sequence[Distribution], values: Sequence[float], drawn: Sequence[Floats], slopes: Floats
) -> _Bar:
    """The bar of a claim by its slopes, (sides, values), for values `drawn` from each distribution."""
    each_with = list(zip(found, values, drawn, slopes.T.tolist(), strict=True))
    changes = [_changes(np.array(each.ends), value, sides) for each, value, _drawn, sides in each_with]
    loss, gain = (float(sum(max(0.0, np.max(side * each)) for each in changes)) for side in (-1.0, 1.0))
    together: dict[object, Floats] = {}  # by all that were measured together
    for each, value, at, sides in each_with:
        source = each.measured or each.key
        together[source] = together.get(source, 0.0) + _changes(at, value, sides)
    return _Bar(loss, gain, math.hypot(*(float(np.std(each)) for each in together.values())))


def _changes(at: Floats, value: float, sides: Sequence[float]) -> Floats:
    """The changes of a distance where a value changes, by its slopes below and above: 0 where these are 0."""
    slopes = np.where(at < value, *sides)
    with np.errstate(invalid="ignore"):
        return np.where(slopes == 0.0, 0.0, slopes * (at - value))
