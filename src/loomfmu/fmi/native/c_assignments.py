"""Assignments of the Python that translates to C: what gets a name, an element, a place in the component."""

import ast
from collections.abc import Iterator

from ..source import of_self
from .c_code import (
    ARRAYS,
    REAL,
    TYPES,
    WHOLE,
    Array,
    Code,
    Kind,
    Untranslatable,
    c_name,
    fits,
    literal,
    shown,
)
from .c_expressions import Expressions
from .c_scope import Scope


class Assignments:
    """Translates the assignments of one function; `read` are the names whose value it uses."""

    def __init__(self, scope: Scope, read: set[str]):
        self.scope, self.read = scope, read
        self.expressions = Expressions(scope)
        self.blocks = 0

    def _made(self, node: ast.expr, indent: str, lines: list[str]) -> Code:
        """A value that gets a name: no array that has another name. `lines` get what has to come before."""
        if isinstance(node, ast.ListComp):
            return self._comprehension(node, indent, lines)
        return self.expressions.made(node)

    def _comprehension(self, node: ast.ListComp, indent: str, lines: list[str]) -> Code:
        """`[f(n) for n in range(6)]`: an array, element by element."""
        loop = node.generators[0]
        if len(node.generators) > 1 or loop.ifs or not isinstance(loop.target, ast.Name):
            raise Untranslatable(node, "a list is made by one loop over range(), without a condition")
        numbers = self._numbers(loop.iter)
        if not numbers:
            raise Untranslatable(node, "the size of an array must be known: a range() of numbers or of len()")
        name, scope = loop.target.id, self.scope
        before = dict(scope.locals), dict(scope.renamed), dict(scope.spans)
        self.blocks += 1
        at, made = f"at_{self.blocks}", f"made_{self.blocks}"
        scope.locals[name], scope.renamed[name] = WHOLE, at
        scope.spans[name] = min(numbers), max(numbers)
        code = self.expressions.of(node.elt)
        scope.locals, scope.renamed, scope.spans = before
        array = scope.array(str(code.type), len(numbers))
        lines += [
            f"{indent}{array} {made};",
            f"{indent}for (int64_t {at} = {numbers.start}; {running(at, numbers.step, numbers.stop)}) {{",
            f"{indent}    {made}.at[{_index(at, numbers)}] = {code.text};",
            f"{indent}}}",
        ]
        return Code(made, array)

    def _annassign(self, node: ast.AnnAssign, indent: str) -> Iterator[str]:
        annotated = ast.unparse(node.annotation)
        known = annotated in TYPES or annotated in ARRAYS or annotated in self.scope.records
        if not known or not isinstance(node.target, ast.Name) or node.value is None:
            raise Untranslatable(
                node,
                "only a name with a value is annotated, with float, int, bool, a list of them or a record",
            )
        if annotated in TYPES:
            self.scope.locals.setdefault(node.target.id, TYPES[annotated])
        yield from self._assigned(node.target, node.value, indent, annotated)

    def _augassign(self, node: ast.AugAssign, indent: str) -> Iterator[str]:
        if any(map(self.expressions.is_ours, ast.walk(node.target))):
            raise Untranslatable(node, f"{ast.unparse(node.target)} would be computed twice")
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

    def _assigned(self, target: ast.expr, value: ast.expr, indent: str, annotated: str = "") -> Iterator[str]:
        inner: list[str] = []
        code = self._made(value, f"{indent}    ", inner)
        if annotated and annotated not in TYPES and not fits(code.type, annotated):
            raise Untranslatable(value, f"{ast.unparse(value)} is {shown(code.type)}, not {annotated}")
        put, kind = self._place(target, code.type)
        text = put % self.scope.numbers.widened(code, kind, value).text
        if not inner:
            yield f"{indent}{text};"
            return
        yield f"{indent}{{"
        yield from inner
        yield f"{indent}    {text};"
        yield f"{indent}}}"

    def _place(self, target: ast.expr, kind: Kind) -> tuple[str, Kind]:
        """Return the text that puts a value in its place, and its type there: none if nothing reads it."""
        if isinstance(target, ast.Attribute) and of_self(target):
            code = self.expressions.of(target)
            return f"{code.text} = %s", code.type
        if isinstance(target, ast.Subscript) and isinstance(target.value, ast.Name):
            return self._element(target)
        if not isinstance(target, ast.Name):
            raise Untranslatable(target, f"{ast.unparse(target)} cannot be assigned to")
        if target.id not in self.read:
            return "(void)(%s)", kind
        if target.id in self.scope.lent:
            raise Untranslatable(
                target, f"{target.id} is an argument: write its elements, or give the new value another name"
            )
        known = self.scope.locals.setdefault(target.id, kind)
        if kind != known and (known, kind) != (REAL, WHOLE):
            raise Untranslatable(target, f"{target.id} is {shown(known)} and becomes {shown(kind)}")
        return f"{c_name(target.id)} = %s", known

    def _element(self, target: ast.Subscript) -> tuple[str, str]:
        """Return the text that writes an element of an array that is a local or an argument."""
        if isinstance(target.value, ast.Name) and target.value.id not in self.scope.locals:
            raise Untranslatable(target, f"{ast.unparse(target)} cannot be assigned to")
        place, kind, size = self.expressions.place(target.value)
        index, within = self.expressions.index(target, size)
        if within:
            return f"{place}[{index}] = %s", kind
        return f"python_put_{self.scope.numbers.named(kind)}({place}, {size}, {index}, %s)", kind

    def _unpacked(self, targets: list[ast.expr], value: ast.expr, indent: str) -> Iterator[str]:
        """Several values, all of them computed before the first is put in its place."""
        inner = f"{indent}    "
        lines: list[str] = []
        if isinstance(value, ast.Tuple):
            codes = [self._made(each, inner, lines) for each in value.elts]
            found = [(f"value_{place}", code.type) for place, code in enumerate(codes)]
            kinds = [self.scope.numbers.text(code.type) for code in codes]
            lines += [
                f"{inner}const {kind} value_{place} = {code.text};"
                for place, (kind, code) in enumerate(zip(kinds, codes, strict=True))
            ]
        else:
            found = self._found(value, inner, lines)
        if len(found) != len(targets):
            raise Untranslatable(value, f"{len(found)} values for {len(targets)} names")
        yield f"{indent}{{"
        yield from lines
        for target, (given, kind) in zip(targets, found, strict=True):
            put, wanted = self._place(target, kind)
            if isinstance(value, ast.Tuple) or not put.startswith("(void)"):
                text = self.scope.numbers.widened(Code(given, kind), wanted, value).text
                yield f"{inner}{put % text};"
        yield f"{indent}}}"

    def _found(self, value: ast.expr, inner: str, lines: list[str]) -> list[tuple[str, Kind]]:
        """The values of a call that returns several, or of an array, with types; `lines` compute them."""
        self.blocks += 1
        name = f"found_{self.blocks}"
        if isinstance(value, ast.Call) and self.expressions.is_ours(value):
            text, kinds = self.expressions.call(value)
            lines.append(f"{inner}const {self.scope.returned(kinds)} {name} = {text};")
            if len(kinds) > 1:
                return [(f"{name}.value_{place}", kind) for place, kind in enumerate(kinds)]
            (kind,) = kinds or ("",)
        else:
            named = isinstance(value, ast.Name | ast.Attribute)  # its elements get names, not the array
            code = self.expressions.any_of(value) if named else self._made(value, inner, lines)
            kind = code.type
            lines.append(f"{inner}const {kind} {name} = {code.text};")
        if not isinstance(kind, Array):
            raise Untranslatable(value, f"{ast.unparse(value)} is not several values")
        return [(f"{name}.at[{place}]", kind.element) for place in range(kind.size)]

    def _range(self, called: ast.expr) -> tuple[Code, Code, int]:
        """First number, end and step of a range()."""
        if not isinstance(called, ast.Call) or ast.unparse(called.func) != "range" or called.keywords:
            raise Untranslatable(called, "a for that does not run over range()")
        bounds = [self.expressions.as_type(each, WHOLE) for each in called.args[:2]]
        first, end = (literal(0), bounds[0]) if len(bounds) == 1 else bounds
        return first, end, _step(called)

    def _numbers(self, called: ast.expr) -> range:
        """The numbers of a range() that are known, else none."""
        first, end, step = self._range(called)
        known = first.number is not None and end.number is not None
        return range(int(first.number or 0), int(end.number or 0), step) if known else range(0)


def running(at: str, step: int, end: str | int) -> str:
    """Condition and step of a loop of C."""
    return f"{at} {'<' if step > 0 else '>'} {end}; {at} += {step}"


def _step(called: ast.Call) -> int:
    """The step of a range(), which has to be known: its sign tells where the loop ends."""
    step = ast.literal_eval(called.args[2]) if len(called.args) == 3 else 1
    if not isinstance(step, int) or step == 0:
        raise Untranslatable(called, "the step of a range() is a whole number other than 0")
    return step


def _index(at: str, numbers: range) -> str:
    """The place of a number of a range."""
    text = at if numbers.start == 0 else f"({at} - {numbers.start})"
    return text if numbers.step == 1 else f"{text} / {numbers.step}"
