"""Confirms a certificate of `prove`, without the prover: the components' own Python, run on intervals."""

import ast
import json
import math
import re
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import cache, partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ... import units
from ...components import COMPONENTS
from ...components.shaft_driven import FOLLOWING, ShaftDriven
from ...cosim.claims.claims import name_of
from ...cosim.claims.conditions import (
    FALLS,
    IN,
    OUT,
    RISES,
    UNKNOWN,
    Condition,
    Sometime,
    Spans,
    Sum,
    Unprovable,
    names_of,
    remembers,
)
from ...cosim.reading import requested
from ...cosim.scenes import scene as scenes
from ...cosim.scenes.graph import step_order
from ...cosim.scenes.instances import Instance
from ...cosim.scenes.scene import Scene
from ...cosim.scenes.settings import texts_in, toml
from ...declaring.variables import MOTION, variables_of
from ...display.progress import Advance
from ...display.progress import progress as progress_bar
from ...errors import LoomfmuError, shown
from ...files import text_of
from ...fmi import source
from ...fmi.native.slicing import settings_of, sliced
from ...fmi.native.translate import ENTRIES
from ...sweeps.varied import Varied, varied
from . import FORMAT, MOST_REVOLUTIONS
from .intervals import ALL, MATH, Ends, Interval, Unknown, floor, joined, number
from .sides import SHAFT, START, check_side, needed_for

FINE = 0.02  # [rad]: so narrow must a box be that a mechanism is in one of its phases
FINER = 8  # bisections of a box that this arithmetic, which is wider, may need on top
Box = tuple[Ends, ...]
Faces = dict[int, int]  # of some sides, which end: 0 the lower, 1 the upper
Numbers = dict[str, Interval]


class Refused(LoomfmuError):
    """A certificate that proves less than it says."""


def check(path: str | Path, *, progress: bool = False) -> list[str]:
    """Return a line for each claim that a certificate proves, confirmed. Raises Refused, a LoomfmuError.

    `progress` shows how many of its boxes are confirmed, which takes some 10 ms each.
    """
    text = text_of(Path(path))
    try:
        told = json.loads(text)
        if told["format"] != FORMAT:
            raise Refused(f"format = {told['format']!r} must be {FORMAT!r}")
        _check_harmless(told)
        with tempfile.TemporaryDirectory() as folder:
            for name, text in told["texts"].items():
                (Path(folder) / name).parent.mkdir(parents=True, exist_ok=True)
                (Path(folder) / name).write_text(text, encoding="utf-8")
            trees = (tree for claim in told["claims"] for covers in claim["conditions"] for tree in covers)
            with progress_bar("boxes", sum(map(len, trees)), wanted=progress) as advance:
                return _Check(told, folder, advance).lines
    except (LoomfmuError, Unprovable) as error:
        raise Refused(f"{path}: {error}") from None
    except (ArithmeticError, LookupError, TypeError, ValueError, AttributeError, OSError, RecursionError):
        raise LoomfmuError(f"{path} is not a certificate that `loomfmu prove --certificate` wrote") from None


