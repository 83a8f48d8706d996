"""Modules of WebAssembly are linked with a C library that is kept, as the compiler would link them."""

import io
import re
import zipfile
from pathlib import Path
from typing import Any

import pytest

from loomfmu.fmi.native import compiler, web_assembly
from loomfmu.fmi.native.web_assembly import KEPT, made, needing_all

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
    assert len(compiled) == 1


def test_what_another_compiler_made_is_not_linked(monkeypatch: pytest.MonkeyPatch) -> None:
    outputs = counted(monkeypatch)
    monkeypatch.setattr(web_assembly, "version", lambda _package: "0.18.0")
    assert web_assembly.web_assembly("sum.c", SUM) == b"compiled"
    assert outputs == ["sum.o", "sum.wasm"]


def test_where_something_is_missing_the_compiler_makes_it(monkeypatch: pytest.MonkeyPatch) -> None:
    outputs = counted(monkeypatch)  # an object file that cannot be linked
    assert web_assembly.web_assembly("sum.c", SUM) == b"compiled"
    assert outputs == ["sum.o", "sum.wasm"]


def test_what_is_kept_is_of_the_pinned_compiler() -> None:
    pinned = re.search(r"^ziglang==(\S+)", PINS.read_text(encoding="utf-8"), re.MULTILINE)
    with zipfile.ZipFile(KEPT) as archive:
        assert pinned and archive.comment.decode() == pinned[1]


@pytest.mark.slow
def test_what_is_kept_is_what_the_compiler_makes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half a minute of computing time, once for a machine; then a module is the same either way."""
    again, before = (zipfile.ZipFile(each) for each in (io.BytesIO(made()), KEPT))
    assert again.namelist() == before.namelist()
    assert all(again.read(name) == before.read(name) for name in again.namelist())
    kept = web_assembly.web_assembly("sum.c", SUM)
    monkeypatch.setattr(web_assembly, "version", lambda _package: "0.18.0")
    assert web_assembly.web_assembly("sum.c", SUM) == kept
