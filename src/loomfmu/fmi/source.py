"""A component as one self-contained module: the text that runs in an FMU and that translates to C.

The component's methods, the physics functions they call and the constants and records those use are written
one after the other, with an `__init__` that lists the declared fields. The module imports `math` alone.
"""

import ast
import dis
import hashlib
import inspect
import math
import textwrap
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, is_dataclass
from pathlib import Path
from threading import RLock
from types import CodeType, FunctionType
from typing import Any, get_args

from ..declaring.variables import Component, Variable, arrays_of, variables_of
from ..errors import LoomfmuError

FIELDS = (float, int, bool, list[float], list[int], list[bool])  # of a record
HEADER = '"""{name}, written by loomfmu from its component and the physics it uses; do not edit."""\n'


class SourceError(LoomfmuError):
    """A component that uses what cannot be carried into a self-contained module."""


one_at_a_time = RLock()  # Python 3.11 may fail with a SystemError where two threads parse
_flattened: dict[type[Component], str] = {}


def flatten(component: type[Component]) -> str:
    """The component as one module, as its source stands at the first call.

    Raises SourceError, naming the function, where that cannot be done.
    """
    if component not in _flattened:
        _flattened[component] = _text(component)
    return _flattened[component]


def of_self(node: ast.AST) -> str:
    """The name of an attribute of `self`, or nothing."""
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "self":
        return node.attr
    return ""


def digest(component: type[Component]) -> str:
    """Return the SHA-256 of the module, hence of the component's equations. Raises as `flatten`."""
    return hashlib.sha256(flatten(component).encode()).hexdigest()


@dataclass
class _Used:
    """All that methods use, directly or through others, by name; what is used first comes first."""

    functions: dict[str, FunctionType] = field(default_factory=dict)
    entered: list[FunctionType] = field(default_factory=list)  # functions of which this is still being found
    records: dict[str, type] = field(default_factory=dict)
    constants: dict[str, Any] = field(default_factory=dict)
    from_math: set[str] = field(default_factory=set)


def _text(component: type[Component]) -> str:
    methods = _methods(component)
    used = _used_by(methods)
    parts = [HEADER.format(name=component.__name__)]
    if used.from_math:
        parts.append(f"from math import {', '.join(sorted(used.from_math))}\n")
    parts.append("\n".join(f"{name} = {value!r}" for name, value in used.constants.items()))
    parts += [_record(record) for record in used.records.values()]
    parts += [inspect.getsource(function) for function in used.functions.values()]
    parts.append(_class(component, methods))
    return "\n\n".join(part for part in parts if part)


def _methods(component: type[Component]) -> dict[str, FunctionType]:
    """The methods that the component and its bases declare, the nearest of each name."""
    found: dict[str, FunctionType] = {}
    for base in reversed(component.__mro__):
        for name, member in vars(base).items():
            if isinstance(member, FunctionType) and not name.startswith("__"):
                found[name] = member
    return found


def _used_by(methods: dict[str, FunctionType]) -> _Used:
    used = _Used()
    for method in methods.values():
        _collect(method, used)
    return used


def _collect(function: FunctionType, used: _Used) -> None:
    """Add what a function uses: math, constants, records, and the functions it calls, those first."""
    for record in _annotated(inspect.get_annotations(function, eval_str=True).values()):
        _add_record(record, used, function)
    for name in _names(function.__code__):
        value: Any = function.__globals__.get(name)
        if value is None or getattr(value, "__module__", None) == "builtins":
            continue  # an attribute or a builtin
        if getattr(math, name, None) is value:
            used.from_math.add(name)
        elif isinstance(value, FunctionType):
            if name not in used.functions:
                _check_function(value, used)
                used.entered.append(value)
                _collect(value, used)
                used.functions[name] = used.entered.pop()
            elif used.functions[name] is not value:
                raise SourceError(f"{_place(function)}: two functions are called {name}")
        elif isinstance(value, int | float) or _is_table(value):
            if repr(used.constants.setdefault(name, value)) != repr(value):
                raise SourceError(f"{_place(function)}: two constants are called {name}")
        elif is_dataclass(value) and isinstance(value, type):
            _add_record(value, used, function)
        else:
            raise SourceError(
                f"{_place(function)}: {function.__name__} uses {name}, which is neither a function of the"
                " physics, a number, several as a tuple, a frozen dataclass nor of math"
            )
        kinds = (used.functions, used.records, used.constants, used.from_math)
        if sum(name in each for each in kinds) > 1:
            raise SourceError(f"{_place(function)}: {name} has two meanings in what the component uses")


