"""Functions of the Python that translates to C: their statements, as C99 text."""

import ast
from collections.abc import Iterator, Mapping
from dataclasses import replace

from .c_code import (
    NAMES,
    TYPES,
    Results,
    Scope,
    Signature,
    Untranslatable,
    c_name,
    comment,
    of_self,
    result_type,
    widened,
)
from .c_expressions import Expressions


class FunctionWriter:
    """Writes one function in C.

    `comments` has the comments of the source by their line.
    """

    def __init__(
        self,
        function: ast.FunctionDef,
        own: Signature,
        scope: Scope,
        component: str,
        comments: Mapping[int, str],
    ):
        self.function, self.own, self.component = function, own, component
        arguments = [each.arg for each in function.args.args][int(own.method) :]
        self.arguments = dict(zip(arguments, own.arguments, strict=True))
        self.scope = replace(scope, locals=dict(self.arguments))
        self.expressions = Expressions(self.scope)
        self.comments = dict(comments)
        self.read = _names_read(function)
        self.blocks = 0

    @property
    def prototype(self) -> str:
        """The function's head."""
        given = [f"struct {self.component} *self"] * self.own.method
        given += [f"{kind} {c_name(name)}" for name, kind in self.arguments.items()]
        kind = result_type(self.own.results, self.component)
        return f"static {kind} {self.own.name}({', '.join(given) or 'void'})"

    def definition(self) -> str:
        """The function, with its docstring and comments. Raises Untranslatable."""
        body = self.function.body
        text = ast.get_docstring(self.function, clean=True)
        lines = list(self._block(body[1:] if text is not None else body, "    "))
        unused = [name for name in self.arguments if name not in self.read]
        unused = ["self"] * (self.own.method and "self" not in self.read) + unused
        declared = {name: kind for name, kind in self.scope.locals.items() if name not in self.arguments}
        head = [f"    {kind} {c_name(name)};" for name, kind in declared.items()]
        head += [f"    (void){c_name(name)};" for name in unused]
        about = comment(text, "") if text else []
        return "\n".join([*about, self.prototype, "{", *head, *lines, "}", ""])

    # ---- statements

    def _block(self, statements: list[ast.stmt], indent: str) -> Iterator[str]:
        for statement in statements:
            for line in sorted(line for line in self.comments if line < statement.lineno):
                yield from comment(self.comments.pop(line), indent)
            method = getattr(self, f"_{type(statement).__name__.lower()}", None)
            if method is None:
                raise Untranslatable(statement, f"{type(statement).__name__} is not in the subset")
            for part in ast.iter_child_nodes(statement):
                if isinstance(part, ast.expr):
                    self._check_order(part)
            yield from method(statement, indent)

    def _check_order(self, expression: ast.expr) -> None:
        """Refuse an expression whose parts C may evaluate in an order in which its value differs."""
        attributes = [node for node in ast.walk(expression) if isinstance(node, ast.Attribute)]
        used = [of_self(node) for node in attributes if isinstance(node.ctx, ast.Load)]
        for method in used:
            changed = self.scope.changes.get(method, frozenset())
            others = [
                name for name in used if name in changed or (name != method and self.scope.changes.get(name))
            ]
            if changed and (others or used.count(method) > 1):
                raise Untranslatable(
                    expression, f"{method}() changes what the rest of this line uses: write two statements"
                )

    def _pass(self, _node: ast.Pass, _indent: str) -> Iterator[str]:
        yield from ()

    def _break(self, _node: ast.Break, indent: str) -> Iterator[str]:
        yield f"{indent}break;"

    def _continue(self, _node: ast.Continue, indent: str) -> Iterator[str]:
        yield f"{indent}continue;"

    def _expr(self, node: ast.Expr, indent: str) -> Iterator[str]:
        if isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            return
        if not isinstance(node.value, ast.Call) or not self.expressions.is_ours(node.value):
            raise Untranslatable(node, "a value that is not used")
        text, results = self.expressions.call(node.value)
        yield f"{indent}{'(void)' if results else ''}{text};"

    def _return(self, node: ast.Return, indent: str) -> Iterator[str]:
        results = self.own.results
        if node.value is None:
            if results:
                raise Untranslatable(node, "a return without the value that is declared")
            yield f"{indent}return;"
        elif len(results) == 1:
            yield f"{indent}return {self.expressions.as_type(node.value, results[0]).text};"
        elif isinstance(node.value, ast.Tuple):
            if len(node.value.elts) != len(results):
                raise Untranslatable(node, f"{len(node.value.elts)} values where {len(results)} are declared")
            values = (
                self.expressions.as_type(value, kind).text
                for value, kind in zip(node.value.elts, results, strict=True)
            )
            yield f"{indent}return ({result_type(results, self.component)}){{{', '.join(values)}}};"
        else:
            yield f"{indent}return {self._several(node.value, results)};"

    def _several(self, node: ast.expr, wanted: Results) -> str:
        """A call that returns several values, of these types."""
        if not isinstance(node, ast.Call) or not self.expressions.is_ours(node):
            raise Untranslatable(node, f"{ast.unparse(node)} is not {len(wanted)} values")
        text, results = self.expressions.call(node)
        if results != wanted:
            raise Untranslatable(node, f"{ast.unparse(node.func)} returns other types than are needed here")
        return text

    def _annassign(self, node: ast.AnnAssign, indent: str) -> Iterator[str]:
        kind = TYPES.get(ast.unparse(node.annotation))
        if kind is None or not isinstance(node.target, ast.Name) or node.value is None:
            raise Untranslatable(node, "an annotation is float, int or bool, of a name that gets a value")
        self.scope.locals.setdefault(node.target.id, kind)
        yield from self._assigned(node.target, node.value, indent)

    def _augassign(self, node: ast.AugAssign, indent: str) -> Iterator[str]:
        before = ast.copy_location(ast.parse(ast.unparse(node.target), mode="eval").body, node)
        value = ast.copy_location(ast.BinOp(before, node.op, node.value), node)
        yield from self._assigned(node.target, value, indent)

    def _assign(self, node: ast.Assign, indent: str) -> Iterator[str]:
        if len(node.targets) > 1:
            raise Untranslatable(node, "an assignment to several names")
        (target,) = node.targets
        if of_self(target) in self.scope.arrays:
            yield from self._unpacked(self.expressions.elements(target), node.value, indent)
        elif isinstance(target, ast.Tuple):
            yield from self._unpacked(target.elts, node.value, indent)
        else:
            yield from self._assigned(target, node.value, indent)

    def _assigned(self, target: ast.expr, value: ast.expr, indent: str) -> Iterator[str]:
        code = self.expressions.of(value)
        place = self._place(target, code.type)
        text = widened(code, place[1], value).text if place[1] else code.text
        yield f"{indent}{place[0]} = {text};" if place[0] else f"{indent}(void)({text});"

    def _place(self, target: ast.expr, kind: str) -> tuple[str, str]:
        """Where a value goes, and the type it has there; nothing for a local that nothing reads."""
        if isinstance(target, ast.Attribute):
            code = self.expressions.of(target)
            return code.text, code.type
        if not isinstance(target, ast.Name):
            raise Untranslatable(target, f"{ast.unparse(target)} cannot be assigned to")
        if target.id not in self.read:
            return "", ""
        known = self.scope.locals.setdefault(target.id, kind)
        if NAMES[kind] != NAMES[known] and (NAMES[known], NAMES[kind]) != ("float", "int"):
            raise Untranslatable(target, f"{target.id} is {NAMES[known]} and becomes {NAMES[kind]}")
        return c_name(target.id), known

    def _unpacked(self, targets: list[ast.expr], value: ast.expr, indent: str) -> Iterator[str]:
        """Several values, all of them computed before the first is put in its place."""
        inner = f"{indent}    "
        if isinstance(value, ast.Tuple):
            codes = [self.expressions.of(each) for each in value.elts]
            kinds = tuple(code.type for code in codes)
            lines = [
                f"{inner}const {kind} value_{place} = {code.text};"
                for place, (kind, code) in enumerate(zip(kinds, codes, strict=True))
            ]
            prefix = ""
        else:
            if not isinstance(value, ast.Call) or not self.expressions.is_ours(value):
                raise Untranslatable(value, f"{ast.unparse(value)} is not several values")
            text, kinds = self.expressions.call(value)
            self.blocks += 1
            prefix = f"found_{self.blocks}."
            lines = [f"{inner}const {result_type(kinds, self.component)} {prefix[:-1]} = {text};"]
        if len(kinds) != len(targets):
            raise Untranslatable(value, f"{len(kinds)} values for {len(targets)} names")
        yield f"{indent}{{"
        yield from lines
        for number, (place, kind) in enumerate(zip(targets, kinds, strict=True)):
            name, wanted = self._place(place, kind)
            given = f"{prefix}value_{number}"
            if name:
                yield f"{inner}{name} = {'' if wanted == kind else f'({wanted})'}{given};"
            elif not prefix:
                yield f"{inner}(void){given};"
        yield f"{indent}}}"

    def _if(self, node: ast.If, indent: str, word: str = "if") -> Iterator[str]:
        yield f"{indent}{word} ({self.expressions.condition(node.test).text}) {{"
        yield from self._block(node.body, f"{indent}    ")
        if len(node.orelse) == 1 and isinstance(node.orelse[0], ast.If):
            yield from self._if(node.orelse[0], indent, "} else if")
            return
        if node.orelse:
            yield f"{indent}}} else {{"
            yield from self._block(node.orelse, f"{indent}    ")
        yield f"{indent}}}"

    def _while(self, node: ast.While, indent: str) -> Iterator[str]:
        if node.orelse:
            raise Untranslatable(node, "an else of a loop")
        yield f"{indent}while ({self.expressions.condition(node.test).text}) {{"
        yield from self._block(node.body, f"{indent}    ")
        yield f"{indent}}}"

    def _for(self, node: ast.For, indent: str) -> Iterator[str]:
        """A loop over range(): computed once are its bounds, and its variable keeps its last value."""
        called = node.iter
        if not isinstance(called, ast.Call) or ast.unparse(called.func) != "range" or called.keywords:
            raise Untranslatable(node, "a for that does not run over range()")
        if node.orelse or not isinstance(node.target, ast.Name):
            raise Untranslatable(node, "an else of a loop" if node.orelse else "a for over several names")
        bounds = [self.expressions.as_type(each, "int64_t").text for each in called.args[:2]]
        first, end = ("0", bounds[0]) if len(bounds) == 1 else bounds
        step = _step(called)
        name = c_name(node.target.id)
        self.scope.locals.setdefault(node.target.id, "int64_t")
        used = node.target.id in self.read
        if not used:
            del self.scope.locals[node.target.id]
        self.blocks += 1
        at, stop = f"at_{self.blocks}", f"end_{self.blocks}"
        yield (
            f"{indent}for (int64_t {at} = {first}, {stop} = {end}; {at} {'<' if step > 0 else '>'} {stop};"
            f" {at} += {step}) {{"
        )
        if used:
            yield f"{indent}    {name} = {at};"
        yield from self._block(node.body, f"{indent}    ")
        yield f"{indent}}}"


def _step(called: ast.Call) -> int:
    """The step of a range(), which has to be known: its sign tells where the loop ends."""
    step = ast.literal_eval(called.args[2]) if len(called.args) == 3 else 1
    if not isinstance(step, int) or step == 0:
        raise Untranslatable(called, "the step of a range() is a whole number other than 0")
    return step


def _names_read(function: ast.FunctionDef) -> set[str]:
    """The names whose value a function uses."""
    nodes = list(ast.walk(function))
    loaded = {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)}
    return loaded | {ast.unparse(node.target) for node in nodes if isinstance(node, ast.AugAssign)}
