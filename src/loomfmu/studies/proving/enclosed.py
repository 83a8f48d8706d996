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

NATIVE = Path(__file__).parent / "native"
LARGEST_BOX = 8  # sides of a box, the shaft angle included

PROGRAM = """#define LARGEST_BOX {largest}
#include "enclosure.h"
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
{joins}
#undef double
#define OUTPUTS {most}
typedef struct {name} component;
#define component_start {name}__init__
#define component_initialize {name}__initialize
#define component_step {name}__step
#include "enclose.h"
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
"""


def program(component: type[Component], wanted: Sequence[str], settings: Mapping[str, Any]) -> str:
    """Return the C++ of all that some outputs depend on with some settings."""
    variables = variables_of(component)
    members = [each.member.partition("[")[0] for each in variables if each.name in wanted]
    written, name = translate_slice(component, members, settings), component.__name__
    puts = [f"    case {len(variables)}: *time = value; break;"]
    gets = []
    for place, variable in enumerate(variables):
        member = f"self->{c_name(variable.member)}"
        as_whole = {float: "value", int: "python_whole(value)", bool: "python_whole(value) != 0"}
        puts.append(f"    case {place}: {member} = {as_whole[variable.type]}; break;")
        if variable.name in wanted:
            gets.append(f"    case {place}: return enclosure({member});")
    return PROGRAM.format(
        largest=LARGEST_BOX,
        name=name,
        struct=written.struct,
        functions=_with_ways(_exact(written.functions), name, written.changes),
        puts="\n".join(puts),
        gets="\n".join(gets),
        most=len(wanted),
        joins=_joins(" ".join(written.struct.split())),
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
    structs = [found.span() for found in re.finditer(r"^struct .*\};$", functions, re.MULTILINE)]
    prototyped = [found.end() for found in re.finditer(r"^static [^=\n]*\);$", functions, re.MULTILINE)]
    first, last = (structs[-1][1] if structs else 0), max(prototyped, default=0)
    joins = _joins(*(functions[start:end] for start, end in structs))
    wrapped = "\n".join(wrappers)
    return f"{functions[:first]}\n{joins}{functions[first:last]}\n\n{wrapped}{functions[last:]}"


def _exact(functions: str) -> str:
    """C in which each number of the source is an enclosure: the compiler computes with none of them."""
    return re.sub(r"(?<![\w.])(\d+\.\d*(?:e[+-]?\d+)?|\d+e[+-]?\d+)(?![\w.])", r"enclosure(\1)", functions)


def _joins(*structs: str) -> str:
    """Return the functions that join the results of several ways, for each struct."""
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
        library = _library(component, tuple(wanted), tuple(settings.items()))  # type: ignore[arg-type] # mypy 6613
        self._enclose = ctypes.PyDLL(str(library)).enclose  # one thread at a time: it has one state
        self._wanted, self.component = wanted, component

    def bounds(
        self, fixed: Mapping[str, float], given: Mapping[str, Floats], shape: tuple[int, ...]
    ) -> dict[str, Floats]:
        """Place the component in boxes of what it is given, by variable; its wanted outputs, by variable.

        `fixed` are numbers, among them the `TIME`, which is unknown otherwise. What is `given`, and what is
        returned, has the shape (boxes, 1 + sides, 2): the bounds of the values, then those of the slopes by
        each side; `shape` begins with boxes and sides. Where there might be a problem, the bounds are open.
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
    code = {"enclosed.cpp": text} | code_of(NATIVE / "enclosure.h") | code_of(NATIVE / "enclose.h")
    identity = compiler.library_identity(code)
    return made_file(
        STEPPER, identity, f"{component.__name__}.so", lambda: compiler.of_boxes("enclosed.cpp", code)
    )
