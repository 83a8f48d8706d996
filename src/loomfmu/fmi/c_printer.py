"""Pyccel with a C printer that says every conversion: `python -m loomfmu.fmi.c_printer MODULE.py`.

Runs in a process of its own, since Pyccel keeps its state in globals. It writes `__pyccel__/MODULE.c`
and `.h` below the current directory. Results do not change, but for the whole part of a number that no
64-bit integer holds, which C leaves undefined.
"""

import sys
from collections.abc import Callable
from typing import Any

from pyccel.ast.datatypes import PrimitiveFloatingPointType, PrimitiveIntegerType
from pyccel.ast.operators import PyccelAssociativeParenthesis, PyccelComparisonOperator, PyccelOperator
from pyccel.codegen.pipeline import execute_pyccel
from pyccel.codegen.printing.ccode import CCodePrinter

SYMBOLS = {
    "Add": "+", "Minus": "-", "Mul": "*", "Div": "/",
    "Lt": "<", "Le": "<=", "Gt": ">", "Ge": ">=", "Eq": "==", "Ne": "!=",
}  # fmt: skip
Print = Callable[[Any, Any], str]


def _is(node: Any, primitive: type) -> bool:
    return isinstance(getattr(node.dtype, "primitive_type", None), primitive)


def _widened(printer: Any, node: Any) -> str:
    """An operand as a double."""
    code: str = printer._print(node)
    if not _is(node, PrimitiveIntegerType):
        return code
    compound = isinstance(node, PyccelOperator) and not isinstance(node, PyccelAssociativeParenthesis)
    return f"(double)({code})" if compound else f"(double){code}"


def _binary(name: str, symbol: str) -> Print:
    original: Print = getattr(CCodePrinter, f"_print_Pyccel{name}")

    def printed(printer: Any, node: Any) -> str:
        mixed = any(_is(item, PrimitiveFloatingPointType) for item in node.args)
        if mixed and any(_is(item, PrimitiveIntegerType) for item in node.args):
            return f" {symbol} ".join(_widened(printer, item) for item in node.args)
        if any(isinstance(item, PyccelComparisonOperator) for item in node.args):
            return f" {symbol} ".join(
                f"({printer._print(item)})" if isinstance(item, PyccelComparisonOperator)
                else printer._print(item)
                for item in node.args
            )  # fmt: skip
        return original(printer, node)

    return printed


def _whole(name: str) -> Print:
    """What makes an integer of a double: through a function that is defined for all doubles."""
    original: Print = getattr(CCodePrinter, f"_print_{name}")

    def printed(printer: Any, node: Any) -> str:
        code = original(printer, node)
        if not code.startswith("(int64_t)"):
            return code
        inner = code.removeprefix("(int64_t)")
        return f"pyc_whole({inner})" if not inner.startswith("(") else f"pyc_whole{inner}"

    return printed


def _floor_division(printer: Any, node: Any) -> str:
    kind = "floor" if any(_is(item, PrimitiveFloatingPointType) for item in node.args) else "integer"
    operands = node.args
    if kind == "floor":
        return f"pyc_floor_division({', '.join(_widened(printer, item) for item in operands)})"
    return f"pyc_integer_division({', '.join(printer._print(item) for item in operands)})"


def _comment(_printer: Any, node: Any) -> str:
    """A docstring as a comment that cannot end early."""
    lines = [line.rstrip().replace("*/", "* /").replace("/*", "/ *") for line in node.comments]
    while lines and not lines[-1]:
        lines.pop()
    if len(lines) == 1:
        return f"/* {lines[0]} */\n"
    return "/* " + "\n* ".join(lines) + "\n*/\n"


def _line_comment(_printer: Any, node: Any) -> str:
    text = str(node.text).strip().replace("*/", "* /").replace("/*", "/ *")
    return f"/* {text} */\n"


def patch() -> None:
    """Let Pyccel's C printer print conversions, comparisons of comparisons, and comments our way."""
    for name, symbol in SYMBOLS.items():
        setattr(CCodePrinter, f"_print_Pyccel{name}", _binary(name, symbol))
    for name in ("MathFunctionBase", "PythonInt"):
        setattr(CCodePrinter, f"_print_{name}", _whole(name))
    CCodePrinter._print_PyccelFloorDiv = _floor_division
    CCodePrinter._print_CommentBlock = _comment
    CCodePrinter._print_Comment = _line_comment
    CCodePrinter._print_SeparatorComment = lambda _printer, _node: ""


if __name__ == "__main__":
    patch()
    execute_pyccel(sys.argv[1], language="c", convert_only=True)
