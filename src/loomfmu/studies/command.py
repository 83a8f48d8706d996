"""The command `loomfmu limit`."""

from pathlib import Path
from typing import Any

from ..errors import LoomfmuError
from ..files import Kind, check_target, write_file
from ..printed import complain, say
from ..report import pictures as pages
from .boundary import limit
from .report import CSV_LIMITS, boundary_table, show, show_boundary, table
from .results import Boundary, Limits


def run(options: Any, overrides: dict[str, Any]) -> int:
    """Find limits, print and write them, and return the exit status."""
    inputs = [Path(options.scene)]
    output = Path(options.output) if options.output else None
    kind = _kind(output) if output is not None else None
    if output is not None and kind is not None:  # before the runs, not after them
        check_target(output, kind, inputs, options.force)
        if output.suffix != ".csv":
            from ..traces.plotting import figure

            figure((1.0, 1.0))
    counts = {name: getattr(options, name) for name in ("points", "rows")}
    found = limit(
        options.scene, vary=options.vary, from_=options.from_, to=options.to, set=overrides, progress=True,
        **{name: count for name, count in counts.items() if count is not None},
    )  # fmt: skip
    if output is not None and kind is not None:  # before anything is printed
        write_file(output, _content(found, output), kind, inputs, options.force)
    for warning in found.warnings:
        complain(f"warning: {warning}")
    if isinstance(found, Boundary):
        show_boundary(found)
    else:
        show(found)
    if output is not None:
        say(f"written: {output}")
    return 0 if found else 1


def _kind(path: Path) -> Kind:
    """What kind of file the output is to be. Raises LoomfmuError for another suffix."""
    if path.suffix == ".csv":
        return Kind("a table of limits", _is_table)
    if path.suffix not in pages.PICTURES:
        raise LoomfmuError(f"{path}: use .csv for a table, or .svg, .png or .pdf for a picture")
    return pages.kind(path)


def _is_table(path: Path) -> bool:
    with path.open(encoding="utf-8", errors="replace") as file:
        line = file.readline(2000).rstrip("\n")
    return line == ",".join(CSV_LIMITS) or line.endswith(",binding below,binding above")


def _content(found: Limits | Boundary, path: Path) -> bytes:
    if path.suffix == ".csv":
        return (boundary_table(found) if isinstance(found, Boundary) else table(found)).encode()
    from .pictures import draw

    return pages.content(draw(found), path.suffix, found.title)
