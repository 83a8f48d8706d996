"""What a step of the belt in motion costs, the most expensive of the components."""

import math
import shutil
import tempfile
from itertools import product
from pathlib import Path
from statistics import median
from time import thread_time_ns
from typing import Any

from compiled import compiled
from records import Notes, Table, say
from texts import Find, parts, whole

from loomfmu.components import BeltDynamics
from loomfmu.components.weft_insertion import WeftInsertion

NAME = "belt_motion"
STEPS = 1440  # in a revolution
SPEEDS = (400.0, 600.0, 682.0)  # rev/min
BOWS = {"its own": 1, "of the span": 2}
ENDS: dict[str, dict[str, int]] = {
    "calibrated guide": {},
    "guide with play": {"guide_end": 2},
    "guided head": {"head_end": 2},
    "both": {"guide_end": 2, "head_end": 2},
}
COLUMNS = (
    "speed [rev/min]",
    "bow",
    "ends",
    "step [us]",
    "step outside the guide [us]",
    "longest [us]",
    "repeats",
)
SIZES = {"full": 9, "quick": 3, "tiny": 1}  # repeats


def measure(effort: str, notes: Notes) -> list[Table]:
    """Each speed, bow and pair of ends; the median of each step over all repeats."""
    rows = Table(NAME, COLUMNS)
    if shutil.which("gcc") is None:
        notes("a step in C", "gcc is not installed")
        return [rows]
    say(f"{NAME}: compiling")
    with tempfile.TemporaryDirectory() as folder:
        in_c = compiled(BeltDynamics, Path(folder))
        for speed in SPEEDS[: 1 if effort == "tiny" else None]:
            for (bow, number), (ends, given) in product(BOWS.items(), ENDS.items()):
                turns = [_turn(in_c, speed, bow_of=number, **given) for _ in range(SIZES[effort])]
                steps = [(median(each[0] for each in step), step[0][1]) for step in zip(*turns, strict=True)]
                outside = [time for time, out in steps if out]
                everywhere = sum(time for time, _out in steps) / len(steps)
                longest = max(time for time, _out in steps)
                rows.add(speed, bow, ends, everywhere, sum(outside) / len(outside), longest, len(turns))
    return [rows]


def _turn(in_c: Any, rpm: float, **given: int) -> list[tuple[float, bool]]:
    """Microseconds of each step of a revolution, and whether the belt was outside its guide."""
    weft = WeftInsertion(speed=rpm * math.pi / 30.0)
    weft.initialize(0.0)
    belt = in_c()
    for name, value in {"inputs_at_step_end": True, **given}.items():
        setattr(belt, name, value)
    belt.initialize(0.0)
    size = 2.0 * math.pi / STEPS / weft.speed
    found = []
    for n in range(STEPS + 1):
        weft.step(n * size, 0.0)
        belt.travel, belt.velocity, belt.acceleration = weft.travel, weft.velocity, weft.acceleration
        if n == 0:
            belt.initialize(0.0)
            continue
        start = thread_time_ns()
        belt.step((n - 1) * size, size)
        found.append((1e-3 * (thread_time_ns() - start), bool(belt.outside)))
    return found


# ---- what is said of it


def section(find: Find) -> str:
    """A row for each speed, bow and pair of ends."""
    return parts(
        f"`BeltDynamics` behind `WeftInsertion`, WL680-3600, {STEPS} steps in a revolution: the translated"
        " component in C, processor time of each step with the call from Python (about 1 us), the median of"
        " the repeats. Mean over the revolution, mean while the belt is outside its guide, and the longest"
        " step, just before the belt is back in its guide.",
        whole(find(NAME)),
    )