def _check_function(function: FunctionType, used: _Used) -> None:
    """Refuse a function that cannot stand by itself."""
    if function in used.entered:
        raise SourceError(f"{_place(function)}: {function.__name__} calls itself")
    if function.__name__ == "<lambda>" or inspect.getsource(function)[0].isspace():
        raise SourceError(f"{_place(function)}: write this function as a def of its own, at the left margin")


def _names(code: CodeType) -> list[str]:
    """The global names that a function uses, comprehensions included."""
    inner = [each for each in code.co_consts if isinstance(each, CodeType)]
    names = [each.argval for each in dis.get_instructions(code) if each.opname == "LOAD_GLOBAL"]
    return [*dict.fromkeys(names), *(name for each in inner for name in _names(each))]


def _is_table(value: Any) -> bool:
    return isinstance(value, tuple) and bool(value) and all(isinstance(each, int | float) for each in value)


def _annotated(annotations: Iterable[Any]) -> Iterator[type]:
    """The records that annotations name."""
    for each in annotations:
        yield from _annotated(get_args(each))
        if isinstance(each, type) and is_dataclass(each):
            yield each


def _add_record(record: type, used: _Used, function: FunctionType) -> None:
    """Add a record, after those that are its fields."""
    name = record.__name__
    if used.records.get(name, record) is not record:
        raise SourceError(f"{_place(function)}: two records are called {name}")
    kinds = inspect.get_annotations(record, eval_str=True)
    own = {each for each in vars(record) if not each.startswith("__")}
    frozen = record.__dataclass_params__.frozen  # type: ignore[attr-defined]
    if (
        not frozen
        or record.__bases__ != (object,)
        or own - (set(kinds) if "__slots__" in vars(record) else set())
    ):
        raise SourceError(
            f"{_place(function)}: {name} is not a frozen dataclass with fields alone, no defaults, no methods"
        )
    for each, kind in kinds.items():
        if kind not in FIELDS and not is_dataclass(kind):
            about = inspect.formatannotation(kind)
            raise SourceError(
                f"{_place(function)}: {name}.{each} is {about}, not a number, a list or a record"
            )
    for field_record in _annotated(kinds.values()):
        _add_record(field_record, used, function)
    used.records[name] = record


def _record(record: type) -> str:
    """A record as a plain class, which a live FMU makes in a third of the time."""
    kinds = inspect.get_annotations(record, eval_str=True)
    given = ", ".join(
        f"{name}: {inspect.formatannotation(kind).rpartition('.')[2]}" for name, kind in kinds.items()
    )
    lines = [f"class {record.__name__}:", f"    {record.__doc__!r}", ""]
    lines += [f"    __slots__ = {tuple(kinds)!r}", "", f"    def __init__(self, {given}) -> None:"]
    return "\n".join([*lines, *(f"        self.{name} = {name}" for name in kinds)]) + "\n"


def _place(function: FunctionType) -> str:
    code = function.__code__
    return f"{Path(code.co_filename).name}, line {code.co_firstlineno}"


def _class(component: type[Component], methods: dict[str, FunctionType]) -> str:
    """The class with its fields and methods."""
    lines = [f"class {component.__name__}:", f"    {component.__doc__!r}", ""]
    lines += ["    def __init__(self) -> None:"]
    lines += [f"        self.{variable.name} = {variable.start!r}" for variable in variables_of(component)]
    lines += [_array(name, variables) for name, variables in arrays_of(component).items()]
    body = "\n".join(lines) + "\n"
    for method in methods.values():
        body += "\n" + textwrap.indent(textwrap.dedent(inspect.getsource(method)), "    ")
    return body


ARRAY = """
    @property
    def {name}(self):
        return {values}

    @{name}.setter
    def {name}(self, values):
        {values} = values"""


def _array(name: str, variables: tuple[Variable, ...]) -> str:
    """An array of the class: a tuple of its variables."""
    return ARRAY.format(name=name, values=", ".join(f"self.{variable.name}" for variable in variables))


def functions(component: type[Component]) -> dict[str, FunctionType]:
    """The methods of a component and the functions of physics that they use."""
    methods = _methods(component)
    return methods | _used_by(methods).functions
