"""The command `loomfmu fit`."""

from pathlib import Path
from typing import Any

from ...errors import LoomfmuError
from ...files import check_target, write_file
from ...printed import say
from ...report import pictures
from .. import rewritten
from .fit import fit
from .report import show


def run(options: Any, overrides: dict[str, Any]) -> int:
    """Fit, print, and write the scene and the picture that were asked for; return the exit status."""
    inputs = [Path(options.scene), Path(options.data)]
    output, picture = (Path(each) if each else None for each in (options.output, options.picture))
    # before the runs, not after them
    if output is not None:
        if output.suffix != ".toml":
            raise LoomfmuError(f"{output}: a scene is written as .toml; --picture draws the curves")
        check_target(output, rewritten.KIND, inputs, options.force)
    if picture is not None:
        check_target(picture, pictures.kind(picture), inputs, options.force)
    found = fit(options.scene, options.data, vary=options.vary, signals=options.signal, set=overrides)
    written = []
    if output is not None:
        written.append(found.write(output, options.force))
    if picture is not None:
        from .picture import draw

        content = pictures.content(draw(found), picture.suffix, found.scene.title)
        written.append(write_file(picture, content, pictures.kind(picture), inputs, options.force))
    show(found)
    say(*(f"written: {path}" for path in written))
    return 0
