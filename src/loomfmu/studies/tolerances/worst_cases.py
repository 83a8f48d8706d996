"""Worst cases as people read them: a table, sentences, a picture."""

from typing import Any

from ...display import printed
from ...display.printed import say
from ...traces.plotting import COLOURS, figure, fixed_style
from .results import HEADINGS, Tolerances, proofs, rows, unsettled

WIDTH, LINE, REST = 8.0, 0.42, 1.4  # [in]


def show(found: Tolerances) -> None:
    """Print the worst case of every claim."""
    say(f"{found.title}: worst cases within")
    say(*(f"  {span.key} {span.exact} ({span.show(span.value)} in the scene)" for span in found.spans))
    table = rows(found)
    entries = [
        (f"{word}  {claim}:", f"{own} in the scene,", f"{worst} in the worst case", f"({where}; {costs})")
        for word, claim, own, worst, where, costs in table
    ]
    printed.show(HEADINGS, table, entries)
    proven = ", unless they are proven" if found.proofs else ""
    say(*unsettled(found), *([*proofs(found), ""] if found.proofs else []))
    say(f"{found.runs} runs; this is a search, not a proof, so worse cases may exist" + proven)


@fixed_style()
def draw(found: Tolerances) -> Any:
    """A picture: of each claim the distance in the scene and in the worst case, as a share of the bound.

    Raises LoomfmuError if matplotlib is not installed.
    """
    drawn = figure((WIDTH, LINE * len(found.claims) + REST))
    axes = drawn.subplots()
    for line, each in enumerate(reversed(found.claims)):
        own, worst = (100.0 * verdict.relative_distance for verdict in (each.own, each.worst))
        axes.plot([own, worst], [line, line], color="#b0b0b0", linewidth=3.0, zorder=1)
        axes.plot([own], [line], "o", color=COLOURS[0], label="in the scene" if not line else None)
        axes.plot([worst], [line], "D", color=COLOURS[1], label="worst case" if not line else None)
    axes.set_yticks(range(len(found.claims)), [each.claim for each in reversed(found.claims)])
    axes.axvline(0.0, color="black", linewidth=1.0)
    axes.set_xlabel("distance from the bound, as a share of it [%]; below 0 the claim fails")
    axes.grid(axis="x", color="#d4d4d4", linewidth=0.6)
    axes.set_title(found.title, fontsize=11)
    drawn.legend(loc="outside lower center", ncols=2, frameon=False)
    return drawn
