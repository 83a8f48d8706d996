"""A component over a box of its inputs: its C, compiled as C++ with enclosures for its numbers."""

import ctypes
import re
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ...cache.entries import STEPPER, made_file
from ...declaring.variables import NOTHING, TIME, Component, variables_of
from ...fmi.native import compiler
from ...fmi.native.c_code import c_name
from ...fmi.native.sources import code_of
from ...fmi.native.translate import translate_slice
from .spans import Floats

HEADER = Path(__file__).parent / "native" / "enclosure.h"
LARGEST_BOX = 8  # sides of a box, as in the header

PROGRAM = """#include "enclosure.h"
#define double enclosure
{struct}

{functions}
static void put(struct {name} *self, enclosure *time, int place, const enclosure &value)
{{
    switch (place) {{
{puts}
    }}
}}

static enclosure got(const struct {name} *self, int place)
{{
    switch (place) {{
{gets}
    }}
    return unknown();
}}

struct begun {{
    struct {name} self;
    int64_t status;
}};

struct outputs {{
    int64_t status;
    enclosure at[{most}];
}};
{joins}
#undef double

static enclosure read(const double *row)
{{
    enclosure made({{row[0], row[1]}}, ++serial, false);
    for (int i = 0; i < box_size; i++) {{
        made.slope[i] = {{row[2 + 2 * i], row[3 + 2 * i]}};
        made.varies |= !(row[2 + 2 * i] == 0.0 && row[3 + 2 * i] == 0.0);
    }}
    if (row[0] == row[1] && !made.varies) {{
        made.serial = 0;
    }}
    return made;
}}

static bool harmless(int64_t status, int64_t count, const int32_t *warnings)
{{
    bool found = status == 0;
    for (int64_t i = 0; i < count; i++) {{
        found |= status == warnings[i];
    }}
    return found;
}}

/* The component, given some inputs, at the start of a run, or at once another sample of it. */
static begun started(begun before, bool again, int64_t given, const int32_t *to, const double *inputs)
{{
    enclosure time = unknown(); /* unless it is given */
    if (!again) {{
        {name}__init__(&before.self);
    }}
    for (int64_t i = 0; i < given; i++) {{
        put(&before.self, &time, to[i], read(inputs + i * (2 + 2 * box_size)));
    }}
    before.status = again ? {name}__step(&before.self, time, enclosure(0.0)) : {name}__initialize(&before.self, time);
    return before;
}}

/* The component in each of `rows` boxes: bounds of the values and slopes of some outputs, from those of its inputs.
 *
 * The first `fixed` inputs of each row are those of all rows; with `once` the component is initialized with these
 * alone, which needs outputs that depend on nothing before. Where it may report a problem, nothing is known.
 */
extern "C" __attribute__((visibility("default"))) void enclose(int64_t rows, int64_t size, int64_t fixed, int64_t given, const int32_t *to,
                               const double *inputs, int64_t wanted, const int32_t *from, double *results,
                               int64_t once, int64_t count, const int32_t *warnings)
{{
    const int64_t width = 2 + 2 * size;
    static begun first;
    volatile bool failed = false;
    frame outermost{{}};
    box_size = (int)size;
    if (setjmp(outermost.given_up)) {{
        failed = true;
    }} else if (once) {{
        present = &outermost;
        first = joined<begun>([=]() {{ return started(begun{{}}, false, fixed, to, inputs); }});
        failed = !harmless(first.status, count, warnings);
    }}
    for (volatile int64_t row = 0; row < rows; row = row + 1) {{
        double *result = results + row * wanted * width;
        for (int64_t i = 0; i < wanted * width; i++) {{
            result[i] = i % 2 ? INFINITY : -INFINITY;
        }}
        outermost = frame{{}};
        serial = fresh += UINT64_C(1) << 28; /* no value of this row is one of another */
        if (failed || setjmp(outermost.given_up)) {{
            continue;
        }}
        present = &outermost;
        const int64_t skipped = once ? fixed : 0;
        const double *own = inputs + (row * given + skipped) * width;
        const outputs found = joined<outputs>([=]() {{
            const begun made = started(once ? first : begun{{}}, once, given - skipped, to + skipped, own);
            outputs shown;
            shown.status = made.status;
            for (int64_t i = 0; i < {most}; i++) {{
                shown.at[i] = i < wanted ? got(&made.self, from[i]) : enclosure(0.0);
            }}
            if (!harmless(made.status, count, warnings)) {{
                longjmp(present->caller->given_up, 1);
            }}
            shown.status = 0;
            return shown;
        }});
        for (int64_t i = 0; i < wanted; i++) {{
            const enclosure &one = found.at[i];
            double *here = result + i * width;
            here[0] = one.value.low;
            here[1] = one.value.high;
            for (int64_t j = 0; j < size; j++) {{
                here[2 + 2 * j] = one.varies ? one.slope[j].low : 0.0;
                here[3 + 2 * j] = one.varies ? one.slope[j].high : 0.0;
            }}
        }}
    }}
}}
"""
WRAPPER = """static {kind} {name}_in_one_way({arguments});
static {kind} {name}({arguments})
{{
    return joined<{kind}>([=]() {{ {own}return {name}_in_one_way({given}); }});
}}
"""
JOINS = """
static bool alike(const {0} &a, const {0} &b)
{{
    return {1};
}}

static void join({0} &a, const {0} &b)
{{
    {2}
}}

static void forget({0} &a)
{{
    {3}
}}
"""


