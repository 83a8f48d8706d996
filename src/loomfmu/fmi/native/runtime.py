"""Makes anew what is kept of the C library, in `runtime.zip`."""

import io
import re
import zipfile
from pathlib import Path

from ...files import replace_file
from . import compiler
from .c_expressions import REAL_FUNCTIONS, WHOLE_FUNCTIONS
from .linking import C_LIBRARY, KEPT, LINK, LINUX, MODULES, compiler_version, is_part
from .platforms import platform_of
from .web_assembly import FLAGS

MADE_BY = {MODULES: FLAGS, LINUX: (*compiler.FLAGS, *platform_of(LINUX).options)}
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


def needing_all() -> dict[str, str]:
    """A file of C that needs all functions of the C library that our code may call."""
    called = ", ".join(f"(void *){each}" for each in (*REAL_FUNCTIONS, *WHOLE_FUNCTIONS, *OTHERS))
    lines = [
        *(f"#include <{each}.h>" for each in HEADERS),
        f"void *const called[] = {{{called}}};",
        "#ifdef __wasm__",
        '__attribute__((export_name("all")))',
        "#endif",
        "void *all(int n) { return called[n]; }",
    ]
    return {"all.c": "\n".join(lines) + "\n"}


def made() -> bytes:
    """The parts that are kept, made anew. Dates are fixed, so that the same parts give the same bytes."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.comment = compiler_version().encode()
        for target in LINK:
            with compiler.folder(needing_all()) as directory:
                for part in _parts(target, directory):
                    content = (directory / part).read_bytes()
                    archive.writestr(zipfile.ZipInfo(f"{target}/{part}"), content, zipfile.ZIP_DEFLATED, 9)
    return file.getvalue()


def _parts(target: str, directory: Path) -> list[str]:
    """Make the parts that a target needs in a directory, and return their names."""
    flags, link = MADE_BY[target], LINK[target]
    told = compiler.zig(
        directory, "cc", "-target", target, *flags, "-o", "made", "all.c", ZIG_VERBOSE_LINK="1"
    )
    *_before, last = (each for each in told.stderr.splitlines() if each.startswith(link[0]))
    places = {Path(word).name: word for word in last.split() if is_part(Path(word).name)}
    parts = [word for word in link if is_part(word)]
    for part in parts:  # libraries are packed anew: the compiler's have the paths of their members
        whole = Path(places[part])
        if whole.suffix != ".a":
            (directory / part).write_bytes(whole.read_bytes())
            continue
        members = _used(link, places, directory) if part == C_LIBRARY else map(str, whole.parent.glob("*.o"))
        compiler.zig(directory, "ar", "rcsD", part, *members)
    return parts


def _used(link: tuple[str, ...], places: dict[str, str], directory: Path) -> list[str]:
    """The members of the C library that our code needs."""
    words = (*link[: link.index("-o")], "--trace", "-o", "traced", *places.values())
    traced = compiler.zig(directory, *words).stdout
    return re.findall(rf"^{re.escape(places[C_LIBRARY])}\((.*)\)$", traced, re.MULTILINE)


if __name__ == "__main__":
    replace_file(KEPT, made())
