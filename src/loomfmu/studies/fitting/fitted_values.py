"""A fit as people read it."""

from ...display import printed
from ...display.printed import say
from .fit import HEADINGS, Fit, rows


def show(found: Fit) -> None:
    """Print a fit: the parameters, what they leave of the data, and what to be careful about."""
    say(f"{found.title}: fitted to {found.data.path}, {found.data.count} measured values")
    table = rows(found)
    entries = [
        (f"{key}:", value, f"interval {interval};", f"scene {own}") for key, value, interval, own in table
    ]
    printed.show(HEADINGS, table, entries)
    say(*remains(found), *found.notes, "", f"{found.runs} runs")


def remains(found: Fit) -> list[str]:
    """Return the residuals in words, a line for each signal."""
    lines = []
    for each in found.curves:
        unit = "" if each.unit == "1" else f" {each.unit}"
        share = f", {100.0 * each.share:.3g} % of the variation in the data" if each.share < 1.0 else ""
        count = len(each.measured)
        lines.append(
            f"{each.signal}: residual {each.rms / each.factor:.3g}{unit} rms over {count} values{share}"
        )
    return lines
