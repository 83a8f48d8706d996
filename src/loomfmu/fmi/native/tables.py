"""The declarations of a component as C tables: `model.h`, which the native shells read."""

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass

from ... import units
from ...declaring.variables import AT_STEP_END, NOTHING, Component, Variable, variables_of
from ..description.references import FIRST_REFERENCE
from ..live.live_slave import CATEGORIES, DISCARD, ERROR, WARNING
from .c_code import c_name
from .c_numbers import DUAL

KINDS = {float: "REAL", int: "INTEGER", bool: "BOOLEAN"}

MODEL = """/* {name}: its variables and problems, written by loomfmu from its declarations; do not edit. */
#ifndef MODEL_H
#define MODEL_H

#include <float.h>
#include <stddef.h>

#include "component.h"
#include "tables.h"

#define MODEL_NAME "{name}"
#define MODEL_TOKEN "{token}"
#define VARIABLES {count}
#define FIRST_REFERENCE {first}U /* the value reference of the first row, from where they count on */
#define PROBLEMS {problem_count}
#define INDICATORS {indicator_count}
#define PARTS {part_count}
#define FINITE {finite_count}
#define MEMORYLESS {memoryless} /* 1: all outputs are functions of time, parameters and inputs alone */

typedef struct {name} Component;

#define component_start {name}__init__

/* What is started and stepped, in this order, and which of the problems below are its own. */
typedef struct {{
    int64_t (*initialize)(Component *, double);
    int64_t (*step)(Component *, double, double);
    int first_problem;
    int problems;
}} Part;

static const Part parts[PARTS] = {{
{parts}}};

#define INNER_STEPS {inner_steps} /* 1: it steps on a grid of its own, whatever the host's step is */
#define INNER_STEP(component) {inner_step}

/* The parameter that says that inputs hold at the end of a step; NONE without one. */
#define INPUTS_AT_STEP_END {at_step_end}

static const Row rows[VARIABLES] = {{
{rows}
}};

/* Where the reals are that must be finite: outputs and locals, in fours. */
static const size_t finite_offsets[FINITE + 1] = {{
{finite}    0,
}};

/* Variables that change their sign where an output jumps. */
static const int indicators[INDICATORS + 1] = {{{indicators}}};

/* The number of a problem is its place here, counted from 1. */
static const Problem problems[PROBLEMS + 1] = {{
{problems}    {{"", false}},
}};

static const char *const categories[CATEGORIES] = {{{categories}}};

{loop}
#endif
"""


DUAL_MODEL = """/* {name} with dual numbers: where its variables are, and what is started and stepped. */
#ifndef MODEL_DUAL_H
#define MODEL_DUAL_H

typedef struct {prefix}{name} DualComponent;

typedef struct {{
    int64_t (*initialize)(DualComponent *, dual);
    int64_t (*step)(DualComponent *, dual, dual);
}} DualPart;

static const DualPart dual_parts[PARTS] = {{
{parts}
}};

static const size_t dual_offsets[VARIABLES] = {{
{offsets}
}};

#endif
"""


@dataclass(frozen=True)
class Part:
    """Return the C of what the shell starts and steps, and the number of problems that it reports."""

    initialize: str
    step: str
    problems: int


def tables(
    component: type[Component], token: str, parts: Sequence[Part] = (), inner_step: str = "", loop: str = ""
) -> str:
    """The text of model.h; `token` is the identity that a host must show.

    `parts` are those of a system of components, one component is a part by itself; `inner_step` is the
    expression in C for the step of a system that has a grid of its own, `loop` defines its loop.
    """
    name = component.__name__
    parts = parts or _itself(component)
    variables = variables_of(component)
    names = [variable.name for variable in variables]
    _check_problems(component, names)
    finite = _finite(variables)
    at_step_end = names.index(AT_STEP_END) if AT_STEP_END in names else "NONE"
    return MODEL.format(
        name=name,
        token=token,
        count=len(variables),
        first=FIRST_REFERENCE,
        problem_count=len(component.problems),
        indicator_count=sum(variable.indicator for variable in variables),
        indicators=", ".join([*(str(names.index(v.name)) for v in variables if v.indicator), "NONE"]),
        memoryless=int(component.keeps == NOTHING),
        part_count=len(parts),
        parts="".join(_part(part, parts[:place]) for place, part in enumerate(parts)),
        inner_steps=int(bool(inner_step)),
        inner_step=inner_step or "0.0",
        finite_count=len(finite),
        finite="".join(f"    {_offset(variable)},\n" for variable in finite),
        at_step_end=at_step_end,
        rows="\n".join(_row(variable, names) for variable in variables),
        problems="".join(
            f"    {{{text(problem.text)}, {str(problem.warning).lower()}}},\n"
            for problem in component.problems
        ),
        loop=loop or "#define LOOP_VALUES 0\n",
        categories=", ".join(text(CATEGORIES[status][0]) for status in (WARNING, DISCARD, ERROR)),
    )


def dual_tables(component: type[Component], parts: Sequence[Part] = ()) -> str:
    """The text of model_dual.h, for the derivatives of the outputs."""
    prefix = DUAL.prefix
    stepped = [
        f"    {{{prefix}{part.initialize}, {prefix}{part.step}}}," for part in parts or _itself(component)
    ]
    offsets = [f"    {_offset(variable, 'DualComponent')}," for variable in variables_of(component)]
    return DUAL_MODEL.format(
        name=component.__name__, prefix=prefix, parts="\n".join(stepped), offsets="\n".join(offsets)
    )


def _itself(component: type[Component]) -> list[Part]:
    name = component.__name__
    return [Part(f"{name}__initialize", f"{name}__step", len(component.problems))]


def _part(part: Part, before: Sequence[Part]) -> str:
    first = sum(each.problems for each in before)
    return f"    {{{part.initialize}, {part.step}, {first}, {part.problems}}},\n"


def _finite(variables: Sequence[Variable]) -> list[Variable]:
    """Real outputs and locals; the last one is repeated, so that they come in fours."""
    computed = [variable for variable in variables if variable.type is float and not variable.settable]
    return computed + computed[-1:] * (-len(computed) % 4)


def _offset(variable: Variable, struct: str = "Component") -> str:
    return f"offsetof({struct}, {c_name(variable.member)})"


def _row(variable: Variable, names: list[str]) -> str:
    fields = (
        text(variable.name),
        KINDS[variable.type],
        variable.causality.upper(),
        variable.variability.upper(),
        _offset(variable),
        *(repr(float(limit)) for limit in variable.limits),
        text(variable.display),
        repr(float(units.unit(variable.display).factor)),
        "NONE" if variable.rate is None else str(names.index(variable.rate)),
    )
    return f"    {{{', '.join(fields)}}},"


def _check_problems(component: type[Component], names: list[str]) -> None:
    """The shells know `{variable}` and doubled braces, nothing else of Python's formatting."""
    for problem in component.problems:
        for field in re.findall(r"\{([^{}]*)\}", problem.text.replace("{{", "").replace("}}", "")):
            if field not in names:
                raise ValueError(
                    f"{component.__name__}: a problem shows {{{field}}}, which is not a variable"
                )


def text(text: str) -> str:
    """A C string; outside ASCII as its UTF-8 bytes stand in the file."""
    return json.dumps(text, ensure_ascii=False)
