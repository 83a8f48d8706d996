"""The sides of a proof's box: what may vary. The prover and the check of its certificates read it alike."""

from collections.abc import Iterable

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