class _Check:
    def __init__(self, told: dict[str, Any], folder: str, advance: Advance):
        self._advance = advance
        scene = scenes.parse(told["scene"], told["name"], told["overrides"], folder)
        self._asked = requested(scene, None, "native")
        self._scene = scene = self._asked.scene
        self._ends = [(float.fromhex(low), float.fromhex(high)) for low, high in told["over"].values()]
        if not all(low < high and math.isfinite(high - low) for low, high in self._ends):
            raise Refused("the box is empty")
        self._sides: dict[tuple[str, ...], int] = {(SHAFT, START): 0}
        self._varied: list[Varied] = []
        for place, (key, ends) in enumerate(zip(told["over"], self._ends, strict=True), 1):
            about = varied(scene, key)
            check_side(scene, about, ends)
            targets = {tuple(each.split(".")): place for each in about.targets}
            if self._sides.keys() & targets:
                raise Refused(f"{key} varies twice")
            self._sides |= targets
            self._varied.append(about)
        self._equations = told["equations"]
        within = f" of {scene.extent:.15g} revolution{'s' * (scene.extent != 1)}"
        for about, (low, high) in zip(self._varied, self._ends, strict=True):
            first, last = (units.exact(end, about.display) for end in (low, high))
            within += f", {about.key} from {first} to {last}" + f" {about.shown_unit}" * (
                about.shown_unit != "1"
            )
        set_to = [f"{key} = {value}" for key, value in told["overrides"].items()]
        within += f"; the scene's own values are changed: {', '.join(set_to)}" * bool(set_to)
        names = [name_of(table) for table in scene.claims]
        self.lines: list[str] = []
        if not told["claims"] or any(names.count(claim["name"]) != 1 for claim in told["claims"]):
            raise Refused("it proves no claim that the scene has under one name")
        for claim in told["claims"]:
            conditions = self._asked.claims[names.index(claim["name"])].conditions(self._asked)
            if not conditions or len(conditions) != len(claim["conditions"]):
                raise Refused(
                    f"{claim['name']}: {len(claim['conditions'])} conditions, not {len(conditions)}"
                )
            chain = _Mechanisms(scene, names_of(conditions), self._sides, self._equations)
            for condition, covers in zip(conditions, claim["conditions"], strict=True):
                self._check(claim["name"], condition, covers, chain)
            table = scene.claims[names.index(claim["name"])]
            asked = ", ".join(f"{key} = {value}" for key, value in table.items() if key != "name")
            line = f"confirmed: {shown(claim['name'])} ({asked}) for all shaft angles{within}"
            self.lines.append(" ".join(line.split()))

    def _check(self, name: str, condition: Condition, covers: Sequence[Any], chain: "_Mechanisms") -> None:
        start = float(self._scene.instances[SHAFT].start(START) or 0.0)
        place = self._sides.get((SHAFT, "speed"))
        speed = float(self._scene.instances[SHAFT].start("speed") or 0.0)
        slow, fast = (speed, speed) if place is None else self._ends[place - 1]
        if slow <= 0.0 <= fast or self._scene.step is not None:
            raise Refused("only runs by revolutions, and at a speed that is not 0, can be confirmed")
        if self._scene.extent > MOST_REVOLUTIONS:
            raise Refused(f"more than {MOST_REVOLUTIONS} revolutions cannot be confirmed")
        turned = 2.0 * math.pi * self._scene.extent
        run = (start, start + turned) if slow > 0.0 else (start - turned, start)
        if isinstance(condition, Spans):
            (tree,) = covers
            lasting = partial(_spans_last, chain, condition, run)
            codes = self._codes(tree)
            _confirm(name, self._text, tuple(self._ends), codes, lasting, lambda _box, _faces: False)
            return
        scale = [FINE, *(high - low for low, high in self._ends)]
        holds, rises = (
            partial(_all_over, scale, partial(each, chain, condition.forms)) for each in (_holds, _rises)
        )
        ranges = condition.ranges(*run)
        if len(ranges) != len(covers):
            raise Refused(f"{name}: {len(covers)} ranges of the shaft angle, not {len(ranges)}")
        for (low, high), cover in zip(ranges, covers, strict=True):
            tree = self._codes(cover)
            if isinstance(condition, Sometime):
                angle = float.fromhex(next(tree, ""))
                if not low <= angle <= high:
                    at, first, end = (math.degrees(each) for each in (angle, low, high))
                    raise Refused(f"{name}: {at:.6g} deg is not within {first:.6g} to {end:.6g} deg")
                low = high = angle
            _confirm(name, self._text, ((low, high), *self._ends), tree, holds, rises)

    def _text(self, box: Box) -> str:
        """A box as people read it: a range of the shaft angle, if it has one, and those of the values."""
        angles, ends = box[: -len(self._varied) or None], box[len(box) - len(self._varied) :]
        shown = [f"shaft angles from {math.degrees(a):.6g} to {math.degrees(b):.6g} deg" for a, b in angles]
        values = zip(self._varied, ends, strict=True)
        return ", ".join([*shown, *(f"{v.key} from {v.show(a)} to {v.show(b)}" for v, (a, b) in values)])

    def _codes(self, tree: Sequence[Any]) -> Iterator[Any]:
        """Yield what a tree says, and count it."""
        for code in tree:
            self._advance(1)
            yield code


