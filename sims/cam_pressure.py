"""A claim on the pressure between the cam of a spline-cam dobby and its roller."""

import math

from loomfmu.claim import Name, OwnClaim, Quantity, Signals, argument
from loomfmu.design import cam, contact


class CamPressure(OwnClaim):
    """Hertz's pressure between a cam and its roller, which moves one frame, at the speeds of a run."""

    at_most: float = argument(Quantity("Pa", "MPa"))
    load: float = argument(Quantity("N"))
    width: float = argument(Quantity("m", "mm"))
    shaft: str = argument(Name(), "shaft")
    heald: str = argument(Name(), "heald_1")

    needs = ("shaft.velocity", "heald.lift")

    def value(self, run: Signals) -> float:
        """Return the highest pressure [Pa]; NaN where the roller lifts off."""
        profile = cam.design_cam()  # Korolev, Appendix 2
        stroke, mass = (run.parameter(f"{self.heald}.{name}") for name in ("stroke", "frame_mass"))
        lever = stroke / (profile.highest_radius - profile.lowest_radius)
        speed = run[f"{self.shaft}.velocity"]
        # at any angle the force is linear in the square of the speed: it is highest at an end of its range
        contacts = [
            contact.radial_contact(
                profile, speed=each, mass=mass * lever**2, load=self.load, width=self.width
            )
            for each in (float(speed.min()), float(speed.max()))
        ]
        if min(each.force.min() for each in contacts) <= 0.0:
            return math.nan  # how the roller comes down, Hertz does not say
        return max(each.highest_pressure for each in contacts)
