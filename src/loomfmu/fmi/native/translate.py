"""A component as C text: its flattened module, translated function by function.

The result is one struct, whose members are the component's variables in the order of their value references,
and static functions: no globals, no allocation, no library but libm.
"""

import ast
import io
import math
import tokenize
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from threading import Lock

from ...errors import LoomfmuError
from ...variables import Component, Variable, arrays_of, variables_of
from .. import source
from .c_code import (
    TYPES,
    Scope,
    Signature,
    Untranslatable,
    c_name,
    comment,
    literal,
    result_struct,
    signature,
)
from .c_functions import FunctionWriter

ENTRIES = ("initialize", "step")  # what the shell calls
INCLUDES = '#include "component.h"\n#include "python_arithmetic.h"\n'
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
class Translation:
    """A component in C: the struct of its variables, and the functions."""

    name: str
    struct: str
    functions: str

    @property
    def header(self) -> str:
        """The text of component.h."""
        return HEADER.format(about=self._about, struct=self.struct)

    @property
    def code(self) -> str:
        """The text of component.c."""
        return f"{self._about}{INCLUDES}\n{self.functions}"

    @property
    def _about(self) -> str:
        return f"/* {self.name}, translated by loomfmu from its Python source; do not edit. */\n"


_done: dict[type[Component], Translation] = {}
_one_at_a_time = Lock()  # Python 3.11 may fail with a SystemError where two threads parse


def translate(component: type[Component]) -> Translation:
    """The component in C.

    Raises TranslationError where it uses what does not translate; component, function and line are named.
    """
    with _one_at_a_time:
        if component not in _done:
            _done[component] = _translated(component)
        return _done[component]


def _translated(component: type[Component]) -> Translation:
    text = source.flatten(component)
    tree = ast.parse(text)
    try:
        code = _code(component, tree, _comments(text))
    except Untranslatable as error:
        raise _located(component, text, tree, error) from None
    return Translation(component.__name__, _struct(component), code)


def _code(component: type[Component], tree: ast.Module, comments: dict[int, str]) -> str:
    name = component.__name__
    functions, methods = _functions(component, tree)
    _refuse_recursion(functions | {f"self.{method}": node for method, node in methods.items()})
    scope = Scope(
        functions=_signatures(functions, f"{name}_", False),
        methods=_signatures(methods, f"{name}__", True),
        variables={variable.member: TYPES[variable.type.__name__] for variable in variables_of(component)},
        arrays={name: tuple(each.member for each in same) for name, same in arrays_of(component).items()},
        constants=_constants(tree),
        from_math=frozenset(_imported(tree)),
        changes={method: frozenset(_changed(method, methods, set())) for method in methods},
    )
    writers = [
        FunctionWriter(function, own, scope, name, _within(comments, function))
        for function, own in _reached(functions, methods, scope)
    ]
    several = {writer.own.results: None for writer in writers if len(writer.own.results) > 1}
    structs = "\n".join(result_struct(results, name) for results in several)
    prototypes = "\n".join(f"{writer.prototype};" for writer in writers)
    definitions = "\n".join([_start(component), *(writer.definition() for writer in writers)])
    return "\n\n".join(part for part in (structs, prototypes, definitions) if part)


def _refuse_recursion(functions: dict[str, ast.FunctionDef]) -> None:
    """Refuse functions that call themselves, near or far: a native FMU would crash where Python stops."""
    called = {
        name: [(node, ast.unparse(node.func)) for node in ast.walk(function) if isinstance(node, ast.Call)]
        for name, function in functions.items()
    }
    finished: set[str] = set()

    def follow(name: str, callers: tuple[str, ...]) -> None:
        for node, callee in called[name]:
            if callee in (*callers, name):
                raise Untranslatable(node, f"{callee} calls itself, and recursion does not translate")
            if callee in called and callee not in finished:
                follow(callee, (*callers, name))
        finished.add(name)

    for name in functions:
        if name not in finished:
            follow(name, ())


