"""A component as C text: its flattened module, translated function by function.

The result is one struct, whose members are the component's variables in the order of their value references,
and static functions: no globals, no allocation, no library but libm.
"""

import ast
import io
import math
import tokenize
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import groupby
from pathlib import Path
from typing import Any

from ...declaring.variables import Component, Variable, arrays_of, variables_of
from ...errors import LoomfmuError
from .. import source
from ..source import of_self, one_at_a_time
from .c_code import TYPES, Untranslatable, c_name, comment, literal
from .c_numbers import DUAL, PLAIN, Numbers
from .c_program import Program
from .c_scope import Scope
from .slicing import sliced

ENTRIES = ("initialize", "step")  # what the shell calls
INCLUDES = '#include "component.h"\n#include "python_arithmetic.h"\n'
DUAL_INCLUDES = (
    '/* With dual numbers: each value brings its derivative in one direction. */\n#include "dual.h"\n'
)
HEADER = """{about}#ifndef COMPONENT_H
#define COMPONENT_H

#include <stdbool.h>
#include <stdint.h>

{struct}

#endif
"""


class TranslationError(LoomfmuError):
    """A component that leaves the Python that translates to C; the message says where."""


@dataclass(frozen=True)
class Written:
    """A component in C with one type of numbers: the struct of its variables, and the functions."""

    struct: str
    functions: str
    changes: Mapping[str, frozenset[str]] = field(default_factory=dict)
    """The variables that each method changes, those that it calls included."""


@dataclass(frozen=True)
class Translation:
    """A component in C, with plain numbers and with dual ones, each written when it is first used."""

    name: str
    written: Callable[[Numbers], Written]

    @cached_property
    def plain(self) -> Written:
        """With plain numbers."""
        return self.written(PLAIN)

    @cached_property
    def dual(self) -> Written:
        """With dual numbers."""
        with one_at_a_time:
            return self.written(DUAL)

    @property
    def header(self) -> str:
        """The text of component.h."""
        return HEADER.format(about=self._about, struct=self.plain.struct)

    @property
    def code(self) -> str:
        """The text of component.c."""
        return f"{self._about}{INCLUDES}\n{self.plain.functions}"

    @property
    def dual_code(self) -> str:
        """The text of component_dual.c."""
        return f"{self._about}{DUAL_INCLUDES}\n{self.dual.struct}\n\n{self.dual.functions}"

    @property
    def _about(self) -> str:
        return f"/* {self.name}, translated by loomfmu from its Python source; do not edit. */\n"


_done: dict[type[Component], Translation] = {}


def translate(component: type[Component]) -> Translation:
    """The component in C.

    Raises TranslationError where it uses what does not translate; component, function and line are named.
    """
    with one_at_a_time:
        if component not in _done:
            _done[component] = _translated(component)
        return _done[component]


def translate_slice(
    component: type[Component], wanted: Iterable[str], settings: Mapping[str, Any]
) -> Written:
    """Return the C of all that some variables depend on with some settings. Raises Untranslatable."""
    with one_at_a_time:
        tree = sliced(ast.parse(source.flatten(component)), ENTRIES, wanted, settings)
        return _written(component, tree, {}, PLAIN)


def _translated(component: type[Component]) -> Translation:
    text = source.flatten(component)
    tree = ast.parse(text)
    found = Translation(
        component.__name__, lambda numbers: _written(component, tree, _comments(text), numbers)
    )
    try:
        _ = found.plain  # what translates with plain numbers does so with dual ones
    except Untranslatable as error:
        raise _located(component, text, tree, error) from None
    return found


def _written(
    component: type[Component], tree: ast.Module, comments: dict[int, str], numbers: Numbers
) -> Written:
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    own = classes.pop(component.__name__)
    arrays = arrays_of(component)  # properties in Python, members in C
    methods = {name: node for name, node in _functions(own.body).items() if name not in arrays}
    constants = _constants(tree)
    scope = Scope(
        component=numbers.prefix + component.__name__,
        functions={},
        methods={},
        records={name: _fields(node) for name, node in classes.items()},
        variables={variable.member: TYPES[variable.type.__name__] for variable in variables_of(component)},
        arrays={name: tuple(each.member for each in same) for name, same in arrays.items()},
        constants={name: value for name, value in constants.items() if not isinstance(value, tuple)},
        tables={name: value for name, value in constants.items() if isinstance(value, tuple)},
        from_math=frozenset(_imported(tree)),
        changes={method: frozenset(_changed(method, methods, set())) for method in methods},
        numbers=numbers,
    )
    structs, prototypes, definitions = Program(scope, _functions(tree.body), methods, comments).text(*ENTRIES)
    start = f"{_start(component)}\n" if numbers is PLAIN else ""
    functions = "\n\n".join(part for part in (structs, prototypes, start + definitions) if part)
    return Written(_struct(component, numbers), functions, scope.changes)


