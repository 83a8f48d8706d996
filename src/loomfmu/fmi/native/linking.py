"""Links what is compiled with the parts of the C library that the package keeps.

The compiler would make them first, in half a minute of computing time for WebAssembly and in four seconds for
Linux. `runtime.zip` has what our code may call, as one version of the compiler makes it. What is linked is
the same to the last byte.
"""

import re
import zipfile
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from .platforms import COMPILER

KEPT = Path(__file__).with_name("runtime.zip")
MODULES, LINUX = "wasm32-wasi", "x86_64-linux-gnu.2.17"  # targets
OUTPUT, COMPILED, C_LIBRARY = "OUTPUT", "COMPILED", "libc.a"
# as the compiler itself links: modules without imports, which export what their source says, and libraries
# that may lack nothing, without those of the system that ours never need
LINK = {
    MODULES: (
        "wasm-ld", "--error-limit=0", "--export-memory", "-s", "--stack-first", "--entry", "_initialize",
        "-z", "stack-size=16777216", "--build-id=none", "-o", OUTPUT,
        "crt1-reactor.o", C_LIBRARY, "libzigc.a", COMPILED, "libcompiler_rt.a",
    ),
    LINUX: (
        "ld.lld", "--error-limit=0", "-mllvm", "-float-abi=hard", "-O3", "--build-id=none", "--image-base=0",
        "--gc-sections", "--eh-frame-hdr", "-s", "-z", "now", "-z", "defs", "-m", "elf_x86_64", "-shared",
        "-o", OUTPUT, "-rpath", "$ORIGIN", "--no-undefined-version", COMPILED,
        "--as-needed", "libm.so.6", "libc.so.6",
    ),
}  # fmt: skip


def is_part(word: str) -> bool:
    """Return whether a word of a command names a part that is kept."""
    return re.fullmatch(r"[\w-]+\.(a|o|so\.6)", word) is not None


def keeps(target: str) -> bool:
    """Return whether what a target needs is kept, as the installed compiler makes it."""
    with zipfile.ZipFile(KEPT) as archive:
        return target in LINK and archive.comment.decode() == compiler_version()


def link(call: Callable[..., bool], target: str, compiled: str, output: str, directory: Path) -> bool:
    """Link a file that was compiled in a directory; return false if what is kept lacks something.

    `call` is given the directory and the words of a command, and returns whether it did what it should.
    """
    with zipfile.ZipFile(KEPT) as archive:
        archive.extractall(directory, [name for name in archive.namelist() if name.startswith(f"{target}/")])
    given = {OUTPUT: output, COMPILED: compiled}
    return call(directory, *(f"{target}/{w}" if is_part(w) else given.get(w, w) for w in LINK[target]))


def compiler_version() -> str:
    """The version of the compiler; empty if it was not installed as a package."""
    try:
        return version(COMPILER)
    except PackageNotFoundError:
        return ""
