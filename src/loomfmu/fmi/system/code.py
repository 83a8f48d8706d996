"""A system as C text: its components one after the other, and what wires and drives them."""

import math
from collections.abc import Iterable, Iterator

from ...declaring.variables import Variable, variables_of
from ...errors import LoomfmuError
from ..native.c_code import TYPES, c_name, literal
from ..native.tables import Part as Stepped
from ..native.translate import Translation, translate
from .system import SPEED, STEP, STEPS, Drive, Part, System, limited, problems_of


def translated(system: System) -> Translation:
    """The system in C. Raises LoomfmuError for components that do not translate, or of one name."""
    components = dict.fromkeys(part.component for part in system.parts)
    named = {component.__name__: component for component in components}
    if len(named) < len(components):
        several = [name for name in named if sum(each.__name__ == name for each in components) > 1]
        raise LoomfmuError(f"two components are called {several[0]}; rename one of them")
    parts = [translate(component) for component in components]
    grid = f"    {TYPES['float']} {STEP};" if system.step else f"    {TYPES['int']} {STEPS};"
    members = [f"    struct {part.component.__name__} {c_name(part.name)};" for part in system.parts]
    struct = "\n".join([f"struct {system.name} {{", grid, *members, "};"])
    return Translation(
        system.name,
        "\n\n".join([*(each.struct for each in parts), struct]),
        "\n".join(['#include "grid.h"\n', *(each.functions for each in parts), *_functions(system)]),
    )


def stepped(system: System) -> list[Stepped]:
    """Return the items that the shell starts and steps: the driven inputs, then the parts."""
    name = system.name
    found = [Stepped(f"{name}__start_drives", f"{name}__drive", 1)]
    for part in system.parts:
        problems = len(problems_of(system, part))
        found.append(Stepped(f"{name}__initialize_{part.name}", f"{name}__step_{part.name}", problems))
    return found


def inner_step(system: System) -> str:
    """The step of the grid, in C."""
    return f"{system.name}__inner_step(component)"


def _functions(system: System) -> Iterator[str]:
    this = f"struct {system.name} *self"
    yield from _function(f"static void {system.name}__init__({this})", _starts(system))
    yield from _function(f"static double {system.name}__inner_step(const {this})", [_step(system)])
    yield from _drives(system, this)
    for part in system.parts:
        wire = f"static int64_t {system.name}__wire_{part.name}({this})"
        yield from _function(wire, _wires(system, part))
        for entry, arguments in (("initialize", ("time",)), ("step", ("time", "size"))):
            given = "".join(f", double {each}" for each in arguments)
            passed = "".join(f", {each}" for each in arguments)
            yield from _function(
                f"static int64_t {system.name}__{entry}_{part.name}({this}{given})",
                [
                    f"int64_t problem = {system.name}__wire_{part.name}(self);",
                    "return problem != 0 ? problem"
                    f" : {part.component.__name__}__{entry}(&self->{c_name(part.name)}{passed});",
                ],
            )


def _function(head: str, lines: Iterable[str]) -> Iterator[str]:
    yield "\n".join([head, "{", *(f"    {line}" for line in lines), "}", ""])


def _starts(system: System) -> Iterator[str]:
    """The start values of the components, then those that differ from these."""
    yield f"self->{STEP if system.step else STEPS} = {literal(system.step or system.steps).text};"
    for part in system.parts:
        yield f"{part.component.__name__}__init__(&{_place(part.name)});"
        for each in variables_of(part.component):
            value = each.type(part.values.get(each.name, each.start))
            if value != each.start:
                yield f"{_place(f'{part.name}.{each.member}')} = {literal(value).text};"


def _step(system: System) -> str:
    if system.step:
        return f"return self->{STEP};"
    turn = literal(2.0 * math.pi).text
    return f"return {turn} / (fabs({_place(SPEED)}) * (double)self->{STEPS});"


def _place(name: str) -> str:
    return f"self->{c_name(name)}"


def _member(system: System, name: str) -> str:
    """Return the place of a variable `part.variable` in the struct."""
    owner, _, variable = name.partition(".")
    (part,) = (each for each in system.parts if each.name == owner)
    (found,) = (each for each in variables_of(part.component) if each.name == variable)
    return _place(f"{owner}.{found.member}")


def _wires(system: System, part: Part) -> Iterator[str]:
    """Copies of what a part is wired to; the number of the first input outside its limits."""
    if not any(sink.startswith(f"{part.name}.") for sink in system.wires):
        yield "(void)self;"
    for each in variables_of(part.component):
        name = f"{part.name}.{each.name}"
        if name in system.wires:
            yield f"{_place(f'{part.name}.{each.member}')} = {_member(system, system.wires[name])};"
    for number, each in enumerate(limited(system, part), start=len(part.component.problems) + 1):
        yield f"if (!({_within(part, each)})) {{"
        yield f"    return {number};"
        yield "}"
    yield "return 0;"


def _within(part: Part, variable: Variable) -> str:
    value = _place(f"{part.name}.{variable.member}")
    low, high = (literal(variable.type(limit)).text for limit in variable.limits)
    return f"{value} >= {low} && {value} <= {high}"


def _drives(system: System, this: str) -> Iterator[str]:
    """The tables, and the functions that set the inputs of a start and of a step."""
    name = system.name
    for place, drive in enumerate(system.drives.values()):
        yield _table("points", place, drive.points)
        yield _table("values", place, drive.values)
    rate = f"1.0 / self->{STEP}" if system.step else f"(double)self->{STEPS}"
    lines = [f"double place = grid_place(time + size, {name}__inner_step(self)) / ({rate});"]
    for place, (driven, drive) in enumerate(system.drives.items()):
        lines.append(f"{_member(system, driven)} = {_driven(drive, place)};")
    if not system.drives:
        lines = ["(void)self;", "(void)time;", "(void)size;"]
    yield from _function(
        f"static int64_t {name}__drive({this}, double time, double size)", [*lines, "return 0;"]
    )
    yield from _function(
        f"static int64_t {name}__start_drives({this}, double time)",
        [
            f"double step = {name}__inner_step(self);",
            f"return step > 0.0 && isfinite(step) ? {name}__drive(self, time, 0.0) : 1;",
        ],
    )


def _driven(drive: Drive, place: int) -> str:
    along = "grid_held" if drive.held else "grid_between"
    value = f"{along}(points_{place}, values_{place}, {len(drive.points)}, place)"
    kind = type(drive.values[0])
    if kind is bool:
        return f"{value} > 0.0"
    return f"({TYPES[kind.__name__]}){value}" if kind is int else value


def _table(what: str, place: int, numbers: Iterable[float]) -> str:
    listed = ", ".join(literal(float(number)).text for number in numbers)
    return f"static const double {what}_{place}[] = {{{listed}}};\n"
