"""The declarations of a component as C tables: `model.h`, which the native shells read."""

import json
import re

from ... import units
from ...variables import AT_STEP_END, NOTHING, Component, Variable, variables_of
from ..description.model_description import FIRST_REFERENCE
from ..live.live_slave import CATEGORIES, DISCARD, ERROR, WARNING
from .c_code import c_name

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
#define MEMORYLESS {memoryless} /* 1: all outputs are functions of time, parameters and inputs alone */

typedef struct {name} Component;

#define component_start {name}__init__
#define component_initialize {name}__initialize
#define component_step {name}__step

/* The parameter that says that inputs hold at the end of a step; NONE without one. */
#define INPUTS_AT_STEP_END {at_step_end}

static const Row rows[VARIABLES] = {{
{rows}
}};

/* Variables that change their sign where an output jumps. */
static const int indicators[INDICATORS + 1] = {{{indicators}}};

/* The number of a problem is its place here, counted from 1. */
static const Problem problems[PROBLEMS + 1] = {{
{problems}    {{"", false}},
}};

static const char *const categories[CATEGORIES] = {{{categories}}};

#endif
"""


def tables(component: type[Component], token: str) -> str:
    """The text of model.h; `token` is the identity that a host must show."""
    variables = variables_of(component)
    names = [variable.name for variable in variables]
    _check_problems(component, names)
    at_step_end = names.index(AT_STEP_END) if AT_STEP_END in names else "NONE"
    return MODEL.format(
        name=component.__name__,
        token=token,
        count=len(variables),
        first=FIRST_REFERENCE,
        problem_count=len(component.problems),
        indicator_count=sum(variable.indicator for variable in variables),
        indicators=", ".join([*(str(names.index(v.name)) for v in variables if v.indicator), "NONE"]),
        memoryless=int(component.keeps == NOTHING),
        at_step_end=at_step_end,
        rows="\n".join(_row(variable, names) for variable in variables),
        problems="".join(
            f"    {{{_text(problem.text)}, {str(problem.warning).lower()}}},\n"
            for problem in component.problems
        ),
        categories=", ".join(_text(CATEGORIES[status][0]) for status in (WARNING, DISCARD, ERROR)),
    )


def _row(variable: Variable, names: list[str]) -> str:
    fields = (
        _text(variable.name),
        KINDS[variable.type],
        variable.causality.upper(),
        variable.variability.upper(),
        f"offsetof(Component, {c_name(variable.member)})",
        *(repr(float(limit)) for limit in variable.limits),
        _text(variable.display),
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


def _text(text: str) -> str:
    """A C string; outside ASCII as its UTF-8 bytes stand in the file."""
    return json.dumps(text, ensure_ascii=False)
