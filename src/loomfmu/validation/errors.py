"""How sure verdicts are: the figures that `make verdicts` wrote."""

import csv
from pathlib import Path

from .sections import Chapter, Row, Section

FIGURES = Path(__file__).with_name("errors.csv")
HEADS = (
    "family", "claim", "scenes", "verdicts", "false_holds", "false_fails", "wrong_from_1440", "undecided",
    "needless", "errors", "too_small", "compared", "median", "most",
)  # fmt: skip
SHOWN = (
    "scene", "claim", "scenes", "verdicts", "wrongly hold", "wrongly fail", "wrong, 1440 steps or more",
    "undecided", "needlessly", "errors", "too small", "compared", "median ratio", "95 % are below",
)  # fmt: skip
FAMILIES = {
    "belt": "belt, heads, frames, reed", "tables": "inputs along tables", "ramps": "start-up, ripple, weft",
    "dampers": "carriers on springs", "stops": "very stiff stops", "threads": "warp threads",
    "play": "play of the healds", "driven": "shaft on its motor", "motion": "belt in motion", "all": "all",
}  # fmt: skip


def figures() -> list[dict[str, str]]:
    """The rows of the file: each family and kind of claim, then each family, then all."""
    with FIGURES.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def sentence() -> str:
    """The figures in one sentence, as the documents have it."""
    total = {name: int(count) for name, count in figures()[-1].items() if count.isdecimal()}
    wrong = total["false_holds"] + total["false_fails"]
    return (
        f"Of {total['verdicts']:,} verdicts on {total['scenes']:,} random scenes {_count(wrong)} are wrong,"
        f" {_count(total['wrong_from_1440'])} of them with 1440 steps in a revolution or more, and"
        f" {_count(total['too_small'])} of {total['errors']:,} errors are too small."
    )


def _count(number: int) -> str:
    return f"{number:,}" if number else "none"


def chapter() -> Chapter:
    """The chapter, a row for each family of scenes and for each kind of claim in it."""
    rows = figures()
    intro = (
        "Random scenes of nine families, as `make verdicts` draws them: machines, speeds, laws, inputs,"
        " springs, stops, threads and claims, also on random outputs and within random windows. The"
        " truth is the same scene with 23,040 steps in a revolution or more; what such runs differ by is"
        " its uncertainty, and bounds that are nearer than that do not count. Bounds lie 1e-9 to 0.3 of"
        " the truth to either side of it. Each scene is judged with 45 to 4000 steps in a revolution,"
        " equal ones and on a window grid, and with an accuracy of 1e-7 to 1e-3. A verdict is wrong if"
        " it is decided and not true, and needlessly undecided if its bound is more than 1000 times the"
        " true error away. An error is too small if the true one is larger. The ratio of both is taken"
        " where the true error is above 1e-9."
    )
    shown = [Row((FAMILIES[row["family"]], row["claim"] or "all", *list(row.values())[2:])) for row in rows]
    section = Section("Verdicts on random scenes", SHOWN, tuple(shown), remarks=(sentence(),))
    return Chapter("How sure verdicts are", intro, (section,))
