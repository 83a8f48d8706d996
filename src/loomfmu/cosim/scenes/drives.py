"""Inputs that a scene drives along a table: wear that grows, a tension that changes."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import LoomfmuError, shown, suggestion
from ..importing.fmus import Port, Value

Floats = NDArray[np.float64]
ROUNDING = 1e-14  # of a number of revolutions
LATEST = 1e9  # revolutions or seconds: no scene is longer


@dataclass(frozen=True)
class Drive:
    """An input with its values over revolutions, or seconds, held before and after.

    Between them continuous reals lie on straight lines; an integer, a boolean, and a real that its FMU
    declares as discrete, are held until the next one.
    """

    instance: str
    variable: str
    periods: tuple[float, ...]
    values: tuple[Value, ...]
    kind: str = "Real"
    held: bool = False
    doubt: str = ""

    def along(self, revolutions: Floats) -> NDArray[Any]:
        """Values at numbers of revolutions since the start.

        >>> Drive("belt", "guide_clearance", (0.0, 2.0), (1.0, 3.0)).along(np.array([-1.0, 0.5, 9.0]))
        array([1. , 1.5, 3. ])
        >>> Drive("motor", "mode", (0.0, 2.0), (1, 3), "Integer", True).along(np.array([-1.0, 1.9, 2.0]))
        array([1, 1, 3], dtype=int32)
        """
        if not self.held:
            return np.interp(revolutions, self.periods, self.values)
        # to rounding, a communication point on a point of the table is that point
        last = np.searchsorted(self.periods, revolutions * (1.0 + ROUNDING), side="right") - 1
        kind = np.float64 if self.kind == "Real" else np.int32
        return np.array(self.values, dtype=kind)[np.maximum(last, 0)]


def drive(name: str, port: Port, table: Any) -> Drive:
    """A drive from its table in a scene, `[[revolution, value], ...]`, checked and in SI."""
    where = f"inputs.{name}"
    if port.causality != "input":
        raise LoomfmuError(f"{where}: {port.name} is not an input")
    if not isinstance(table, list) or not table:
        raise LoomfmuError(f'{where} = {shown(table)} is not a list such as [[0, "0.3 mm"], [10, "1 mm"]]')
    revolutions: list[float] = []
    values: list[Value] = []
    doubts: list[str] = []
    for row in table:
        if not isinstance(row, list) or len(row) != 2 or isinstance(row[0], bool):
            raise LoomfmuError(f"{where}: {shown(row)} is not a pair [revolution, value]")
        if not isinstance(row[0], int | float):
            raise LoomfmuError(f"{where}: revolution {shown(row[0])} is not a number")
        if revolutions and not row[0] > revolutions[-1]:
            raise LoomfmuError(
                f"{where}: the revolutions must increase; {shown(row[0])} follows {revolutions[-1]:g}"
            )
        if not abs(row[0]) <= LATEST:
            raise LoomfmuError(f"{where}: revolution {shown(row[0])} is not within {LATEST:g}")
        revolutions.append(float(row[0]))
        values.append(port.value(row[1], where))
        doubts.append(port.doubt(row[1], where))
    instance = name.partition(".")[0]
    doubt = next(filter(None, doubts), "")
    held = port.discrete or port.kind != "Real"
    return Drive(instance, port.name, tuple(revolutions), tuple(values), port.kind, held, doubt)


def split(name: str, instances: dict[str, Any]) -> tuple[str, str]:
    """Instance and variable of a name. Raises LoomfmuError where there is no such instance."""
    instance, _, variable = name.partition(".")
    if instance not in instances:
        raise LoomfmuError(
            f"inputs.{name}: there is no instance {instance!r}{suggestion(instance, instances)}"
        )
    return instance, variable
