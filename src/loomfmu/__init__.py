"""The mechanisms of a weaving loom as FMI components, co-simulated over main-shaft time and judged."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .cosim.claims import judge
    from .cosim.run import Result, run
    from .cosim.verdict import Verdict
    from .errors import LoomfmuError
    from .traces import Trace

_HOMES = {
    "LoomfmuError": "errors",
    "Result": "cosim.run",
    "Trace": "traces",
    "Verdict": "cosim.verdict",
    "judge": "cosim.claims",
    "run": "cosim.run",
}

__all__ = ["LoomfmuError", "Result", "Trace", "Verdict", "judge", "run"]


def __getattr__(name: str) -> Any:
    """Load the public names when they are first used: importing loomfmu alone costs next to nothing."""
    if name not in _HOMES:
        raise AttributeError(f"module 'loomfmu' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f".{_HOMES[name]}", __name__), name)
