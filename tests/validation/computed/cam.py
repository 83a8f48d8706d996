"""Korolev, the spline cam: Tables 4.1 and 4.2, sections 4.1 and 4.2, Appendices 2 and 3."""

from functools import cache
from types import SimpleNamespace

import numpy as np
from scipy.optimize import minimize_scalar

from loomfmu.components.dobby.drive import DobbyDrive
from loomfmu.design.cam import TURN, Cam, design_cam, published_path
from loomfmu.design.contact import radial_contact
from loomfmu.physics.rotor_laws.shed_cam import SPLINE_CAM
from validation.computed import rotor

FRAME = 6.0  # travel of the frame over the height of the warp, Appendix 2
HEIGHT = 0.015  # m, of the warp above the lowest: what has to be clear of the air stream


@cache
def drive() -> DobbyDrive:
    """The drive with the spline cam, which begins to rise at shaft angle 0, at 1 rad/s."""
    found = DobbyDrive(law=SPLINE_CAM, slow_point=0.0, speed=1.0)
    found.initialize(0.0)
    return found


@cache
def cam() -> Cam:
    """The cam of Appendix 2."""
    return design_cam()


def span() -> float:
    """Largest travel of the frame [m]."""
    return FRAME * drive().cam_span


def peak(order: float, speed: float = 1.0) -> float:
    """Largest derivative of that order of the frame's position by time, at a shaft speed [SI]."""
    of = drive()
    return (
        span() * (of.highest_speed, of.highest_acceleration, of.highest_jerk)[int(order) - 1] * speed**order
    )


def frame(angle: float) -> tuple[float, float, float]:
    """Travel, speed and acceleration of the frame at 1 rad/s [SI]."""
    place, first, second = drive().cam(min(angle, 2.0 * TURN - 1e-12))
    return span() * place, span() * first, span() * second


def outline(curve: str) -> tuple[np.ndarray, np.ndarray]:
    """x and y of the cam's `profile` or `path`, of its `base` circle or the `cutter` in one place [mm]."""
    if curve in ("profile", "path"):
        return tuple(1e3 * getattr(cam(), curve).T)
    x, y = 1e3 * cam().path[len(cam().path) // 8] if curve == "cutter" else (0.0, 0.0)
    radius, turn = 19.0 if curve == "cutter" else 84.0, np.linspace(0.0, TURN, 361)
    return x + radius * np.cos(turn), y + radius * np.sin(turn)


def above() -> float:
    """Shaft angle over which the warp is above 15 mm [rad]."""
    return drive().angle_above(drive().cam_height[0] + HEIGHT)


def lowest() -> float:
    """Lowest position of the frame [m]: the spline dips below its start."""
    found = minimize_scalar(
        lambda x: drive().cam(x)[0], bounds=(0.0, 0.3), method="bounded", options={"xatol": 1e-10}
    )
    return span() * float(found.fun)


def jump() -> float:
    """Jump of the frame's acceleration where two picks join, at 1 rad/s [m/s2]."""
    return FRAME * abs(drive().cam_bend[5] - drive().cam_bend[0])


def faster(law: str) -> float:
    """Largest speed of a frame under a law at zeta = 0.7, over that with the cam at equal stroke."""
    return rotor.largest_lift_rate(law, 0.7, order=1) / drive().highest_speed


def fastest() -> float:
    """The most that a law gives."""
    return max(faster(law) for law in ("uniform", "harmonic ends", "sloped line", "sloped sine"))


@cache
def profile() -> SimpleNamespace:
    """Extremes of the cam of Appendix 2 [m, rad]."""
    of = cam()
    radii, path, bends = np.hypot(*of.profile.T), np.hypot(*of.path.T), of.curvature_radius
    hollow = bends[bends < 0.0]
    return SimpleNamespace(
        lowest=radii.min(),
        highest=radii.max(),
        path_lowest=path.min(),
        path_highest=path.max(),
        rising=of.pressure_angle.max(),
        falling=-of.pressure_angle.min(),
        crest=bends[bends > 0.0].min(),
        hollow=-hollow.max() if hollow.size else "none",
        inside=-of.radial_excess().min(),
    )


def program() -> tuple[float, float, float]:
    """Lowest and highest radius of the program of Appendix 3 less the cutter's, and the lift [m]."""
    radii = np.hypot(*published_path().T) - 0.019
    return float(radii.min()), float(radii.max()), float(np.ptp(radii))


def printed_travel() -> float:
    """Largest travel of the frame with the Y row of Table 4.2 as it is printed [m]."""
    of = DobbyDrive(law=SPLINE_CAM)
    of.cam_height = (*of.cam_height[:4], 0.657, of.cam_height[5])
    of.initialize(0.0)
    return FRAME * of.cam_span


def misfit() -> float:
    """Distance of the program's points from the law, scaled and turned to fit best either way round [m]."""
    points, path = published_path(), cam().path
    angle, radius = np.arctan2(points[:, 1], points[:, 0]), np.hypot(*points.T)
    at, law = np.arctan2(path[:, 1], path[:, 0]) % TURN, np.hypot(*path.T)
    order = np.argsort(at)
    law = radius.min() + (law - law.min()) / np.ptp(law) * np.ptp(radius)

    def off(sense: int, shift: float) -> float:
        found = np.interp((sense * angle + shift) % TURN, at[order], law[order], period=TURN)
        return float(np.max(np.abs(found - radius)))

    return min(off(sense, TURN * k / 720) for sense in (1, -1) for k in range(720))


def contact(speed: float) -> SimpleNamespace:
    """Highest values of the contact of the cam of Appendix 2 with one frame, at a shaft speed [SI]."""
    of = cam()
    mass = 15.0 * (span() / (of.highest_radius - of.lowest_radius)) ** 2
    found = radial_contact(of, speed=speed, mass=mass, load="10 kN", width="30 mm")
    return SimpleNamespace(
        highest_pressure=found.highest_pressure,
        highest_force=float(found.force.max()),
        highest_sliding_speed=float(found.sliding_speed.max()),
    )
