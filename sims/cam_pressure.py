"""A claim on the pressure between the cam of a spline-cam dobby and its roller."""

import itertools
import math

import numpy as np

from loomfmu.claim import Name, OwnClaim, Quantity, Signals, argument
from loomfmu.design import cam, contact


class CamPressure(OwnClaim):
    """Hertz's pressure between a cam and its roller, which moves one frame, at the speeds of a run."""

    at_most: float = argument(Quantity("Pa", "MPa"))
    load: float = argument(Quantity("N"))
    width: float = argument(Quantity("m", "mm"))
    shaft: str = argument(Name(), "shaft")
    heald: str = argument(Name(), "heald_1")

    needs = ("shaft.velocity", "shaft.acceleration", "heald.lift")

    def value(self, run: Signals) -> float:
        """Return the highest pressure [Pa] at any speed and acceleration of the run.

        NaN where the roller may lift off: how it comes down, Hertz does not say.
        """
        profile = cam.design_cam()  # Korolev, Appendix 2
        stroke, mass = (run.parameter(f"{self.heald}.{name}") for name in ("stroke", "frame_mass"))
        lever = stroke / (profile.highest_radius - profile.lowest_radius)
        signals = (np.abs(run[f"{self.shaft}.velocity"]), run[f"{self.shaft}.acceleration"])
        # the force is linear in the acceleration and the square of the speed: at any angle it is highest, and
        # lowest, at ends of their ranges
        ends = ((float(each.min()), float(each.max())) for each in signals)
        contacts = [
            contact.radial_contact(
                profile,
                speed=speed,
                acceleration=acceleration,
                mass=mass * lever**2,
                load=self.load,
                width=self.width,
            )
            for speed, acceleration in itertools.product(*ends)
        ]
        if min(each.force.min() for each in contacts) <= 0.0:
            return math.nan
        return max(each.highest_pressure for each in contacts)
