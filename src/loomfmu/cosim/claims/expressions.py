"""Expressions of signals, such as `heald_1.lift - heald_2.lift`: their grammar, their units, their cases."""

import ast
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import product
from operator import add, sub
from typing import Any

from ... import units
from ...errors import LoomfmuError, shown, suggestion
from ...units import BASES, UNITS

Dimension = tuple[int, ...]
UnitOf = Callable[[str], str]  # the unit of a signal
Linear = tuple[dict[str, Fraction], Fraction]  # the share of each signal, and a constant

FUNCTIONS = {"abs": (1, 1), "min": (2, 9), "max": (2, 9)}  # and how many arguments they take
FOLDED: Mapping[str, Callable[[list[Any]], Any]] = {"abs": lambda each: abs(each[0]), "min": min, "max": max}
OPERATORS: dict[type[ast.AST], str] = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}
LONGEST, DEEPEST = 500, 50  # characters, and levels of operations in one another
MOST_CASES = 32
NONE = UNITS["1"].dimension
ANGLE = BASES.index("rad")
GRAMMAR = "+, -, *, /, abs, min, max, parentheses, signals, and numbers with units such as 5 mm"
_NAMES = "|".join(re.escape(name) for name in sorted({*UNITS, "rpm"} - {"1"}, key=len, reverse=True))
_NUMBER = re.compile(
    rf"(?<![\w.])(\d++(?:\.\d*+)?(?:[eE][-+]?\d++)?+|\.\d++)(?:\s*({_NAMES})(?![\w.])|\s*([^\W\d]\w*))?"
)


def is_expression(signal: str) -> bool:
    """Return whether a text is more than the name of a signal, or cannot be one."""
    return re.search(r"[-+*/(),]|^\s*(?![^\W\d_])", signal) is not None


class TooManyCases(Exception):
    """An expression has more than `MOST_CASES`."""


@dataclass(frozen=True)
class Node:
    """A number, a signal or an operation on others; a number is in SI, `factor` leads a signal there.

    A number is that which is written, not the float that is nearest to it.
    """

    kind: str
    parts: tuple["Node", ...] = ()
    text: str = ""
    number: Fraction = Fraction(0)
    factor: Fraction = Fraction(1)
    dimension: Dimension = NONE

    @property
    def signals(self) -> tuple[str, ...]:
        """The signals in it, each once."""
        own = [self.text] if self.kind == "signal" else []
        return tuple(dict.fromkeys([*own, *(name for part in self.parts for name in part.signals)]))

    @property
    def smooth(self) -> bool:
        """Return whether it has no corners that its signals do not have."""
        known = self.constant is not None
        return known or (self.kind not in FUNCTIONS and all(part.smooth for part in self.parts))

    @property
    def constant(self) -> Fraction | None:
        """Its number, if it is made of numbers alone."""
        return _number(self.linear)

    def of(self, *parts: "Node") -> "Node":
        """The same operation on other parts."""
        text = f"({f' {self.kind} '.join(part.text for part in parts)})"
        return Node(self.kind, parts, text, dimension=self.dimension)

    @property
    def negative(self) -> "Node":
        """Its negative."""
        return Node("neg", (self,), f"-{self.text}", dimension=self.dimension)

    def cases(self, sense: int) -> list["Node"]:
        """Smooth expressions that all keep a bound exactly where this one does; an empty list without such.

        With sense 1 the least of them is this expression, with -1 the largest. Raises TooManyCases.
        """
        if self.smooth:
            return [self]
        if self.kind == "neg":
            return [each.negative for each in self.parts[0].cases(-sense)]
        if self.kind == "+":
            every = [part.cases(sense) for part in self.parts]
            if math.prod(map(len, every)) > MOST_CASES:  # each further one would double them
                raise TooManyCases
            return [self.of(*each) for each in product(*every)]
        if self.kind == "*" or (self.kind == "/" and self.parts[1].constant is not None):
            return self._scaled(sense)
        if self.kind == ("max" if sense < 0 else "min"):
            each = [part.cases(sense) for part in self.parts]
            return [case for cases in each for case in cases] if all(each) else []
        if self.kind == "abs" and sense < 0:
            each = [self.parts[0].cases(-1), self.parts[0].negative.cases(-1)]
            return [*each[0], *each[1]] if all(each) else []
        return []

    def _scaled(self, sense: int) -> list["Node"]:
        """The cases of a constant times, or over, another expression."""
        known = [part.constant for part in self.parts]
        place = next((place for place, each in enumerate(known) if each), None)
        if place is None:
            return []
        others = self.parts[1 - place].cases(sense if (known[place] or 0) > 0 else -sense)
        return [self.of(*((each, self.parts[1]) if place else (self.parts[0], each))) for each in others]

    @cached_property
    def linear(self) -> Linear | None:
        """The share of each signal and a constant, if it is a sum of these; its numbers are not rounded."""
        known = [part.constant for part in self.parts]
        match self.kind:
            case "number":
                return {}, self.number
            case "signal":
                return {self.text: self.factor}, Fraction(0)
            case "neg":
                return _sum([self.parts[0].linear], Fraction(-1))
            case "+":
                return _sum([part.linear for part in self.parts])
            case "*" if known[1] is not None:
                return _sum([self.parts[0].linear], known[1])
            case "*" if known[0] is not None:
                return _sum([self.parts[1].linear], known[0])
            case "/" if known[1]:
                return _sum([self.parts[0].linear], 1 / known[1])
        numbers = [each for each in known if each is not None]
        whole = self.kind in FUNCTIONS and len(numbers) == len(known)
        return ({}, FOLDED[self.kind](numbers)) if whole else None


