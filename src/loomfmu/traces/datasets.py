"""Signals as xarray datasets: along time, or folded onto one revolution of the main shaft."""

import math
from collections.abc import Mapping
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import units
from ..errors import LoomfmuError, shown

Floats = NDArray[np.float64]
TURN = 2.0 * math.pi
WHOLE = 1e-9  # of a revolution: what a sample may be beside its end


def dataset(
    run: str,
    time: Floats,
    shaft_angle: Floats,
    signals: Mapping[str, tuple[NDArray[Any], dict[str, str]]],
    fold: bool | int,
) -> Any:
    """Values and attributes of some signals as a dataset. Raises LoomfmuError as `Signals.to_xarray`."""
    import xarray

    of_angle = {"units": "rad", "long_name": "shaft angle"}
    of_degrees = {"units": "degree", "long_name": "shaft angle"}
    of_time = {"units": "s", "long_name": "time"}
    coordinates: dict[str, Any]
    variables: dict[str, Any]
    if fold is False:
        coordinates = {
            "time": ("time", time, of_time),
            "shaft_angle": ("time", shaft_angle, of_angle),
            "degrees": ("time", np.degrees(shaft_angle), of_degrees),
        }
        variables = {name: ("time", values, about) for name, (values, about) in signals.items()}
        return xarray.Dataset(variables, coordinates)
    turned, way = _turned(run, shaft_angle)
    first, last = math.ceil(turned[0] - WHOLE), math.floor(turned[-1] + WHOLE)
    if last <= first:
        raise LoomfmuError(f"{run}: no whole revolution is recorded, so there is nothing to fold")
    count = _count(turned, first, last) if fold is True else fold
    if not isinstance(count, Integral) or int(count) < 1:
        raise LoomfmuError(f"fold = {shown(fold)} must be true or a number of angles, 1 or more")
    angles = np.arange(count) / count
    places = (np.arange(first, last)[:, None] + (angles if way > 0 else 1.0 - angles)).ravel()
    dims, shape = ("revolution", "angle"), (last - first, count)

    def folded(values: NDArray[Any]) -> NDArray[Any]:
        return _at(turned, values, places).reshape(shape)

    begun = math.floor(turned[0] + WHOLE)
    coordinates = {
        "revolution": ("revolution", np.arange(first, last) - begun + 1),
        "angle": ("angle", TURN * angles, of_angle),
        "degrees": ("angle", 360.0 * angles, of_degrees),
        "time": (dims, folded(time), of_time),
    }
    variables = {name: (dims, folded(values), about) for name, (values, about) in signals.items()}
    return xarray.Dataset(variables, coordinates)


def attributes(unit: str, description: str) -> dict[str, str]:
    """The attributes of a signal that xarray itself reads from the file of a trace."""
    about = {"UNIT": unit, "units": units.udunits(unit)}
    return about | ({"COMMENT": description} if description else {})


def _turned(run: str, angle: Floats) -> tuple[Floats, int]:
    """The shaft's angle in revolutions, counted the way that it turns. Raises LoomfmuError if it does not."""
    way = 1 if len(angle) and angle[-1] >= angle[0] else -1
    turned = way * angle / TURN
    if len(turned) < 2 or not np.all(np.diff(turned) > 0.0):
        raise LoomfmuError(f"{run}: the shaft does not turn one way throughout, so there is nothing to fold")
    return turned, way


def _count(turned: Floats, first: int, last: int) -> int:
    """Samples in a revolution, the most that one has."""
    edges = np.searchsorted(turned, np.arange(first, last + 1) - WHOLE)
    return int(np.max(np.diff(edges)))


def _at(turned: Floats, values: NDArray[Any], places: Floats) -> NDArray[Any]:
    """Values at these places: those of samples there, and between samples on the line that joins them.

    What is not a real number holds until the next sample.
    """
    end = len(turned) - 1
    after = np.clip(np.searchsorted(turned, places - WHOLE), 0, end)
    there = np.abs(turned[after] - places) <= WHOLE
    before = np.where(there, after, np.maximum(after - 1, 0))
    if values.dtype.kind != "f":
        return values[before]
    found: NDArray[Any] = np.interp(places, turned, values)
    found[there] = values[after[there]]
    return found
