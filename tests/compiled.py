"""Components translated to C, compiled by gcc with every warning, and used as the Python ones are."""

import ctypes
import shutil
import subprocess
from pathlib import Path
from typing import Any

from loomfmu.fmi.native.builder import ARITHMETIC, SHELL
from loomfmu.fmi.native.translate import translate
from loomfmu.variables import Component, variables_of

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
    run = subprocess.run(
        [*call, "-o", "entries.so", "entries.c", "-lm"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return ctypes.CDLL(str(folder / "entries.so"))


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
