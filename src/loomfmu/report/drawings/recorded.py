"""Recorded mechanisms as components with their parameters."""

from collections.abc import Callable
from dataclasses import fields
from typing import Any

import numpy as np

from ...errors import LoomfmuError
from .tracks import Tracks

SHAFT = ("follow_shaft", "speed", "start_angle", "inputs_at_step_end")  # parameters of where the shaft stands
AGREES = 1e-6  # m by which a recorded signal may differ from the component's
COMPARED = 50  # samples at which they are compared


def follows(tracks: Tracks, instance: str, kind: Callable[[], Any], signal: str) -> Any:
    """A component with the recorded parameters of an instance, moved by `start_angle`.

    None unless it is the shaft's angle alone that moves it: unless it has the recorded signal there.
    """
    component, trace = kind(), tracks.trace
    if not tracks.subject.turns:
        return None
    for each in fields(component):
        if each.name in SHAFT:
            continue
        try:
            value = tracks.parameter(f"{instance}.{each.name}")
        except LoomfmuError:
            continue  # an input or an output
        setattr(component, each.name, type(getattr(component, each.name))(value))
    component.follow_shaft, component.speed = False, 0.0
    if component.initialize(0.0) != 0:
        return None
    recorded = trace[f"{instance}.{signal}"]
    for place in np.linspace(0, trace.rows - 1, COMPARED).astype(int):
        component.start_angle = float(trace.shaft_angle[place])
        component.step(0.0, 0.0)
        if not abs(getattr(component, signal) - recorded[place]) < AGREES:
            return None
    return component
