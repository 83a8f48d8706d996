"""Values of the Python that translates to C: names, arrays, records, and what functions return.

An array has one name: what is assigned to another name, or becomes part of a record, is made there. A record
is never changed. So C may copy where Python refers to one object, and both compute the same.
"""

import ast
from collections.abc import Iterable

from ..source import of_self
from .c_code import (
    NAMES,
    REAL,
    TRUTH,
    WHOLE,
    Array,
    Code,
    Declared,
    Kind,
    Record,
    Results,
    Untranslatable,
    c_name,
    fits,
    literal,
    shown,
)
from .c_numbers import PLAIN
from .c_scope import Scope


class Values:
    """Translates names, elements, fields, lists and calls of one function."""

    def __init__(self, scope: Scope):
        self.scope = scope

    def any_of(self, node: ast.expr) -> Code:
        """An expression in C, also an array or a record. Raises Untranslatable where there is none."""
        method = getattr(self, f"_{type(node).__name__.lower()}", None)
        if method is None:
            raise Untranslatable(node, f"{type(node).__name__} is not in the subset")
        found: Code = method(node)
        return found

    def of(self, node: ast.expr) -> Code:
        """An expression in C that is a number or a truth value."""
        code = self.any_of(node)
        if isinstance(code.type, Array | Record):
            raise Untranslatable(node, f"{ast.unparse(node)} is {shown(code.type)}, not a number")
        return code

    def as_type(self, node: ast.expr, kind: Kind) -> Code:
        """An expression as a type."""
        return self.scope.numbers.widened(self.any_of(node), kind, node)

    def made(self, node: ast.expr) -> Code:
        """As `any_of`, but no array that has a name already."""
        code = self.any_of(node)
        if isinstance(code.type, Array) and isinstance(node, ast.Name | ast.Attribute):
            name = ast.unparse(node)
            raise Untranslatable(node, f"{name} would be one array under two names: copy it, list({name})")
        return code

    # ---- calls

    def call(self, node: ast.Call) -> tuple[str, Results]:
        """A call of one of our functions or methods: its text and the types of its results."""
        called = self.declared(node)
        values = [each for given in node.args for each in self.spread(given)]
        if len(values) != len(called.arguments):
            raise Untranslatable(node, f"{ast.unparse(node.func)} takes {len(called.arguments)} arguments")
        codes = [
            self._argument(value, annotated, place in called.written)
            for place, (value, annotated) in enumerate(zip(values, called.arguments, strict=True))
        ]
        signature = self.scope.translated(called, tuple(code.type for code in codes))
        given_texts = ["self"] * called.method + [code.text for code in codes]
        return f"{signature.name}({', '.join(given_texts)})", signature.results

    def _argument(self, value: ast.expr, annotated: str, written: bool) -> Code:
        """An argument: a number by its value, an array or a record by a pointer."""
        if annotated in NAMES:
            return self.as_type(value, annotated)
        code = self.any_of(value)
        if not fits(code.type, annotated):
            raise Untranslatable(value, f"{ast.unparse(value)} is {shown(code.type)}, not {annotated}")
        if self.is_ours(value):
            raise Untranslatable(value, f"give {ast.unparse(value)} a name before it is passed on")
        if written and isinstance(value, ast.Attribute):
            raise Untranslatable(value, f"{ast.unparse(value)} would be changed, and a record is not")
        text = (
            code.text.removeprefix("(*").removesuffix(")") if code.text.startswith("(*") else f"&{code.text}"
        )
        return Code(text, code.type)

    def spread(self, given: ast.expr) -> list[ast.expr]:
        """An argument, or the elements of the array that `*` makes several of."""
        return self.elements(given.value) if isinstance(given, ast.Starred) else [given]

    def elements(self, array: ast.expr) -> list[ast.expr]:
        """The elements of an array of the component, or of another one."""
        if of_self(array) in self.scope.arrays:
            itself = ast.Name("self", ast.Load())
            return [
                ast.copy_location(ast.Attribute(itself, name, ast.Load()), array)
                for name in self.scope.arrays[of_self(array)]
            ]
        _text, _kind, size = self.place(array)
        return [
            ast.copy_location(ast.Subscript(array, ast.Constant(n), ast.Load()), array) for n in range(size)
        ]

    def is_ours(self, node: ast.AST) -> bool:
        """Return whether an expression calls one of our functions or methods."""
        if not isinstance(node, ast.Call):
            return False
        called = node.func
        return isinstance(called, ast.Attribute) or (
            isinstance(called, ast.Name) and called.id in self.scope.functions
        )

    def declared(self, node: ast.Call) -> Declared:
        """The function that a call calls. Raises Untranslatable if it is not ours."""
        if node.keywords:
            raise Untranslatable(node, "an argument is given by its name")
        if isinstance(node.func, ast.Name):
            return self.scope.functions[node.func.id]
        attribute = of_self(node.func)
        if attribute not in self.scope.methods:
            raise Untranslatable(node, f"{ast.unparse(node.func)} is not a method of the component")
        return self.scope.methods[attribute]

    def built(self, node: ast.Call, name: str) -> Code:
        """A record from the values of its fields, in their order or by their names."""
        annotations = self.scope.records[name]
        given = dict(zip(annotations, node.args, strict=False))
        given |= {each.arg: each.value for each in node.keywords if each.arg and each.arg not in given}
        if set(given) != set(annotations) or len(given) != len(node.args) + len(node.keywords):
            raise Untranslatable(node, f"{name} takes {', '.join(annotations)}")
        codes = {}
        for field, annotated in annotations.items():
            code = self.made(given[field])
            widened = self.scope.numbers.widened
            codes[field] = widened(code, annotated, given[field]) if annotated in NAMES else code
            if not fits(codes[field].type, annotated):
                raise Untranslatable(given[field], f"{field} is {shown(code.type)}, not {annotated}")
        kind = self.scope.record(name, (code.type for code in codes.values()))
        members = ", ".join(f".{c_name(field)} = {code.text}" for field, code in codes.items())
        return Code(f"({kind}){{{members}}}", kind)

    # ---- names, fields, elements

    def _name(self, node: ast.Name) -> Code:
        scope = self.scope
        if node.id in scope.locals:
            text = scope.renamed.get(node.id, c_name(node.id))
            return Code(f"(*{text})" if node.id in scope.lent else text, scope.locals[node.id])
        if node.id in scope.constants:
            return scope.numbers.literal(scope.constants[node.id])
        if node.id in scope.tables:
            raise Untranslatable(
                node, f"{node.id} is several numbers: read {node.id}[index] or list({node.id})"
            )
        raise Untranslatable(node, f"{node.id} has no value here")

    def _attribute(self, node: ast.Attribute) -> Code:
        name = of_self(node)
        if not name:
            return self._field(node)
        if name in self.scope.arrays:
            raise Untranslatable(
                node,
                f"self.{name} is an array: read self.{name}[index] or pass *self.{name} or list(self.{name})",
            )
        if name not in self.scope.variables:
            raise Untranslatable(node, f"{ast.unparse(node)} is not a variable of the component")
        return Code(f"self->{c_name(name)}", self.scope.variables[name])

    def _field(self, node: ast.Attribute) -> Code:
        """A field of a record."""
        record = None if ast.unparse(node).startswith("self.") else self.any_of(node.value)
        if record is None or not isinstance(record.type, Record):
            raise Untranslatable(node, f"{ast.unparse(node)} is not a variable of the component")
        if node.attr not in dict(record.type.fields):
            raise Untranslatable(node, f"{record.type.name} has no field {node.attr}")
        return Code(_member(record.text, c_name(node.attr)), dict(record.type.fields)[node.attr])

    def place(self, array: ast.expr) -> tuple[str, str, int]:
        """Return the place of the elements of an array in C, their type and number."""
        scope, name = self.scope, array.id if isinstance(array, ast.Name) else ""
        if of_self(array) in scope.arrays:
            members = scope.arrays[of_self(array)]
            return f"self->{c_name(of_self(array))}", scope.variables[members[0]], len(members)
        if name in scope.tables and name not in scope.locals:
            table = [literal(value) for value in scope.tables[name]]
            place, kind = f"{scope.component}_{c_name(name)}", _element(table)
            values = ", ".join(scope.numbers.initial(PLAIN.widened(code, kind, array)) for code in table)
            scope.structs[place] = (
                f"static const {scope.numbers.text(kind)} {place}[{len(table)}] = {{{values}}};"
            )
            return place, kind, len(table)
        code = self.any_of(array) if not of_self(array) else None
        if code is None:
            raise Untranslatable(array, f"{ast.unparse(array)} is not an array of the component")
        if not isinstance(code.type, Array):
            raise Untranslatable(array, f"{ast.unparse(array)} is not an array")
        return _member(code.text, "at"), code.type.element, code.type.size

    def index(self, node: ast.Subscript, size: int) -> tuple[str, bool]:
        """The index of an element, counted from 0, and whether it is known to lie within the array."""
        code = self.as_type(node.slice, WHOLE)
        if code.number is not None:
            number = int(code.number)
            if not -size <= number < size:
                raise Untranslatable(node, f"{ast.unparse(node.value)} has {size} elements")
            return str(number % size), True
        first, last = self.span(node.slice)
        return code.text, 0 <= first <= last < size

    def span(self, node: ast.expr) -> tuple[int, int]:
        """The least and the largest value of an index; of one that is not known, none that is within."""
        if isinstance(node, ast.Name) and node.id in self.scope.spans:
            return self.scope.spans[node.id]
        if isinstance(node, ast.BinOp) and type(node.op) in (ast.Add, ast.Sub, ast.Mult):
            (first, last), (low, high) = self.span(node.left), self.span(node.right)
            if first >= 0 and low >= 0:
                return {
                    ast.Add: (first + low, last + high),
                    ast.Sub: (first - high, last - low),
                    ast.Mult: (first * low, last * high),
                }[type(node.op)]
        elif isinstance(node, ast.Constant | ast.Name | ast.Call):
            number = self.of(node).number
            if isinstance(number, int):
                return number, number
        return -1, -1

    def _subscript(self, node: ast.Subscript) -> Code:
        """An element of an array; C, too, counts a negative index from the end and never reads beside it."""
        place, kind, size = self.place(node.value)
        index, within = self.index(node, size)
        if within:
            return Code(f"{place}[{index}]", kind)
        return Code(f"python_item_{self.scope.numbers.named(kind)}({place}, {size}, {index})", kind)

    # ---- lists

    def listed(self, codes: list[Code], node: ast.expr) -> Code:
        """An array of these values."""
        if not codes:
            raise Untranslatable(node, "an array has one element or more")
        kind = _element(codes)
        array = self.scope.array(kind, len(codes))
        elements = ", ".join(self.scope.numbers.widened(code, kind, node).text for code in codes)
        return Code(f"({array}){{{{{elements}}}}}", array)

    def _list(self, node: ast.List) -> Code:
        return self.listed([self.of(each) for each in node.elts], node)

    def repeated(self, node: ast.BinOp) -> Code:
        """`[0.0] * 6`: an array of equal elements."""
        times = self.of(node.right).number
        if not isinstance(node.left, ast.List) or not isinstance(times, int):
            raise Untranslatable(node, "an array is made by a list of one number times a whole number")
        return self.listed([self.of(each) for each in node.left.elts] * times, node)

    def copied(self, array: ast.expr) -> Code:
        """`list(q)`: a copy of an array, of one of the component or of a constant."""
        place, kind, size = self.place(array)
        return self.listed([Code(f"{place}[{n}]", kind) for n in range(size)], array)

    def length(self, array: ast.expr) -> Code:
        """`len(q)`: a number, known at once."""
        return literal(self.place(array)[2])

    def _listcomp(self, node: ast.ListComp) -> Code:
        raise Untranslatable(node, "a list over range() stands by itself: assign it to a name, or return it")


def _member(text: str, member: str) -> str:
    """A member of a struct, or of one that a pointer points to."""
    return f"{text[2:-1]}->{member}" if text.startswith("(*") else f"{text}.{member}"


def _element(codes: Iterable[Code]) -> str:
    """The type that several numbers have together."""
    kinds = {code.type for code in codes}
    return next(kind for kind in (REAL, WHOLE, TRUTH) if kind in kinds)
