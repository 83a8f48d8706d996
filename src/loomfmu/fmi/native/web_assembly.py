"""Compiles C to modules of WebAssembly, linked with a C library that is part of the package.

The compiler would make that library in half a minute of computing time. `runtime.zip` has what our code may
call of it, as one version of the compiler makes it; `make runtime` makes it anew.
"""

import io
import re
import zipfile
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from ...files import replace_file
from . import compiler
from .c_expressions import REAL_FUNCTIONS, WHOLE_FUNCTIONS
from .platforms import COMPILER

KEPT = Path(__file__).with_name("runtime.zip")
TARGET, FLAGS = "wasm32-wasi", ("-mexec-model=reactor", "-std=c99", *compiler.PLAIN)
C_LIBRARY = "libc.a"
PARTS = ("crt1-reactor.o", C_LIBRARY, "libzigc.a", "libcompiler_rt.a")
# as the compiler itself links, without imports; the module exports what its source says
LINK = (
    "wasm-ld", "--error-limit=0", "--export-memory", "-s", "--stack-first", "--entry", "_initialize",
    "-z", "stack-size=16777216", "--build-id=none",
)  # fmt: skip
OTHERS = (
    "malloc",
    "realloc",
    "free",
    "snprintf",
    "vsnprintf",
    "strtod",
    "strlen",
    "strcmp",
    "strncmp",
    "memcpy",
)
HEADERS = ("math", "stdio", "stdlib", "string")


def web_assembly(source: str, code: dict[str, str]) -> bytes:
    """A file of some code as a module. Raises LoomfmuError without a compiler, or if it does not compile."""
    with compiler.folder(code) as directory:
        module, compiled = (str(Path(source).with_suffix(each)) for each in (".wasm", ".o"))
        compiler.compiled_in(directory, TARGET, *FLAGS, "-c", "-o", compiled, source)
        if not _linked(compiled, module, directory):
            compiler.compiled_in(directory, TARGET, *FLAGS, "-o", module, source)
        return (directory / module).read_bytes()


def _linked(compiled: str, module: str, directory: Path) -> bool:
    """Link what is kept; return false if that is of another compiler, or lacks something."""
    with zipfile.ZipFile(KEPT) as archive:
        if archive.comment.decode() != _compiler():
            return False
        archive.extractall(directory)
    first, second, third, last = PARTS
    return compiler.zig(directory, *LINK, "-o", module, first, second, third, compiled, last).returncode == 0


def _compiler() -> str:
    """The version of the compiler; empty if it was not installed as a package."""
    try:
        return version(COMPILER)
    except PackageNotFoundError:
        return ""


def needing_all() -> dict[str, str]:
    """A file of C that needs all functions of the C library that our code may call."""
    called = ", ".join(f"(void *){each}" for each in (*REAL_FUNCTIONS, *WHOLE_FUNCTIONS, *OTHERS))
    lines = [
        *(f"#include <{each}.h>" for each in HEADERS),
        f"void *const called[] = {{{called}}};",
        '__attribute__((export_name("all"))) void *all(int n) { return called[n]; }',
    ]
    return {"all.c": "\n".join(lines) + "\n"}


def made() -> bytes:
    """Make anew what is kept. Dates are fixed, so that the same parts give the same bytes."""
    with compiler.folder(needing_all()) as directory:
        told = compiler.zig(
            directory, "cc", "-target", TARGET, *FLAGS, "-o", "all.wasm", "all.c", ZIG_VERBOSE_LINK="1"
        )
        words = next(each for each in told.stderr.splitlines() if each.startswith(LINK[0])).split()
        places = {Path(word).name: word for word in words if word.endswith((".o", ".a"))}
        traced = compiler.zig(directory, *LINK, "--trace", "-o", "all.wasm", *places.values()).stdout
        used = re.findall(rf"^{re.escape(places[C_LIBRARY])}\((.*)\)$", traced, re.MULTILINE)
        for part in PARTS:  # libraries are packed anew: the compiler's have the paths of their members
            whole = Path(places[part])
            if whole.suffix == ".o":
                (directory / part).write_bytes(whole.read_bytes())
            else:
                members = used if part == C_LIBRARY else [str(each) for each in whole.parent.glob("*.o")]
                compiler.zig(directory, "ar", "rcsD", part, *members)
        file = io.BytesIO()
        with zipfile.ZipFile(file, "w") as archive:
            archive.comment = _compiler().encode()
            for part in PARTS:
                content = (directory / part).read_bytes()
                archive.writestr(zipfile.ZipInfo(part), content, zipfile.ZIP_DEFLATED, 9)
        return file.getvalue()


if __name__ == "__main__":
    replace_file(KEPT, made())