def _functions(
    component: type[Component], tree: ast.Module
) -> tuple[dict[str, ast.FunctionDef], dict[str, ast.FunctionDef]]:
    """The functions of a flattened module, and the methods of its class."""
    (own,) = (node for node in tree.body if isinstance(node, ast.ClassDef))
    functions, methods = (
        {node.name: node for node in body if isinstance(node, ast.FunctionDef)}
        for body in (tree.body, own.body)
    )
    arrays = arrays_of(component)  # properties in Python, members in C
    return functions, {name: node for name, node in methods.items() if name not in arrays}


def _signatures(functions: dict[str, ast.FunctionDef], prefix: str, method: bool) -> dict[str, Signature]:
    return {
        name: signature(function, prefix + name, method)
        for name, function in functions.items()
        if name != "__init__"
    }


def _constants(tree: ast.Module) -> dict[str, float | int]:
    found = {name: getattr(math, name) for name in _imported(tree) if isinstance(getattr(math, name), float)}
    for node in tree.body:
        if isinstance(node, ast.Assign):
            found |= {ast.unparse(target): ast.literal_eval(node.value) for target in node.targets}
    return found


def _imported(tree: ast.Module) -> list[str]:
    """What the module imports from math."""
    return [name.name for node in tree.body if isinstance(node, ast.ImportFrom) for name in node.names]


def _changed(method: str, methods: dict[str, ast.FunctionDef], seen: set[str]) -> set[str]:
    """The variables of the component that a method changes, those it calls included."""
    seen.add(method)
    nodes = [node for node in ast.walk(methods[method]) if isinstance(node, ast.Attribute)]
    found = {node.attr for node in nodes if isinstance(node.ctx, ast.Store)}
    called = {node.attr for node in nodes if node.attr in methods and node.attr not in seen}
    return found.union(*(_changed(name, methods, seen) for name in called))


def _reached(
    functions: dict[str, ast.FunctionDef], methods: dict[str, ast.FunctionDef], scope: Scope
) -> list[tuple[ast.FunctionDef, Signature]]:
    """The functions and methods that the entries lead to, in the order of the module."""
    bodies = {("", name): body for name, body in functions.items()}
    bodies |= {("self.", name): body for name, body in methods.items()}
    waiting = [("self.", name) for name in ENTRIES]
    reached: set[tuple[str, str]] = set()
    while waiting:
        key = waiting.pop()
        if key in bodies and key not in reached:
            reached.add(key)
            calls = (node.func for node in ast.walk(bodies[key]) if isinstance(node, ast.Call))
            for called in map(ast.unparse, calls):
                waiting.append(("self." if called.startswith("self.") else "", called.removeprefix("self.")))
    signatures = {("", name): own for name, own in scope.functions.items()}
    signatures |= {("self.", name): own for name, own in scope.methods.items()}
    return [(bodies[key], signatures[key]) for key in bodies if key in reached]


def _comments(text: str) -> dict[int, str]:
    """Comments that stand on a line of their own, by its number."""
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    return {
        token.start[0]: token.string.lstrip("# ")
        for token in tokens
        if token.type == tokenize.COMMENT and token.line.lstrip().startswith("#")
    }


def _within(comments: dict[int, str], function: ast.FunctionDef) -> dict[int, str]:
    return {
        line: text for line, text in comments.items() if function.lineno < line <= (function.end_lineno or 0)
    }


# ---- the struct


def _struct(component: type[Component]) -> str:
    """The struct of the variables, each with its unit and description."""
    members = groupby(variables_of(component), lambda variable: variable.member.partition("[")[0])
    lines = [_member(name, list(same)) for name, same in members]
    return "\n".join([f"struct {component.__name__} {{", *lines, "};"])


def _member(name: str, variables: list[Variable]) -> str:
    """A variable, or an array of them."""
    first, last = variables[0], variables[-1]
    size = f"[{len(variables)}]" if first.element else ""
    unit = "" if first.unit == "1" else f" [{first.unit}]"
    (about,) = comment(" .. ".join(dict.fromkeys((first.description, last.description))) + unit, "")
    return f"    {TYPES[first.type.__name__]} {c_name(name)}{size}; {about}"


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
