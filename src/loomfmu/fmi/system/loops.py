"""Loops: when their values agree, and the table of a system's loop for the shell, which iterates it."""

from typing import NamedTuple

from ...declaring.variables import Component, variables_of
from ..native.tables import text
from .system import System


class Rule(NamedTuple):
    """The numbers of Broyden's method, see `broyden.h`."""

    most_exchanges: int = 50  # in one step: it needs two or three where the loop is linear
    few: int = 8  # exchanges after which `rounding` will do, if what is left
    stalls: int = 2  # has not halved in the last ones
    orders: int = 4  # a step begins with values that go on as a cubic: a value and three differences
    tolerance: float = 1e-12  # of the value on a wire: what its two ends may differ by
    small: float = 1e-14  # of the largest value so far, where that is more: rounding, for one near zero
    rounding: float = 1e-9  # of the largest value: what rounding may leave in a loop with a high gain
    flat: float = 1e-8  # slope from which on it is taken for rounding: no way to a solution leads along it


RULE = Rule()

LOOP = """/* An algebraic loop: the parts that are repeated until what comes out of them is what went in. */
#define LOOP_FIRST {first}
#define LOOP_END {end}
#define LOOP_VALUES {values} /* on the wires that close it, the reals first */
#define LOOP_REALS {reals}
#define LOOP_WIRES {wires}
#define LOOP_RULE {{{rule}}}

/* The rows that these values come from. */
static const int loop_sources[LOOP_VALUES] = {{{sources}}};

/* What is not real must come out as it went in: the rows of the parts' outputs. */
static const int loop_wholes[] = {{{wholes}NONE}};
"""


def loop_of(system: System, component: type[Component]) -> str:
    """The definitions of a system's loop for model.h, if it has one; `component` is the system as one."""
    closing, sources = system.closing, system.closing_sources
    if not closing:
        return ""
    names = {part.name: place for place, part in enumerate(system.parts, start=1)}  # after the drives
    variables = variables_of(component)
    rows = {variable.name: row for row, variable in enumerate(variables)}
    places = [(names[sink.partition(".")[0]], names[source.partition(".")[0]]) for sink, source in closing]
    first, last = min(sink for sink, _ in places), max(source for _, source in places)
    looped = {name for name, place in names.items() if first <= place <= last}
    read = system.outputs.union(system.wires.values())
    wholes = [
        row
        for name, row in rows.items()
        if name in read and name.partition(".")[0] in looped and variables[row].type is not float
    ]
    return LOOP.format(
        first=first,
        end=last + 1,
        values=len(sources),
        reals=sum(variables[rows[source]].type is float for source in sources),
        wires=text(", ".join(f"{source} -> {sink}" for sink, source in closing)),
        rule=", ".join(map(repr, RULE)),
        sources=", ".join(str(rows[source]) for source in sources),
        wholes="".join(f"{row}, " for row in wholes),
    )
