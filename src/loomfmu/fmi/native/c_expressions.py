"""Expressions of the Python that translates to C, as C99 with their types.

What is not written down here does not translate: the grammar is closed. Whole numbers widen to real ones
where Python would let them.
"""

import ast
from dataclasses import replace

from .c_code import (
    AND,
    ATOM,
    BITS,
    EQUAL,
    OR,
    ORDER,
    PRODUCT,
    REAL,
    SHIFT,
    SUM,
    TERNARY,
    TRUTH,
    TYPES,
    UNARY,
    WHOLE,
    Code,
    Untranslatable,
    shown,
    within,
)
from .c_numbers import DUAL
from .c_values import Values

ARITHMETIC: dict[type[ast.operator], tuple[str, int]] = {
    ast.Add: ("+", SUM),
    ast.Sub: ("-", SUM),
    ast.Mult: ("*", PRODUCT),
    ast.Div: ("/", PRODUCT),
}
BITWISE: dict[type[ast.operator], tuple[str, int]] = {
    ast.BitAnd: ("&", BITS),
    ast.BitOr: ("|", BITS),
    ast.BitXor: ("^", BITS),
    ast.LShift: ("<<", SHIFT),
    ast.RShift: (">>", SHIFT),
}
# C rounds and takes remainders in another way than Python: python_arithmetic.h has Python's
DIVISIONS: dict[type[ast.operator], str] = {ast.FloorDiv: "floor_division", ast.Mod: "modulo"}
COMPARISONS: dict[type[ast.cmpop], tuple[str, int]] = {
    ast.Lt: ("<", ORDER),
    ast.LtE: ("<=", ORDER),
    ast.Gt: (">", ORDER),
    ast.GtE: (">=", ORDER),
    ast.Eq: ("==", EQUAL),
    ast.NotEq: ("!=", EQUAL),
}
# functions that Python takes from the same libm, and how many arguments they have
REAL_FUNCTIONS = {
    **dict.fromkeys(
        (
            "acos",
            "acosh",
            "asin",
            "asinh",
            "atan",
            "atanh",
            "cbrt",
            "cos",
            "cosh",
            "erf",
            "erfc",
            "exp",
            "expm1",
            "fabs",
            "log",
            "log10",
            "log1p",
            "log2",
            "sin",
            "sinh",
            "sqrt",
            "tan",
            "tanh",
        ),
        1,
    ),
    **dict.fromkeys(("atan2", "copysign", "fmod", "pow"), 2),
}
OF_DUALS = {"at_root": REAL, "absent": TRUTH}  # of the physics, which with dual numbers are those of dual.h
WHOLE_FUNCTIONS = ("floor", "ceil", "trunc")
TRUTH_FUNCTIONS = ("isfinite", "isinf", "isnan")
INSTEAD = {
    "abs": "; use fabs of math for a float",
    "max": "; write a if a > b else b",
    "min": "; write a if a < b else b",
}


