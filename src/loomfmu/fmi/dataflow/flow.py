"""The flow of data through a source.

Nothing is computed: the value of an expression is the set of names that it may depend on, by what it is made
of and by the conditions that lead there. At a branch both ways are gone.
"""

import ast
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TypeVar, cast

from ...declaring.variables import NOTHING, TIME, Component, arrays_of
from ..source import flatten, of_self
from .values import NONE, Names, Places, Record, Value, flat, joined, together, under

Found = TypeVar("Found")
NEW = (ast.List, ast.ListComp, ast.BinOp, ast.Call)  # of a list: one that has no other name
BUILTIN = frozenset(("abs", "bool", "float", "int", "list", "max", "min", "range", "round", "sum"))


class Unfollowed(Exception):
    """Source beyond the Python that is followed here."""


def started(component: type[Component], own: Mapping[str, Names]) -> Places:
    """The places after the start, from what variables depend on before."""
    flow = _Flow(component)
    flow.places |= own
    flow.call(flow.methods["initialize"], [NONE, frozenset({TIME})])
    return flow.places


def followed(component: type[Component], own: Mapping[str, Names]) -> tuple[Places, Places]:
    """The places after one step, and after many, from what variables depend on before."""
    flow = _Flow(component)
    flow.places |= own
    time = frozenset({TIME})
    if component.keeps == NOTHING:
        flow.call(flow.methods["initialize"], [NONE, time])
    before, passed = flow.places, list[Places]()
    while not passed or (before != flow.places and component.keeps != NOTHING):
        before = flow.places
        flow.call(flow.methods["step"], [NONE, time, NONE])
        passed.append(flow.places)
    return passed[0], passed[-1]


@dataclass
class _Frame:
    """A call of a function: what decides whether the place is reached where it stands, and its ways out."""

    condition: Names = NONE  # of the statements around it
    is_entry: bool = False  # it returns the number of a problem to the shell
    left: Names = NONE  # of the ways that have returned
    broken: Names = NONE  # of the ways that have left the loop, or a pass through it
    returned: list[Value] = field(default_factory=list)
    exits: list[Places] = field(default_factory=list)
    breaks: list[Places] = field(default_factory=list)
    filled: set[str] = field(default_factory=set)  # lists whose elements it sets
    shared: set[str] = field(default_factory=set)  # what has two names

    @property
    def all(self) -> Names:
        """Return all that decides."""
        return self.condition | self.left | self.broken


