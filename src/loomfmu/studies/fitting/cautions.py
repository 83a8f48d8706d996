"""Cautions about a fit, in words."""

import math
from collections.abc import Iterator, Sequence
from itertools import combinations

from ... import units
from ...errors import listed
from .curves import Compared
from .intervals import Sure, doubtful
from .offset import DISPLAY

MORE = 10  # values than parameters, of each signal whose noise must be known
UNTRUSTED = "not to be trusted"  # of an interval
REACH = 2.0  # standard errors: what the residuals would not show
LARGEST = 2.0 * math.pi  # offset that is worth a word [rad or s]: a revolution
STRONG = 0.9  # correlation that is worth a word


def cautions(curves: Sequence[Compared], found: Sure, over: str) -> tuple[str, ...]:
    """Return cautions: residuals that are not noise, ends of ranges, correlations, coarse steps.

    `over` is the axis of the data, "shaft_angle" or "time".
    """
    unexplained = [each for each in curves if not each.explained]
    lines = [
        f"{each.signal}: the fit {_explains(each.share)}; check the units and the rest of the scene"
        for each in unexplained
    ]
    lines += [*_dependent(found, over)]
    lines += [
        f"the data do not determine {each.span.key}: its interval is wider than the range that was searched"
        for each in found.parameters
        if each.high - each.low > each.span.high - each.span.low
    ]
    remedy = "" if unexplained else ": widen it"
    lines += [
        f"{each.span.key} ended at {each.span.show(each.value)}, the end of its range{remedy}"
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
    return (*lines, *(each.note for each in curves if each.note))


def _explains(share: float) -> str:
    """Say how little a fit explains that leaves this share of the variation of the data."""
    if math.isinf(share):
        return "does not reach the data, which do not vary"
    if share >= 1.0:
        return "explains nothing of the variation of the data"
    return f"leaves {100.0 * share:.3g} % of the variation of the data unexplained"


def _dependent(found: Sure, over: str) -> Iterator[str]:
    """Yield evidence against independent residuals, and the consequences."""
    doubts = doubtful(found.residuals, found.offset)
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
    if found.offset is None:
        return
    if found.offset in doubts:
        size, error = (_offset(over, value) for value in (found.offset.size, REACH * found.offset.error))
        yield (
            f"the residuals show an offset of the data, {size} +- {error} to be added to all places; the"
            f" intervals are {UNTRUSTED}: --offset fits it"
        )
        return
    for one in found.parameters:
        if one.shift < min(REACH * found.offset.error, LARGEST):
            yield (
                f"{one.span.key}: an offset of the data of {_offset(over, one.shift)} moves it to the end of"
                " its interval, and the residuals would not show it: --offset allows for it"
            )


def _offset(over: str, value: float) -> str:
    return units.show(float(f"{value:.2g}"), DISPLAY[over])
