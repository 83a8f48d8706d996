"""Commands and functions in a process to which the packages of all extras are not installed."""

import contextlib
import io
import json
import shlex
import sys
from pathlib import Path
from typing import Any

from loomfmu.extras import EXTRAS

if __name__ == "__main__":
    for package in sum(EXTRAS.values(), ()):
        sys.modules[package] = None  # type: ignore[assignment]  # as Python marks what cannot be imported

import loomfmu
from loomfmu.cli import main
from loomfmu.design import cam_export
from loomfmu.fmi.native import platforms

TRACE = "results/scene.h5"
CALLS: dict[str, Any] = {
    "Trace.plot": lambda: loomfmu.Trace(TRACE).plot("belt.margin"),
    "Trace.to_xarray": lambda: loomfmu.Trace(TRACE).to_xarray("belt.margin"),
    "Result.report": lambda: loomfmu.run("scene.toml", flavour="live").report(),
    "evaluate": lambda: loomfmu.evaluate("scene.toml", flavour="live"),
    "sweep": lambda: loomfmu.sweep("sweep.toml"),
    "optimize": lambda: loomfmu.optimize("study.toml"),
    "write_dxf": lambda: cam_export.write_dxf(None, Path("cam.dxf")),  # type: ignore[arg-type]
    "dir": lambda: [getattr(loomfmu, name) for name in dir(loomfmu)],
}


def command(line: str) -> tuple[int, str]:
    """Exit status and errors of a command, its warnings left out."""
    errors = io.StringIO()
    with contextlib.redirect_stderr(errors), contextlib.redirect_stdout(io.StringIO()):
        status = main(shlex.split(line))
    said = [each for each in errors.getvalue().splitlines() if not each.startswith("warning: ")]
    return status, "\n".join(said).removeprefix("loomfmu: ")


def call(name: str) -> tuple[int, str]:
    """What comes of a call, as of a command."""
    try:
        CALLS[name]()
    except loomfmu.LoomfmuError as error:
        return 2, str(error)
    return 0, ""


if __name__ == "__main__":
    if sys.argv[1:]:  # a folder of libraries that a package brings
        platforms.SHIPPED = Path(sys.argv[1])
    found = [call(line) if line in CALLS else command(line) for line in json.load(sys.stdin)]
    print(json.dumps(found))
