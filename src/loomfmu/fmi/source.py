"""A component as one self-contained module: the text that runs in an FMU and that translates to C.

The component's methods, the physics functions they call and the constants those use are written one
after the other, with an `__init__` that lists the declared fields. The module imports `math` alone.
"""

import inspect
import math
import textwrap
from pathlib import Path
from types import FunctionType
from typing import Any

from ..errors import LoomfmuError
from ..variables import Component, Variable, arrays_of, variables_of

HEADER = '"""{name}, written by loomfmu from its component and the physics it uses; do not edit."""\n'


class SourceError(LoomfmuError):
    """A component that uses what cannot be carried into a self-contained module."""


_flattened: dict[type[Component], str] = {}


def flatten(component: type[Component]) -> str:
    """The component as one module, as its source stands at the first call.

    Raises SourceError, naming the function, where that cannot be done.
    """
    if component not in _flattened:
        _flattened[component] = _text(component)
    return _flattened[component]


def _text(component: type[Component]) -> str:
    methods = _methods(component)
    functions: dict[str, FunctionType] = {}
    constants: dict[str, float | int] = {}
    from_math: set[str] = set()
    for method in methods.values():
        _collect(method, functions, constants, from_math)
    parts = [HEADER.format(name=component.__name__)]
    if from_math:
        parts.append(f"from math import {', '.join(sorted(from_math))}\n")
    parts.append("\n".join(f"{name} = {value!r}" for name, value in constants.items()))
    parts += [inspect.getsource(function) for function in functions.values()]
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


def _collect(
    function: FunctionType,
    functions: dict[str, FunctionType],
    constants: dict[str, float | int],
    from_math: set[str],
) -> None:
    """Add what a function uses: math, constants, and the functions it calls, those first."""
    for name in function.__code__.co_names:
        used: Any = function.__globals__.get(name)
        if used is None or getattr(used, "__module__", None) == "builtins":
            continue  # an attribute or a builtin
        if getattr(math, name, None) is used:
            from_math.add(name)
        elif isinstance(used, FunctionType):
            known = functions.get(name)
            if known is None:
                _collect(used, functions, constants, from_math)
                functions[name] = used
            elif known is not used:
                raise SourceError(f"{_place(function)}: two functions are called {name}")
        elif isinstance(used, int | float):
            constants[name] = used
        else:
            raise SourceError(
                f"{_place(function)}: {function.__name__} uses {name}, which is neither a function of the"
                " physics, a number nor of math"
            )


def _place(function: FunctionType) -> str:
    code = function.__code__
    return f"{Path(code.co_filename).name}, line {code.co_firstlineno}"


def _class(component: type[Component], methods: dict[str, FunctionType]) -> str:
    """The class with its fields and methods."""
    lines = [f"class {component.__name__}:", f'    """{component.__doc__}"""', ""]
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
    found = dict(methods)
    for method in methods.values():
        _collect(method, found, {}, set())
    return found
