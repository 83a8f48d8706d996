"""Contact of a cam and its roller: force, Hertz's pressure on a line, speed at which the surfaces pass.

H. Hertz, Journal fuer die reine und angewandte Mathematik 92 (1881) 156: two cylinders of radii R1 and R2 and
of one width b touch along a strip of half-width a under the force N,

    1 / R = 1 / R1 + 1 / R2,   1 / E' = (1 - nu^2) (1 / E1 + 1 / E2)
    p = sqrt(N E' / (pi b R)),   a = sqrt(4 N R / (pi b E'))

for flawless bodies, dry, aligned over their width, and large against the strip.
"""

from dataclasses import dataclass

import numpy as np

from .cam import Cam, Floats
from .quantities import Quantity, read
from .rocker_cam import RockerCam

POISSON = 0.3  # of steel


@dataclass(frozen=True)
class Contact:
    """The contact at the even angles of the cam's turn.

    `force` presses cam and roller together [N]; where it is negative the roller would lift off, or its
    counter-cam takes over, and `pressure` [Pa] and `half_width` [m] are 0. `sliding_speed` is that of the
    cam's surface on a roller that does not turn [m/s]; one that turns rolls at this speed.
    """

    angle: Floats
    force: Floats
    pressure: Floats
    half_width: Floats
    sliding_speed: Floats

    @property
    def highest_pressure(self) -> float:
        """Highest pressure in a turn [Pa]."""
        return float(self.pressure.max())

    def endures(self, allowed: Quantity) -> bool:
        """Return whether the pressure stays within what the softer of both bodies endures, `allowed` [Pa].

        It says nothing of a roller that lifts off, which a negative `force` shows, and comes down again.
        """
        return self.highest_pressure <= read("contact_pressure", allowed)


def radial_contact(
    cam: Cam,
    *,
    speed: Quantity,
    mass: Quantity,
    load: Quantity,
    width: Quantity,
    acceleration: Quantity = 0.0,
    modulus: Quantity = "206 GPa",
    roller_modulus: Quantity = "206 GPa",
) -> Contact:
    """Contact of a cam whose roller moves on a radial guide without friction.

    With r the radius of the roller's path over the cam's angle, `r' / r` is the tangent of the pressure angle
    and r'' follows from the path's curvature. The cam turns at w, with the acceleration a. The force is
    `(load + mass (r'' w^2 + r' a)) / cos(pressure angle)`.

    Args:
        cam: from `cam.design_cam`
        speed: of the main shaft [rad/s]; the cam turns at half of it
        mass: of all that the roller moves, reduced to it [kg]
        load: that presses the roller towards the cam's centre, such as a spring's [N]
        width: of the narrower of cam and roller [m]
        acceleration: of the main shaft [rad/s2]; the cam has half of it
        modulus, roller_modulus: of elasticity [Pa]; Poisson's ratio is 0.3

    >>> from .cam import design_cam
    >>> still = radial_contact(design_cam(), speed=0.0, mass="15 kg", load="1 kN", width="20 mm")
    >>> round(1e-6 * still.highest_pressure)  # MPa
    338
    """
    turning = 0.5 * read("speed", speed)
    radius = np.hypot(cam.path[:, 0], cam.path[:, 1])
    first = radius * np.tan(cam.pressure_angle)
    along = np.hypot(radius, first)
    second = (radius**2 + 2.0 * first**2 - along**3 / (cam.curvature_radius + cam.roller_radius)) / radius
    moved = second * turning**2 + first * 0.5 * read("acceleration", acceleration)
    pressed = read("contact_load", load) + read("moved_mass", mass) * moved
    passing = turning * (along - cam.roller_radius)
    return _contact(cam, pressed / np.cos(cam.pressure_angle), passing, width, modulus, roller_modulus)


def rocker_contact(
    cam: RockerCam,
    *,
    speed: Quantity,
    inertia: Quantity,
    torque: Quantity,
    width: Quantity,
    modulus: Quantity = "206 GPa",
    roller_modulus: Quantity = "206 GPa",
) -> Contact:
    """Contact of a cam whose roller sits on a rocker.

    The force is `(torque + inertia psi'' w^2) / (arm cos(pressure angle))`. A cam and its counter-cam on one
    rocker have the same inertia and torques of opposite signs: each bears where its force is positive.

    Args:
        cam: from `rocker_cam.design_rocker_cam`
        speed: of the main shaft [rad/s]; the cam turns at half of it
        inertia: of the rocker and all that it moves, about its pivot [kg m2]
        torque: that presses the roller towards the cam [N m]
        width, modulus, roller_modulus: as for `radial_contact`
    """
    turning = 0.5 * read("speed", speed)
    _share, slope, bend = cam.law(cam.angle)
    moment = read("contact_torque", torque) + read("moved_inertia", inertia) * cam.swing * bend * turning**2
    centre = cam.path[:, 0] + 1j * cam.path[:, 1]
    reach = cam.distance * np.exp(1j * cam.angle) - centre
    swung = (1.0 if cam.trailing else -1.0) * cam.swing * slope  # turn of the arm, in the sense of the cam's
    along = np.abs(centre - swung * reach)
    passing = turning * (along - cam.roller_radius * (1.0 + swung))
    force = moment / (cam.arm * np.cos(cam.pressure_angle))
    return _contact(cam, force, passing, width, modulus, roller_modulus)


def _contact(
    cam: Cam | RockerCam,
    force: Floats,
    passing: Floats,
    width: Quantity,
    modulus: Quantity,
    roller_modulus: Quantity,
) -> Contact:
    """Hertz's contact of a cam and its roller under a force at each angle."""
    softness = (1.0 - POISSON**2) * (1.0 / read("modulus", modulus) + 1.0 / read("modulus", roller_modulus))
    curvature = 1.0 / cam.roller_radius + 1.0 / cam.curvature_radius
    line = np.maximum(force, 0.0) / (np.pi * read("contact_width", width))
    return Contact(
        angle=cam.angle,
        force=force,
        pressure=np.sqrt(line * curvature / softness),
        half_width=np.sqrt(4.0 * line * softness / curvature),
        sliding_speed=passing,
    )
