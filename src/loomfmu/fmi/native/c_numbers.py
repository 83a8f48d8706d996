"""The type of real numbers in the C that is written: `double`, or `dual`, which carries a derivative along.

Whatever a function computes is written once, by the same methods; here is all that the two types differ in.
"""

import ast
from dataclasses import dataclass, replace

from .c_code import ATOM, NAMES, REAL, TRUTH, UNARY, WHOLE, Code, Kind, Untranslatable, literal, shown, within

OPERATIONS = {"+": "dual_sum", "-": "dual_difference", "*": "dual_product", "/": "dual_quotient"}  # of dual.h


@dataclass(frozen=True)
class Numbers:
    """A type of real numbers: its name, that in python_arithmetic.h, and a prefix for what has two forms."""

    type: str
    name: str
    prefix: str

    def text(self, kind: Kind) -> str:
        """A type as C calls it."""
        return self.type if kind == REAL else str(kind)

    def named(self, kind: str) -> str:
        """A type in the names of python_arithmetic.h."""
        return self.name if kind == REAL else NAMES[kind]

    def literal(self, value: float | int | bool) -> Code:
        """A number or a truth value."""
        return self.constant(literal(value), f"{self.prefix}of(%s)")

    def initial(self, code: Code) -> str:
        """A number where C allows constants alone."""
        return self.constant(code, "{%s, 0.0}").text

    def constant(self, code: Code, form: str) -> Code:
        """A number that does not change with anything."""
        return (
            code if self is PLAIN or code.type != REAL else replace(code, text=form % code.text, level=ATOM)
        )

    def widened(self, code: Code, kind: Kind, node: ast.AST) -> Code:
        """An expression as another type: what Python takes for equal, and nothing else."""
        if code.type == kind:
            return code
        if kind == REAL and code.number is not None:
            return self.literal(float(code.number))
        if (code.type, kind) in ((WHOLE, REAL), (TRUTH, REAL), (TRUTH, WHOLE)):
            return self.converted(code, kind)
        raise Untranslatable(node, f"{ast.unparse(node)} is {shown(code.type)} where {shown(kind)} is needed")

    def converted(self, code: Code, kind: Kind = REAL) -> Code:
        """A whole number or a truth value as another type."""
        return self.constant(Code(f"({kind}){within(code, ATOM)}", kind, UNARY), f"{self.prefix}of(%s)")

    def negated(self, code: Code) -> Code:
        """A number with the other sign."""
        if self is PLAIN or code.type != REAL:
            return Code(f"-{within(code, ATOM)}", code.type, UNARY)
        return Code(f"dual_negated({code.text})", REAL)

    def combined(self, symbol: str, level: int, left: Code, right: Code) -> Code:
        """Two numbers of one type under an operator of C."""
        if self is not PLAIN and left.type == REAL:
            return Code(f"{OPERATIONS[symbol]}({left.text}, {right.text})", REAL)
        shown = within(right, level + 1)
        shown = f"({shown})" if shown.startswith("-") else shown
        return Code(f"{within(left, level)} {symbol} {shown}", left.type, level)

    def value(self, code: Code) -> Code:
        """The value alone, for all that no derivative leads through: comparisons, whole numbers."""
        if self is PLAIN or code.type != REAL:
            return code
        return Code(f"{within(code, ATOM)}.value", REAL)


PLAIN = Numbers(REAL, "float", "")
DUAL = Numbers("dual", "dual", "dual_")
