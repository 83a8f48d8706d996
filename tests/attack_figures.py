"""The figures of the attack, for the validation report: `make attack` says where they go."""

import csv
import os
from pathlib import Path

HEADINGS = ("attack", "tried", "refused")


def record(attack: str, tried: int, refused: int = 0) -> None:
    """Add what was tried and came to its right end, and how much of it was refused."""
    print(f"\n{attack}: {tried} tried, {refused} refused, nothing lost")
    if not (place := os.environ.get("ATTACK_FIGURES")):
        return
    path = Path(place)
    known: dict[str, list[int]] = {}
    if path.exists():
        with path.open(newline="") as file:
            known = {name: [int(each) for each in counts] for name, *counts in list(csv.reader(file))[1:]}
    before = known.get(attack, [0, 0])
    known[attack] = [before[0] + tried, before[1] + refused]
    with path.open("w", newline="") as file:
        rows = ([name, *counts] for name, counts in sorted(known.items()))
        csv.writer(file, lineterminator="\n").writerows([HEADINGS, *rows])
