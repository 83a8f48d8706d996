"""Rows at once beside the same rows one by one: the belt's two FMUs, and the whole demonstration loom."""

from statistics import median
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from own import DEMO
from records import Notes, Table, say
from texts import Find, parts, whole

import loomfmu
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.units import Si

NAME = "many"
SIZES = {"full": (400, 5), "quick": (200, 3), "tiny": (20, 1)}  # rows of the belt, repeats
LONG = 24  # a row of the loom takes the steps of so many rows of the belt, all FMUs counted
STEPS = 180  # in the one revolution of a row of the belt
BELT = f"""
revolutions = 1
steps_per_revolution = {STEPS}
[loom]
machine = "WL680-3600"
head = "G6300 left"
[shaft]
speed = "600 rev/min"
[belt]
guide_clearance = "0.3 mm"
[[claims]]
kind = "lowest_margin"
bound = 0.1
[[claims]]
kind = "above"
signal = "belt.lowest_speed_limit"
bound = "shaft.speed"
"""
RANGES = {
    "belt.guide_clearance": (2e-4, 5e-4),
    "belt.bending_stiffness": (0.2, 0.3),
    "belt.head_mass": (0.09, 0.13),
    "shaft.speed": (56.0, 70.0),
}


class Way(NamedTuple):
    """Values that differ from row to row in a scene, in words as well, and the errors that are estimated."""

    words: str
    scene: Scene
    keys: tuple[str, ...]
    errors: Any
    share: int = 1  # of the rows


def measure(effort: str, notes: Notes) -> list[Table]:
    """Rows of either scene, at once and one by one in turn."""
    del notes
    columns = ("rows", "errors", "one by one [rows/s]", "at once [rows/s]", "times as many", "run singly [%]")
    table = Table(NAME, columns)
    belt, loom = scenes.parse(BELT, "belt", {}), scenes.load(DEMO)
    keys = tuple(RANGES)
    count, repeats = SIZES[effort]
    for way in (
        Way("belt, 4 parameters", belt, keys, "none"),
        Way("belt, 4 parameters", belt, keys, "near"),
        Way("belt, 3 parameters, the speed stays", belt, keys[:3], "none"),
        Way("loom, 4 parameters", loom, keys, "none", LONG),
        Way("loom, 3 parameters of the belt", loom, keys[:3], "none", LONG),
        Way("loom, 3 parameters of the belt", loom, keys[:3], "near", LONG),
    ):
        say(f"{NAME}: {way.words}, errors {way.errors}")
        table.add(way.words, way.errors, *_rates(way, max(8, count // way.share), repeats))
    return [table]


def _rates(way: Way, count: int, repeats: int) -> tuple[float, float, float, float]:
    """Rows in a second one by one and at once, how many times as many, and the share run singly [%]."""
    generator = np.random.default_rng(1)
    values = {key: generator.uniform(*RANGES[key], count) for key in way.keys}
    rows = [
        {key: Si(each) for key, each in zip(values, row, strict=True)}
        for row in zip(*values.values(), strict=True)
    ]
    single, many, times = [], [], []
    with loomfmu.prepare(way.scene) as found:
        found.evaluate(rows[0], errors=way.errors)
        for _ in range(repeats):
            start = perf_counter()
            for row in rows:
                found.evaluate(row, errors=way.errors)
            between = perf_counter()
            made = found.evaluate_many(values, errors=way.errors)
            end = perf_counter()
            single.append(count / (between - start))
            many.append(count / (end - between))
            times.append((between - start) / (end - between))
    return median(single), median(many), median(times), 100.0 * len(made.single) / count


# ---- what is said of it


def section(find: Find) -> str:
    """Rows in a second, before and after."""
    return parts(
        "`loom.evaluate_many` beside `loom.evaluate` row by row, in one process; both give the same bits."
        f" The belt is that of the demonstration loom, with two FMUs, {STEPS} steps and two claims; the loom"
        " is the whole demonstration, with 4320 steps and six claims. Errors are those that are estimated:"
        " a row with a verdict near its bound, whose error coarser steps show, is run singly.",
        whole(find(NAME)),
    )
