"""The mechanisms of a weaving loom as FMI components, co-simulated over main-shaft time and judged."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .cosim.claims.claims import judge
    from .cosim.run import Evaluation, Result, evaluate, run
    from .errors import LoomfmuError
    from .sweeps.run import Sweep, sweep
    from .traces import Trace, Verdict

_HOMES = {
    "Evaluation": "cosim.run",
    "LoomfmuError": "errors",
    "Result": "cosim.run",
    "Sweep": "sweeps.run",
    "Trace": "traces",
    "Verdict": "traces",
    "evaluate": "cosim.run",
    "judge": "cosim.claims.claims",
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
    if name == "__version__":
        from importlib.metadata import version

        return version("loomfmu")
    if name == "design":
        raise AttributeError("loomfmu.design is not loaded yet: from loomfmu.design import loom, cam")
    if name not in _HOMES:
        raise AttributeError(f"module 'loomfmu' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f".{_HOMES[name]}", __name__), name)


def __dir__() -> list[str]:
    """The public names, loaded or not."""
    return sorted({*globals(), *__all__, "__version__"})
