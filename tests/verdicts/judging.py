"""Verdicts on a random scene, beside the truth that far finer steps give."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from random import Random
from typing import Any, NamedTuple

import numpy as np
from verdicts.drawing import Claim, Drawn

from loomfmu import LoomfmuError, Verdict, judge, prepare
from loomfmu.cosim.master.grid import period
from loomfmu.cosim.scenes.scene import parse
from loomfmu.traces import Signals

BOUNDS = 6  # to either side of the truth, at random distances
NEAREST, FARTHEST = 1e-9, 0.3  # of the truth
CLEARANCE = 3e-4  # m: any that a belt may have
ROUNDING = 1e-12  # of value, bound and signal: what sums may leave
CONFIRMED = 4  # times the finest steps, where a verdict seems to be wrong
ANY = 0.25  # a bound that all claims take
SPREAD = 3.0  # times what the fine runs differ by: how uncertain the truth is


@dataclass(frozen=True)
class Truth:
    """What a claim judges, by far finer steps, how uncertain that is, and its distance from the bound.

    `scale` is the value's size, or that of the signal where the value is 0.
    """

    value: float
    uncertainty: float
    distance: float
    scale: float

    def says(self, whole: bool) -> bool | None:
        """Whether the claim holds; None where the truth is too uncertain to tell."""
        exact = whole and self.uncertainty < 0.5
        return self.distance >= 0.0 if abs(self.distance) > self.uncertainty or exact else None


class Stated(NamedTuple):
    """A claim as a scene states it: with a bound, None if it keeps its own."""

    claim: Claim
    bound: float | None

    @property
    def table(self) -> dict[str, Any]:
        """What a scene says of it."""
        return self.claim.table if self.bound is None else self.claim.table | {self.claim.bound: self.bound}


@dataclass(frozen=True)
class Found:
    """One verdict beside the truth; `first` is the first one of its claim and steps, whose error counts."""

    scene: Drawn
    stated: Stated
    setting: dict[str, Any]
    steps: float
    verdict: Verdict
    truth: Truth
    first: bool

    @property
    def claim(self) -> Claim:
        """The claim without its bound."""
        return self.stated.claim

    @property
    def holds(self) -> bool | None:
        """What is true."""
        return self.truth.says(self.claim.whole)

    @property
    def wrong(self) -> str:
        """The word of a verdict that is decided and not true."""
        counts = self.verdict.decided and self.holds is not None
        return self.verdict.word if counts and self.verdict.holds != self.holds else ""

    @property
    def off(self) -> float:
        """The true error."""
        return abs(self.verdict.worst - self.truth.value)

    @property
    def floor(self) -> float:
        """What of the true error the truth itself may be off by."""
        return self.truth.uncertainty + ROUNDING * max(abs(self.truth.value), abs(self.verdict.bound))

    @property
    def too_small(self) -> bool:
        """Whether the error that is stated does not cover the true one."""
        return math.isfinite(self.verdict.error) and self.off > self.verdict.error + self.floor


def text_with(scene: Drawn, claims: Sequence[Stated]) -> str:
    """The scene's text with claims."""
    lines = [scene.text.strip()]
    for stated in claims:
        lines += ["", "[[claims]]", *(f"{key} = {_toml(value)}" for key, value in stated.table.items())]
    return "\n".join(lines) + "\n"


