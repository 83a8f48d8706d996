"""The command `loomfmu limit`."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...display.printed import say, warn
from ...errors import LoomfmuError
from ...files import Kind, check_target, write_file
from ...report import pictures
from .boundary import limit
from .report import CSV_LIMITS, boundary_table, show, show_boundary, table
from .results import Boundary, Limits


def run(options: Any, overrides: dict[str, Any]) -> int:
    """Find limits, print and write them, and return the exit status."""
    inputs = [Path(options.scene)]
    output = Path(options.output) if options.output else None
    if output is not None:
        _check(output, inputs, options.force)  # before the runs, not after them
    counts = {name: getattr(options, name) for name in ("points", "rows")}
    found = limit(
        options.scene,
        vary=options.vary,
        from_=options.from_,
        to=options.to,
        set=overrides,
        progress=True,
        **{name: count for name, count in counts.items() if count is not None},
    )
    if output is not None:  # before anything is printed
        _write(found, output, inputs, options.force)
    warn(found.warnings)
    if isinstance(found, Boundary):
        show_boundary(found)
    else:
        show(found)
    if output is not None:
        say(f"written: {output}")
    return 0 if found else 1


def _check(path: Path, inputs: Sequence[Path], overwrite: bool) -> None:
    """Refuse an output that cannot be written. Raises LoomfmuError."""
    if path.suffix == ".csv":
        check_target(path, TABLE, inputs, overwrite)
    elif path.suffix in pictures.PICTURES:
        pictures.check(path, inputs, overwrite)
    else:
        raise LoomfmuError(f"{path}: use .csv for a table, or .svg, .png or .pdf for a picture")


def _write(found: Limits | Boundary, path: Path, inputs: Sequence[Path], overwrite: bool) -> None:
    if path.suffix == ".csv":
        text = boundary_table(found) if isinstance(found, Boundary) else table(found)
        write_file(path, text.encode(), TABLE, inputs, overwrite)
    else:
        from .picture import draw

        pictures.save(draw(found), path, found.title, inputs, overwrite)


def _is_table(path: Path) -> bool:
    with path.open(encoding="utf-8", errors="replace") as file:
        line = file.readline(2000).rstrip("\n")
    return line == ",".join(CSV_LIMITS) or line.endswith(",binding below,binding above")


TABLE = Kind("a table of limits", _is_table)
