"""The duration of a scene, and its communication steps."""

import math
from dataclasses import dataclass
from typing import Any

from ... import units
from ...errors import LoomfmuError, listed
from .keys import TIMES
from .tables import number

SLOWEST = 1e-12  # rad/s: below, times overflow
ROUNDING = 1e-9  # of a duration: one that is off by more than that from whole steps is refused


@dataclass(frozen=True)
class Times:
    """A run of `periods`, each in `steps_per_period`: revolutions, or seconds if there is a `step`."""

    periods: float
    steps_per_period: float
    step: float | None = None


EXAMPLES = {"duration": "2 s", "step": "1 ms"}


def times_of(tables: dict[str, Any]) -> Times:
    """Duration and step as the tables of a scene say them. Raises LoomfmuError for a mixture of both ways."""
    given = [key for key in TIMES if key in tables]
    if not {"duration", "step"} & set(given):
        revolutions = number(tables.get("revolutions", 1), "revolutions", 1e-9, 1e9)
        steps = number(tables.get("steps_per_revolution", 1440), "steps_per_revolution", 1, 1e9, whole=True)
        return Times(revolutions, int(steps))
    if len(given) == 1:
        missing = "duration" if given == ["step"] else "step"
        raise LoomfmuError(
            f'{given[0]} is given but not {missing}: say {missing} = "{EXAMPLES[missing]}" as well'
        )
    if set(given) != {"duration", "step"}:
        raise LoomfmuError(
            f"{listed(given)}: a scene runs either by duration and step,"
            " or by revolutions and steps_per_revolution"
        )
    duration, step = (seconds(tables[key], key, 1e-12) for key in ("duration", "step"))
    return Times(duration, 1.0 / step, step)


def seconds(given: Any, key: str, low: float) -> float:
    """A time within bounds [s]."""
    try:
        return number(units.parse(given, "s"), key, low, 1e9)
    except units.UnitError as error:
        raise LoomfmuError(f"{key}: {error}") from None


def check_times(times: Times, speed: float | None) -> None:
    """Refuse times that are not a whole number of steps; `speed` is the shaft's, if there is one [rad/s]."""
    steps = round(times.periods * times.steps_per_period)
    if times.step is not None:
        if steps < 1:
            raise LoomfmuError(
                f"duration = {times.periods:g} s in steps of {times.step:g} s is less than one step"
            )
        _check_whole(times, "duration", " s", f"{times.step:g} s")
        return
    if speed is None:
        raise LoomfmuError(
            'there is no shaft whose speed sets the step: add duration = "2 s" and step = "1 ms"'
        )
    if speed == 0.0:
        raise LoomfmuError("shaft.speed = 0 rev/min: the shaft's speed sets the step, so it must not be 0")
    if abs(speed) < SLOWEST:
        shown = f"{speed / units.unit('rev/min').factor:.7g} rev/min"
        raise LoomfmuError(
            f"shaft.speed = {shown}: one revolution would take {2.0 * math.pi / SLOWEST:.1g} s or more"
        )
    if steps < 1:
        raise LoomfmuError(
            f"revolutions = {times.periods:g} at {times.steps_per_period} steps each is less than one step"
        )
    _check_whole(times, "revolutions", "", f"1/{times.steps_per_period:g} revolution")


def _check_whole(times: Times, key: str, unit: str, step: str) -> None:
    """Refuse a duration that does not end with a step: the run would be shorter or longer."""
    wanted = times.periods * times.steps_per_period
    if abs(wanted - round(wanted)) > ROUNDING * wanted:
        fitting = [n / times.steps_per_period for n in (math.floor(wanted), math.ceil(wanted)) if n]
        raise LoomfmuError(
            f"{key} = {times.periods:.10g}{unit} is {wanted:.7g} steps of {step}, not a whole number of"
            f" steps; these would fit: {' or '.join(f'{each:.10g}{unit}' for each in fitting)}"
        )