def _functions(body: list[ast.stmt]) -> dict[str, ast.FunctionDef]:
    """The functions of a module, or the methods of a class."""
    return {node.name: node for node in body if isinstance(node, ast.FunctionDef)}


def _fields(record: ast.ClassDef) -> dict[str, str]:
    """The fields of a record, with their types or the names of these."""
    arguments = _functions(record.body)["__init__"].args.args[1:]
    annotations = {each.arg: ast.unparse(each.annotation) for each in arguments if each.annotation}
    return {name: TYPES.get(annotation, annotation) for name, annotation in annotations.items()}


def _constants(tree: ast.Module) -> dict[str, Any]:
    """Return the constants of the module: numbers, and tuples of numbers."""
    found: dict[str, Any] = {
        name: getattr(math, name) for name in _imported(tree) if isinstance(getattr(math, name), float)
    }
    for node in tree.body:
        if isinstance(node, ast.Assign):
            found |= {ast.unparse(target): ast.literal_eval(node.value) for target in node.targets}
    return found


def _imported(tree: ast.Module) -> list[str]:
    """Return the names that the module imports from math."""
    return [name.name for node in tree.body if isinstance(node, ast.ImportFrom) for name in node.names]


def _changed(method: str, methods: dict[str, ast.FunctionDef], seen: set[str]) -> set[str]:
    """The variables of the component that a method changes, those it calls included."""
    seen.add(method)
    nodes = [node for node in ast.walk(methods[method]) if isinstance(node, ast.Attribute) and of_self(node)]
    found = {node.attr for node in nodes if isinstance(node.ctx, ast.Store)}
    called = {node.attr for node in nodes if node.attr in methods and node.attr not in seen}
    return found.union(*(_changed(name, methods, seen) for name in called))


def _comments(text: str) -> dict[int, str]:
    """Comments that stand on a line of their own, by its number."""
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    return {
        token.start[0]: token.string.lstrip("# ")
        for token in tokens
        if token.type == tokenize.COMMENT and token.line.lstrip().startswith("#")
    }


# ---- the struct


def _struct(component: type[Component], numbers: Numbers) -> str:
    """The struct of the variables, each with its unit and description."""
    members = groupby(variables_of(component), lambda variable: variable.member.partition("[")[0])
    lines = [_member(name, list(same), numbers) for name, same in members]
    return "\n".join([f"struct {numbers.prefix}{component.__name__} {{", *lines, "};"])


def _member(name: str, variables: list[Variable], numbers: Numbers) -> str:
    """A variable, or an array of them."""
    first, last = variables[0], variables[-1]
    size = f"[{len(variables)}]" if first.element else ""
    unit = "" if first.unit == "1" else f" [{first.unit}]"
    (about,) = comment(" .. ".join(dict.fromkeys((first.description, last.description))) + unit, "")
    return f"    {numbers.text(TYPES[first.type.__name__])} {c_name(name)}{size}; {about}"


def _start(component: type[Component]) -> str:
    """The function that gives every variable its start value."""
    name = component.__name__
    lines = [
        f"    self->{c_name(each.member)} = {literal(each.start).text};" for each in variables_of(component)
    ]
    return "\n".join([f"static void {name}__init__(struct {name} *self)", "{", *lines, "}", ""])


# ---- what does not translate


def _located(
    component: type[Component], text: str, tree: ast.Module, error: Untranslatable
) -> TranslationError:
    """One line that names the component, the function, the place in its source and what is wrong."""
    line = getattr(error.node, "lineno", 0)
    place, shown = "", ""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and node.lineno <= line <= (node.end_lineno or 0):
            place = f".{node.name}{_origin(component, node.name, line - node.lineno)}"
            shown = f": `{text.splitlines()[line - 1].strip()}`"
    return TranslationError(f"{component.__name__}{place}{shown} does not translate to C: {error}")


def _origin(component: type[Component], function: str, offset: int) -> str:
    """File and line that a line of a function was taken from."""
    found = source.functions(component).get(function)
    if found is None:
        return ""
    return f" ({Path(found.__code__.co_filename).name}, line {found.__code__.co_firstlineno + offset})"