def _sum(parts: list[Linear | None], scale: Fraction = Fraction(1)) -> Linear | None:
    """Return a multiple of a sum, if its parts are all known."""
    shares, total = dict[str, Fraction](), Fraction(0)
    for part in parts:
        if part is None:
            return None
        for name, share in part[0].items():
            shares[name] = shares.get(name, Fraction(0)) + scale * share
        total += scale * part[1]
    return shares, total


def _number(linear: Linear | None) -> Fraction | None:
    """Return the number that a sum is if it has no signals."""
    return None if linear is None or linear[0] else linear[1]


class Expression(str):
    """The text of an expression, with what was read from it; its values are in `unit`, SI."""

    node: Node
    unit: str

    @classmethod
    def made(cls, node: Node, text: str, unit: str) -> "Expression":
        """Return the expression of a node, under a text."""
        found = cls(text)
        found.node, found.unit = node, unit
        return found

    def display(self, display_of: Callable[[str], str]) -> str:
        """The unit that people read it in: that of the first signal of its kind, as `display_of` gives it."""
        dimension = known_as(self.node.dimension)
        alike = (each.text for each in _all_signals(self.node) if each.dimension == dimension)
        return next(map(display_of, alike), self.unit)

    def cases(self, sense: int) -> list["Expression"]:
        """Smooth expressions, see `Node.cases`; itself if there are none, or too many."""
        found = self._nodes(sense) or []
        return [Expression.made(each, each.text, self.unit) for each in found] if len(found) > 1 else [self]

    def has_too_many_cases(self, sense: int) -> bool:
        """Return whether there are more than `MOST_CASES`."""
        return self._nodes(sense) is None

    def _nodes(self, sense: int) -> list[Node] | None:
        try:
            found = self.node.cases(sense)
        except TooManyCases:
            return None
        return found if len(found) <= MOST_CASES else None


def read(text: str, unit_of: UnitOf, where: str) -> Expression:
    """Read an expression of signals. Raises LoomfmuError, one line on what is wrong."""
    node = _Reader(text, unit_of, where).node()
    dimension = known_as(node.dimension)
    name = _name(dimension)
    if not name:
        raise LoomfmuError(
            f"{where} = {shown(text)} is in {_shown(node.dimension)}, a unit without a name;"
            " divide by a quantity, such as 1 mm, and state the bound as a number"
        )
    if not node.signals:
        raise LoomfmuError(f"{where} = {shown(text)} has no signal in it")
    return Expression.made(node, text, name)


def _all_signals(node: Node) -> list[Node]:
    own = [node] if node.kind == "signal" else []
    return [*own, *(each for part in node.parts for each in _all_signals(part))]


def _exact(unit: units.Unit) -> Fraction:
    """The factor of a unit, in the decimal digits that it has in the table of units."""
    return Fraction(repr(unit.factor))


def known_as(dimension: Dimension) -> Dimension:
    """A dimension as it has a name: in products an angle counts as a number where they have none else."""
    plain = tuple(0 if place == ANGLE else each for place, each in enumerate(dimension))
    return plain if not _name(dimension) and _name(plain) else dimension


def _name(dimension: Dimension) -> str:
    """The SI unit of a dimension; an empty text if there is none."""
    return next(
        (name for name, each in UNITS.items() if each.dimension == dimension and each.factor == 1.0), ""
    )


def _shown(dimension: Dimension) -> str:
    """A dimension as part of a message."""
    if name := _name(dimension):
        return units.fitted(name)
    return ".".join(
        f"{base}{power if power != 1 else ''}" for base, power in zip(BASES, dimension, strict=True) if power
    )


