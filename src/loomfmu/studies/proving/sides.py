"""The names that a proof is about: its sides, which vary, and what its claims name.

The prover and the check of its certificates read them alike.
"""

from collections.abc import Iterable

from ...cosim.claims.conditions import Unprovable
from ...cosim.master.grid import contradicted
from ...cosim.planning.pruning import prune
from ...cosim.reading import requested
from ...cosim.scenes.scene import Scene, differing
from ...errors import LoomfmuError
from ...sweeps.varied import Varied

SHAFT, START = "shaft", "start_angle"


def check_side(scene: Scene, about: Varied, ends: Iterable[float]) -> None:
    """Refuse a key that does not move its targets alone, each to the same value (SI). Raises LoomfmuError."""
    refused = f"{about.key} cannot vary in a proof"
    if f"{SHAFT}.{START}" in about.targets:
        raise LoomfmuError(f"{refused}: all shaft angles are proven")
    if about.kind != "Real" or about.needs_scene or not about.targets:
        raise LoomfmuError(f"{refused}: it is not the value of a parameter")
    fed = {wire.sink for wire in scene.wires}
    for end in ends:
        setting = {about.key: about.setting(about.read(about.setting(end)))}
        moved = requested(scene, {**scene.overrides, **setting}, "native").scene
        for name, variable, _before, _after in differing(scene, moved):
            if f"{name}.{variable}" not in about.targets:
                raise LoomfmuError(f"{refused}: {name}.{variable} changes with it")
        for target in about.targets:
            name, _, variable = target.partition(".")
            if (name, variable) not in fed and moved.instances[name].effect(variable) not in (None, end):
                raise LoomfmuError(f"{refused}: {target} keeps a value of its own")


def needed_for(scene: Scene, names: Iterable[str]) -> Scene:
    """Return the scene with the mechanisms alone that give what claims name.

    Raises Unprovable for an input that takes its values from elsewhere, and where an input has another rate
    than its own: runs leave all that depends on it undecided.
    """
    needed = prune(scene, _outputs_of(scene, names), keep_shafts=True).scene
    if wrong := next(iter(contradicted(needed).values()), ""):
        raise Unprovable(wrong)
    return needed


def _outputs_of(scene: Scene, names: Iterable[str]) -> list[str]:
    """Return the outputs among what claims name; all others have their start values throughout."""
    found = []
    fed = {wire.sink for wire in scene.wires} | {(each.instance, each.variable) for each in scene.drives}
    for name in names:
        owner, _, variable = name.partition(".")
        if (owner, variable) in fed:
            raise Unprovable(f"{name} is an input that follows a table or a wire")
        if scene.instances[owner].fmu.ports[variable].causality == "output":
            found.append(name)
    return found
