"""A whole scene as one native FMU for other tools."""

import re
from collections.abc import Collection
from pathlib import Path

from ..declaring.variables import Component, variables_of
from ..errors import LoomfmuError
from ..files import check_target, write_file
from ..fmi.fmu_files import FMU, zipped
from ..fmi.native.c_code import KEYWORDS
from ..fmi.native.platforms import PLATFORMS
from ..fmi.system.system import Drive, Part, System, component_of
from ..fmi.system.system_fmu import contents
from .master.grid import uniform
from .planning.plan import Stepping
from .planning.pruning import prune
from .planning.requested import Requested
from .reading import checked_claims
from .scenes.graph import step_order
from .scenes.headings import heading
from .scenes.instances import Instance, altered
from .scenes.scene import Scene, files_of
from .scenes.settings import ITERATED

LINES = 200  # of the reference results


def export(
    scene: Scene,
    path: Path,
    platforms: tuple[str, ...] = tuple(PLATFORMS),
    fmi: int = 2,
    overwrite: bool = False,
) -> list[str]:
    """Write a scene as one native FMU of FMI 2 or FMI 3, and return warnings.

    It gives what the scene records and what its claims need, and holds only the instances that this takes.
    The results of a revolution go with it.
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
    reference, warnings = None, [*scene.notes]
    try:
        reference = _reference(scene, component_of(made))
    except LoomfmuError as error:  # other values may do
        warnings.append(f"the FMU has no reference results, since the scene cannot run: {error}")
    write_file(path, zipped(contents(made, platforms, fmi, reference)), FMU, inputs, overwrite)
    return warnings


def _reference(scene: Scene, component: type[Component]) -> bytes:
    """The outputs along a revolution, or `LINES` steps of a scene in seconds, in at most so many lines."""
    each = round(scene.steps_per_period) if scene.step is None else LINES
    steps = min(scene.steps, each)
    stride = -(-steps // LINES)
    periods = steps // stride * stride / scene.steps_per_period
    shorter = altered(scene, periods=periods, accuracy=None)
    outputs = {v.structured: v.name for v in variables_of(component) if v.causality == "output"}
    stepping = Stepping(Requested(shorter), tuple(outputs.values()))
    found = stepping.in_memory(shorter, uniform(shorter)).recording
    columns = [found.time, *(1 * found[name] for name in outputs.values())]  # yes and no as 1 and 0
    rows = zip(*(column[::stride].tolist() for column in columns), strict=True)
    lines = [",".join(["time", *outputs]), *(",".join(map(repr, row)) for row in rows)]
    return "".join(f"{line}\n" for line in lines).encode()


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