def _toml(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    return f'"{value}"' if isinstance(value, str) else repr(value)


def judged(scene: Drawn) -> Iterator[Found]:
    """All verdicts on a scene: every claim, with bounds about the truth, on all of its steps."""
    random = Random(f"bounds {scene.family} {scene.number} {scene.text}")
    try:
        traces = fine_runs(scene, scene.fine)
    except LoomfmuError:  # a loop that is unstable with any steps
        return
    claims = _bounded(scene, traces[-1], random)
    known = [_truth(stated, traces) for stated in claims]
    both = [each for each in zip(claims, known, strict=True) if math.isfinite(each[1].value)]
    for setting in scene.settings if both else ():
        some = both
        if "accuracy" in setting:  # the steps follow from the claims: those of one claim
            one = random.choice(both)[0].claim
            some = [each for each in both if each[0].claim is one]
        yield from _on(scene, some, setting)


def _bounded(scene: Drawn, trace: Signals, random: Random) -> list[Stated]:
    """The claims, each with bounds to either side of what it judges, and those that it lists."""
    found = []
    for claim in scene.claims:
        truth = _truth(Stated(claim, ANY if claim.bound else None), [trace])
        if not math.isfinite(truth.value) or not claim.bound:
            found += [] if claim.bound else [Stated(claim, None)]
        elif claim.whole:
            bounds = [truth.value + each for each in (-1.0, 0.0, 1.0)]
            found += [Stated(claim, each) for each in bounds if each >= 0.0]
        else:
            low, high = claim.between
            bounds = [*_about(truth, random), *claim.also]
            found += [Stated(claim, each) for each in bounds if low <= each < high]
    return found


def _about(truth: Truth, random: Random) -> list[float]:
    """Bounds to either side of the truth, at random distances."""
    ends = (math.log(NEAREST), math.log(FARTHEST))
    distances = [truth.scale * math.exp(random.uniform(*ends)) for _ in range(2 * BOUNDS)]
    return [truth.value + (-1) ** place * each for place, each in enumerate(distances)]


def fine_runs(scene: Drawn, fine: Sequence[int]) -> list[Signals]:
    """The scene on fine steps."""
    claims = [Stated(claim, ANY if claim.bound else None) for claim in scene.claims]
    with prepare(parse(text_with(scene, claims))) as loom:
        return [loom.evaluate({"steps_per_revolution": steps}, errors="none").trace for steps in fine]


def _truth(stated: Stated, traces: Sequence[Signals]) -> Truth:
    """What a claim judges, on fine steps."""
    verdicts = [judge(trace, **stated.table) for trace in traces]
    values, last = [each.worst for each in verdicts], verdicts[-1]
    spread = SPREAD * (max(values) - min(values)) if all(map(math.isfinite, values)) else math.nan
    size = float(np.max(np.abs(traces[-1][last.signal]))) if last.signal in traces[-1] else 0.0
    distance = last.sense * (last.worst - last.bound)
    return Truth(last.worst, spread + ROUNDING * size, distance, abs(last.worst) or size or 1.0)


def _on(scene: Drawn, claims: Sequence[tuple[Stated, Truth]], setting: dict[str, Any]) -> Iterator[Found]:
    loaded = parse(text_with(scene, [stated for stated, _truth in claims]))
    try:
        with prepare(loaded, set=setting) as loom:
            found = loom.evaluate()
    except LoomfmuError:  # refused: an accuracy that is not reached, odd steps for half a revolution
        return
    steps, before = found.steps / found.scene.periods, None
    for (stated, truth), verdict in zip(claims, found.claims, strict=True):
        yield Found(scene, stated, setting, steps, verdict, truth, stated.claim is not before)
        before = stated.claim


def confirmed(found: Sequence[Found]) -> list[Found]:
    """The verdicts on one scene, with a truth from still finer steps where one of them seems to be wrong."""
    doubtful = [each for each in found if each.wrong or each.too_small]
    if not doubtful:
        return list(found)
    scene, finest = doubtful[0].scene, CONFIRMED * doubtful[0].scene.fine[-1]
    seen = with_samples(scene, [each.verdict.time for each in doubtful])
    traces = fine_runs(seen, [finest // 2 + 2, finest])  # with points of their own
    better = {id(each.truth): _truth(each.stated, traces) for each in doubtful}  # one for each bound
    return [_with_better(each, better.get(id(each.truth))) for each in found]


def with_samples(scene: Drawn, times: Iterable[float]) -> Drawn:
    """The scene with samples at some times, too: points of a table of an instance that nothing needs."""
    revolution = period(parse(scene.text))
    turns = sorted({time / revolution for time in times if time > 0.0})
    table = [[0.0, CLEARANCE], *([turn, CLEARANCE] for turn in turns)]
    inputs = f'[inputs]\n"witness.block_clearance" = {_toml(table)}\n'
    text = scene.text.rstrip() + '\n[witness]\ncomponent = "BeltWrap"\n'
    return scene._replace(text=text.replace("[inputs]\n", inputs) if "[inputs]\n" in text else text + inputs)


def _with_better(found: Found, finer: Truth | None) -> Found:
    """The verdict beside a finer truth; how far that is off the first one counts as uncertain."""
    if finer is None:
        return found
    uncertain = max(finer.uncertainty, abs(finer.value - found.truth.value))
    return replace(found, truth=replace(finer, uncertainty=uncertain))
