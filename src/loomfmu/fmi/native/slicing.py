"""A slice of a component: what some of its outputs depend on with some settings, without the rest."""

import ast
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from ...declaring.variables import Variable
from ..source import of_self

Place = tuple[str, str]  # a function and a name in it; "" for the component's own variables
RETURNED = "return"  # in the place of a name: what a function returns
SELF = ""
COMPARED: dict[type[ast.cmpop], Any] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}


def sliced(
    tree: ast.Module, entries: Iterable[str], wanted: Iterable[str], settings: Mapping[str, Any]
) -> ast.Module:
    """Return the module with only the statements that these variables, and what entries return, depend on.

    `settings` are parameters that keep their value: what they rule out is left out. A statement stays if it
    may set what a statement that stays reads, and every return of a function that stays. The tree is changed.
    """
    return _Slice(_Settled(tree, settings).visit(tree), entries, wanted).tree


class _Settled(ast.NodeTransformer):
    """Takes the branch that settings decide on, instead of both."""

    def __init__(self, tree: ast.Module, settings: Mapping[str, Any]):
        functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
        within = [node for each in functions if each.name != "__init__" for node in ast.walk(each)]
        stored = {ast.unparse(node) for node in within if isinstance(getattr(node, "ctx", None), ast.Store)}
        stored |= {node.arg for node in within if isinstance(node, ast.arg)}
        known = {f"self.{name}": value for name, value in settings.items()}
        for node in tree.body:
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant):
                known[ast.unparse(node.targets[0])] = node.value.value
        self._known = {name: value for name, value in known.items() if name not in stored}

    def visit_If(self, node: ast.If) -> Any:
        self.generic_visit(node)
        value = self._value(node.test)
        if value is None:
            return node
        return (node.body if value else node.orelse) or ast.Pass()

    def visit_IfExp(self, node: ast.IfExp) -> ast.AST:
        self.generic_visit(node)
        value = self._value(node.test)
        return node if value is None else node.body if value else node.orelse

    def _value(self, node: ast.expr) -> Any:
        """The value of a condition; None where it is open."""
        if isinstance(node, ast.Constant):
            return node.value
        if isinstance(node, ast.Name | ast.Attribute):
            return self._known.get(ast.unparse(node))
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            value = self._value(node.operand)
            return None if value is None else not value
        if any(isinstance(each, ast.Call) for each in ast.walk(node)):
            return None  # it may change something
        if isinstance(node, ast.BoolOp):
            values = [self._value(each) for each in node.values]
            decides = isinstance(node.op, ast.Or)
            if any(value is not None and bool(value) == decides for value in values):
                return decides
            return None if None in values else not decides
        if isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in COMPARED:
            left, right = self._value(node.left), self._value(node.comparators[0])
            return None if None in (left, right) else COMPARED[type(node.ops[0])](left, right)
        return None


class _Slice:
    def __init__(self, tree: ast.Module, entries: Iterable[str], wanted: Iterable[str]):
        self.tree = tree
        methods = {id(each) for node in tree.body if isinstance(node, ast.ClassDef) for each in node.body}
        self.functions = {
            f"self.{node.name}" if id(node) in methods else node.name: node
            for node in ast.walk(tree)
            if isinstance(node, ast.FunctionDef) and node.name != "__init__" and not node.decorator_list
        }
        self.live: set[Place] = {(SELF, name) for name in wanted}
        self.live |= {(f"self.{name}", RETURNED) for name in entries}
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
        for function in self.functions.values():
            function.body = self._left(function.body) or [ast.Pass()]

    def _matters(self, function: str, statement: ast.stmt) -> bool:
        if isinstance(statement, ast.Return):
            return (function, RETURNED) in self.live or self._has_effect(function)
        if isinstance(statement, ast.Break | ast.Continue):
            return True  # its loop may not be kept, and then neither is it
        for node in _own_nodes(statement):
            if isinstance(node, ast.Call) and self._has_effect(ast.unparse(node.func)):
                return True
            if isinstance(getattr(node, "ctx", None), ast.Store):
                if isinstance(node, ast.Subscript):
                    return True  # an element of an array, which may be the caller's
                if any(place in self.live for place in _places(function, node)):
                    return True
        return False

    def _has_effect(self, function: str) -> bool:
        """Return whether what is kept of a function sets a variable of the component, or an array."""
        if function not in self.functions:
            return False
        statements = (each for _, each in _statements(self.functions[function].body, ()))
        return any(
            (isinstance(node, ast.Attribute | ast.Subscript) and isinstance(node.ctx, ast.Store))
            or (isinstance(node, ast.Call) and self._has_effect(ast.unparse(node.func)))
            for each in statements
            if each in self.kept
            for node in _own_nodes(each)
        )

    def _keep(self, function: str, statement: ast.stmt) -> None:
        self.kept.add(statement)
        for node in _own_nodes(statement):
            self.live |= set(_places(function, node))
            if isinstance(node, ast.Call):
                self.live.add((ast.unparse(node.func), RETURNED))

    def _left(self, body: list[ast.stmt]) -> list[ast.stmt]:
        found = []
        for statement in body:
            if statement in self.kept:
                for name in ("body", "orelse"):
                    if inner := getattr(statement, name, []):
                        setattr(statement, name, self._left(inner) or [ast.Pass()] * (name == "body"))
                found.append(statement)
        return found


def settings_of(variables: Iterable[Variable], start: Callable[[str], Any]) -> dict[str, Any]:
    """Return the values of the parameters that choose: truth values and enumerations."""
    return {
        each.name: each.type(start(each.name))
        for each in variables
        if each.causality == "parameter" and (each.type is bool or each.choices)
    }


def _statements(
    body: list[ast.stmt], parents: tuple[ast.stmt, ...]
) -> Iterator[tuple[tuple[ast.stmt, ...], ast.stmt]]:
    """Yield the statements of a body, those inside of others included, with all that they are in."""
    for statement in body:
        yield parents, statement
        for name in ("body", "orelse"):
            yield from _statements(getattr(statement, name, []), (*parents, statement))


def _own_nodes(statement: ast.stmt) -> Iterator[ast.AST]:
    """Yield the nodes of a statement, without those of the statements inside of it."""
    parts: list[ast.AST] = [statement]
    if isinstance(statement, ast.If | ast.While):
        parts = [statement.test]
    elif isinstance(statement, ast.For):
        parts = [statement.target, statement.iter]
    for part in parts:
        yield from ast.walk(part)


def _places(function: str, node: ast.AST) -> Iterator[Place]:
    """Yield the places that a node names: of the component's variables, and of its function's."""
    if isinstance(node, ast.Attribute) and of_self(node):
        yield SELF, node.attr
    elif isinstance(node, ast.Name):
        yield function, node.id
    elif isinstance(node, ast.Subscript):
        yield from _places(function, node.value)
