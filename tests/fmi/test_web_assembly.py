"""Modules of WebAssembly and libraries for Linux are linked with what is kept, as the compiler links them."""

import io
import re
import zipfile
from pathlib import Path
from typing import Any

import pytest

from loomfmu.components import COMPONENTS
from loomfmu.fmi.native import compiler, linking, native_fmu, web_assembly
from loomfmu.fmi.native.linking import KEPT, LINUX, MODULES
from loomfmu.fmi.native.runtime import made, needing_all

PINS = Path(__file__).parents[2] / "pins" / "run.txt"
SUM = {"sum.c": '__attribute__((export_name("sum"))) double sum(double a, double b) { return a + b; }\n'}


def counted(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Collect what is compiled: once for an object file, again if the compiler is to make the C library."""
    outputs: list[str] = []

    def compiled_in(directory: Path, _target: str, *arguments: str) -> None:
        outputs.append(arguments[arguments.index("-o") + 1])
        (directory / outputs[-1]).write_bytes(b"compiled")

    monkeypatch.setattr(compiler, "compiled_in", compiled_in)
    return outputs


def test_all_that_our_code_may_call_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled: list[Any] = []
    compile_ = compiler.compiled_in
    monkeypatch.setattr(compiler, "compiled_in", lambda *given: (compiled.append(given), compile_(*given)))
    assert web_assembly.web_assembly("all.c", needing_all()).startswith(b"\0asm")
    with compiler.folder(needing_all()) as directory:
        compiler.made_in(directory, LINUX, "all.c", Path("all.so"), *compiler.FLAGS)
        assert (directory / "all.so").read_bytes().startswith(b"\x7fELF")
    assert [given[1] for given in compiled] == [MODULES, LINUX]


def test_what_another_compiler_made_is_not_linked(monkeypatch: pytest.MonkeyPatch) -> None:
    outputs = counted(monkeypatch)
    monkeypatch.setattr(linking, "version", lambda _package: "0.18.0")
    assert web_assembly.web_assembly("sum.c", SUM) == b"compiled"
    assert outputs == ["sum.wasm"]


def test_where_something_is_missing_the_compiler_makes_it(monkeypatch: pytest.MonkeyPatch) -> None:
    outputs = counted(monkeypatch)  # an object file that cannot be linked
    assert web_assembly.web_assembly("sum.c", SUM) == b"compiled"
    assert outputs == ["sum.o", "sum.wasm"]


def test_what_is_kept_is_of_the_pinned_compiler() -> None:
    pinned = re.search(r"^ziglang==(\S+)", PINS.read_text(encoding="utf-8"), re.MULTILINE)
    with zipfile.ZipFile(KEPT) as archive:
        assert pinned and archive.comment.decode() == pinned[1]


def test_an_fmu_is_linked_as_the_compiler_links_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def library() -> dict[str, bytes]:
        return compiler._compiled("MainShaft", 2, native_fmu.sources(COMPONENTS["MainShaft"]), ("linux64",))

    kept = library()
    monkeypatch.setattr(linking, "version", lambda _package: "0.18.0")
    assert library() == kept


def test_what_a_library_lacks_is_not_left_open(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled: list[Any] = []
    compile_ = compiler.compiled_in
    monkeypatch.setattr(compiler, "compiled_in", lambda *given: (compiled.append(given), compile_(*given)))
    wide = {"wide.c": "__int128 wide(__int128 a, __int128 b) { return a / b; }\n"}
    with compiler.folder(wide) as directory:  # division of 128 bits is not in the C library
        compiler.made_in(directory, LINUX, "wide.c", Path("wide.so"), *compiler.FLAGS, "-fPIC")
    assert len(compiled) == 2


@pytest.mark.slow
def test_what_is_kept_is_what_the_compiler_makes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half a minute of computing time, once for a machine; then a module is the same either way."""
    again, before = (zipfile.ZipFile(each) for each in (io.BytesIO(made()), KEPT))
    assert again.namelist() == before.namelist()
    assert all(again.read(name) == before.read(name) for name in again.namelist())
    kept = web_assembly.web_assembly("sum.c", SUM)
    monkeypatch.setattr(linking, "version", lambda _package: "0.18.0")
    assert web_assembly.web_assembly("sum.c", SUM) == kept