def _check_harmless(told: dict[str, Any]) -> None:
    """Refuse a certificate that names files which are no text of its own: reading them may run code."""
    named = [text for _place, text in (*texts_in(toml(told["scene"])), *texts_in(told["overrides"]))]
    for text in [*named, *told["texts"]]:
        if re.search(r"\.(py|fmu|ssp)\s*(:|$)", text, re.IGNORECASE):
            raise Refused(
                f"{shown(text)} is no part of a proof: only the package's own mechanisms are proven"
            )
        if re.search(r"^\s*([/\\~]|\w:[/\\])|(^|[/\\])\.\.([/\\]|$)", text):
            raise Refused(f"{shown(text)} is a file outside of the certificate")
    for name in told["texts"]:
        if not re.fullmatch(r"(?!\.)[\w .-]{1,99}(/(?!\.)[\w .-]{1,99}){0,9}", name):
            raise Refused(f"{shown(name)} is not the name of a file beside the scene")


def _confirm(
    name: str,
    text: Callable[[Box], str],
    box: Box,
    tree: Iterator[int],
    holds: Callable[[Box], bool],
    rises: Callable[[Box, Faces], bool],
) -> None:
    """Confirm all boxes of a tree, which are together this one. Raises Refused, also for a tree with gaps.

    `holds` says whether the claim holds all over a box, `rises` whether these ends of some sides are enough.
    """
    stack, sides = [box], len(box)
    while stack:
        box, faces = stack.pop(), {}
        while (code := next(tree, None)) is not None and sides <= code < 3 * sides:
            side, upper = divmod(code - sides, 2)
            faces[side] = upper
        if code is None or not isinstance(code, int) or not -1 <= code < sides:
            raise Refused(f"{name}: a box is missing")
        if faces and not rises(box, faces):
            raise Refused(f"{name} is not confirmed for {text(box)}: one end of a side is not enough")
        box = tuple((ends[faces[n]],) * 2 if n in faces else ends for n, ends in enumerate(box))
        if code < 0 and not holds(box):
            raise Refused(f"{name} is not confirmed for {text(box)}")
        if code >= 0:
            low, high = box[code]
            middle = min(max(0.5 * (low + high), low), high)
            stack += [(*box[:code], part, *box[code + 1 :]) for part in ((middle, high), (low, middle))]
    if next(tree, None) is not None:
        raise Refused(f"{name}: there are more boxes than the box has parts")


def _all_over(
    scale: Sequence[float], sure: Callable[..., bool], box: Box, *more: Any, finer: int = FINER
) -> bool:
    """Return whether something is sure all over a box, or over each half of it; `scale` is what is wide."""
    with suppress(Unknown):
        if sure(box, *more):
            return True
    side = max(range(len(box)), key=lambda each: (box[each][1] - box[each][0]) / scale[each])
    low, high = box[side]
    if not finer or not low < high:
        return False
    parts = ((low, 0.5 * (low + high)), (0.5 * (low + high), high))
    halves = ((*box[:side], part, *box[side + 1 :]) for part in parts)
    return all(_all_over(scale, sure, half, *more, finer=finer - 1) for half in halves)


def _holds(chain: "_Mechanisms", forms: Sequence[Sum], box: Box) -> bool:
    """Return whether one of the forms is not negative all over a box. Raises Unknown."""
    found, middle = chain.numbers(box)
    values = ((chain.value(form, found), chain.value(form, middle)) for form in forms)
    return any(_narrowed(wide, here, box).ends[0] >= 0.0 for wide, here in values)


def _rises(chain: "_Mechanisms", forms: Sequence[Sum], box: Box, faces: Faces) -> bool:
    """Return whether no form falls from the low ends of some sides, or from the upper. Raises Unknown."""
    found, _middle = chain.numbers(box)
    slopes = [slopes for form in forms if (slopes := chain.value(form, found).slopes)]
    return all(
        each[side][1] <= 0.0 if upper else each[side][0] >= 0.0
        for each in slopes
        for side, upper in faces.items()
    )


