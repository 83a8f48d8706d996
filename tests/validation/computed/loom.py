"""What components of a loom show by themselves, and what moving masses add."""

from functools import cache
from typing import Any

import numpy as np

from loomfmu.components import COMPONENTS
from loomfmu.components.weft_insertion import WeftInsertion
from loomfmu.design.dobby import eccentric_chain
from loomfmu.machines import parameters


@cache
def unconnected(
    component: str, output: str, steps: float = 1, step: float = 0.0
) -> tuple[float, float, float]:
    """First, lowest and last value of an output with nothing wired to the inputs [SI]."""
    of: Any = COMPONENTS[component]()
    of.initialize(0.0)
    values = [float(getattr(of, output))]
    for n in range(int(steps)):
        of.step(step * n, step)
        values.append(float(getattr(of, output)))
    return values[0], min(values), values[-1]


@cache
def weft_peaks(**masses: float) -> tuple[float, float, float]:
    """Mass reduced to the head [kg], largest shaft torque [N m] and kinetic energy [J] at 600 rev/min."""
    given = parameters("WeftInsertion", machine="WL680-3600", head="G6300 left")
    drive = WeftInsertion(**given | masses, speed=20.0 * np.pi)
    drive.initialize(0.0)
    rows = []
    for place in range(1440):
        drive.step(place * 0.1 / 1440, 0.0)
        rows.append((drive.shaft_torque, drive.kinetic_energy, drive.velocity))
    torque, energy, velocity = np.abs(np.array(rows)).T
    return 2.0 * float(energy.max() / velocity.max() ** 2), float(torque.max()), float(energy.max())


def eccentric(share: float) -> tuple[float, float]:
    """Lowest and highest speed ratio of an eccentric chain, its eccentricity a share of the radius."""
    low, high = eccentric_chain(0.06, 0.06, 0.06 * share, 0.6).extremes()
    return low, high
