"""The command `loomfmu tolerances`."""

from pathlib import Path
from typing import Any

from ...display.printed import say, warn
from ...report import pictures
from .report import draw, show
from .tolerances import tolerances


def run(options: Any, overrides: dict[str, Any]) -> int:
    """Search, print, draw where that was asked for, and return the exit status."""
    inputs = [Path(options.scene)]
    picture = Path(options.picture) if options.picture else None
    if picture is not None:  # before the runs, not after them
        pictures.check(picture, inputs, options.force)
    found = tolerances(options.scene, vary=options.vary, set=overrides, progress=True)
    if picture is not None:
        pictures.save(draw(found), picture, found.title, inputs, options.force)
    warn(found.warnings)
    show(found)
    if picture is not None:
        say(f"written: {picture}")
    return 0 if found else 1
