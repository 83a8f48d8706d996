"""The corners of a scene's tolerances, as cases."""

from collections.abc import Collection, Sequence
from itertools import product

from ..cosim.scenes.scene import Scene
from ..errors import LoomfmuError
from ..sweeps.varied import Varied, varied
from .cases import MOST, Case
from .tolerances.distributions import ends_within


def corners_of(scene: Scene, apart: Collection[str] = ()) -> list[Case]:
    """Return the scene's own values, and the corners of its tolerances, but those that set one `apart`.

    Raises LoomfmuError where there are none, too many, or one without ends.
    """
    keys = [key for key in scene.tolerances if not {*varied(scene, key).targets} & {*apart}]
    if not keys:
        more = " of anything else" if scene.tolerances else ""
        raise LoomfmuError(f"corners: the scene states no [tolerances]{more}")
    ends = [_ends(scene, key) for key in keys]
    if 2 ** len(ends) >= MOST:
        raise LoomfmuError(f"{len(ends)} tolerances have {2 ** len(ends)} corners; the limit is {MOST} cases")
    corners = [
        Case(
            ", ".join(f"{each.key} = {each.show(value)}" for each, value in corner),
            {each.key: each.setting(value) for each, value in corner},
        )
        for corner in product(*ends)
    ]
    return [Case("own values"), *corners]


def _ends(scene: Scene, key: str) -> Sequence[tuple[Varied, float]]:
    """A variable with a tolerance, at both ends of this."""
    variable, ends = varied(scene, key), ends_within(scene, key)
    if ends is None:
        raise LoomfmuError(f'tolerances: {key} is normal without ends; add within = ["LOW", "HIGH"]')
    return [(variable, float(variable.read(end))) for end in ends]
