"""The Python that translates to C, checked before the translator sees it.

The translator takes more than it translates faithfully (containers, text) and some things it translates
wrongly without a word. What is outside the subset is refused here, with its place.
"""

import ast
from collections.abc import Iterator

STATEMENTS = (
    ast.Return, ast.Assign, ast.AnnAssign, ast.AugAssign, ast.If, ast.While, ast.For, ast.Break,
    ast.Continue, ast.Pass, ast.Expr,
)  # fmt: skip
EXPRESSIONS = (
    ast.BoolOp, ast.BinOp, ast.UnaryOp, ast.IfExp, ast.Compare, ast.Call, ast.Name, ast.Attribute,
    ast.Constant, ast.Tuple,
)  # fmt: skip
OPERATORS = (ast.boolop, ast.operator, ast.unaryop, ast.cmpop, ast.expr_context)
NO_OPERATORS = (ast.MatMult, ast.In, ast.NotIn, ast.Is, ast.IsNot)
BUILTINS = ("float", "int", "range")

Complaint = tuple[ast.AST, str]
Method = dict[str, ast.FunctionDef]


def complaints(tree: ast.Module) -> Iterator[Complaint]:
    """What in a flattened module does not translate: the node and the reason."""
    functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    methods: Method = {}
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            methods = {item.name: item for item in node.body if isinstance(item, ast.FunctionDef)}
    from_math = names_of_math(tree)
    for function in (*functions.values(), *methods.values()):
        yield from _signature(function)
        for statement in function.body:
            yield from _statement(statement, from_math, {*functions, *from_math, *BUILTINS}, methods)


def names_of_math(tree: ast.Module) -> set[str]:
    """What the module imports from math."""
    return {
        name.name for node in tree.body if isinstance(node, ast.ImportFrom) for name in node.names
    }  # fmt: skip


def _signature(function: ast.FunctionDef) -> Iterator[Complaint]:
    given = function.args
    if function.decorator_list:
        yield function, "a decorator"
    if given.vararg or given.kwarg or given.kwonlyargs or given.posonlyargs or given.defaults:
        yield function, "an argument that is not a plain one"


def _statement(
    statement: ast.stmt, from_math: set[str], known: set[str], methods: Method
) -> Iterator[Complaint]:
    """Complaints of a statement and of all that is in it."""
    annotations = {id(node.annotation) for node in ast.walk(statement) if isinstance(node, ast.AnnAssign)}
    texts = {id(node.value) for node in ast.walk(statement) if isinstance(node, ast.Expr)}
    for node in ast.walk(statement):
        if id(node) in annotations:
            continue
        if isinstance(node, NO_OPERATORS) or not isinstance(node, (*STATEMENTS, *EXPRESSIONS, *OPERATORS)):
            yield _placed(node, statement), f"{type(node).__name__} is not in the subset"
        elif isinstance(node, ast.Constant):
            is_text = isinstance(node.value, str) and id(node) in texts
            if not is_text and not isinstance(node.value, bool | int | float):
                yield node, f"{node.value!r} is no number"
        elif isinstance(node, ast.Attribute) and not _of_self(node):
            yield node, f"{ast.unparse(node)} is no variable of the component"
        elif isinstance(node, ast.Call):
            yield from _call(node, known, methods)
        elif isinstance(node, ast.While | ast.For):
            yield from _loop(node, from_math)
        elif isinstance(node, ast.Assign):
            yield from _aliased(node, methods)


def _placed(node: ast.AST, statement: ast.stmt) -> ast.AST:
    return node if hasattr(node, "lineno") else statement


def _of_self(node: ast.AST) -> bool:
    return isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "self"


def _call(node: ast.Call, known: set[str], methods: Method) -> Iterator[Complaint]:
    called = node.func
    if isinstance(called, ast.Name) and called.id not in known:
        yield node, f"{called.id} is neither of math nor a function of the physics"
    elif isinstance(called, ast.Attribute) and _of_self(called) and called.attr not in methods:
        yield node, f"{called.attr} is no method of the component"
    if node.keywords:
        yield node, "an argument given by its name"


def _loop(node: ast.While | ast.For, from_math: set[str]) -> Iterator[Complaint]:
    """The translator calls a function in a while's condition once, before the loop, unless it is math's."""
    if node.orelse:
        yield node, "an else of a loop"
    if isinstance(node, ast.For):
        counted = isinstance(node.iter, ast.Call) and ast.unparse(node.iter.func) == "range"
        if not counted:
            yield node, "a for that does not run over range()"
        return
    for call in (inner for inner in ast.walk(node.test) if isinstance(inner, ast.Call)):
        if ast.unparse(call.func) not in from_math:
            yield call, f"{ast.unparse(call.func)} is called in the condition of a while"


def _aliased(node: ast.Assign, methods: Method) -> Iterator[Complaint]:
    """Several results of a method are written one by one in C: it may not read a variable among them."""
    (target, *more) = node.targets
    if more:
        yield node, "an assignment to several names"
    if not (isinstance(target, ast.Tuple) and isinstance(node.value, ast.Call) and _of_self(node.value.func)):
        return
    written = {item.attr for item in target.elts if isinstance(item, ast.Attribute)}
    assert isinstance(node.value.func, ast.Attribute)
    for name in sorted(written & _touched(node.value.func.attr, methods, set())):
        yield node, f"{node.value.func.attr}() uses self.{name}, one of its own results"


def _touched(method: str, methods: Method, seen: set[str]) -> set[str]:
    """The variables of the component that a method reads or writes, those it calls included."""
    if method in seen or method not in methods:
        return set()
    seen.add(method)
    found = {node.attr for node in ast.walk(methods[method]) if isinstance(node, ast.Attribute)}
    return found.union(*(_touched(name, methods, seen) for name in found & set(methods)))
