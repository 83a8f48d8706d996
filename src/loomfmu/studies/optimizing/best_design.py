"""The best design as people read it in a terminal."""

from ...display import printed
from ...display.printed import say
from .optimum import Optimum, best_tables, conclusion, front_table


def show(found: Optimum) -> None:
    """Print the best design, or the front, and where it is."""
    study = found.study
    before = found.runs - found.ran
    again = f" ({before} of them run before)" if before > 0 else ""
    met = f"{found.allowed} of which meet {study.wanted} (numerical errors aside)"
    say(f"{study.title}: {found.runs} designs{again}, {met}")
    if found.front and len(study.goals) == 1:
        (best,) = found.front
        (headings, values), (verdicts, claims) = best_tables(found, best)
        entries = [(f"{name}: {value}", _bracketed(text, note)) for name, value, text, note in values]
        printed.show(headings, values, entries)
        by_claim = [
            (f"{word}  {claim}", f"{worst}, bound {bound}", _bracketed(distance, note))
            for word, claim, worst, bound, distance, note in claims
        ]
        printed.show(verdicts, claims, by_claim, further=True)
    elif found.front:
        headings, rows = front_table(found)
        designs = [[f"{head}: {cell};" for head, cell in zip(headings, row, strict=True)] for row in rows]
        printed.show(headings, rows, designs)
    say(*conclusion(found))
    if found.study.enumerable:
        say(f"All {found.study.combinations} combinations were run.")
    else:
        say("This is a search, not a proof that there is no better design.")
    if found.front:
        first, last = found.front[0].scene, found.front[-1].scene
        say(f"scene: {first}" if first == last else f"scenes: {first} to {last.name}")
    say(f"table: {found.path / 'designs.csv'}")
    if found.picture is not None:
        say(f"picture: {found.picture}")


def _bracketed(*parts: str) -> str:
    found = "; ".join(filter(None, parts))
    return f"({found})" if found else ""
