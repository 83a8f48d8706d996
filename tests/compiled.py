"""Components translated to C, compiled by gcc with every warning, and used as the Python ones are."""

import ctypes
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from sharing import made_by_gcc

from loomfmu.components import BeltDynamics
from loomfmu.declaring.variables import Component, variables_of
from loomfmu.fmi.native.native_fmu import ARITHMETIC, SHELL
from loomfmu.fmi.native.translate import translate

WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]
TYPES = {float: ctypes.c_double, int: ctypes.c_int64, bool: ctypes.c_bool}
ENTRIES = """
#include "component.c"
void start(struct {name} *self) {{ {name}__init__(self); }}
int64_t initialize(struct {name} *self, double t) {{ return {name}__initialize(self, t); }}
int64_t step(struct {name} *self, double t, double h) {{ return {name}__step(self, t, h); }}
"""


def library(component: type[Component], folder: Path, more: str = "") -> ctypes.CDLL:
    """The translated component with functions that a test can call, and others in C."""
    translated = translate(component)
    (folder / "component.c").write_text(translated.code)
    (folder / "component.h").write_text(translated.header)
    shutil.copy(SHELL / "python_arithmetic.h", folder)
    (folder / "entries.c").write_text(ENTRIES.format(name=component.__name__) + more)
    call = ["gcc", "-shared", "-fPIC", "-std=c99", *ARITHMETIC, *WARNINGS]

    def make() -> bytes:
        run = subprocess.run(
            [*call, "-o", "entries.so", "entries.c", "-lm"],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
        assert run.returncode == 0, run.stderr
        return (folder / "entries.so").read_bytes()

    texts = [path.read_text() for path in sorted(folder.glob("*.[ch]"))]
    (folder / "library.so").write_bytes(made_by_gcc("entries.so", [*call, *texts], make).read_bytes())
    return ctypes.CDLL(str(folder / "library.so"))


def compiled(component: type[Component], folder: Path) -> type[Any]:
    """A class whose instances are the component in C, with its variables as attributes."""
    loaded = library(component, folder)
    loaded.step.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_double]
    loaded.initialize.argtypes = [ctypes.c_void_p, ctypes.c_double]

    class Compiled(ctypes.Structure):
        """The struct of the component's variables."""

        _fields_ = tuple((v.name, TYPES[v.type]) for v in variables_of(component))

        def __init__(self) -> None:
            super().__init__()
            loaded.start(ctypes.byref(self))

        def initialize(self, time: float) -> int:
            return int(loaded.initialize(ctypes.byref(self), time))

        def step(self, time: float, step_size: float) -> int:
            return int(loaded.step(ctypes.byref(self), time, step_size))

    return Compiled


def in_c(component: type[Component], folder: Path) -> type[Any]:
    """The component with its limits and its other methods in Python, but initialized and stepped in C."""
    inside = compiled(component, folder)
    names = [variable.name for variable in variables_of(component)]

    class InC(component):  # type: ignore[valid-type, misc]
        """All variables go into C and come back with every call."""

        def _called(self, method: str, *arguments: float) -> int:
            struct = inside()
            for name in names:
                setattr(struct, name, getattr(self, name))
            problem: int = getattr(struct, method)(*arguments)
            for name in names:
                setattr(self, name, getattr(struct, name))
            return problem

        def initialize(self, time: float) -> int:
            return self._called("initialize", time)

        def step(self, time: float, step_size: float) -> int:
            return self._called("step", time, step_size)

    return InC


@cache
def quick_belt() -> type[Any]:
    """BeltDynamics for long runs: in C thirty times as fast, with the same bits."""
    if shutil.which("gcc") is None:
        return BeltDynamics
    with tempfile.TemporaryDirectory(prefix="belt-") as folder:
        return in_c(BeltDynamics, Path(folder))


@pytest.fixture(scope="session")
def belt_in_c() -> type[Any]:
    return quick_belt()
