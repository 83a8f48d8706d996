"""Functions of the Python that translates to C: their statements, as C99 text."""

import ast
from collections.abc import Iterator, Mapping
from dataclasses import replace

from ..source import of_self
from .c_assignments import Assignments, running
from .c_code import (
    NAMES,
    WHOLE,
    Array,
    Code,
    Declared,
    Kind,
    Signature,
    Untranslatable,
    c_name,
    comment,
    fits,
    shown,
    sizes,
)
from .c_scope import Scope
from .c_ways import check_ways


class FunctionWriter(Assignments):
    """Writes one function in C, for arguments of these types.

    `comments` has the comments of the source by their line.
    """

    def __init__(self, own: Declared, kinds: tuple[Kind, ...], scope: Scope, comments: Mapping[int, str]):
        self.function, self.own = own.function, own
        check_ways(self.function, returns=bool(own.results))
        arguments = [each.arg for each in self.function.args.args][int(own.method) :]
        self.arguments = dict(zip(arguments, kinds, strict=True))
        lent = frozenset(name for name, kind in self.arguments.items() if not isinstance(kind, str))
        own_scope = replace(scope, locals=dict(self.arguments), lent=lent, renamed={}, spans={})
        super().__init__(own_scope, _names_read(self.function))
        self.comments = dict(comments)
        # those of arrays and records are known from the first return on
        self.results: list[Kind | None] = [each if each in NAMES else None for each in own.results]
        self.name = own.name + sizes(kinds)
        self.text = self._definition()

    @property
    def signature(self) -> Signature:
        """Return its signature in C. Raises Untranslatable if it never returns what it declares."""
        results = tuple(kind for kind in self.results if kind is not None)
        if len(results) < len(self.results):
            raise Untranslatable(self.function, "a function without the return that is declared")
        return Signature(self.name, tuple(self.arguments.values()), results)

    @property
    def prototype(self) -> str:
        """The function's head."""
        given = [f"struct {self.scope.component} *self"] * self.own.method
        for place, (name, kind) in enumerate(self.arguments.items()):
            pointer = "" if isinstance(kind, str) else "*"
            constant = "const " if pointer and place not in self.own.written else ""
            given.append(f"{constant}{self.scope.numbers.text(kind)} {pointer}{c_name(name)}")
        kind = self.scope.returned(self.signature.results)
        return f"static {kind} {self.name}({', '.join(given) or 'void'})"

    def _definition(self) -> str:
        """The function, with its docstring and comments. Raises Untranslatable."""
        body = self.function.body
        text = ast.get_docstring(self.function, clean=True)
        lines = list(self._block(body[1:] if text is not None else body, "    "))
        unused = [name for name in self.arguments if name not in self.read]
        unused = ["self"] * (self.own.method and "self" not in self.read) + unused
        declared = {name: kind for name, kind in self.scope.locals.items() if name not in self.arguments}
        head = [f"    {self.scope.numbers.text(kind)} {c_name(name)};" for name, kind in declared.items()]
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
            self._check_order(
                [part for part in ast.iter_child_nodes(statement) if isinstance(part, ast.expr)]
            )
            yield from method(statement, indent)

    def _check_order(self, parts: list[ast.expr]) -> None:
        """Refuse a statement whose parts C may evaluate in an order in which its value differs."""
        nodes = [node for part in parts for node in ast.walk(part)]
        names = [node.id for node in nodes if isinstance(node, ast.Name)]
        for node in nodes:
            if isinstance(node, ast.Call) and self.expressions.is_ours(node):
                for written in self._written(node):
                    if names.count(written) > 1:
                        raise Untranslatable(
                            node,
                            f"{ast.unparse(node.func)}() changes {written}, which the rest of this line uses:"
                            " write two statements",
                        )
        attributes = [node for node in nodes if isinstance(node, ast.Attribute)]
        used = [of_self(node) for node in attributes if isinstance(node.ctx, ast.Load)]
        for method in used:
            changed = self.scope.changes.get(method, frozenset())
            others = [
                name for name in used if name in changed or (name != method and self.scope.changes.get(name))
            ]
            if changed and (others or used.count(method) > 1):
                raise Untranslatable(
                    parts[0], f"{method}() changes what the rest of this line uses: write two statements"
                )

    def _written(self, node: ast.Call) -> list[str]:
        """The arrays that a call writes to."""
        places = self.expressions.declared(node).written
        return [
            arg.id for place, arg in enumerate(node.args) if place in places and isinstance(arg, ast.Name)
        ]

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
        if node.value is None:
            if self.results:
                raise Untranslatable(node, "a return without the value that is declared")
            yield f"{indent}return;"
        elif len(self.results) < 2:
            yield from self._given([node.value], indent)
        elif isinstance(node.value, ast.Tuple):
            yield from self._given(node.value.elts, indent)
        else:
            yield f"{indent}return {self._several(node.value)};"

    def _given(self, nodes: list[ast.expr], indent: str) -> Iterator[str]:
        """A return of these values."""
        if len(nodes) != len(self.results):
            raise Untranslatable(nodes[0], f"{len(nodes)} values where {len(self.results)} are declared")
        lines: list[str] = []
        values = []
        for place, node in enumerate(nodes):
            mine = isinstance(node, ast.Name) and node.id not in self.arguments
            code = self.expressions.any_of(node) if mine else self._made(node, indent, lines)
            values.append(self._result(place, code, node))
            if isinstance(code.type, Array) and ast.dump(node) in map(ast.dump, nodes[:place]):
                raise Untranslatable(node, f"{ast.unparse(node)} is returned twice: copy it")
        yield from lines
        several = f"({self.scope.returned(self.signature.results)}){{{', '.join(values)}}}"
        yield f"{indent}return {values[0] if len(values) == 1 else several};"

    def _result(self, place: int, code: Code, node: ast.expr) -> str:
        """One of the values that are returned, of the type that is declared."""
        wanted, annotated = self.results[place], self.own.results[place]
        if wanted is None:
            if not fits(code.type, annotated):
                raise Untranslatable(node, f"{ast.unparse(node)} is {shown(code.type)}, not {annotated}")
            wanted = self.results[place] = code.type
        return self.scope.numbers.widened(code, wanted, node).text

    def _several(self, node: ast.expr) -> str:
        """A call that returns several values, of the types that are declared."""
        wanted = len(self.results)
        if not isinstance(node, ast.Call) or not self.expressions.is_ours(node):
            raise Untranslatable(node, f"{ast.unparse(node)} is not {wanted} values")
        text, results = self.expressions.call(node)
        if len(results) != wanted:
            raise Untranslatable(node, f"{ast.unparse(node.func)} returns other types than are needed here")
        for place, kind in enumerate(results):
            if self.results[place] is None and fits(kind, self.own.results[place]):
                self.results[place] = kind
            if self.results[place] != kind:
                raise Untranslatable(
                    node, f"{ast.unparse(node.func)} returns other types than are needed here"
                )
        return text

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
        first, end, step = self._range(node.iter)
        if node.orelse or not isinstance(node.target, ast.Name):
            raise Untranslatable(node, "an else of a loop" if node.orelse else "a for over several names")
        name = node.target.id
        used = name in self.read
        if used:
            self._place(node.target, WHOLE)
        numbers = self._numbers(node.iter)
        if numbers and not _set_in(node.body, name):
            self.scope.spans[name] = min(numbers), max(numbers)
        self.blocks += 1
        at, stop = f"at_{self.blocks}", f"end_{self.blocks}"
        bounds = f"int64_t {at} = {first.text}, {stop} = {end.text}"
        yield f"{indent}for ({bounds}; {running(at, step, stop)}) {{"
        if used:
            yield f"{indent}    {c_name(name)} = {at};"
        yield from self._block(node.body, f"{indent}    ")
        yield f"{indent}}}"
        self.scope.spans.pop(name, None)


def _set_in(body: list[ast.stmt], name: str) -> bool:
    """Return whether statements set a name."""
    nodes = (node for statement in body for node in ast.walk(statement))
    return any(
        isinstance(node, ast.Name) and node.id == name and isinstance(node.ctx, ast.Store) for node in nodes
    )


def _names_read(function: ast.FunctionDef) -> set[str]:
    """The names whose value a function uses."""
    nodes = list(ast.walk(function))
    loaded = {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)}
    return loaded | {ast.unparse(node.target) for node in nodes if isinstance(node, ast.AugAssign)}
