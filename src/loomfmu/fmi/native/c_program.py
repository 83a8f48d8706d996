"""The functions that a component leads to, each translated once for every size of the arrays it is given."""

import ast
from dataclasses import replace

from .c_code import Declared, Kind, Signature, Untranslatable, declared, sizes
from .c_functions import FunctionWriter
from .c_scope import Scope

Functions = dict[str, ast.FunctionDef]


class Program:
    """Translates functions as they are called: what a call returns is known once its function is translated.

    `scope` says what names mean; `comments` has the comments of the source by their line.
    """

    def __init__(self, scope: Scope, functions: Functions, methods: Functions, comments: dict[int, str]):
        self.comments = comments
        self.written: dict[tuple[str, str], FunctionWriter] = {}
        bodies = functions | {f"self.{name}": body for name, body in methods.items()}
        self.places = {id(body): place for place, body in enumerate(bodies.values())}
        _refuse_recursion(bodies)
        known: dict[str, Declared] = {}
        written: dict[str, frozenset[int]] = {}
        for name, body in bodies.items():
            if name.endswith("__init__"):
                continue
            own, method = name.removeprefix("self."), name.startswith("self.")
            prefix = f"{scope.component}__" if method else f"{scope.component}_"
            found = declared(body, prefix + own, method, scope.records)
            known[name] = replace(found, written=_written(name, bodies, written))
        scope.functions |= {name: known[name] for name in functions}
        scope.methods |= {name: known[f"self.{name}"] for name in methods if f"self.{name}" in known}
        self.scope = replace(scope, translated=self.translated)

    def translated(self, called: Declared, kinds: tuple[Kind, ...]) -> Signature:
        """A function for arguments of these types."""
        key = called.name, sizes(kinds)
        if key not in self.written:
            body = called.function
            within = {
                line: text
                for line, text in self.comments.items()
                if body.lineno < line <= (body.end_lineno or 0)
            }
            self.written[key] = FunctionWriter(called, kinds, self.scope, within)
        return self.written[key].signature

    def text(self, *entries: str) -> tuple[str, str, str]:
        """Structs, prototypes and definitions that these methods lead to, in the order of the module."""
        for name in entries:
            entry = self.scope.methods[name]
            self.translated(entry, entry.arguments)
        writers = sorted(self.written.values(), key=lambda each: (self.places[id(each.function)], each.name))
        prototypes = "\n".join(f"{writer.prototype};" for writer in writers)
        return "\n".join(self.scope.structs.values()), prototypes, "\n".join(each.text for each in writers)


def _refuse_recursion(bodies: Functions) -> None:
    """Refuse functions that call themselves, near or far: a native FMU would crash where Python stops."""
    called = {name: _calls(function) for name, function in bodies.items()}
    finished: set[str] = set()

    def follow(name: str, callers: tuple[str, ...]) -> None:
        for node in called[name]:
            callee = ast.unparse(node.func)
            if callee in (*callers, name):
                raise Untranslatable(node, f"{callee} calls itself, and recursion does not translate")
            if callee in called and callee not in finished:
                follow(callee, (*callers, name))
        finished.add(name)

    for name in bodies:
        if name not in finished:
            follow(name, ())


def _written(name: str, bodies: Functions, known: dict[str, frozenset[int]]) -> frozenset[int]:
    """The arguments of a function, by their places, that it writes to or passes on to be written."""
    if name not in known:
        given = [each.arg for each in bodies[name].args.args][int(name.startswith("self.")) :]
        found = {
            node.value.id
            for node in ast.walk(bodies[name])
            if isinstance(node, ast.Subscript)
            and isinstance(node.ctx, ast.Store)
            and isinstance(node.value, ast.Name)
        }
        for call in _calls(bodies[name]):
            if ast.unparse(call.func) in bodies:
                places = _written(ast.unparse(call.func), bodies, known)
                passed = [arg for place, arg in enumerate(call.args) if place in places]
                found |= {arg.id for arg in passed if isinstance(arg, ast.Name)}
        known[name] = frozenset(place for place, each in enumerate(given) if each in found)
    return known[name]


def _calls(function: ast.FunctionDef) -> list[ast.Call]:
    return [node for node in ast.walk(function) if isinstance(node, ast.Call)]
