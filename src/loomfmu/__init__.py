"""The mechanisms of a weaving loom as FMI components, co-simulated over main-shaft time and judged."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .cosim.claims import judge
    from .cosim.run import Evaluation, Result, evaluate, run
    from .cosim.verdict import Verdict
    from .errors import LoomfmuError
    from .sweeps.run import Sweep, sweep
    from .traces import Trace

_HOMES = {
    "Evaluation": "cosim.run",
    "LoomfmuError": "errors",
    "Result": "cosim.run",
    "Sweep": "sweeps.run",
    "Trace": "traces",
    "Verdict": "cosim.verdict",
    "evaluate": "cosim.run",
    "judge": "cosim.claims",
    "run": "cosim.run",
    "sweep": "sweeps.run",
}

__all__ = [
    "Evaluation",
    "LoomfmuError",
    "Result",
    "Sweep",
    "Trace",
    "Verdict",
    "evaluate",
    "judge",
    "run",
    "sweep",
]


def __getattr__(name: str) -> Any:
    """Load the public names when they are first used: importing loomfmu alone costs next to nothing."""
    if name not in _HOMES:
        raise AttributeError(f"module 'loomfmu' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f".{_HOMES[name]}", __name__), name)
