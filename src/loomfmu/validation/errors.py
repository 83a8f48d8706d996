"""How sure verdicts are: estimated beside true errors of random scenes.

`python -m loomfmu.validation.errors` measures them anew and writes the figures that the report shows.
"""

import csv
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random
from typing import NamedTuple

import numpy as np

from ..cosim.run import prepare
from ..cosim.scenes.scene import parse
from ..printed import as_csv
from .sections import Chapter, Row, Section

FIGURES = Path(__file__).with_name("errors.csv")
SEED, SCENES = 20, 240
FINER = 32  # times the steps, for the true values
ROUNDING = 1e-11  # of value or bound: an error of the reference
HIDDEN = (
    1e-9  # of value or bound: errors below it are those of iterations and noise, which steps do not change
)
FAR = 100.0  # times the true error
STEPS = (48, 60, 72, 90, 96, 120, 144, 180, 240, 360, 480, 720)  # in a revolution
HEADS = ("scene", "claim", "verdicts", "covered", "compared", "median", "most", "far", "undecided", "wrong")

LOOM = """
revolutions = {turns}
coupling = "iterated"
[loom]
machine = "WL680-3600"
head = "G6300 left"
weave = "{weave}"
{fittings}
[shaft]
speed = "{speed} rev/min"
{shaft}
[belt]
guide_clearance = "{clearance} mm"
[dobby]
law = "{law}"
speed_reduction = {reduction}
[heald]
stroke = "{stroke} mm"
{rest}
"""
MARGIN = '[[claims]]\nkind = "lowest_margin"\nbound = {margin}\n'
SPEED = '[[claims]]\nkind = "above"\nsignal = "belt.lowest_speed_limit"\nbound = "{limit} rev/min"\n'
DWELL = '[[claims]]\nkind = "dwell"\nheald = "heald_1"\nlifted_by = "frame"\nat_least = "{dwell} deg"\n'
INSIDE = (
    '[[claims]]\nkind = "dwell_contains"\nheald = "heald_1"\nlifted_by = "frame"\n'
    'angles = ["{angle} deg"]\ntolerance = 0.05\n'
)
CLEAR = (
    '[[claims]]\nkind = "clear_shed"\nheald = "heald_1"\nlifted_by = "frame"\nclearance = "5 mm"\n'
    'at_least = "{dwell} deg"\n'
)
ROOM = '[[claims]]\nkind = "rapier_in_open_shed"\nhead_height = "15 mm"\n'
FAST = '[[claims]]\nkind = "below"\nsignal = "weft.velocity"\nbound = "{fast} m/s"\n'
SAMPLED = '[[claims]]\nkind = "below"\nsignal = "heald_1.inertia_force"\nbound = "{force} N"\n'
PEAK = '[[claims]]\nkind = "peak_load"\ndamper = "damper_1"\nat_most = "{peak} N"\n'
TRAVEL = '[[claims]]\nkind = "below"\nsignal = "damper_1.displacement"\nbound = "{travel} mm"\n'
THREAD = '[[claims]]\nkind = "below"\nsignal = "warp_1.highest_tension"\nbound = "{tension} cN"\n'
BALANCE = '[[claims]]\nkind = "energy_balance"\n'
POWER = '[[claims]]\nkind = "motor_power"\nat_most = "{power} kW"\n'
FLUCTUATION = '[[claims]]\nkind = "speed_fluctuation"\nat_most = "{even} %"\n'
LAWS = ("sloped-sine", "sloped-line", "uniform")


class Drawn(NamedTuple):
    """A random scene, its family and its number of steps in a revolution."""

    family: str
    text: str
    steps: int


class Found(NamedTuple):
    """Of one verdict: its family and claim, the larger of value and bound, its estimated and its true error,
    whether it is decided, and whether the reference is on the same side of the bound."""

    family: str
    claim: str
    scale: float
    error: float
    true: float
    decided: bool
    same_side: bool


def drawn(seed: int = SEED, scenes: int = SCENES) -> Iterator[Drawn]:
    """Random scenes of all families in turn, the same for the same seed."""
    random = Random(seed)
    families: tuple[tuple[str, Callable[[Random], str]], ...] = (
        ("belt and dobby", _dobby),
        ("carriers on springs", _carriers),
        ("start-up", _start_up),
        ("carriers with warp threads", _threads),
        ("shaft on its motor", _driven),
    )
    for place in range(scenes):
        family, text = families[place % len(families)]
        yield Drawn(family, text(random), random.choice(STEPS))


def _text(random: Random, claims: str, **given: str) -> str:
    """A scene with random values; those given stay."""
    values: dict[str, str] = {
        "turns": "2", "weave": random.choice(("10/01", "1100/0110")), "fittings": "", "shaft": "",
        "speed": f"{random.uniform(200, 650):.6g}", "clearance": f"{random.uniform(0.2, 0.8):.6g}",
        "law": random.choice(LAWS), "reduction": f"{random.uniform(0.2, 0.7):.6g}",
        "stroke": f"{random.uniform(75, 110):.6g}", "rest": "",
    }  # fmt: skip
    bounds = {
        "margin": f"{random.uniform(0.1, 0.8):.6g}", "limit": f"{random.uniform(500, 700):.6g}",
        "dwell": f"{random.uniform(40, 120):.6g}", "angle": f"{random.uniform(150, 210):.6g}",
        "fast": f"{random.uniform(20, 90):.6g}", "force": f"{random.uniform(20, 900):.6g}",
        "peak": f"{random.uniform(100, 6000):.6g}", "travel": f"{random.uniform(5, 20):.6g}",
        "tension": f"{random.uniform(50, 90):.6g}", "power": f"{random.uniform(2, 20):.6g}",
        "even": f"{random.uniform(5, 30):.6g}",
    }  # fmt: skip
    return LOOM.format(**(values | given)) + claims.format(**bounds)