class _Flow(ast.NodeVisitor):
    """Goes through statements, and returns what each expression depends on."""

    def __init__(self, component: type[Component]):
        tree = ast.parse(flatten(component))
        classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
        self.methods = _functions(classes.pop(component.__name__).body)
        self._entries = [self.methods[name] for name in ("initialize", "step")]
        self._functions = _functions(tree.body)
        self._records = {
            name: tuple(each.arg for each in _functions(node.body)["__init__"].args.args[1:])
            for name, node in classes.items()
        }
        arrays = arrays_of(component)
        self._arrays = {name: [f".{each.member}" for each in same] for name, same in arrays.items()}
        problems = enumerate(component.problems, start=1)
        self._problems = {number for number, each in problems if not each.warning}
        self._warns = len(self._problems) < len(component.problems)
        self._called: dict[tuple[str, tuple[Value, ...]], tuple[Value, Places]] = {}
        self._ended = False  # this way has returned, or left its loop
        self._frame = _Frame()
        self.places: Places = {}

    def call(self, function: ast.FunctionDef, arguments: Sequence[Value]) -> tuple[Value, Places]:
        """Return what a function returns, and those of its arguments whose elements it sets."""
        names = [each.arg for each in function.args.args]
        if len(names) != len(arguments):
            raise Unfollowed
        outer, around = self._frame, self.places
        self._frame = frame = _Frame(outer.all, function in self._entries)
        self.places = _of_component(around) | dict(zip(names, arguments, strict=True))
        self._block(function.body)
        if not self._ended:
            frame.exits.append(self.places)
        after, self._ended, self._frame = together(frame.exits), False, outer
        self.places = around | _of_component(after)
        result: Value = frame.returned[0] if frame.returned else NONE
        for each in frame.returned[1:]:
            result = joined(result, each)
        return result, {name: after[name] for name in names if name in frame.filled}

    def generic_visit(self, node: ast.AST) -> None:
        """Refuse what is not known here."""
        raise Unfollowed

    # ---- statements

    def _block(self, body: Iterable[ast.stmt]) -> None:
        for statement in body:
            if not self._ended:
                self.visit(statement)

    def visit_Pass(self, node: ast.Pass) -> None: ...

    def visit_Expr(self, node: ast.Expr) -> None:
        self.visit(node.value)

    def visit_Assign(self, node: ast.Assign) -> None:
        value = self.visit(node.value)
        for target in node.targets:
            if isinstance(target, ast.Name) and not isinstance(node.value, NEW):
                self._frame.shared |= {target.id, ast.unparse(node.value)}
            self._put(target, value)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self._put(node.target, self.visit(node.value))

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        self._put(node.target, self._names(node.target) | self._names(node.value))

    def visit_Return(self, node: ast.Return) -> None:
        value = self.visit(node.value) if node.value else NONE
        self._frame.returned.append(under(value, self._frame.all))
        self._frame.exits.append(self.places)
        self._frame.left |= self._frame.condition | self._frame.broken
        self._ended = True

    def visit_Break(self, node: ast.Break | ast.Continue) -> None:
        """Leave the loop, or this pass through it: both count as ways to its end and to another pass."""
        self._frame.breaks.append(self.places)
        self._frame.broken |= self._frame.condition
        self._ended = True

    visit_Continue = visit_Break

    def visit_If(self, node: ast.If) -> None:
        test = self._names(node.test)
        if self._frame.is_entry and self._is_rejection(node):
            self._block(node.orelse)
        else:
            self._ways(test, lambda: self._block(node.body), lambda: self._block(node.orelse))

    def visit_While(self, node: ast.While) -> None:
        self._loop(partial(self._names, node.test), node)

    def visit_For(self, node: ast.For) -> None:
        def begin() -> Names:
            span = self._names(node.iter)
            self._put(node.target, span)
            return span

        self._loop(begin, node)

    def _is_rejection(self, node: ast.If) -> bool:
        """Return whether the step ends with a problem and without outputs if the test is true."""
        first = node.body[0]
        if isinstance(first, ast.Return) and isinstance(first.value, ast.Constant):
            return first.value.value in self._problems
        if isinstance(first, ast.Return) and isinstance(first.value, ast.Name) and not self._warns:
            return ast.unparse(node.test) == f"{first.value.id} != 0"
        return False

    def _ways(self, test: Names, *ways: Callable[[], Found]) -> list[Found]:
        """Go several ways from here, one of which is taken, as the test says."""
        before, condition = self.places, self._frame.condition
        self._frame.condition |= test
        ends, found = [], []
        for way in ways:
            self.places = dict(before)
            found.append(way())
            if not self._ended:
                ends.append(self.places)
            self._ended = False
        self.places, self._ended = (together(ends), False) if ends else (before, True)
        self._frame.condition = condition
        return found

    def _loop(self, begin: Callable[[], Names], node: ast.While | ast.For) -> None:
        """Go through a loop until another pass through it changes nothing."""
        if node.orelse:
            raise Unfollowed
        frame, condition = self._frame, self._frame.condition
        broken, breaks = frame.broken, frame.breaks
        frame.breaks = []
        seen: tuple[Places, Names] = {}, NONE
        while True:
            frame.condition |= begin()
            if seen == (self.places, frame.all):
                break
            seen = dict(self.places), frame.all
            frame.breaks = []
            self._block(node.body)
            ends = [] if self._ended else [self.places]
            self.places, self._ended = together([seen[0], *ends, *frame.breaks]), False
        self.places = together([self.places, *frame.breaks])
        frame.condition, frame.broken, frame.breaks = condition, broken, breaks

    def _put(self, target: ast.expr, value: Value) -> None:
        """Set what is on the left of an assignment."""
        value, name = under(value, self._frame.all), of_self(target)
        if isinstance(target, ast.Tuple):
            for each, part in zip(target.elts, _parts(value, len(target.elts)), strict=True):
                self._put(each, part)
        elif isinstance(target, ast.Subscript):
            self._put_element(target.value, target.slice, value)
        elif name in self._arrays:
            places = self._arrays[name]
            self.places |= zip(places, _parts(value, len(places)), strict=True)
        elif name or isinstance(target, ast.Name):
            self.places[f".{name}" if name else ast.unparse(target)] = value
        else:
            raise Unfollowed

    def _put_element(self, array: ast.expr, index: ast.expr | None, value: Value) -> None:
        """Set an element of a list or an array: the one of a known number, or any."""
        name, more = of_self(array), flat(value) | (self._names(index) if index else NONE)
        places = self._arrays.get(name) or [ast.unparse(array)]
        if not (name in self._arrays or isinstance(array, ast.Name)) or self._frame.shared & {*places}:
            raise Unfollowed
        if name and isinstance(index, ast.Constant):
            places = [places[_number(index)]]
        for place in places:
            self.places[place] = flat(self.places.get(place, NONE)) | more
        self._frame.filled |= {*places}

    # ---- expressions

    def _names(self, node: ast.expr) -> Names:
        return flat(self.visit(node))

    def _made_of(self, node: ast.expr) -> Names:
        parts = [part for part in ast.iter_child_nodes(node) if isinstance(part, ast.expr)]
        return NONE.union(*map(self._names, parts))

    visit_BinOp = visit_UnaryOp = visit_Compare = visit_Constant = visit_List = _made_of

    def visit_Name(self, node: ast.Name) -> Value:
        return self.places.get(node.id, NONE)

    def visit_Attribute(self, node: ast.Attribute) -> Value:
        if name := of_self(node):
            places = self._arrays.get(name)
            own = [self.places.get(place, NONE) for place in places or [f".{name}"]]
            return tuple(own) if places else own[0]
        record = self.visit(node.value)
        return record.values[record.names.index(node.attr)] if isinstance(record, Record) else flat(record)

    def visit_Subscript(self, node: ast.Subscript) -> Value:
        value, index = self.visit(node.value), self._names(node.slice)
        if isinstance(value, tuple) and isinstance(node.slice, ast.Constant):
            part: Value = value[_number(node.slice)]
            return part
        return flat(value) | index

    def visit_Tuple(self, node: ast.Tuple) -> Value:
        return tuple(self._several(node.elts))

    def visit_ListComp(self, node: ast.ListComp) -> Names:
        each, before = node.generators[0], self.places
        if len(node.generators) > 1 or each.ifs:
            raise Unfollowed
        span = self._names(each.iter)
        self.places = dict(before)
        self._put(each.target, span)
        found = span | self._names(node.elt)
        self.places = before | _of_component(self.places)
        return found

    def visit_IfExp(self, node: ast.IfExp) -> Value:
        test = self._names(node.test)
        ways = self._ways(test, partial(self.visit, node.body), partial(self.visit, node.orelse))
        return under(joined(*ways), test)

    def visit_BoolOp(self, node: ast.BoolOp) -> Names:
        found = self._names(node.values[0])
        for each in node.values[1:]:
            found |= self._ways(found, partial(self._names, each), lambda: NONE)[0]
        return found

    def visit_Call(self, node: ast.Call) -> Value:
        arguments, method, name = self._several(node.args), of_self(node.func), ast.unparse(node.func)
        if node.keywords:
            raise Unfollowed
        if method in self.methods:
            function = self.methods[method]
            value, filled = self.call(function, [NONE, *arguments])
        elif name in self._functions:
            function = self._functions[name]
            value, filled = self._apart(function, tuple(arguments))
        elif name in self._records:
            return Record(self._records[name], tuple(arguments))
        elif name in BUILTIN or (isinstance(node.func, ast.Name) and hasattr(math, name)):
            return NONE.union(*map(flat, arguments))
        elif name == "len":  # known beforehand
            return NONE
        else:
            raise Unfollowed
        for argument, given in zip(function.args.args[bool(method) :], node.args, strict=False):
            if argument.arg in filled:
                self._put_element(given, None, filled[argument.arg])
        return under(value, self._frame.all)

    def _apart(self, function: ast.FunctionDef, arguments: tuple[Value, ...]) -> tuple[Value, Places]:
        """Call a function that knows nothing but its arguments; once for the same."""
        key = function.name, arguments
        if key not in self._called:
            around, frame, self.places, self._frame = self.places, self._frame, {}, _Frame()
            self._called[key] = self.call(function, arguments)
            self.places, self._frame = around, frame
        return self._called[key]

    def _several(self, nodes: Iterable[ast.expr]) -> list[Value]:
        found: list[Value] = []
        for node in nodes:
            if isinstance(node, ast.Starred):
                several = self.visit(node.value)
                if not isinstance(several, tuple):
                    raise Unfollowed
                found += several
            else:
                found.append(self.visit(node))
        return found


def _parts(value: Value, count: int) -> Sequence[Value]:
    """The parts of what is taken apart."""
    return value if isinstance(value, tuple) and len(value) == count else [flat(value)] * count


def _number(node: ast.Constant) -> int:
    return int(cast("int", node.value))


def _of_component(places: Places) -> Places:
    return {name: value for name, value in places.items() if name[0] == "."}


def _functions(body: Iterable[ast.stmt]) -> dict[str, ast.FunctionDef]:
    return {node.name: node for node in body if isinstance(node, ast.FunctionDef)}
