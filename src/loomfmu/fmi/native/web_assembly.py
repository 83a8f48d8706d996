"""Compiles C to modules of WebAssembly."""

from pathlib import Path

from . import compiler
from .linking import MODULES

FLAGS = ("-mexec-model=reactor", "-std=c99", *compiler.PLAIN)


def web_assembly(source: str, code: dict[str, str]) -> bytes:
    """A file of some code as a module. Raises LoomfmuError without a compiler, or if it does not compile."""
    with compiler.folder(code) as directory:
        module = Path(source).with_suffix(".wasm")
        compiler.made_in(directory, MODULES, source, module, *FLAGS)
        return (directory / module).read_bytes()