class Expressions(Values):
    """Translates the expressions of one function."""

    def condition(self, node: ast.expr) -> Code:
        """An expression that is true or false."""
        code = self.of(node)
        if code.type != TRUTH:
            raise Untranslatable(node, f"{ast.unparse(node)} is {shown(code.type)}, not a condition")
        return code

    # ---- one method for each kind of node

    def _constant(self, node: ast.Constant) -> Code:
        if not isinstance(node.value, bool | int | float):
            raise Untranslatable(node, f"{node.value!r} is not a number")
        return self.scope.numbers.literal(node.value)

    def _unaryop(self, node: ast.UnaryOp) -> Code:
        if isinstance(node.op, ast.Not):
            return Code(f"!{within(self.condition(node.operand), ATOM)}", TRUTH, UNARY)
        operand = self.of(node.operand)
        if isinstance(node.op, ast.Invert) or operand.type == TRUTH:
            raise Untranslatable(node, f"{ast.unparse(node)} is not in the subset")
        if isinstance(node.op, ast.UAdd):
            return operand
        if operand.number is not None:
            return self.scope.numbers.literal(-operand.number)
        return self.scope.numbers.negated(operand)

    def _binop(self, node: ast.BinOp) -> Code:
        operation = type(node.op)
        if operation is ast.Mult and isinstance(node.left, ast.List):
            return self.repeated(node)
        left, right = self.of(node.left), self.of(node.right)
        if operation in BITWISE:
            return self._bits(node)
        if operation is ast.Pow:
            if REAL not in (left.type, right.type):
                raise Untranslatable(node, "a power of whole numbers is not in the subset")
            return self._function("pow", [node.left, node.right])
        kind = WHOLE if left.type == right.type == WHOLE and operation is not ast.Div else REAL
        if operation in DIVISIONS:
            one, other = self.as_type(node.left, kind).text, self.as_type(node.right, kind).text
            return Code(
                f"python_{DIVISIONS[operation]}_{self.scope.numbers.named(kind)}({one}, {other})", kind
            )
        if operation not in ARITHMETIC:
            raise Untranslatable(node, f"{operation.__name__} is not in the subset")
        symbol, level = ARITHMETIC[operation]
        numbers = self.scope.numbers
        left, right = numbers.widened(left, kind, node.left), numbers.widened(right, kind, node.right)
        return numbers.combined(symbol, level, left, right)

    def _function(self, name: str, given: list[ast.expr]) -> Code:
        """A function of libm."""
        arguments = ", ".join(self.as_type(each, REAL).text for each in given)
        return Code(f"{self.scope.numbers.prefix}{name}({arguments})", REAL)

    def _bits(self, node: ast.BinOp) -> Code:
        symbol, level = BITWISE[type(node.op)]
        left, right = self.as_type(node.left, WHOLE), self.as_type(node.right, WHOLE)
        return Code(f"{within(left, UNARY)} {symbol} {within(right, UNARY)}", WHOLE, level)

    def _compare(self, node: ast.Compare) -> Code:
        operands = [node.left, *node.comparators]
        if any(self.is_ours(operand) for operand in operands[1:-1]):
            raise Untranslatable(node, "a call in the middle of a chain of comparisons would be made twice")
        parts = [
            self._compared(one, sign, other)
            for one, sign, other in zip(operands, node.ops, operands[1:], strict=False)
        ]
        return parts[0] if len(parts) == 1 else _joined("&&", AND, parts)

    def _compared(self, one: ast.expr, sign: ast.cmpop, other: ast.expr) -> Code:
        if type(sign) not in COMPARISONS:
            raise Untranslatable(other, f"{type(sign).__name__} is not in the subset")
        symbol, level = COMPARISONS[type(sign)]
        left, right = self.of(one), self.of(other)
        kind = next(each for each in (REAL, WHOLE, TRUTH) if each in (left.type, right.type))
        numbers = self.scope.numbers
        left = numbers.value(numbers.widened(left, kind, one))
        right = numbers.value(numbers.widened(right, kind, other))
        return Code(f"{within(left, SHIFT)} {symbol} {within(right, SHIFT)}", TRUTH, level)

    def _boolop(self, node: ast.BoolOp) -> Code:
        parts = [self.condition(value) for value in node.values]
        return _joined("&&", AND, parts) if isinstance(node.op, ast.And) else _joined("||", OR, parts)

    def _ifexp(self, node: ast.IfExp) -> Code:
        then, otherwise = self.of(node.body), self.of(node.orelse)
        kind = next(each for each in (REAL, WHOLE, TRUTH) if each in (then.type, otherwise.type))
        numbers = self.scope.numbers
        then, otherwise = (
            numbers.widened(then, kind, node.body),
            numbers.widened(otherwise, kind, node.orelse),
        )
        asked = within(self.condition(node.test), OR)
        return Code(f"{asked} ? {within(then, OR)} : {within(otherwise, TERNARY)}", kind, TERNARY)

    def _call(self, node: ast.Call) -> Code:
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if name in OF_DUALS and self.scope.numbers is DUAL:
            return replace(self._function(name, node.args), type=OF_DUALS[name])
        if self.is_ours(node):
            text, results = self.call(node)
            if len(results) != 1:
                raise Untranslatable(node, f"{ast.unparse(node.func)} returns {len(results)} values, not one")
            return Code(text, results[0])
        if name in self.scope.records:
            return self.built(node, name)
        if node.keywords:
            raise Untranslatable(node, "an argument is given by its name")
        if name in ("float", "int") and len(node.args) == 1:
            return self._converted(node.args[0], TYPES[name])
        if name in ("list", "len") and len(node.args) == 1:
            return self.copied(node.args[0]) if name == "list" else self.length(node.args[0])
        if name not in self.scope.from_math:
            hint = INSTEAD.get(name, "")
            raise Untranslatable(node, f"{name} is not a function of math, of physics or of this file{hint}")
        if len(node.args) != REAL_FUNCTIONS.get(name, 1):
            raise Untranslatable(node, f"{name} takes {REAL_FUNCTIONS.get(name, 1)} arguments")
        if name in REAL_FUNCTIONS:
            return self._function(name, node.args)
        value = self.scope.numbers.value(self.as_type(node.args[0], REAL)).text
        if name in WHOLE_FUNCTIONS:
            return Code(f"python_whole({name}({value}))", WHOLE)
        if name in TRUTH_FUNCTIONS:
            return Code(f"({name}({value}) != 0)", TRUTH)
        raise Untranslatable(node, f"math.{name} gives other bits in C than in Python")

    def _converted(self, node: ast.expr, kind: str) -> Code:
        code = self.of(node)
        if kind == WHOLE and code.type == REAL:
            return Code(f"python_whole({self.scope.numbers.value(code).text})", WHOLE)
        return self.scope.numbers.widened(code, kind, node)


def _joined(symbol: str, level: int, parts: list[Code]) -> Code:
    """Conditions joined by one operator; those of the other one stand in parentheses."""
    return Code(f" {symbol} ".join(within(part, EQUAL) for part in parts), TRUTH, level)
