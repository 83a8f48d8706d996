"""The load cases of a study: values under which every design is run, and the worst of them counts."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Any

from ...cosim.scenes.scene import Scene
from ...cosim.scenes.tolerances import ends_of
from ...errors import LoomfmuError, shown
from ...sweeps.axes import flattened
from ...sweeps.header import Header
from ...sweeps.varied import Varied, varied
from ..tolerances.distributions import distribution_of

CORNERS = "corners"
MOST = 64  # cases


@dataclass(frozen=True)
class Case:
    """A load case: its name, and its settings of the scene; `doubts` warn of their units."""

    name: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    doubts: tuple[str, ...] = ()

    def and_(self, other: Case) -> Case:
        """Both at once."""
        name = ", ".join(filter(None, (self.name, other.name)))
        return Case(name, {**self.settings, **other.settings}, (*self.doubts, *other.doubts))


def cases_of(head: Header, tables: dict[str, Any], taken: Collection[str]) -> tuple[Case, ...]:
    """Read the cases of a study; none if it states none. None sets what is `taken`.

    Raises LoomfmuError for what they cannot set.
    """
    given = tables.get("cases", [])
    if not isinstance(given, list) or not all(isinstance(each, dict) for each in given):
        raise LoomfmuError("cases are written as [[cases]] tables")
    stated = [_case(head, table, number) for number, table in enumerate(given, 1)]
    corners = _corners(head.scene) if _wants_corners(tables) else []
    found = [one.and_(other) for one, other in product(stated or [Case("")], corners or [Case("")])]
    if found == [Case("")]:
        return ()
    if len(found) > MOST:
        raise LoomfmuError(f"{len(found)} cases; the limit is {MOST}")
    names = [each.name for each in found]
    if twice := next((name for name in names if names.count(name) > 1), ""):
        raise LoomfmuError(f"two cases are called {shown(twice)}")
    for case in found:
        for key in case.settings:
            if both := {*varied(head.scene, key).targets} & {*taken}:
                raise LoomfmuError(
                    f"case {shown(case.name)} sets {min(both)}, which the study varies or fixes already"
                )
    return tuple(found)


def _case(head: Header, table: dict[str, Any], number: int) -> Case:
    name = table.get("name", f"case {number}")
    if not isinstance(name, str) or not name:
        raise LoomfmuError(f"cases: name = {shown(name)} is not a name in quotes")
    where = f"case {shown(name)}"
    given = flattened({key: value for key, value in table.items() if key != "name"}, where)
    if not given:
        raise LoomfmuError(f'{where} sets nothing; give it values, such as "shaft.speed" = "450 rpm"')
    settings, doubts = dict[str, Any](), list[str]()
    for key, value in given.items():
        try:
            variable = varied(head.scene, key)
            settings[key] = variable.setting(variable.read(value))
            doubts.append(variable.doubt(value))
        except LoomfmuError as error:
            raise LoomfmuError(f"{where}: {error}") from None
    return Case(name, settings, tuple(filter(None, doubts)))


def _wants_corners(tables: dict[str, Any]) -> bool:
    wanted = tables.get("tolerances")
    if wanted not in (None, CORNERS):
        raise LoomfmuError(f'tolerances = {shown(wanted)} must be "{CORNERS}"')
    return wanted is not None


def _corners(scene: Scene) -> list[Case]:
    """The scene's own values, and the corners of its tolerances."""
    if not scene.tolerances:
        raise LoomfmuError(f'tolerances = "{CORNERS}", but the scene states no [tolerances]')
    ends = [_ends(scene, key) for key in scene.tolerances]
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
    variable, stated = varied(scene, key), ends_of(scene.tolerances[key])
    if stated is None:
        ends = distribution_of(scene, key, scene.tolerances[key]).ends
        if math.isinf(ends[1] - ends[0]):
            raise LoomfmuError(f'tolerances: {key} is normal without ends; add within = ["LOW", "HIGH"]')
        return [(variable, end) for end in ends]
    return [(variable, float(variable.read(end))) for end in stated]
