"""The number of steps that an accuracy takes: few at first, then more until all errors are below."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

from ..errors import LoomfmuError
from ..traces import Signals, Verdict
from .claims.claims import called
from .dependence import Judged
from .estimates import SHARES, Coarser, Estimates
from .master.grid import crowded, uniform
from .scenes.instances import altered
from .scenes.scene import Scene
from .scenes.settings import ROUNDING

FEWEST, MOST = 15, 13_000  # steps in a revolution
GROWTH = 0.5 * (1.0 + math.sqrt(5.0))  # so that the runs before are those of `estimates.SHARES`
MOST_STEPS = 10_000_000  # in a run


class Choice(NamedTuple):
    """A scene with the steps that were chosen, what coarser ones gave, and a line that says so."""

    scene: Scene
    coarser: Coarser
    text: str


def fewest_steps(
    scene: Scene,
    estimates: Estimates,
    by_steps: Sequence[int],
    judge: Callable[[Scene], tuple[Signals, Sequence[Verdict]]],
) -> Choice:
    """The fewest steps with which the error of every claim of a scene is below its `accuracy`.

    `by_steps` are the claims, counted from 0, whose errors coarser steps show: without any, one run suffices.
    An error counts as a share of the claim's bound, or of its worst value where the bound is 0. Raises
    LoomfmuError where the accuracy is not reached.
    """
    wanted = scene.accuracy or 0.0
    before: list[Judged] = []
    reached = f"no number of steps that was tried fits revolutions = {scene.periods:g}"
    for steps in tried_steps(scene.periods):
        total = scene.periods * steps
        if not 0.0 < total <= MOST_STEPS or abs(total - round(total)) > ROUNDING * total:
            continue
        tried = altered(scene, steps_per_period=steps)
        trace, verdicts = judge(tried)
        if len(before) == len(SHARES) or not by_steps:
            coarser = Coarser(by_steps, tuple(before))
            coarsest = altered(scene, steps_per_period=round(SHARES[-1] * steps))
            if crowded(coarsest):  # those that were tried before are hardly coarser
                coarser = estimates.coarser(tried, uniform(tried), by_steps)
            exact = {*range(len(verdicts))}.difference(by_steps)
            estimated = estimates.of(tried, trace, verdicts, coarser, exact)
            errors = [_share(estimated[each], estimates.claims[each].noise) for each in estimates.own_claims]
            number, error = max(enumerate(errors), key=lambda each: each[1])
            if error <= wanted:
                text = (
                    f"chose {steps} steps in a revolution: estimated error {error:.1g}, accuracy {wanted:g}"
                )
                return Choice(tried, replace(coarser, longer=estimates.longer(tried, by_steps)), text)
            signal = verdicts[number].signal
            name = called(scene.claims[number], verdicts[number]) if number < len(scene.claims) else signal
            if estimated[number].error <= estimates.claims[number].left_by_model(trace, verdicts[number]):
                raise LoomfmuError(
                    f"accuracy = {wanted:g} cannot be reached: with any steps, the error of {name!r} is at"
                    f" least {error:.1g} of its bound ({trace.error(signal)}); set a larger accuracy, or"
                    " steps_per_revolution"
                )
            reached = f"with {steps} steps in a revolution, the error of {name!r} is {error:.1g} of its bound"
        before = [estimates.judged(trace, by_steps), *before[: len(SHARES) - 1]]
    raise LoomfmuError(
        f"accuracy = {wanted:g} is not reached: {reached}; set a larger accuracy, or steps_per_revolution"
    )


def tried_steps(periods: float) -> Iterator[int]:
    """Numbers of steps in a revolution, few first, all of which fit the revolutions of a run.

    Each is about 1.618 times the one before, and no multiple of it: the sums of Fibonacci.
    """
    whole = Fraction(periods).limit_denominator(MOST_STEPS).denominator
    fewer = max(2, round(FEWEST / whole))
    more = round(GROWTH * fewer)
    while whole * fewer <= MOST:
        yield whole * fewer
        fewer, more = more, fewer + more


def _share(verdict: Verdict, noise: float) -> float:
    """The error of a verdict as a share of its bound; none where steps do not count."""
    if not math.isfinite(verdict.worst) or verdict.error <= noise:
        return 0.0
    if not math.isfinite(verdict.error):
        return math.inf
    scale = abs(verdict.bound) or abs(verdict.worst)
    return verdict.error / scale if scale else math.inf
