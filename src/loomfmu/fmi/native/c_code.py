"""Parts of C text: types, names, numbers and the signatures of functions.

Python's `float` is `double` here, its `int` is `int64_t`.
"""

import ast
import math
from collections.abc import Iterable
from dataclasses import dataclass

REAL, WHOLE, TRUTH = "double", "int64_t", "bool"
TYPES = {"float": REAL, "int": WHOLE, "bool": TRUTH}
NAMES = {c: python for python, c in TYPES.items()}
ARRAYS = {
    f"list[{python}]": c for python, c in TYPES.items()
}  # as annotations call them, with their elements

# C's levels of binding, loosest first
TERNARY, OR, AND, BITS, EQUAL, ORDER, SHIFT, SUM, PRODUCT, UNARY, ATOM = range(11)


class Untranslatable(Exception):
    """A node that has no counterpart in C, and the reason."""

    def __init__(self, node: ast.AST, reason: str):
        super().__init__(reason)
        self.node = node


@dataclass(frozen=True)
class Array:
    """The type of an array. In C it is a struct, so that it is assigned and returned as a number is."""

    component: str
    element: str
    size: int

    def __str__(self) -> str:
        return f"struct {self.component}_{NAMES[self.element]}_{self.size}"


@dataclass(frozen=True)
class Record:
    """The type of a record: its name and those of its fields, with their types."""

    component: str
    name: str
    fields: tuple[tuple[str, "Kind"], ...]

    def __str__(self) -> str:
        return f"struct {self.component}_{self.name}{sizes(kind for _name, kind in self.fields)}"


Kind = str | Array | Record
Results = tuple[Kind, ...]  # types of what a function returns: none, one or several


@dataclass(frozen=True)
class Code:
    """An expression in C: text, type, how tightly it binds, and its value if it is a plain number."""

    text: str
    type: Kind
    level: int = ATOM
    number: float | int | None = None


@dataclass(frozen=True)
class Declared:
    """A function as it is annotated: arrays get their sizes, and records theirs, where it is called."""

    function: ast.FunctionDef
    name: str
    arguments: tuple[str, ...]
    results: tuple[str, ...]
    method: bool
    written: frozenset[int] = frozenset()  # the arguments whose elements it writes


@dataclass(frozen=True)
class Signature:
    """A function as C calls it, with the types of its arguments and of its results."""

    name: str
    arguments: tuple[Kind, ...]
    results: Results


def sizes(kinds: Iterable[Kind]) -> str:
    """Tell types apart that are annotated alike, by the sizes of their arrays."""
    found = ""
    for kind in kinds:
        if isinstance(kind, Array):
            found += f"_{kind.size}"
        elif isinstance(kind, Record):
            found += sizes(each for _name, each in kind.fields)
    return found


def shown(kind: Kind) -> str:
    """A type as messages call it."""
    if isinstance(kind, Array):
        return f"list[{NAMES[kind.element]}] of {kind.size}"
    return kind.name if isinstance(kind, Record) else NAMES[kind]


def short(kind: Kind) -> str:
    """A type in the names of structs that hold several values."""
    if isinstance(kind, Array):
        return f"{NAMES[kind.element][0]}{kind.size}"
    return f"{kind.name}{sizes([kind])}" if isinstance(kind, Record) else NAMES[kind][0]


def literal(value: float | int | bool) -> Code:
    """A number or a truth value as C writes it."""
    if isinstance(value, bool):
        return Code(str(value).lower(), TRUTH)
    if isinstance(value, int):
        text = str(value) if abs(value) < 2**31 else f"INT64_C({value})"
        return Code(text, WHOLE, UNARY if value < 0 else ATOM, value)
    if not math.isfinite(value):
        text = "NAN" if math.isnan(value) else "INFINITY" if value > 0 else "-INFINITY"
    else:
        text = repr(value)
    return Code(text, REAL, UNARY if text.startswith("-") else ATOM, value)


def within(code: Code, level: int) -> str:
    """The text of an operand, in parentheses if it binds more loosely than that."""
    return code.text if code.level >= level else f"({code.text})"


def declared(function: ast.FunctionDef, name: str, method: bool, records: Iterable[str]) -> Declared:
    """A function as it is annotated. Raises Untranslatable for what C has no counterpart of."""
    given = function.args
    if function.decorator_list:
        raise Untranslatable(function, "a decorator is not in the subset")
    if given.vararg or given.kwarg or given.kwonlyargs or given.posonlyargs or given.defaults:
        raise Untranslatable(function, "only plain arguments are in the subset")
    known = {**TYPES, **{each: each for each in (*ARRAYS, *records)}}
    arguments = tuple(_type(each.annotation, known, function) for each in given.args[int(method) :])
    return Declared(function, name, arguments, _results(function, known), method)


def _type(annotation: ast.expr | None, known: dict[str, str], function: ast.FunctionDef) -> str:
    name = ast.unparse(annotation) if annotation is not None else "no type"
    if name not in known:
        raise Untranslatable(
            annotation or function, f"{name} is not float, int or bool, nor a list of them or a record"
        )
    return known[name]


def _results(function: ast.FunctionDef, known: dict[str, str]) -> tuple[str, ...]:
    given = function.returns
    if isinstance(given, ast.Constant) and given.value is None:
        return ()
    if isinstance(given, ast.Subscript) and ast.unparse(given.value) == "tuple":
        several = given.slice.elts if isinstance(given.slice, ast.Tuple) else [given.slice]
        return tuple(_type(each, known, function) for each in several)
    return (_type(given, known, function),)


def fits(kind: Kind, annotated: str) -> bool:
    """Return whether a type is what an annotation of `Declared` says."""
    if isinstance(kind, Array):
        return ARRAYS.get(annotated) == kind.element
    return annotated == (kind.name if isinstance(kind, Record) else kind)


def comment(text: str, indent: str) -> list[str]:
    """A text as a comment of C that cannot end early."""
    lines = [line.rstrip() for line in text.replace("*/", "* /").replace("/*", "/ *").splitlines()]
    if len(lines) == 1:
        return [f"{indent}/* {lines[0]} */"]
    return [f"{indent}/* {lines[0]}", *(f"{indent} * {line}".rstrip() for line in lines[1:]), f"{indent} */"]


KEYWORDS = frozenset(
    (
        "auto",
        "bool",
        "break",
        "case",
        "char",
        "const",
        "continue",
        "default",
        "do",
        "double",
        "dual",
        "else",
        "enum",
        "extern",
        "false",
        "float",
        "for",
        "goto",
        "if",
        "inline",
        "int",
        "long",
        "main",
        "register",
        "restrict",
        "return",
        "short",
        "signed",
        "sizeof",
        "static",
        "struct",
        "switch",
        "true",
        "typedef",
        "union",
        "unsigned",
        "void",
        "volatile",
        "while",
    )
)


def c_name(name: str) -> str:
    """A name that C takes, with its owner and its index: keywords and macros of C get an underscore."""
    owner, dot, member = name.rpartition(".")
    word, bracket, index = member.partition("[")
    taken = word in KEYWORDS or word.isupper()  # as the macros of its headers are
    own = f"{word}_{bracket}{index}" if taken else member
    return f"{c_name(owner)}.{own}" if dot else own