def _spans_last(chain: "_Mechanisms", condition: Spans, run: Ends, box: Box) -> bool:
    """Return whether all spans within a run last long enough, all over a box of parameters."""

    @cache
    def kind(form: Sum, cell: Ends) -> int:
        return _kind(chain, form, (cell, *box))

    def kinds(form: Sum, edges: Any) -> Any:
        return np.array([kind(form, cell) for cell in pairwise(edges.tolist())])

    return condition.hold(*run, kinds)


def _kind(chain: "_Mechanisms", form: Sum, box: Box) -> int:
    """Say what a form does while the angle, the first side of a box, rises."""
    try:
        found, middle = chain.numbers(box)
    except Unknown:
        return UNKNOWN
    value = _narrowed(chain.value(form, found), chain.value(form, middle), box)
    if value.ends[1] < 0.0 or value.ends[0] >= 0.0:
        return OUT if value.ends[1] < 0.0 else IN
    low, high = value.slopes[0] if value.slopes else (0.0, 0.0)
    return RISES if low > 0.0 else FALLS if high < 0.0 else UNKNOWN


def _middle(box: Box) -> list[float]:
    return [min(max(0.5 * (low + high), low), high) for low, high in box]


def _narrowed(wide: Interval, middle: Interval, box: Box) -> Interval:
    """Return a number narrowed to what its slopes leave from its value in the middle of the box."""
    about: Any = Interval(middle.ends, None)
    for slope, side, place in zip(wide.slopes or (), box, _middle(box), strict=False):
        about = about + Interval(slope, None) * (Interval(side, None) - place)
    if wide.slopes is not None:
        wide.ends = max(wide.ends[0], about.ends[0]), min(wide.ends[1], about.ends[1])
    return wide


class _Mechanisms:
    """The mechanisms that some signals need, in their order, each a module that computes with intervals."""

    def __init__(self, scene: Scene, names: Sequence[str], sides: dict[Any, int], equations: dict[str, str]):
        self._scene, self._sides = scene, sides
        needed = needed_for(scene, names)
        order, lagged = step_order(needed.instances, needed.wires)
        if lagged or needed.drives:
            raise Refused("the scene has a loop or a table of inputs")
        read = {wire.source for wire in needed.wires} | {tuple(name.split(".")) for name in names}
        self._parts = []
        for name in order:
            instance = needed.instances[name]
            component = instance.fmu.component
            if not (instance.fmu.built and COMPONENTS.owns(component)) or component is None:
                raise Refused(f"{name} is no mechanism of this package")
            unsteady = any(instance.start(each) or (name, each) in sides for each in component.unsteady)
            if component.keeps == MOTION or unsteady:
                raise Refused(f"{name} depends on more than the shaft angle")
            if issubclass(component, ShaftDriven) and not instance.start(FOLLOWING):
                raise Refused(f"{name} does not follow the shaft")
            if equations.get(component.__name__) != source.digest(component):
                raise Refused(f"the equations of {component.__name__} are not those of the proof")
            wanted = [
                v.name for v in variables_of(component) if (name, v.name) in read and v.causality == "output"
            ]
            if any(remembers(each) for each in variables_of(component) if each.name in wanted):
                raise Refused(f"{name} gives what depends on the run so far")
            wires = {w.sink[1]: ".".join(w.source) for w in needed.wires if w.sink[0] == name}
            warnings = [0, *(n for n, each in enumerate(component.problems, 1) if each.warning)]
            self._parts.append(
                (name, instance, component, _module(component, wanted, instance), wanted, wires, warnings)
            )

    def numbers(self, box: Box) -> tuple[Numbers, Numbers]:
        """Return all outputs over a box, and in its middle. Raises Unknown where too little is known."""
        Interval.sides, point = len(box), tuple((m, m) for m in _middle(box))
        found, middle = ({".".join(k): _side(n, b) for k, n in self._sides.items()} for b in (box, point))
        for name, instance, component, module, wanted, wires, warnings in self._parts:
            start = {
                each.name: each.type(instance.start(each.name) if each.settable else each.start)
                for each in variables_of(component)
            }
            sides = {key[1]: ".".join(key) for key in self._sides if key[0] == name}
            time = number(0.0) if name == SHAFT else Interval(ALL, [ALL] * len(box))
            place = joined(partial(_started, component, module, wanted, warnings))
            given = (
                start | {variable: known[source] for variable, source in (sides | wires).items()}
                for known in (found, middle)
            )
            try:
                wide, here = (place(each, time) for each in given)
            except (TypeError, NameError):
                raise Refused(f"{name} computes with what the check has no intervals for") from None
            for variable, a, b in zip(wanted, wide, here, strict=True):
                middle[f"{name}.{variable}"] = b
                found[f"{name}.{variable}"] = _narrowed(a, b, box)
        return found, middle

    def value(self, form: Sum, found: Numbers) -> Interval:
        """Return a sum of signals and parameters."""
        total = number(form.constant)
        for share, name in form.terms:
            instance, variable = name.split(".")
            fixed = name not in found or name == f"{SHAFT}.{START}"  # that of the scene, not of the box
            start = self._scene.instances[instance].start(variable) if fixed else 0.0
            total = total + share * (number(float(start or 0.0)) if fixed else found[name])
        return total


