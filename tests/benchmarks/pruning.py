"""What it saves to run only what the claims need: the belt's margin alone against the whole loom."""

import re
from typing import Any

from children import Child, Inside, Task, children, in_turn, middle, spread
from own import Judged, Ours, Source, demo
from records import Notes, Table, say
from texts import Find, parts, shown, table

NAME = "pruning"
STEPS = 1440  # in a revolution
TIME = "time [ms/revolution]"
COLUMNS = ("what", "judged", "time [ms/revolution]", "spread [%]", "repeats", "what is run")
WHOLE = "the whole loom"
SIZES = {"full": (7, 33.0), "quick": (3, 17.0), "tiny": (1, 2.0)}


def belt_alone(**overrides: Any) -> Source:
    """The demonstration loom with its first claim, the lowest margin of its belt, and nothing recorded."""
    source = demo(judged=True, **overrides)
    head, *claims = source.text.split("[[claims]]")
    (margin,) = [claim for claim in claims if 'kind = "lowest_margin"' in claim]
    return Source("[[claims]]".join([head, margin]), source.overrides, judged=True)


def measure(effort: str, notes: Notes) -> list[Table]:
    """In turn: everything, the claims, one claim."""
    made = {
        f"{WHOLE}, HDF5": (Ours, demo(), "native"),
        "all claims, in memory": (Judged, demo(judged=True), "native"),
        "the belt's margin, in memory": (Judged, belt_alone(), "native"),
    }
    repeats, turns = SIZES[effort]
    steps = 90 if effort == "tiny" else STEPS
    rows = Table(NAME, COLUMNS)
    say(f"{NAME}: {len(made)} scenes")
    with children(made, notes, inside=effort == "tiny") as asked:
        for name, found in in_turn(asked, dict.fromkeys(asked, Task(repeats, steps, turns)), notes).items():
            what, judged = name.split(", ", 1)
            cells = (1e3 * middle(found).turn, 100.0 * spread(found), len(found))
            rows.add(what, judged, *cells, _run(asked[name], steps))
    return [rows]


def _run(asked: Child | Inside, steps: int) -> str:
    """What a run says of itself: FMUs and steps."""
    said = asked.ask("explained", steps)
    found = re.search(r"\d+ of \d+ FMUs, \d+ steps", said)
    return found[0] if found else said


# ---- what is said of it


def section(find: Find) -> str:
    """What each way saves."""
    rows = find(NAME)
    most = next((row[TIME] for row in rows if row["what"] == WHOLE), None)
    heads = ["what", "how", "ms per revolution", "spread, %", "repeats", "of the whole", "what is run"]
    lines = []
    for row in rows:
        cells = [shown(row[key]) for key in (TIME, "spread [%]", "repeats")]
        share = shown(row[TIME] / most) if most else ""
        lines.append([row["what"], row["judged"], *cells, share, row["what is run"]])
    return parts(
        f"The demonstration loom, native FMUs, {STEPS} steps in a revolution. Judged in memory,"
        " nothing runs that the claims do not need, and nothing is written. Times contain the judging.",
        table(heads, lines),
    )