def _dobby(random: Random) -> str:
    start = f'start_angle = "{random.uniform(0, 360):.6g} deg"'
    return _text(random, MARGIN + SPEED + DWELL + INSIDE + CLEAR + ROOM + FAST + SAMPLED, shaft=start)


def _carriers(random: Random) -> str:
    return _text(random, PEAK + TRAVEL + ROOM + DWELL, fittings="dampers = true")


def _start_up(random: Random) -> str:
    ramp = f'ramp_duration = "{random.uniform(0.05, 0.2):.6g} s"'
    ripple = f"ripple_amplitude = {random.uniform(0, 0.03):.3g}\nripple_order = 2"
    return _text(random, MARGIN + DWELL + FAST, shaft=f"{ramp}\n{ripple}")


def _threads(random: Random) -> str:
    speed = f"{random.uniform(200, 450):.6g}"
    return _text(
        random, PEAK + ROOM + THREAD, fittings="dampers = true\nwarps = true", speed=speed, law=LAWS[0]
    )


def _driven(random: Random) -> str:
    shaft = f'component = "DrivenShaft"\ninertia = "{random.uniform(3, 8):.6g} kg.m2"\ntorque_32 = "60 N.m"'
    speed = f"{random.uniform(250, 412):.6g}"
    claims = BALANCE + POWER + FLUCTUATION + MARGIN
    return _text(random, claims, fittings="reed = true", shaft=shaft, speed=speed, law=LAWS[0])


def found(scene: Drawn) -> Iterator[Found]:
    """The verdicts on a scene beside those with far more steps."""
    key = "steps_per_revolution"
    loaded = parse(scene.text)
    with prepare(loaded, set={key: scene.steps}) as loom:
        own = loom.evaluate().claims
    with prepare(loaded, set={key: scene.steps * FINER}) as loom:
        true = loom.evaluate(errors="none").claims
    for table, verdict, reference in zip(loaded.claims, own, true, strict=True):
        if math.isfinite(verdict.worst) and math.isfinite(reference.worst):
            claim = table["signal"] if "signal" in table else table["kind"]
            scale = max(abs(verdict.worst), abs(verdict.bound))
            same = (verdict.worst >= verdict.bound) == (reference.worst >= reference.bound)
            off = abs(verdict.worst - reference.worst)
            yield Found(scene.family, claim, scale, verdict.error, off, verdict.decided, same)


def measured(seed: int = SEED, scenes: int = SCENES) -> list[list[str]]:
    """The table: a row for each family and claim."""
    groups: dict[tuple[str, str], list[Found]] = {}
    for scene in drawn(seed, scenes):
        for each in found(scene):
            groups.setdefault((each.family, each.claim), []).append(each)
    everything = [each for group in groups.values() for each in group]
    rows = [[family, claim, *_statistics(group)] for (family, claim), group in groups.items()]
    return [*rows, ["all", "", *_statistics(everything)]]


def _statistics(group: list[Found]) -> list[str]:
    covered = sum(each.error >= each.true or each.true <= ROUNDING * each.scale for each in group)
    ratios = np.array([each.error / each.true for each in group if each.true > HIDDEN * each.scale])
    shown = ["-", "-"]
    if len(ratios):
        shown = [f"{value:.2g}" for value in np.percentile(ratios, [50, 95])]
    undecided = sum(not each.decided for each in group)
    wrong = sum(each.decided and not each.same_side for each in group)
    counts = [len(group), covered, len(ratios), *shown, int(np.sum(ratios > FAR)), undecided, wrong]
    return [str(count) for count in counts]


def written(rows: list[list[str]]) -> str:
    """The rows as the text of the file."""
    return as_csv([HEADS, *rows])


def chapter() -> Chapter:
    """The chapter, a row for each family of scenes and claim."""
    with FIGURES.open(newline="", encoding="utf-8") as file:
        _heads, *rows = csv.reader(file)
    total = dict(zip(HEADS, rows[-1], strict=True))
    intro = (
        f"{SCENES} random scenes (seed {SEED}) with {min(STEPS)} to {max(STEPS)} steps in a revolution:"
        " speeds, clearances, laws, strokes, start angles, ramps, inertias and bounds are drawn at random."
        f" The true error is the difference from the same scene with {FINER} times the steps. An estimate"
        " covers it if"
        f" it is no smaller, or if the true error is below {ROUNDING:.0e} of value or bound, which may be the"
        " reference's own. The ratio of estimate and true error is taken where the latter is above"
        f" {HIDDEN:.0e}, in {total['compared']} of {total['verdicts']} verdicts: below, iterations and noise"
        " hide it. Wrong would be a verdict that is decided although the reference is on the other side of"
        " its bound."
    )
    heads = (
        "scene", "claim", "verdicts", "covered", "compared", "median ratio", "95 % are below",
        f"above {FAR:g}", "undecided", "wrong",
    )  # fmt: skip
    remarks = (
        "The estimate is made for the lowest order that a claim may have. Where all is smooth the order is"
        " higher, and the estimate too large.",
        "`heald_1.inertia_force` has no rate and is known only at the samples: where one of them happens to"
        " meet the peak, the true error is far below the estimate.",
    )
    section = Section(
        "Estimated and true errors", heads, tuple(Row(tuple(cell or "-" for cell in row)) for row in rows),
        remarks=remarks,
    )  # fmt: skip
    return Chapter("How sure verdicts are", intro, (section,))


if __name__ == "__main__":
    FIGURES.write_text(written(measured()), encoding="utf-8")