def _side(place: int, box: Box) -> Interval:
    return Interval(box[place], [(float(n == place),) * 2 for n in range(len(box))])


def _started(
    component: Any, module: Any, wanted: Any, warnings: Any, given: dict[str, Any], time: Any
) -> Any:
    """Outputs of a component at the start of a run. Raises Unknown where it may report a problem."""
    made = module[component.__name__]()
    for each in variables_of(component):
        value = given[each.name]
        if each.type is not float and isinstance(value, Interval):
            value = each.type(floor(value))
        setattr(made, each.name, number(value) if each.type is float else value)
    if made.initialize(time) not in warnings:
        raise Unknown
    return tuple(number(getattr(made, variable)) for variable in wanted)


class _Numbers(ast.NodeTransformer):
    """Makes each number with a point an interval, and each quotient one of intervals."""

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        return (
            ast.parse(f"number({node.value!r})", mode="eval").body if isinstance(node.value, float) else node
        )

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        self.generic_visit(node)
        if isinstance(node.op, ast.Div):
            node.left = ast.Call(ast.Name("number", ast.Load()), [node.left], [])
        return node


def _module(component: Any, wanted: Sequence[str], instance: Instance) -> dict[str, Any]:
    """Return a module that computes some outputs of a component with intervals."""
    variables = variables_of(component)
    settings = settings_of(variables, instance.start)
    members = [each.member.partition("[")[0] for each in variables if each.name in wanted]
    tree = sliced(ast.parse(source.flatten(component)), ENTRIES, members, settings)
    constants = {name: number(getattr(math, name)) for name in ("pi", "inf", "e", "tau")}
    space: dict[str, Any] = {"number": number, **constants, **MATH}
    tree.body = [node for node in tree.body if not isinstance(node, ast.ImportFrom)]
    exec(compile(ast.fix_missing_locations(_Numbers().visit(tree)), component.__name__, "exec"), space)
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    for name in {node.name for node in functions} - _writers(functions):
        space[name] = joined(space[name])
    return space


def _writers(functions: Sequence[ast.FunctionDef]) -> set[str]:
    """The functions that write to a list that they are given, themselves or through others.

    Their ways are those of their callers: each way needs a list of its own.
    """
    found, known = set[str](), -1
    while len(found) > known:
        known = len(found)
        for function in functions:
            given = {each.arg for each in function.args.args}
            for node in ast.walk(function):
                match node:
                    case ast.Subscript(value=ast.Name(id=name), ctx=ast.Store()) if name in given:
                        found.add(function.name)
                    case ast.Call(func=ast.Name(id=called), args=args) if called in found:
                        if given & {each.id for each in args if isinstance(each, ast.Name)}:
                            found.add(function.name)
    return found