def program(component: type[Component], wanted: Sequence[str], settings: Mapping[str, Any]) -> str:
    """What some outputs of the component depend on with some settings, in C++."""
    written, name = translate_slice(component, wanted, settings), component.__name__
    variables = variables_of(component)
    puts = [f"    case {len(variables)}: *time = value; break;"]
    gets = []
    for place, variable in enumerate(variables):
        member = f"self->{c_name(variable.member)}"
        as_whole = {float: "value", int: "python_whole(value)", bool: "python_whole(value) != 0"}
        puts.append(f"    case {place}: {member} = {as_whole[variable.type]}; break;")
        if variable.name in wanted:
            gets.append(f"    case {place}: return enclosure({member});")
    return PROGRAM.format(
        name=name,
        struct=written.struct,
        functions=_with_ways(_exact(written.functions), name, written.changes),
        puts="\n".join(puts),
        gets="\n".join(gets),
        most=len(wanted),
        joins=_joins(
            " ".join(written.struct.split()),
            f"struct begun {{ struct {name} self; int64_t status; }};",
            "struct outputs { int64_t status; enclosure at[1]; };",
        ),
    )


def _with_ways(functions: str, name: str, changes: Mapping[str, frozenset[str]]) -> str:
    """The functions of a component, each that changes nothing called until all its ways are done."""
    prototypes = re.findall(r"^static ([\w ]+?) (\w+)\(([^)]*)\);$", functions, re.MULTILINE)
    wrappers = []
    for kind, called, arguments in prototypes:
        parts = [part for part in arguments.split(", ") if part != "void"]
        method = parts[:1] == [f"struct {name} *self"]
        if kind == "void" or (method and changes.get(called.removeprefix(f"{name}__"))):
            continue
        if not all(part.startswith("const ") for part in parts[method:] if "*" in part):
            continue
        functions = re.sub(
            rf"^(static {re.escape(kind)} {called})(?=\([^;]*?\)\n\{{)",
            r"\1_in_one_way",
            functions,
            flags=re.M,
        )
        given = ", ".join(["&own"] * method + [part.split()[-1].lstrip("*") for part in parts[method:]])
        wrappers.append(
            WRAPPER.format(
                kind=kind,
                name=called,
                arguments=arguments,
                given=given,
                own=f"struct {name} own = *self; " * method,
            )
        )
    structs = re.findall(r"^struct .*\};$", functions, re.MULTILINE)
    last = max((found.end() for found in re.finditer(r"^static .*\);$", functions, re.MULTILINE)), default=0)
    head, rest = functions[:last], functions[last:]
    first = head.index("static ")
    return head[:first] + _joins(*structs) + head[first:] + "\n\n" + "\n".join(wrappers) + rest


