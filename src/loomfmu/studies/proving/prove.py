"""`prove`: claims for all shaft angles of a run and all values of a box, proven, refuted or left open."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...cosim.claims.claims import name_of
from ...cosim.prepared import Prepared
from ...cosim.reading import requested
from ...cosim.scenes.scene import Scene
from ...errors import LoomfmuError, shown
from ..span import Span, set_twice, span_of, warnings_of
from .enclosed import LARGEST_BOX
from .proofs import Proofs
from .search import MOST, Search
from .sides import check_side


def prove(
    scene: str | Path | Scene,
    *,
    over: Sequence[str] = (),
    set: dict[str, Any] | None = None,  # the command's own word
    claims: Sequence[str] | None = None,
    boxes: int = MOST,
) -> Proofs:
    """Prove claims of a scene for all shaft angles of its revolutions, and all values of a box.

    Proven is what the equations of the mechanisms say, in real numbers. Claims on mechanisms with a memory
    cannot be proven.

    Args:
        scene, set: as for `run`
        over: parameters that vary together, each with its range, such as "shaft.speed=300rpm..640rpm"
        claims: names of those to be proven; all of them by default
        boxes: so many are looked at for one condition, before it is left open

    Raises:
        LoomfmuError: bad input, or a claim that is not there
    """
    asked = requested(scene, set, "native")
    texts = [over] if isinstance(over, str) else list(over)
    for text in texts:
        if isinstance(text, str) and "=" not in text:
            form = "write INSTANCE.VARIABLE=LOW..HIGH, such as shaft.speed=300rpm..640rpm"
            raise LoomfmuError(f"a proof over {text} needs a range; {form}")
    sides = [span_of(asked.scene, text, option="a proof over") for text in texts]
    check_sides(asked.scene, sides)
    names = [name_of(table) for table in asked.scene.claims]
    for name in claims or ():
        if name not in names:
            raise LoomfmuError(f"the scene has no claim {shown(name)}; it has {', '.join(names)}")
    if boxes < 1:
        raise LoomfmuError(f"boxes = {boxes} is not a number of boxes")
    wanted = [number for number, name in enumerate(names) if claims is None or name in claims]
    with Prepared(asked.scene, None, "native", ()) as loom:
        search = Search(loom, sides, boxes)
        found = [search.proof(number, names[number]) for number in wanted]
    return Proofs(asked.scene, tuple(sides), tuple(found), warnings_of(sides, asked.scene.notes))


def check_sides(scene: Scene, sides: Sequence[Span]) -> None:
    """Refuse what cannot vary in a proof, alone or together. Raises LoomfmuError."""
    if len(sides) >= LARGEST_BOX:
        raise LoomfmuError(f"{len(sides)} values vary; in a proof, at most {LARGEST_BOX - 1} can together")
    if twice := set_twice(sides):
        raise LoomfmuError(f"{twice[0].key} and {twice[1].key} both set {twice[2]}")
    for side in sides:
        check_side(scene, side.varied, (side.low, side.high))
