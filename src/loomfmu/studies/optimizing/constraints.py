"""The constraints of a study: which claims must hold, and how far from their bounds."""

from collections.abc import Sequence
from typing import Any

from ... import units
from ...cosim.scenes.scene import Scene
from ...errors import LoomfmuError, shown, suggestion


def names_of(scene: Scene) -> list[str]:
    """Return the study's names of the claims of its scene."""
    return [str(claim.get("name") or f"claim_{number + 1}") for number, claim in enumerate(scene.claims)]


def _check_claim(name: Any, names: Sequence[str], where: str) -> None:
    if name not in names:
        known = suggestion(str(name), names)
        raise LoomfmuError(f"{where}: the scene has no claim {shown(name)}{known}")


def required_of(scene: Scene, given: Any) -> tuple[bool, ...]:
    """Return which claims must hold: all but those that are named."""
    if not isinstance(given, list):
        raise LoomfmuError(f"except = {shown(given)} must be a list of claims by their names")
    names = names_of(scene)
    for name in given:
        _check_claim(name, names, "except")
    return tuple(name not in given for name in names)


def safety_of(
    scene: Scene, given: Any, required: Sequence[bool]
) -> tuple[tuple[float, ...], tuple[str, ...]]:
    """Return the distances of claims from their bounds: shares of bounds, and amounts in claims' units."""
    names = names_of(scene)
    if not scene.claims and given:
        raise LoomfmuError(f"safety = {shown(given)}, but the scene has no claims")
    free = [name for name, needed in zip(names, required, strict=True) if not needed]
    table = given if isinstance(given, dict) else {name: given for name in names if name not in free}
    for name in table:
        _check_claim(name, names, "safety")
        if name in free:
            raise LoomfmuError(
                f"safety.{name!r}: except says that this claim may fail; leave out one of them"
            )
    shares, amounts = [], []
    for name in names:
        share, amount = _distance(table.get(name, 0.0), name if isinstance(given, dict) else "")
        shares.append(share)
        amounts.append(amount)
    return tuple(shares), tuple(amounts)


def _distance(given: Any, name: str) -> tuple[float, str]:
    where = f"safety.{name!r}" if name else "safety"
    try:
        share, amount = units.parse(given, "1"), ""
    except units.UnitError as error:
        if not isinstance(given, str) or not name:
            raise LoomfmuError(f"{where}: {error}; give a share of the bound, such as '2 %'") from None
        share, amount = 0.0, given
    if units.is_plain(given) and share > 1.0:
        raise LoomfmuError(f'{where} = {share:g} is {share:.0%} of the bound; write "{share:g} %"')
    if not 0.0 <= share < 1000.0:
        raise LoomfmuError(f"{where} = {share:g} is outside [0, 1000]")
    return share, amount
