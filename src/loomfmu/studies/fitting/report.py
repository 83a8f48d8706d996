"""A fit as people read it."""

from collections.abc import Iterator
from itertools import combinations

from ... import printed, units
from ...errors import listed
from ...printed import say
from .fit import HEADINGS, MORE, UNTRUSTED, Fit, rows
from .intervals import doubtful
from .offset import DISPLAY

UNEXPLAINED = 0.3  # share of the variation that remains
REACH = 2.0  # standard errors: what the residuals would not show
STRONG = 0.9  # correlation that is worth a word


def show(found: Fit) -> None:
    """Print a fit: the parameters, what they leave of the data, and what to be careful about."""
    say(f"{found.title}: fitted to {found.data.path}, {found.data.count} measured values")
    table = rows(found)
    entries = [
        (f"{key}:", value, f"interval {interval};", f"scene {own}") for key, value, interval, own in table
    ]
    printed.show(HEADINGS, table, entries)
    say(*remains(found), *cautions(found), "", f"{found.runs} runs")


def remains(found: Fit) -> list[str]:
    """Return the residuals in words, a line for each signal."""
    lines = []
    for each in found.curves:
        unit = "" if each.unit == "1" else f" {each.unit}"
        share = f", {100.0 * each.share:.2g} % of the variation in the data" if each.share < 1.0 else ""
        count = len(each.measured)
        lines.append(
            f"{each.signal}: residual {each.rms / each.factor:.3g}{unit} rms over {count} values{share}"
        )
    return lines


def cautions(found: Fit) -> list[str]:
    """Return cautions: residuals that are not noise, ends of ranges, correlations, coarse steps."""
    lines = [
        f"{each.signal}: the fit leaves {100.0 * each.share:.3g} % of the variation of the data unexplained;"
        " check the units and the rest of the scene"
        for each in found.curves
        if each.share > UNEXPLAINED
    ]
    lines += [*_dependent(found)]
    lines += [
        f"the data do not determine {each.span.key}: its interval is wider than the range that was searched"
        for each in found.parameters
        if each.high - each.low > each.span.high - each.span.low
    ]
    lines += [
        f"{each.span.key} ended at {each.span.show(each.value)}, the end of its range: widen it"
        for each in found.parameters
        if each.at_bound
    ]
    for one, two in combinations(range(len(found.parameters)), 2):
        correlation = float(found.correlations[one, two])
        if abs(correlation) >= STRONG:
            names = listed(found.parameters[each].span.key for each in (one, two))
            lines.append(
                f"errors of {names} are correlated ({correlation:.3f}): the data barely tell them apart"
            )
    return [*lines, *found.notes]


def _dependent(found: Fit) -> Iterator[str]:
    """Yield evidence against independent residuals, and the consequences."""
    doubts = doubtful(found.residuals, found.shift)
    for each in found.residuals:
        if each in doubts:
            yield (
                f"{each.signal}: residuals are not independent: Durbin-Watson {each.durbin_watson:.2f} where"
                f" {each.expected_durbin_watson:.2f} is expected, {each.runs} runs of one sign where"
                f" {each.expected_runs:.0f} are; the intervals are {UNTRUSTED}: the scene lacks something, or"
                " the noise is filtered"
            )
        elif each.count < len(found.parameters) + MORE:
            yield f"{each.signal}: {each.count} values are too few to see whether residuals are independent"
    if found.shift is None:
        return
    if found.shift in doubts:
        size, error = (_offset(found, value) for value in (found.shift.size, REACH * found.shift.error))
        yield (
            f"the residuals show an offset of the data, {size} +- {error} to be added to all places; the"
            f" intervals are {UNTRUSTED}: --offset fits it"
        )
        return
    for one in found.parameters:
        if one.shift < REACH * found.shift.error:
            yield (
                f"{one.span.key}: an offset of the data of {_offset(found, one.shift)} moves it to the end of"
                " its interval, and the residuals would not show it: --offset allows for it"
            )


def _offset(found: Fit, value: float) -> str:
    return units.show(float(f"{value:.2g}"), DISPLAY[found.data.over])
