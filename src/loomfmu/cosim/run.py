"""Running a scene: co-simulate, record, judge."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from .importing.fmus import Flavour
from .prepared import Errors, Prepared
from .results import Evaluation, Result
from .scenes.scene import Scene


def run(
    scene: str | Path | Scene,
    *,
    set: dict[str, Any] | None = None,  # the command's own word
    output: str | Path | None = None,
    progress: bool = False,
    flavour: Flavour = "native",
    overwrite: bool = False,
    remarks: Mapping[int, str] | None = None,
) -> Result:
    """Co-simulate a scene, record it to HDF5 and judge its claims.

    Args:
        scene: path of a scene file or a system package (.ssp), or a scene that was read before
        set: values that differ from the scene's, such as {"shaft.speed": "685 rpm"}; numbers are SI
        output: path of the trace; `results/<scene>.h5` below the current directory by default, and
            `results/<scene>_<values>.h5` with other values than the scene's; with eight hex digits more
            where the trace of another scene file has that name
        progress: report the size of a large trace beforehand and show a progress bar for a long run, if
            standard error is a terminal
        flavour: "native" or "live" FMUs; live ones also where no native one is available, with a warning
        overwrite: replace a file at `output` that is not a trace
        remarks: what else to note of claims, by their numbers counted from 0, such as `proofs.remarks`

    Raises:
        LoomfmuError: bad input, or an FMU that failed; one line that names what and where
        KeyboardInterrupt: Ctrl-C; what was written stays readable in a file that the message names
    """
    loom = prepare(scene, set=set, flavour=flavour)
    return loom.run(output=output, progress=progress, overwrite=overwrite, remarks=remarks)


def evaluate(
    scene: str | Path | Scene,
    *,
    set: dict[str, Any] | None = None,
    flavour: Flavour = "native",
    values: Sequence[str] = (),
    errors: Errors = "all",
) -> Evaluation:
    """Co-simulate what the claims of a scene need, and judge them; nothing is written.

    Args:
        scene, set, flavour: as for `run`; what the scene would record is left out
        values: further signals to keep
        errors: which verdicts get an estimate of their numerical error, which takes further runs: "all",
            those "near" their bounds, or "none"

    Raises:
        LoomfmuError: bad input, or an FMU that failed; one line that names what and where
        KeyboardInterrupt: Ctrl-C
    """
    return prepare(scene, set=set, flavour=flavour, values=values).evaluate(errors=errors)


def prepare(
    scene: str | Path | Scene,
    *,
    set: dict[str, Any] | None = None,
    flavour: Flavour = "native",
    values: Sequence[str] = (),
) -> Prepared:
    """Read, wire and plan a scene once, to run it many times with other values.

    `loom.evaluate({"shaft.speed": "650 rpm"})` and `loom.run(...)` set values, reset the FMUs, step and
    judge; results are those of `evaluate` and `run`, to the last bit.

    Args:
        scene, set, flavour: as for `run`
        values: further signals that `loom.evaluate` keeps

    Raises:
        LoomfmuError: bad input; one line that names what and where
    """
    return Prepared(scene, set, flavour, values)
