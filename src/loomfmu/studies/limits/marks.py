"""Limits as marks on the slider of a page."""

from ...cosim.scenes.scene import Scene
from ...live_page.knobs import Knob, Marks
from .limits import limit
from .results import rows


def marks(scene: Scene, knob: Knob) -> Marks:
    """Search for the limits of a scene over the range of a knob.

    Raises LoomfmuError where the scene has no claims, or a value cannot be run.
    """
    found = limit(scene, vary=knob.key, from_=knob.low, to=knob.high, progress=True)
    percent = 100.0 / (knob.high - knob.low)
    texts = tuple(
        f"{claim}: holds {where}"
        for each, (claim, where, *_rest) in zip(found.claims, rows(found), strict=True)
        if each.limits or each.doubts
    )
    return Marks(
        tuple((percent * (each.low - knob.low), percent * (each.high - knob.low)) for each in found.ranges),
        texts or (str(found),),
    )
