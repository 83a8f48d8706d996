"""A guard against getting slower: instructions of a step, counted, beside those that were committed last.

Times differ from machine to machine and from hour to hour, counts do not. Where valgrind is missing, ratios
of times that were taken in one run stand in their place.
"""

import re
import shutil
import subprocess
from statistics import median
from typing import Any

import c_programs
from children import Asked, Task, children, in_turn
from limits import HOST, LOOP, InC
from own import Source, demo
from records import Notes, Table, committed, say
from scaling import WEFT
from texts import Find, parts, whole

NAME = "guard"
STEPS = 1440  # in a revolution
COLUMNS = ("what", "unit", "value", "repeats differ by [%]", "committed", "change [%]")
COLLECTED = re.compile(r"Collected\s*:\s*(\d+)")
SIZES = {"full": (1440, 2), "quick": (1440, 2), "tiny": (10, 1)}  # steps that are counted, repeats
INSTRUCTIONS = "instructions per step"


def measure(effort: str, notes: Notes) -> list[Table]:
    """Instructions of a step in the second stretch of a run."""
    tiny = effort == "tiny"
    source = Source(WEFT.replace('record = ["weft.shaft_torque"]', "")) if tiny else demo()
    made: dict[str, tuple[Any, ...]] = {
        LOOP: (InC, c_programs.loop, source),
        HOST: (InC, c_programs.host, source),
    }
    before = {(row["what"], row["unit"]): row["value"] for row in committed(NAME)}
    table = Table(NAME, COLUMNS)
    say(f"{NAME}: compiling")
    with children(made, notes, inside=True) as built:
        for what, unit, values in _found(built, effort, notes):
            centre = median(values)
            differ = 100.0 * (max(values) - min(values)) / centre
            last = before.get((what, unit), "")
            change = 100.0 * (centre / last - 1.0) if last and not tiny else ""
            table.add(what, unit, round(centre, 1) if unit == INSTRUCTIONS else centre, differ, last, change)
    return [table]


def _found(built: Asked, effort: str, notes: Notes) -> list[tuple[str, str, list[float]]]:
    """What is guarded, its unit, and its values in each repeat."""
    steps, repeats = SIZES[effort]
    if shutil.which("valgrind"):
        say(f"{NAME}: counting")
        return [
            (name, INSTRUCTIONS, [_counted(child, steps) for _ in range(repeats)])
            for name, child in built.items()
        ]
    notes(INSTRUCTIONS, "valgrind is not installed; the ratio of two times of one run is shown instead")
    timings = in_turn(built, dict.fromkeys(built, Task(7, STEPS, 4.0)), notes)
    if len(timings) < 2:
        return []
    ratios = [host.turn / loop.turn for host, loop in zip(timings[HOST], timings[LOOP], strict=True)]
    return [(f"{HOST} over {LOOP}", "ratio of times", ratios)]


def _counted(child: Any, steps: int) -> float:
    """Instructions of a step, as valgrind's callgrind counts them: two runs tell the start from the steps."""
    program = str(child.ask("path"))
    first, both = (_collected(program, count) for count in (steps, 2 * steps))
    return (both - first) / steps


def _collected(program: str, steps: int) -> int:
    words = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", program, str(steps)]
    run = subprocess.run(words, capture_output=True, text=True, check=True)
    found = COLLECTED.search(run.stderr)
    if found is None:
        raise RuntimeError(f"callgrind said nothing of instructions: {run.stderr[-200:]}")
    return int(found[1])


# ---- what is said of it


def section(find: Find) -> str:
    """Counts beside the committed ones."""
    return parts(
        "Instructions of a step of the demonstration loom as valgrind's callgrind counts them: of the C loop"
        " and of the plain C host that are timed above, in the second revolution. Beside each stands what was"
        " committed before and the change; another compiler or another libm changes them too.",
        whole(find(NAME)),
    )
