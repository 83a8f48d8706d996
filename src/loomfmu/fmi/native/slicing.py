"""A slice of a component: what some of its outputs depend on, without the rest of its source."""

import ast
from collections.abc import Iterable, Iterator

from .c_code import of_self

Place = tuple[str, str]  # a function and a name in it; "" for the component's own variables
RETURNED = "return"  # in the place of a name: what a function returns
SELF = ""


def sliced(tree: ast.Module, entries: Iterable[str], wanted: Iterable[str]) -> ast.Module:
    """Return the module with only the statements that these variables depend on, and what the entries return.

    The tree is changed. A statement stays if it may set what a statement that stays reads, and every return
    of a function that stays.
    """
    return _Slice(tree, entries, wanted).tree


class _Slice:
    def __init__(self, tree: ast.Module, entries: Iterable[str], wanted: Iterable[str]):
        self.tree = tree
        self.functions = {node.name: node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
        self.live: set[Place] = {(SELF, name) for name in wanted} | {(name, RETURNED) for name in entries}
        self.kept: set[ast.stmt] = set()
        statements = [
            (name, parents, statement)
            for name, function in self.functions.items()
            for parents, statement in _statements(function.body, ())
        ]
        before = -1
        while before < len(self.kept) + len(self.live):
            before = len(self.kept) + len(self.live)
            for name, parents, statement in statements:
                if statement not in self.kept and self._matters(name, statement):
                    for each in (statement, *parents):
                        self._keep(name, each)
        for name, function in self.functions.items():
            if name != "__init__" and function.args.args != []:
                function.body = self._left(function.body)

    def _matters(self, function: str, statement: ast.stmt) -> bool:
        if isinstance(statement, ast.Return):
            return (function, RETURNED) in self.live or self._has_effect(function)
        if isinstance(statement, ast.Break | ast.Continue):
            return True  # its loop may not be kept, and then neither is it
        if isinstance(statement, ast.If | ast.While | ast.For):
            return False  # for what is in it
        targets = [node for node in ast.walk(statement) if isinstance(getattr(node, "ctx", None), ast.Store)]
        called = (_called(node) for node in ast.walk(statement) if isinstance(node, ast.Call))
        return any(place in self.live for node in targets for place in _places(function, node)) or any(
            self._has_effect(name) for name in called
        )

    def _has_effect(self, function: str) -> bool:
        """Return whether what is kept of a function sets a variable of the component, or an array it is given."""
        if function not in self.functions:
            return False
        return any(
            isinstance(node, ast.Attribute | ast.Subscript)
            and isinstance(node.ctx, ast.Store)
            or isinstance(node, ast.Call)
            and _called(node) != function
            and self._has_effect(_called(node))
            for _parents, statement in _statements(self.functions[function].body, ())
            if statement in self.kept and not isinstance(statement, ast.If | ast.While | ast.For)
            for node in ast.walk(statement)
        )

    def _keep(self, function: str, statement: ast.stmt) -> None:
        self.kept.add(statement)
        parts: list[ast.AST] = [statement]
        if isinstance(statement, ast.If | ast.While):
            parts = [statement.test]
        elif isinstance(statement, ast.For):
            parts = [statement.target, statement.iter]
        for node in (node for part in parts for node in ast.walk(part)):
            self.live |= set(_places(function, node))
            if isinstance(node, ast.Call):
                self.live.add((_called(node), RETURNED))

    def _left(self, body: list[ast.stmt]) -> list[ast.stmt]:
        found = []
        for statement in body:
            if statement in self.kept:
                for name in ("body", "orelse"):
                    if inner := getattr(statement, name, []):
                        setattr(statement, name, self._left(inner) or [ast.Pass()] * (name == "body"))
                found.append(statement)
        return found


def _statements(
    body: list[ast.stmt], parents: tuple[ast.stmt, ...]
) -> Iterator[tuple[tuple[ast.stmt, ...], ast.stmt]]:
    """The statements of a body, those inside of others included, with all that they are in."""
    for statement in body:
        yield parents, statement
        for name in ("body", "orelse"):
            yield from _statements(getattr(statement, name, []), (*parents, statement))


def _places(function: str, node: ast.AST) -> Iterator[Place]:
    """What a node names: a variable of the component, or one of its function."""
    if isinstance(node, ast.Attribute) and of_self(node):
        yield SELF, node.attr
    elif isinstance(node, ast.Name):
        yield function, node.id
    elif isinstance(node, ast.Subscript):
        yield from _places(function, node.value)


def _called(node: ast.Call) -> str:
    return node.func.attr if isinstance(node.func, ast.Attribute) else ast.unparse(node.func)
