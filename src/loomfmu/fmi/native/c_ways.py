"""The ways through a function that translates to C: each returns what is declared, with names that are set.

Python says so when it gets there; C would go on with whatever it finds.
"""

import ast
from collections.abc import Iterable
from contextlib import suppress
from functools import reduce

from .c_code import Untranslatable

Names = frozenset[str]


def check_ways(function: ast.FunctionDef, returns: bool) -> None:
    """Refuse a function of which a way ends without its return, or reads a name that it may not have set.

    Raises Untranslatable.
    """
    ways = _Ways(function)
    given = frozenset(each.arg for each in function.args.args)
    if ways.through(function.body, given) is not None and returns:
        raise Untranslatable(function, f"{function.name} may end without the return that is declared")


class _Ways:
    """Follows all ways through a function, with the names that are set on each of them."""

    def __init__(self, function: ast.FunctionDef):
        self._own = {each.id for each in _names(function, ast.Store)}
        # what is set where each loop around is left by a break, and where its body is by a continue
        self._left: list[tuple[list[Names], list[Names]]] = []

    def through(self, statements: Iterable[ast.stmt], known: Names | None) -> Names | None:
        """Return the names that are set after some statements, None where no way gets there."""
        for statement in statements:
            if known is None:
                break
            known = self._after(statement, known)
        return known

    def _after(self, node: ast.stmt, known: Names) -> Names | None:
        match node:
            case ast.If():
                self._check(node.test, known)
                return _both(self.through(node.body, known), self.through(node.orelse, known))
            case ast.While():
                self._check(node.test, known)
                endless = isinstance(node.test, ast.Constant) and bool(node.test.value)
                return self._loop(node.body, known, None if endless else known, once=False)
            case ast.For():
                self._check(node.iter, known)
                inside = known | {each.id for each in _names(node.target, ast.Store)}
                return self._loop(node.body, inside, known, _has_numbers(node.iter))
        self._check(node, known)
        if isinstance(node, ast.Break | ast.Continue):
            self._left[-1][isinstance(node, ast.Continue)].append(known)
        if isinstance(node, ast.Return | ast.Break | ast.Continue):
            return None
        return known | {each.id for each in _names(node, ast.Store)}

    def _loop(self, body: list[ast.stmt], inside: Names, after: Names | None, once: bool) -> Names | None:
        """Return what is set after a loop: `after` if it does not run; it may be known to run `once`."""
        self._left.append(([], []))
        end = self.through(body, inside)
        breaks, continues = self._left.pop()
        if once:
            after = reduce(_both, continues, end)
        return reduce(_both, breaks, after)

    def _check(self, node: ast.AST, known: Names) -> None:
        """Refuse to read a name that is set in the function, but not here."""
        if isinstance(node, ast.AugAssign):
            self._check(ast.parse(ast.unparse(node.target), mode="eval").body, known)
        for each in _names(node, ast.Load):
            if each.id in self._own and each.id not in known:
                raise Untranslatable(node, f"{each.id} may not be set yet: give it a value before")


def _both(one: Names | None, other: Names | None) -> Names | None:
    """Return what is set on both of two ways that meet."""
    if one is None or other is None:
        return other if one is None else one
    return one & other


def _has_numbers(called: ast.expr) -> bool:
    """Return whether a range() is known not to be empty."""
    given = called.args if isinstance(called, ast.Call) else []
    with suppress(TypeError, ValueError):  # what is no range is refused where it is translated
        return bool(range(*map(ast.literal_eval, given)))
    return False


def _names(node: ast.AST, context: type[ast.expr_context]) -> list[ast.Name]:
    """The names that are read or set in a node, but for those of its comprehensions."""
    if isinstance(node, ast.ListComp):
        inner = {
            each.id
            for loop in node.generators
            for each in ast.walk(loop.target)
            if isinstance(each, ast.Name)
        }
        parts = [node.elt, *(loop.iter for loop in node.generators)]
        return [each for part in parts for each in _names(part, context) if each.id not in inner]
    if isinstance(node, ast.Name):
        return [node] if isinstance(node.ctx, context) else []
    return [each for part in ast.iter_child_nodes(node) for each in _names(part, context)]
