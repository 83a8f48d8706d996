"""The load cases that a study file states."""

from collections.abc import Collection
from itertools import product
from typing import Any

from ...cosim.scenes.settings import several
from ...errors import LoomfmuError, shown, within
from ...sweeps.axes import flattened
from ...sweeps.header import Header
from ...sweeps.varied import varied
from ..cases import MOST, Case
from ..corners import corners_of

CORNERS = "corners"


def cases_of(head: Header, tables: dict[str, Any], taken: Collection[str]) -> tuple[Case, ...]:
    """Read the cases of a study; none if it states none. None sets what is `taken`.

    Raises LoomfmuError for what they cannot set.
    """
    given = tables.get("cases", [])
    if not isinstance(given, list) or not all(isinstance(each, dict) for each in given):
        raise LoomfmuError(several("cases"))
    stated = [_case(head, table, number) for number, table in enumerate(given, 1)]
    corners = corners_of(head.scene) if _wants_corners(tables) else []
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
        with within(where):
            variable = varied(head.scene, key)
            settings[key] = variable.setting(variable.read(value))
            doubts.append(variable.doubt(value))
    return Case(name, settings, tuple(filter(None, doubts)))


def _wants_corners(tables: dict[str, Any]) -> bool:
    wanted = tables.get("tolerances")
    if wanted not in (None, CORNERS):
        raise LoomfmuError(f'tolerances = {shown(wanted)} must be "{CORNERS}"')
    return wanted is not None
