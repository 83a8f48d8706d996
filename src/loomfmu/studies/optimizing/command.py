"""The command `loomfmu optimize`."""

from typing import Any

from ...display.printed import warn
from .optimize import optimize
from .report import show


def run(options: Any) -> int:
    """Search, print what was found, and return the exit status."""
    found = optimize(
        options.study,
        processes=options.processes,
        output=options.output,
        scheduler=options.scheduler,
        restart=options.restart,
        progress=True,
    )
    warn(found.warnings)
    show(found)
    return 0 if found.holds else 1
