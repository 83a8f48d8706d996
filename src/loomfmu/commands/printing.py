"""Lines that several commands print."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..display import printed
from ..display.printed import say

if TYPE_CHECKING:
    from ..traces import Verdict


def revolutions(count: str) -> str:
    """A count of revolutions."""
    return f"{count} revolution" + "s" * (count != "1")


def print_verdicts(verdicts: "Sequence[Verdict]") -> None:
    """The verdicts as a table."""
    if not verdicts:
        say("no claims")
        return
    from ..traces.verdict import HEADINGS

    rows = [verdict.row for verdict in verdicts]
    entries = []
    for word, claim, name, worst, bound, distance, error, place, note in rows:
        away = f" ({distance})" if distance != "-" else ""
        away += f", error {error}" if error != "-" else ""
        at = f", at {place}" if place != "-" else ""
        entry = f"{word}  {claim}", f"({name})", f"{worst}, bound {bound}{away}{at}"
        entries.append((*entry, f"({note})") if note else entry)
    printed.show(HEADINGS, rows, entries)
