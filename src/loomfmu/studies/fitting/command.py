"""The command `loomfmu fit`."""

from pathlib import Path
from typing import Any

from ...cosim.reading import checked
from ...display.printed import say, warn
from ...errors import LoomfmuError
from ...files import check_target
from ...report import pictures
from .. import rewritten
from .fit import fit
from .report import show


def run(options: Any, overrides: dict[str, Any]) -> int:
    """Fit, print, and write the scene and the picture that were asked for; return the exit status."""
    inputs = [Path(options.scene), Path(options.data)]
    output, picture = (Path(each) if each else None for each in (options.output, options.picture))
    scene = checked(options.scene, overrides, "native")
    # before the runs, not after them
    if output is not None:
        if output.suffix != ".toml":
            raise LoomfmuError(f"{output}: a scene is written as .toml; --picture draws the curves")
        check_target(output, rewritten.KIND, inputs, options.force)
        rewritten.check(scene)
    if picture is not None:
        pictures.check(picture, inputs, options.force)
    found = fit(
        scene,
        options.data,
        vary=options.vary,
        signals=options.signal,
        offset=options.offset,
        loss=options.loss,
    )
    if output is not None:
        found.write(output, options.force)
    if picture is not None:
        from .picture import draw

        pictures.save(draw(found), picture, found.title, inputs, options.force)
    warn(found.warnings)
    show(found)
    say(*(f"written: {path}" for path in (output, picture) if path is not None))
    return 0 if found else 1