class _Reader:
    """Walks the tree that Python's parser makes of a text; nothing of it is run."""

    def __init__(self, text: str, unit_of: UnitOf, where: str):
        self._text, self._unit_of, self._where = text, unit_of, f"{where} = {shown(text)}"
        self._quantities: dict[str, Node] = {}
        self._mark = "_"  # begins names that stand for numbers
        while self._mark in text:
            self._mark += "_"

    def node(self) -> Node:
        """The whole expression."""
        if len(self._text) > LONGEST:
            raise self._refused(f"has {len(self._text)} characters; at most {LONGEST} are possible")
        plain = _NUMBER.sub(self._quantity, self._text).strip()
        if not plain:
            raise self._refused("has no signal in it")
        try:
            return self._read(ast.parse(plain, mode="eval").body, DEEPEST)
        except (MemoryError, RecursionError):
            raise self._refused("is nested too deeply") from None
        except (SyntaxError, ValueError):
            raise self._refused(f"is not an expression of {GRAMMAR}") from None

    def _refused(self, why: str) -> LoomfmuError:
        return LoomfmuError(f"{self._where} {why}")

    def _quantity(self, found: re.Match[str]) -> str:
        """Take a number with its unit out of the text, which Python's grammar does not know."""
        number, name, other = found.groups()
        if other:
            raise self._refused(f"has the unknown unit {shown(other)}{suggestion(other, UNITS)}")
        unit, text = units.unit(name or "1"), found[0].strip()
        size = float(number) * unit.factor
        if math.isinf(size) or (not size and re.search("[1-9]", number.lower().partition("e")[0])):
            raise self._refused(f"has {text} in it, which is too {'large' if size else 'small'}")
        value = Fraction(number) * _exact(unit)
        stands_for = f"{self._mark}{len(self._quantities)}"
        self._quantities[stands_for] = Node("number", (), text, value, dimension=unit.dimension)
        return f" {stands_for} "

    def _read(self, tree: ast.expr, levels: int) -> Node:
        if not levels:
            raise RecursionError
        if isinstance(tree, ast.Name) and tree.id in self._quantities:
            return self._quantities[tree.id]
        if isinstance(tree, ast.Attribute) and isinstance(tree.value, ast.Name):
            return self._signal(f"{tree.value.id}.{tree.attr}")
        if isinstance(tree, ast.UnaryOp) and isinstance(tree.op, ast.USub):
            part = self._read(tree.operand, levels - 1)
            return Node("neg", (part,), f"-{part.text}", dimension=part.dimension)
        if isinstance(tree, ast.UnaryOp) and isinstance(tree.op, ast.UAdd):
            return self._read(tree.operand, levels - 1)
        if isinstance(tree, ast.BinOp) and type(tree.op) in OPERATORS:
            parts = [self._read(each, levels - 1) for each in (tree.left, tree.right)]
            return self._binary(OPERATORS[type(tree.op)], *parts)
        if isinstance(tree, ast.Call):
            return self._call(tree, levels - 1)
        if isinstance(tree, ast.Name):
            raise self._refused(f"has {shown(tree.id)}, which is not a signal such as heald_1.lift")
        raise self._refused(f"is not an expression of {GRAMMAR}")

    def _signal(self, name: str) -> Node:
        unit = UNITS.get(units.canonical(self._unit_of(name)))
        if unit is None:
            raise self._refused(f"has {name} in it, whose unit {shown(self._unit_of(name))} is not known")
        return Node("signal", (), name, factor=_exact(unit), dimension=unit.dimension)

    def _binary(self, sign: str, left: Node, right: Node) -> Node:
        text = f"({left.text} {sign} {right.text})"
        if sign in "+-":
            dimension = self._same([left, right], text)
            return Node("+", (left, right if sign == "+" else right.negative), text, dimension=dimension)
        if sign == "/" and right.constant == 0:
            raise self._refused("divides by 0")
        combined = zip(left.dimension, right.dimension, strict=True)
        dimension = tuple((add if sign == "*" else sub)(*each) for each in combined)
        return Node(sign, (left, right), text, dimension=dimension)

    def _call(self, tree: ast.Call, levels: int) -> Node:
        name = tree.func.id if isinstance(tree.func, ast.Name) else ast.unparse(tree.func)
        if name in self._quantities:
            raise self._refused(f"lacks an operator after {self._quantities[name].text}")
        if name not in FUNCTIONS:
            raise self._refused(f"has the unknown function {shown(name)}{suggestion(name, FUNCTIONS)}")
        fewest, most = FUNCTIONS[name]
        if tree.keywords or not fewest <= len(tree.args) <= most:
            count = "1 argument" if most == 1 else f"{fewest} to {most} arguments"
            raise self._refused(f"must have {count} in {name}(...)")
        parts = [self._read(each, levels) for each in tree.args]
        text = f"{name}({', '.join(part.text for part in parts)})"
        return Node(name, tuple(parts), text, dimension=self._same(parts, text))

    def _same(self, parts: list[Node], text: str) -> Dimension:
        """The dimension that all parts have. Raises LoomfmuError where they differ."""
        found = [known_as(part.dimension) for part in parts]
        for part, each in zip(parts, found, strict=True):
            if each != found[0]:
                raise self._refused(
                    f"has {parts[0].text} in {_shown(found[0])} beside {part.text} in {_shown(each)}"
                )
        return found[0]
