"""The tolerances of a scene: ends between which a value may lie, or how it is distributed."""

from typing import Any

from ...errors import LoomfmuError, shown, suggestion

ENDS = 'two ends such as ["0.2 mm", "0.5 mm"]'
DISTRIBUTION = {  # the keys of a table, and what each must be
    "normal": 'a mean and a standard deviation such as ["0.35 mm", "0.05 mm"]',
    "uniform": ENDS,
    "measured": "the name of a CSV file",
    "within": ENDS,
}


def tolerances_of(table: Any) -> dict[str, Any]:
    """The ends between which values may lie, or tables that say how they are distributed, by their keys."""
    if not isinstance(table, dict):
        raise LoomfmuError(
            'tolerances are a table, such as [tolerances] "belt.guide_clearance" = ["0.2 mm", "0.5 mm"]'
        )
    for key, ends in table.items():
        if isinstance(ends, dict) and "." not in key:
            name = f"{key}.{next(iter(ends), 'VARIABLE')}"
            raise LoomfmuError(
                f'tolerances: write the whole key in quotes, such as "{name}" = ["LOW", "HIGH"]'
            )
        if not (isinstance(ends, dict) or _is_pair(ends)):
            raise LoomfmuError(f"tolerances: {key} = {shown(ends)} must be {ENDS}")
        if isinstance(ends, dict):
            _check_distribution(f"tolerances: {key}", ends)
    return {key: ends if isinstance(ends, dict) else (ends[0], ends[1]) for key, ends in table.items()}


def _is_pair(given: Any) -> bool:
    return isinstance(given, list) and len(given) == 2


def _check_distribution(where: str, table: dict[str, Any]) -> None:
    """Refuse a table that does not say in one way how a value is distributed."""
    for key, given in table.items():
        if key not in DISTRIBUTION:
            raise LoomfmuError(f"{where} has no {key!r}{suggestion(key, DISTRIBUTION)}")
        if not (isinstance(given, str) if key == "measured" else _is_pair(given)):
            raise LoomfmuError(f"{where}: {key} = {shown(given)} must be {DISTRIBUTION[key]}")
    kinds = [key for key in table if key != "within"]
    if len(kinds) != 1 or ("within" in table and kinds != ["normal"]):
        raise LoomfmuError(f"{where} must be either normal, perhaps within two ends, or uniform, or measured")


def ends_of(tolerance: Any) -> tuple[Any, Any] | None:
    """The ends that a tolerance states, if it does."""
    if isinstance(tolerance, tuple):
        return tolerance[0], tolerance[1]
    found = tolerance.get("uniform") or tolerance.get("within")
    return (found[0], found[1]) if found else None
