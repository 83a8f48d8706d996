"""A system as C text: its components one after the other, and what wires and drives them."""

import math
from collections.abc import Iterable, Iterator

from ...declaring.variables import Variable, variables_of
from ...errors import LoomfmuError
from ..native.c_code import PRODUCT, REAL, SUM, TYPES, WHOLE, Code, c_name, literal
from ..native.c_numbers import PLAIN, Numbers
from ..native.tables import Part as Stepped
from ..native.translate import Translation, Written, translate
from .loops import RULE
from .system import SPEED, STEP, STEPS, Drive, Part, System, limited, problems_of


def translated(system: System) -> Translation:
    """The system in C. Raises LoomfmuError for components that do not translate, or of one name."""
    components = dict.fromkeys(part.component for part in system.parts)
    named = {component.__name__: component for component in components}
    if len(named) < len(components):
        several = [name for name in named if sum(each.__name__ == name for each in components) > 1]
        raise LoomfmuError(f"two components are called {several[0]}; rename one of them")
    parts = [translate(component) for component in components]

    def written(numbers: Numbers) -> Written:
        return _written(system, [each.plain if numbers is PLAIN else each.dual for each in parts], numbers)

    return Translation(system.name, written)


def _written(system: System, parts: list[Written], numbers: Numbers) -> Written:
    """The system in C with one type of numbers."""
    prefix = numbers.prefix
    grid = f"    {numbers.type} {STEP};" if system.step else f"    {TYPES['int']} {STEPS};"
    members = [f"    struct {prefix}{part.component.__name__} {c_name(part.name)};" for part in system.parts]
    kept = list(_memory(system, numbers)) if system.closing else []
    members += [f"    {prefix}LoopMemory loop;"] if kept else []
    struct = "\n".join([*kept, f"struct {prefix}{system.name} {{", grid, *members, "};"])
    included = f'#include "{prefix}grid.h"\n'
    return Written(
        "\n\n".join([*(each.struct for each in parts), struct]),
        "\n".join([included, *(each.functions for each in parts), *_functions(system, numbers)]),
    )


def _memory(system: System, numbers: Numbers) -> Iterator[str]:
    """The struct of what a system keeps of its loop from step to step."""
    values, reals = len(system.closing_sources), max(1, system.closing_reals)
    yield "typedef struct {"
    yield f"    {numbers.type} values[{values}];"
    if numbers is PLAIN:
        yield f"    double largest[{reals}];"
        yield f"    double differences[{RULE.orders * reals}];"
        yield f"    double inverse[{reals * reals}];"
    yield f"}} {numbers.prefix}LoopMemory;\n"


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


