"""What C text is made of: types, names, numbers, and how functions are called.

Python's `float` is `double` here, its `int` is `int64_t`.
"""

import ast
import math
from dataclasses import dataclass, field

REAL, WHOLE, TRUTH = "double", "int64_t", "bool"
TYPES = {"float": REAL, "int": WHOLE, "bool": TRUTH}
NAMES = {c: python for python, c in TYPES.items()}
Results = tuple[str, ...]  # types of what a function returns: none, one or several

# C's levels of binding, loosest first
TERNARY, OR, AND, BITS, EQUAL, ORDER, SHIFT, SUM, PRODUCT, UNARY, ATOM = range(11)


class Untranslatable(Exception):
    """A node that has no counterpart in C, and the reason."""

    def __init__(self, node: ast.AST, reason: str):
        super().__init__(reason)
        self.node = node


@dataclass(frozen=True)
class Code:
    """An expression in C: text, type, how tightly it binds, and its value if it is a plain number."""

    text: str
    type: str
    level: int = ATOM
    number: float | int | None = None


@dataclass(frozen=True)
class Signature:
    """A function as C calls it: its name, the types of its arguments and of its results."""

    name: str
    arguments: tuple[str, ...]
    results: Results
    method: bool = False


@dataclass
class Scope:
    """What the names of a function mean: its locals, the component's variables, functions and constants."""

    functions: dict[str, Signature]
    methods: dict[str, Signature]
    variables: dict[str, str]  # of the component, as C calls them, with their types
    arrays: dict[str, tuple[str, ...]]  # of the component, with the names of their elements
    constants: dict[str, float | int]
    from_math: frozenset[str]
    changes: dict[str, frozenset[str]]  # the variables that each method changes, those that it calls included
    locals: dict[str, str] = field(default_factory=dict)


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


def widened(code: Code, kind: str, node: ast.AST) -> Code:
    """An expression as another type: what Python takes for equal, and nothing else."""
    if code.type == kind:
        return code
    if kind == REAL and code.number is not None:
        return literal(float(code.number))
    if (code.type, kind) in ((WHOLE, REAL), (TRUTH, REAL), (TRUTH, WHOLE)):
        return Code(f"({kind}){within(code, ATOM)}", kind, UNARY)
    raise Untranslatable(node, f"{ast.unparse(node)} is {NAMES[code.type]} where {NAMES[kind]} is needed")


def signature(function: ast.FunctionDef, name: str, method: bool) -> Signature:
    """How C calls a function. Raises Untranslatable for what C has no counterpart of."""
    given = function.args
    if function.decorator_list:
        raise Untranslatable(function, "a decorator is not in the subset")
    if given.vararg or given.kwarg or given.kwonlyargs or given.posonlyargs or given.defaults:
        raise Untranslatable(function, "only plain arguments are in the subset")
    arguments = given.args[1:] if method else given.args
    return Signature(
        name, tuple(_type(each.annotation, function) for each in arguments), _results(function), method
    )


def _type(annotation: ast.expr | None, function: ast.FunctionDef) -> str:
    name = ast.unparse(annotation) if annotation is not None else "no type"
    if name not in TYPES:
        raise Untranslatable(annotation or function, f"{name} is not float, int or bool")
    return TYPES[name]


def _results(function: ast.FunctionDef) -> Results:
    given = function.returns
    if isinstance(given, ast.Constant) and given.value is None:
        return ()
    if isinstance(given, ast.Subscript) and ast.unparse(given.value) == "tuple":
        several = given.slice.elts if isinstance(given.slice, ast.Tuple) else [given.slice]
        return tuple(_type(each, function) for each in several)
    return (_type(given, function),)


def result_type(results: Results, component: str) -> str:
    """The C type of what a function returns; several values come in a struct."""
    if len(results) < 2:
        return results[0] if results else "void"
    return f"struct {component}_{''.join(NAMES[kind][0] for kind in results)}"


def result_struct(results: Results, component: str) -> str:
    """The declaration of a struct of several values."""
    members = " ".join(f"{kind} value_{place};" for place, kind in enumerate(results))
    return f"{result_type(results, component)} {{ {members} }};"


def comment(text: str, indent: str) -> list[str]:
    """A text as a comment of C that cannot end early."""
    lines = [line.rstrip() for line in text.replace("*/", "* /").replace("/*", "/ *").splitlines()]
    if len(lines) == 1:
        return [f"{indent}/* {lines[0]} */"]
    return [f"{indent}/* {lines[0]}", *(f"{indent} * {line}".rstrip() for line in lines[1:]), f"{indent} */"]


def of_self(node: ast.AST) -> str:
    """The name of an attribute of `self`, or nothing."""
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "self":
        return node.attr
    return ""


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
    """A name that C takes, with its owner and its index: keywords of C get an underscore."""
    owner, dot, member = name.rpartition(".")
    word, bracket, index = member.partition("[")
    own = f"{word}_{bracket}{index}" if word in KEYWORDS else member
    return f"{c_name(owner)}.{own}" if dot else own
