"""A whole scene as one native FMU for other tools."""

import re
from collections.abc import Collection
from pathlib import Path

from ..errors import LoomfmuError
from ..files import check_target, write_file
from ..fmi.fmu_files import FMU, zipped
from ..fmi.native.c_code import KEYWORDS
from ..fmi.native.platforms import PLATFORMS
from ..fmi.system.system import Drive, Part, System
from ..fmi.system.system_fmu import contents
from .planning.pruning import prune
from .planning.requested import Requested
from .reading import checked_claims
from .scenes.graph import step_order
from .scenes.headings import heading
from .scenes.instances import Instance
from .scenes.scene import Scene, files_of
from .scenes.settings import ITERATED


def export(
    scene: Scene,
    path: Path,
    platforms: tuple[str, ...] = tuple(PLATFORMS),
    fmi: int = 2,
    overwrite: bool = False,
) -> list[str]:
    """Write a scene as one native FMU of FMI 2 or FMI 3, and return warnings.

    It gives what the scene records and what its claims need, and holds only the instances that this takes.
    The same scene gives the same bytes. `overwrite` replaces a file that is not an FMU of ours.

    Raises:
        LoomfmuError: the scene has third-party FMUs or a lagged loop, a component does not translate, no
            compiler is installed, or the file cannot be written
    """
    scene = checked_claims(scene).scene
    inputs = files_of(scene)
    check_target(path, FMU, inputs, overwrite)  # before the FMU is compiled
    made = system(scene)
    if made.closing and scene.coupling != ITERATED:
        sink, source = made.closing[0]
        raise LoomfmuError(
            f"loop: {source} -> {sink} is {scene.coupling}, and one FMU of a whole scene iterates:"
            f" set coupling = {ITERATED!r}"
        )
    write_file(path, zipped(contents(made, platforms, fmi)), FMU, inputs, overwrite)
    return [*scene.notes]


def system(scene: Scene, whole: str = "one FMU of a whole scene", instead: str = "use --ssp") -> System:
    """Return a scene's components as one system. Raises LoomfmuError for a scene that cannot be one.

    `whole` is what messages call it, `instead` what they advise.
    """
    requested = Requested(scene)
    signals = requested.needed(requested.claims, requested.recorded)
    needed = prune(scene, signals, keep_shafts=True).scene
    order, _closing = step_order(needed.instances, needed.wires)
    parts = tuple(
        _part(needed.instances[name], f"{whole} is made of components alone: {instead}") for name in order
    )
    return System(
        name=_identifier(scene.name, {part.component.__name__ for part in parts}),
        title=heading(scene),
        description=scene.description,
        parts=parts,
        wires={".".join(wire.sink): ".".join(wire.source) for wire in needed.wires},
        drives={
            f"{drive.instance}.{drive.variable}": Drive(drive.periods, drive.values, drive.held)
            for drive in needed.drives
        },
        outputs=frozenset(signals),
        experiment=(scene.steps * scene.step_size, scene.step_size),
        steps=0 if scene.step else int(scene.steps_per_period),
        step=scene.step or 0.0,
    )


def _part(instance: Instance, rule: str) -> Part:
    fmu = instance.fmu
    if fmu.component is None or not fmu.built:
        raise LoomfmuError(f"{instance.name} is an FMU file, {fmu.path}; {rule}")
    return Part(instance.name, fmu.component, instance.values)


def _identifier(name: str, taken: Collection[str]) -> str:
    """The name of a scene as one that C takes, and no component has."""
    word = re.sub(r"[^A-Za-z0-9_]", "_", name)
    word = word if word[:1].isalpha() else f"scene_{word}"
    return f"{word}_scene" if word in taken or word in KEYWORDS else word
