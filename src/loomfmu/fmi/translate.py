"""A component as C text: its flattened module, translated by Pyccel and tidied.

The result is one struct, whose members are the component's variables in the order of their value
references, and static functions: no globals, no allocation, no library but libm.
"""

import ast
import math
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from ..errors import LoomfmuError
from ..variables import Component, Variable, variables_of
from . import source, subset

C_TYPES = {float: "double", int: "int64_t", bool: "bool"}
STRUCT = re.compile(r"^struct \w+ \{\n(.*?)^\};", re.MULTILINE | re.DOTALL)
FUNCTION = re.compile(
    r"(?P<comment>(?:^/\*(?:(?!\*/).)*\*/\n)?)"
    r"^(?P<type>\w+) (?P<name>\w+)\((?P<arguments>[^\n]*)\)\n\{\n(?P<body>.*?)^\}\n",
    re.MULTILINE | re.DOTALL,
)
DECLARATION = re.compile(r"^    (?:double|int64_t|bool) (\w+);\n", re.MULTILINE)
COMPLAINT = re.compile(r"\|(?:error|fatal) \[\w+\]: \S+?(?: \[(\d+),\d+\])?\| ([^\n]*)")


class TranslationError(LoomfmuError):
    """A component that leaves the Python that translates to C; the message says where."""


@dataclass(frozen=True)
class Translation:
    """A component in C: the struct of its variables, and the functions."""

    header: str
    code: str
    members: tuple[str, ...]


_done: dict[type[Component], Translation] = {}


def translate(component: type[Component]) -> Translation:
    """The component in C.

    Raises:
        TranslationError: it uses what does not translate; component, function and line are named
        LoomfmuError: Pyccel is not installed
    """
    if component not in _done:
        _done[component] = _translated(component)
    return _done[component]


def _translated(component: type[Component]) -> Translation:
    if find_spec("pyccel") is None:
        raise LoomfmuError("native FMUs are translated by pyccel: pip install 'loomfmu[native]'")
    name = component.__name__
    text = source.flatten(component)
    tree = ast.parse(text)
    for node, reason in subset.complaints(tree):
        raise _error(component, text, getattr(node, "lineno", 0), reason)
    code, header = _pyccel(component, text, _prepared(text, tree))
    members = _members(component, header)
    renamed = {found: variable.name for found, variable in zip(members, variables_of(component), strict=True)}
    functions = [_function(match, renamed) for match in FUNCTION.finditer(code)]
    kept = [each for each in functions if f"{name}__del__" not in each[0]]
    prototypes = "\n".join(f"{prototype};" for prototype, _definition in kept)
    definitions = "\n".join(definition for _prototype, definition in kept)
    about = f"/* {name}, translated by loomfmu from its Python source; do not edit. */\n"
    return Translation(
        header=about + _header(component),
        code=f'{about}#include "component.h"\n#include "pyc_math_c.h"\n\n{prototypes}\n\n{definitions}',
        members=tuple(renamed.values()),
    )


def _error(component: type[Component], text: str, line: int, reason: str) -> TranslationError:
    """One line that names the component, the function, the place in its source and what is wrong."""
    lines = text.splitlines()
    place, shown = "", ""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef) and node.lineno <= line <= (node.end_lineno or 0):
            place = f".{node.name}{_origin(component, node.name, line - node.lineno)}"
            shown = f": `{lines[line - 1].strip()}`"
    return TranslationError(f"{component.__name__}{place}{shown} does not translate to C: {reason}")


def _origin(component: type[Component], function: str, offset: int) -> str:
    """File and line that a line of a function was taken from."""
    methods = source._methods(component)
    functions = dict(methods)
    for method in methods.values():
        source._collect(method, functions, {}, set())
    found = functions.get(function)
    if found is None:
        return ""
    return f" ({Path(found.__code__.co_filename).name}, line {found.__code__.co_firstlineno + offset})"


# ---- what goes into Pyccel


def _prepared(text: str, tree: ast.Module) -> str:
    """The module with constants written out and without what no step uses; all lines keep their place.

    Constants would become globals that somebody has to initialise.
    """
    values: dict[str, float | int] = {}
    for name in subset.names_of_math(tree):
        if isinstance(getattr(math, name), float):
            values[name] = getattr(math, name)
    lines = text.encode().split(b"\n")
    for node in tree.body:
        if isinstance(node, ast.Assign):
            (target,) = node.targets
            assert isinstance(target, ast.Name)
            values[target.id] = ast.literal_eval(node.value)
            _blank(lines, node)
        elif isinstance(node, ast.ImportFrom):
            functions = sorted(subset.names_of_math(tree) - set(values))
            _blank(lines, node)
            lines[node.lineno - 1] = f"from math import {', '.join(functions)}".encode() if functions else b""
    for function in _functions(tree):
        if function.name in _used(tree):
            _write_out(lines, function, values)
        else:
            _blank(lines, function)
    return b"\n".join(lines).decode()


def _functions(tree: ast.Module) -> list[ast.FunctionDef]:
    found = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            found += [item for item in node.body if isinstance(item, ast.FunctionDef)]
    return found


