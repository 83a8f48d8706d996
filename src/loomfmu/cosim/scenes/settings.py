"""The scene's own keys: what is recorded and claimed, tolerances, accuracy and coupling."""

import fnmatch
from collections.abc import Iterable
from typing import Any

from ...errors import LoomfmuError, shown, suggestion
from .graph import Wire, step_order
from .instances import Instance
from .keys import ACCURACY, CHOSEN, COUPLINGS, ITERATED, LAGGED
from .tables import choice, number
from .times import Times


def accuracy(tables: dict[str, Any], times: Times) -> float | None:
    """The accuracy that chooses the steps. Raises LoomfmuError beside what it chooses, or without claims."""
    if ACCURACY not in tables:
        return None
    for key in CHOSEN:
        if key in tables:
            raise LoomfmuError(
                f"{ACCURACY} and {key} are both given: {ACCURACY} chooses the steps; remove one"
            )
    if times.step is not None:
        raise LoomfmuError(
            f"{ACCURACY} chooses the steps in a revolution, but the scene runs by seconds; remove it"
        )
    if not tables.get("claims"):
        raise LoomfmuError(
            f"{ACCURACY} is that of the claims, but the scene has none:"
            " add [[claims]] or set steps_per_revolution"
        )
    return number(tables[ACCURACY], ACCURACY, 1e-12, 1.0)


def coupling(tables: dict[str, Any], instances: dict[str, Instance], wires: list[Wire]) -> str:
    """Return how loops are closed: iterated, unless the scene says otherwise or an FMU is not ours."""
    if "coupling" not in tables:
        _order, closing = step_order(instances, wires)
        return ITERATED if closing and all(each.fmu.trusted for each in instances.values()) else LAGGED
    return choice(tables, "coupling", COUPLINGS)


def recorded(instances: dict[str, Instance], patterns: Any) -> list[str]:
    """The outputs that match one of the patterns, in the order of the scene."""
    if not isinstance(patterns, list):
        raise LoomfmuError(f'record = {shown(patterns)} is not a list such as ["belt.*", "weft.travel"]')
    outputs = dict.fromkeys(_outputs(instances.values()))
    wanted: set[str] = set()
    for pattern in map(str, patterns):
        matched = [pattern] if pattern in outputs else fnmatch.filter(outputs, pattern)
        if not matched and (outputs or pattern != "*"):
            raise LoomfmuError(f"record: no output is called {shown(pattern)}{suggestion(pattern, outputs)}")
        wanted.update(matched)
    return [output for output in outputs if output in wanted]


def _outputs(instances: Iterable[Instance]) -> Iterable[str]:
    for each in instances:
        for port in each.fmu.ports.values():
            if port.causality == "output":
                yield f"{each.name}.{port.name}"


def claims(tables: Any) -> list[dict[str, Any]]:
    """The tables of the claims."""
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise LoomfmuError("claims are written as [[claims]] tables")
    return tables


def tolerances(table: Any) -> dict[str, tuple[Any, Any]]:
    """The ends between which values may lie, by their keys."""
    if not isinstance(table, dict):
        raise LoomfmuError(
            'tolerances are a table, such as [tolerances] "belt.guide_clearance" = ["0.2 mm", "0.5 mm"]'
        )
    for key, ends in table.items():
        if isinstance(ends, dict):
            name = f"{key}.{next(iter(ends), 'VARIABLE')}"
            raise LoomfmuError(
                f'tolerances: write the whole key in quotes, such as "{name}" = ["LOW", "HIGH"]'
            )
        if not (isinstance(ends, list) and len(ends) == 2):
            raise LoomfmuError(
                f'tolerances: {key} = {shown(ends)} must be two ends such as ["0.2 mm", "0.5 mm"]'
            )
    return {key: (ends[0], ends[1]) for key, ends in table.items()}
