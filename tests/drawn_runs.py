"""Runs in memory of signals that are drawn, not stepped."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from loomfmu.traces import Channel, Recording

DISPLAY = {"m": "mm", "rad": "deg", "rad/s": "rev/min"}
# of each signal its unit, its samples and perhaps what else is known of it
Drawn = Mapping[str, tuple[Any, ...]]


def drawn(
    time: np.ndarray, signals: Drawn, parameter: Any = lambda _owner, _name: None, *run: Any
) -> Recording:
    """A run of these signals over time [s]; those of truth values are yes-or-no signals.

    `parameter` gives the parameters of its instances, `run` are its wires and FMUs.
    """
    channels, columns = list[Channel](), {True: list[np.ndarray](), False: list[np.ndarray]()}
    for name, (unit, samples, *about) in signals.items():
        real = np.asarray(samples).dtype != bool
        more = {"real": real, "boolean": not real} | (about[0] if about else {})
        display = DISPLAY.get(unit, unit)
        channels.append(Channel(*name.split("."), unit, display, name, len(columns[real]), **more))
        columns[real].append(samples)
    reals, flags = (np.array(each).reshape(-1, len(time)).T for each in (columns[True], columns[False]))
    made = Recording("drawn", channels, parameter, *run)
    angle = signals["shaft.angle"][1] if "shaft.angle" in signals else 0.0 * time
    made.append(time, angle, np.array(reals, order="C", dtype=float), np.array(flags, order="C", dtype="i4"))
    return made


def turning(angle: np.ndarray, velocity: np.ndarray | float, acceleration: Any = None) -> Drawn:
    """The signals of a shaft, with samples of its acceleration or without."""
    whole = 0.0 * angle
    shaft = {
        "shaft.angle": ("rad", angle, {"rate": "velocity"}),
        "shaft.velocity": (
            "rad/s",
            velocity + whole,
            {"rate": None if acceleration is None else "acceleration"},
        ),
    }
    return shaft if acceleration is None else shaft | {"shaft.acceleration": ("rad/s2", acceleration + whole)}