def _functions(system: System, numbers: Numbers) -> Iterator[str]:
    name, real = numbers.prefix + system.name, numbers.type
    this = f"struct {name} *self"
    if numbers is PLAIN:
        yield from _function(f"static void {name}__init__({this})", _starts(system))
    yield from _function(f"static {real} {name}__inner_step(const {this})", [_step(system, numbers)])
    yield from _drives(system, this, numbers)
    for part in system.parts:
        wire = f"static int64_t {name}__wire_{part.name}({this})"
        yield from _function(wire, _wires(system, part, numbers))
        component = numbers.prefix + part.component.__name__
        for entry, arguments in (("initialize", ("time",)), ("step", ("time", "size"))):
            given = "".join(f", {real} {each}" for each in arguments)
            passed = "".join(f", {each}" for each in arguments)
            yield from _function(
                f"static int64_t {name}__{entry}_{part.name}({this}{given})",
                [
                    f"int64_t problem = {name}__wire_{part.name}(self);",
                    "return problem != 0 ? problem"
                    f" : {component}__{entry}(&self->{c_name(part.name)}{passed});",
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


def _step(system: System, numbers: Numbers) -> str:
    if system.step:
        return f"return self->{STEP};"
    speed = Code(f"{numbers.prefix}fabs({_place(SPEED)})", REAL)
    steps = numbers.combined("*", PRODUCT, speed, _steps(numbers))
    return f"return {numbers.combined('/', PRODUCT, numbers.literal(2.0 * math.pi), steps).text};"


def _steps(numbers: Numbers) -> Code:
    """The steps in a revolution as a real number."""
    return numbers.converted(Code(f"self->{STEPS}", WHOLE))


def _place(name: str) -> str:
    return f"self->{c_name(name)}"


def _member(system: System, name: str) -> str:
    """Return the place of a variable `part.variable` in the struct."""
    return _place(f"{name.partition('.')[0]}.{system.variable(name).member}")


def _wires(system: System, part: Part, numbers: Numbers) -> Iterator[str]:
    """Copies of what a part is wired to; the number of the first input outside its limits."""
    if not any(sink.startswith(f"{part.name}.") for sink in system.wires):
        yield "(void)self;"
    closing, sources = dict(system.closing), system.closing_sources
    for each in variables_of(part.component):
        name = f"{part.name}.{each.name}"
        if name in closing:
            place = f"self->loop.values[{sources.index(closing[name])}]"
            yield f"{_place(f'{part.name}.{each.member}')} = {_as(each.type, Code(place, REAL), numbers)};"
        elif name in system.wires:
            yield f"{_place(f'{part.name}.{each.member}')} = {_member(system, system.wires[name])};"
    for number, each in enumerate(limited(system, part), start=len(part.component.problems) + 1):
        yield f"if (!({_within(part, each, numbers)})) {{"
        yield f"    return {number};"
        yield "}"
    yield "return 0;"


def _within(part: Part, variable: Variable, numbers: Numbers) -> str:
    place = Code(_place(f"{part.name}.{variable.member}"), TYPES[variable.type.__name__])
    value = numbers.value(place).text
    low, high = (literal(variable.type(limit)).text for limit in variable.limits)
    return f"{value} >= {low} && {value} <= {high}"


def _drives(system: System, this: str, numbers: Numbers) -> Iterator[str]:
    """The tables, and the functions that set the inputs of a start and of a step."""
    name, real = numbers.prefix + system.name, numbers.type
    for place, drive in enumerate(system.drives.values() if numbers is PLAIN else ()):
        yield _table("points", place, drive.points)
        yield _table("values", place, drive.values)
    rate = _steps(numbers)
    if system.step:
        rate = numbers.combined("/", PRODUCT, numbers.literal(1.0), Code(f"self->{STEP}", REAL))
    end = numbers.combined("+", SUM, Code("time", REAL), Code("size", REAL)).text
    steps = Code(f"{numbers.prefix}grid_place({end}, {name}__inner_step(self))", REAL)
    lines = [f"{real} place = {numbers.combined('/', PRODUCT, steps, rate).text};"]
    for place, (driven, drive) in enumerate(system.drives.items()):
        lines.append(f"{_member(system, driven)} = {_driven(drive, place, numbers)};")
    if not system.drives:
        lines = ["(void)self;", "(void)time;", "(void)size;"]
    yield from _function(
        f"static int64_t {name}__drive({this}, {real} time, {real} size)", [*lines, "return 0;"]
    )
    step = numbers.value(Code(f"{name}__inner_step(self)", REAL)).text
    zero = numbers.literal(0.0).text
    yield from _function(
        f"static int64_t {name}__start_drives({this}, {real} time)",
        [
            f"double step = {step};",
            f"return step > 0.0 && isfinite(step) ? {name}__drive(self, time, {zero}) : 1;",
        ],
    )


def _driven(drive: Drive, place: int, numbers: Numbers) -> str:
    along = f"{numbers.prefix}grid_{'held' if drive.held else 'between'}"
    code = Code(f"{along}(points_{place}, values_{place}, {len(drive.points)}, place)", REAL)
    return _as(type(drive.values[0]), code, numbers)


def _as(kind: type, real: Code, numbers: Numbers) -> str:
    """A real number as a variable of another type."""
    value = numbers.value(real).text
    if kind is bool:
        return f"{value} > 0.0"
    return f"({TYPES[kind.__name__]}){value}" if kind is int else real.text


def _table(what: str, place: int, numbers: Iterable[float]) -> str:
    listed = ", ".join(literal(float(number)).text for number in numbers)
    return f"static const double {what}_{place}[] = {{{listed}}};\n"