def _used(tree: ast.Module) -> set[str]:
    """Names of all functions and methods that `initialize` and `step` lead to."""
    bodies = {function.name: function for function in _functions(tree)}
    found: set[str] = set()
    waiting = ["__init__", "initialize", "step"]
    while waiting:
        name = waiting.pop()
        if name in bodies and name not in found:
            found.add(name)
            for node in ast.walk(bodies[name]):
                if isinstance(node, ast.Call):
                    waiting.append(ast.unparse(node.func).removeprefix("self."))
    return found


def _blank(lines: list[bytes], node: ast.stmt) -> None:
    for number in range(node.lineno - 1, node.end_lineno or node.lineno):
        lines[number] = b""


def _write_out(lines: list[bytes], function: ast.FunctionDef, values: dict[str, float | int]) -> None:
    """Put the constants' values where their names are read, the last of a line first."""
    names = [node for node in ast.walk(function) if isinstance(node, ast.Name)]
    own = {node.id for node in names if isinstance(node.ctx, ast.Store)}
    own |= {argument.arg for argument in function.args.args}
    for node in sorted(names, key=lambda node: (node.lineno, -node.col_offset)):
        if node.id in values and node.id not in own:
            value = values[node.id]
            literal = repr(value) if value >= 0 else f"({value!r})"
            line = lines[node.lineno - 1]
            lines[node.lineno - 1] = line[: node.col_offset] + literal.encode() + line[node.end_col_offset :]


def _pyccel(component: type[Component], text: str, prepared: str) -> tuple[str, str]:
    """C text and header as Pyccel writes them, in a process of its own."""
    name = component.__name__.lower()
    with tempfile.TemporaryDirectory(prefix="loomfmu-") as directory:
        (Path(directory) / f"{name}.py").write_text(prepared, encoding="utf-8")
        run = subprocess.run(
            [sys.executable, "-m", f"{__package__}.c_printer", f"{name}.py"],
            cwd=directory, capture_output=True, text=True, check=False,
            # Pyccel names the folder it writes to after a worker of pytest-xdist that it finds itself in
            env={name: value for name, value in os.environ.items() if name != "PYTEST_XDIST_WORKER"},
        )  # fmt: skip
        written = Path(directory) / "__pyccel__" / name
        if run.returncode == 0 and written.with_suffix(".c").exists():
            code, header = (written.with_suffix(suffix).read_text("utf-8") for suffix in (".c", ".h"))
            return code, header
    said = run.stdout + run.stderr
    match = COMPLAINT.search(said)
    if match:
        raise _error(component, text, int(match[1] or 0), match[2])
    raise _error(component, text, 0, (said.strip().splitlines() or ["pyccel gave no reason"])[-1])


# ---- what comes out of it


def _members(component: type[Component], header: str) -> list[str]:
    """Members of the struct, one for each variable, checked against the declarations.

    Pyccel gives a member another name where a function has the same.
    """
    struct = STRUCT.search(header)
    found = [line.strip(" ;").split(" ") for line in struct[1].splitlines()] if struct else []
    variables = variables_of(component)
    if len(found) != len(variables) + 1 or found[-1] != ["bool", "is_freed"]:
        raise TranslationError(f"{component.__name__}: the translated struct is not that of its variables")
    for (kind, name), variable in zip(found, variables, strict=False):
        if kind != C_TYPES[variable.type] or not re.fullmatch(rf"{variable.name}(_\d{{4}})?", name):
            raise TranslationError(f"{component.__name__}.{variable.name} was translated as {kind} {name}")
    return [name for _kind, name in found[:-1]]


def _header(component: type[Component]) -> str:
    """The struct of the variables, each with its unit and description."""
    lines = ["#ifndef COMPONENT_H", "#define COMPONENT_H", "", "#include <stdbool.h>", "#include <stdint.h>"]
    lines += ["", f"struct {component.__name__} {{"]
    lines += [_member(variable) for variable in variables_of(component)]
    return "\n".join([*lines, "};", "", "#endif", ""])


def _member(variable: Variable) -> str:
    unit = "" if variable.unit == "1" else f" [{variable.unit}]"
    about = variable.description.replace("*/", "* /").replace("/*", "/ *")
    return f"    {C_TYPES[variable.type]} {variable.name}; /* {about}{unit} */"


def _function(match: re.Match[str], renamed: dict[str, str]) -> tuple[str, str]:
    """A function as prototype and definition: static, without what it does not use."""
    body = match["body"]
    for name, own in renamed.items():
        body = re.sub(rf"\bself->{name}\b", f"self->{own}", body)
    body = re.sub(r"^    self->is_freed = 0;\n", "", body, flags=re.MULTILINE)
    for name in DECLARATION.findall(body):
        if len(re.findall(rf"\b{name}\b", body)) == 1:
            body = re.sub(rf"^    \w+ {name};\n", "", body, count=1, flags=re.MULTILINE)
    arguments = [each.split(" ")[-1].lstrip("*") for each in match["arguments"].split(", ")]
    unused = [each for each in arguments if not re.search(rf"\b{each}\b", body)]
    declared = max((found.end() for found in DECLARATION.finditer(body)), default=0)
    body = body[:declared] + "".join(f"    (void){name};\n" for name in unused) + body[declared:]
    prototype = f"static {match['type']} {match['name']}({match['arguments']})"
    comment = re.sub(r"^\*", " *", re.sub(r" +$", "", match["comment"], flags=re.M), flags=re.M)
    return prototype, f"{comment}{prototype}\n{{\n{body}}}\n"
