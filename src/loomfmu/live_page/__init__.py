"""A scene as a page in which its FMUs themselves run, in WebAssembly."""

from .page import write

__all__ = ["write"]