def _exact(functions: str) -> str:
    """C in which a number of the source is one in real numbers, too: the compiler computes with none of them."""
    return re.sub(r"(?<![\w.])(\d+\.\d*(?:e[+-]?\d+)?|\d+e[+-]?\d+)(?![\w.])", r"enclosure(\1)", functions)


def _joins(*structs: str) -> str:
    """What is done with the results of several ways, for each struct."""
    texts = []
    for name, members in (
        found for text in structs for found in re.findall(r"(struct \w+) \{ (.*?) ?\};", text)
    ):
        names = re.findall(r"(\w+)(?:\[\d+\])?;", re.sub(r"/\*.*?\*/", "", members))
        texts.append(
            JOINS.format(
                name,
                " && ".join(f"alike(a.{each}, b.{each})" for each in names),
                " ".join(f"join(a.{each}, b.{each});" for each in names),
                " ".join(f"forget(a.{each});" for each in names),
            )
        )
    return "".join(texts)


class Enclosed:
    """A component over boxes of its inputs and parameters. Raises LoomfmuError without a compiler."""

    def __init__(self, component: type[Component], wanted: Sequence[str], settings: Mapping[str, Any]):
        variables = variables_of(component)
        self._places = {each.name: place for place, each in enumerate(variables)} | {TIME: len(variables)}
        self._inputs = {each.name for each in variables if each.causality == "input"}
        self._warnings = np.array(
            [n for n, each in enumerate(component.problems, 1) if each.warning], dtype=np.int32
        )
        self._memoryless = component.keeps == NOTHING
        self._enclose = ctypes.CDLL(str(_library(component, tuple(wanted), tuple(settings.items())))).enclose
        self._wanted, self.component = wanted, component

    def bounds(
        self, fixed: Mapping[str, float], given: Mapping[str, Floats], shape: tuple[int, ...]
    ) -> dict[str, Floats]:
        """Place the component in boxes of what it is given, by variable; its wanted outputs, by variable.

        `fixed` are numbers, among them the `TIME`, which is unknown otherwise; what is `given` and what is returned has the shape (boxes, 1 + sides, 2): the bounds
        of the values, then those of the slopes by each side. Where the component might report a problem, they
        are open.
        """
        rows, width = shape[0], 1 + shape[1]
        names = [*fixed, *given]
        inputs = np.zeros((rows, len(names), width, 2))
        for place, value in enumerate(fixed.values()):
            inputs[:, place, 0] = value
        for place, bounds in enumerate(given.values(), len(fixed)):
            inputs[:, place] = bounds
        once = self._memoryless and self._inputs.issuperset(given)
        places, asked = (
            np.array([self._places[name] for name in each], dtype=np.int32) for each in (names, self._wanted)
        )
        results = np.empty((rows, len(asked), width, 2))
        self._enclose(
            *map(ctypes.c_int64, (rows, width - 1, len(fixed), len(names))),
            *(ctypes.c_void_p(each.ctypes.data) for each in (places, inputs)),
            ctypes.c_int64(len(asked)),
            *(ctypes.c_void_p(each.ctypes.data) for each in (asked, results)),
            *map(ctypes.c_int64, (once, len(self._warnings))),
            ctypes.c_void_p(self._warnings.ctypes.data),
        )
        return {name: results[:, place] for place, name in enumerate(self._wanted)}


@cache
def _library(
    component: type[Component], wanted: tuple[str, ...], settings: tuple[tuple[str, Any], ...]
) -> Path:
    """The library of what some outputs of a component depend on, built once."""
    text = program(component, wanted, dict(settings))
    code = {"enclosed.cpp": text} | code_of(HEADER)
    identity = compiler.library_identity(code)
    return made_file(
        STEPPER, identity, f"{component.__name__}.so", lambda: compiler.of_boxes("enclosed.cpp", code)
    )
