"""The mechanisms of a weaving loom as FMI components, co-simulated over main-shaft time and judged.

`run` co-simulates a scene and records it, `evaluate` does so in memory, `prepare` gets it ready for many
runs, `sweep` runs it with many values, `limit` finds how far a value may go, `optimize` the best design,
`gradient` the derivatives of claims,
`fit` values from measured curves; `Trace` reads a recorded run, `judge` judges a claim on it, `compare`
compares two. `design` solves the same physics for a design; `report` and `live_page` write pages.
"""

from typing import TYPE_CHECKING, Any

from .cosim.standard import Standard, hand_down
from .version import __version__ as __version__

if TYPE_CHECKING:
    from . import design as design
    from . import live_page as live_page
    from . import report as report
    from .cosim.many import Rows as Rows
    from .cosim.prepared import Prepared as Prepared
    from .cosim.results import Evaluation as Evaluation
    from .cosim.results import Result as Result
    from .cosim.run import evaluate as evaluate
    from .cosim.run import prepare as prepare
    from .cosim.run import run as run
    from .errors import LoomfmuError as LoomfmuError
    from .loom.judged import judge as judge
    from .studies.fitting.fit import Fit as Fit
    from .studies.fitting.fit import fit as fit
    from .studies.gradient import Gradient as Gradient
    from .studies.gradient import gradient as gradient
    from .studies.limits.limits import limit as limit
    from .studies.limits.results import Boundary as Boundary
    from .studies.limits.results import Limits as Limits
    from .studies.optimizing.optimize import optimize as optimize
    from .studies.optimizing.optimum import Optimum as Optimum
    from .studies.proving.proofs import Proofs as Proofs
    from .studies.proving.prove import prove as prove
    from .studies.tolerances.draw import draw_looms as draw_looms
    from .studies.tolerances.results import Tolerances as Tolerances
    from .studies.tolerances.shares import Shares as Shares
    from .studies.tolerances.tolerances import tolerances as tolerances
    from .sweeps.run import Sweep as Sweep
    from .sweeps.run import sweep as sweep
    from .traces import Comparison as Comparison
    from .traces import Trace as Trace
    from .traces import Verdict as Verdict
    from .traces import compare as compare

# public name -> its module
_HOMES = {
    "Boundary": "studies.limits.results",
    "Comparison": "traces",
    "Evaluation": "cosim.results",
    "Fit": "studies.fitting.fit",
    "Gradient": "studies.gradient",
    "Limits": "studies.limits.results",
    "LoomfmuError": "errors",
    "Optimum": "studies.optimizing.optimum",
    "Prepared": "cosim.prepared",
    "Proofs": "studies.proving.proofs",
    "Result": "cosim.results",
    "Rows": "cosim.many",
    "Shares": "studies.tolerances.shares",
    "Sweep": "sweeps.run",
    "Tolerances": "studies.tolerances.results",
    "Trace": "traces",
    "Verdict": "traces",
    "compare": "traces",
    "design": "",
    "draw_looms": "studies.tolerances.draw",
    "evaluate": "cosim.run",
    "prepare": "cosim.run",
    "judge": "loom.judged",
    "live_page": "",
    "report": "",
    "gradient": "studies.gradient",
    "fit": "studies.fitting.fit",
    "limit": "studies.limits.limits",
    "optimize": "studies.optimizing.optimize",
    "prove": "studies.proving.prove",
    "run": "cosim.run",
    "sweep": "sweeps.run",
    "tolerances": "studies.tolerances.tolerances",
}


def _loom() -> Standard:
    from . import loom

    return loom


def _bars() -> Any:
    from .studies.tolerances.error_bars import error_bars

    return error_bars


hand_down(_loom, _bars)


def __getattr__(name: str) -> Any:
    """Load the public names when they are first used: importing loomfmu alone costs next to nothing."""
    if name == "__all__":
        return __dir__()
    if name not in _HOMES:
        raise AttributeError(f"module 'loomfmu' has no attribute {name!r}")
    from importlib import import_module

    home = _HOMES[name]
    return getattr(import_module(f".{home}", __name__), name) if home else import_module(f".{name}", __name__)


def __dir__() -> list[str]:
    """The public names, loaded or not."""
    return sorted([*_HOMES, "__version__"])
