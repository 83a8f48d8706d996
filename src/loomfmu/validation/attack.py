"""What was tried to break loomfmu: the figures that `make attack` wrote."""

import csv
from pathlib import Path

from .sections import Chapter, Row, Section

FIGURES = Path(__file__).with_name("attack.csv")


def chapter() -> Chapter:
    """The chapter, a row for each kind of attack."""
    with FIGURES.open(newline="", encoding="utf-8") as file:
        counts = [(row["attack"], int(row["tried"]), int(row["refused"])) for row in csv.DictReader(file)]
    total = ("all", sum(row[1] for row in counts), sum(row[2] for row in counts))
    rows = [Row((name, f"{tried:,}", f"{refused:,}", "0")) for name, tried, refused in [*counts, total]]
    intro = (
        "What `make attack` tried: kills at random moments, runs with one output, hostile files from a"
        " generator, random calls on FMUs. Hostile input is either taken or refused: a file in one line"
        " without a traceback, a state with a status. Every killed run left a trace that is equal to the bit"
        " to the beginning of the whole one, every killed sweep went on to the same table, and every pair of"
        " runs left one whole trace. Lost would be a crash, a call without end, a traceback, or a result that"
        " is damaged, missing or different; an attack that loses anything fails and is not in the table."
    )
    section = Section("Attempts", ("attack", "tried", "refused", "lost"), tuple(rows))
    return Chapter("Faults and hostile files", intro, (section,))
