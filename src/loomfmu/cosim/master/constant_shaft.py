"""A main shaft of constant speed, which needs no FMU."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ConstantShaft:
    """A main shaft that needs no FMU. Its values are those that `MainShaft` gives, to the last bit."""

    speed: float
    start_angle: float

    def values(self, variable: str, time: Floats) -> Floats | float:
        """An output of the shaft along times [s]; one number where it is the same at all of them."""
        if variable == "angle":
            return self.start_angle + self.speed * time
        return self.speed if variable == "velocity" else 0.0
