"""Peaks of the loads that heald frames put on a rotary dobby: force on a frame, torque on rotor and shaft.

Korolev, thesis on rotary dobbies (Moscow), section 3.2, measured the forces on the output lever, which go
with the force on the frame, and on the modulator's rocker, which go with the torque on the rotor. Its figures
are lost, and the dimensions of lever and rocker are not published.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import pi

from ..components.dobby.drive import DobbyDrive
from ..components.heald_frame import HealdFrame
from ..declaring.variables import variables_of
from ..errors import LoomfmuError, listed
from ..physics.rotor_laws.shed_cam import SPLINE_CAM
from ..physics.warp import eye_pull
from .quantities import Quantity, read, whole

LAWS = next(v.choices for v in variables_of(DobbyDrive) if v.name == "law")
TURN = 4.0 * pi  # two picks, after which a frame that changes at every pick is where it was
# outputs of the dobby that a frame takes
FOLLOWED = (*HealdFrame.terminals[0].variables, "rotor_ratio", "lift_slope")
PLACES = 180  # in two picks; the crests of force and torque lie several of them apart
WITHIN = 1e-9  # rad, by which the place of a crest is known: its height is then exact to rounding


@dataclass(frozen=True)
class Peak:
    """Largest size of a load in two picks.

    `value` has the load's sign [N or N m], `angle` is the shaft angle from the slow point [rad].
    """

    value: float
    angle: float


@dataclass(frozen=True)
class Loads:
    """Peaks of the loads in two picks.

    `frame_force` is the force of the drive on a frame, upwards, whichever frame has the larger one;
    `rotor_torque` and `shaft_torque` are those of all frames and of the rotor.
    """

    frame_force: Peak
    rotor_torque: Peak
    shaft_torque: Peak


class Weave:
    """A dobby at a constant shaft speed, and frames that change at every weave."""

    def __init__(
        self, dobby: DobbyDrive, frames: list[tuple[int, HealdFrame]], warp: float, front: float, back: float
    ):
        self.dobby, self.frames = dobby, frames
        self.warp, self.front, self.back = warp, front, back

    def at(self, angle: float) -> tuple[float, float, float]:
        """Force on the frame with the larger one, torque on the rotor and on the shaft, at a shaft angle."""
        dobby = self.dobby
        dobby.start_angle = angle
        dobby.step(0.0, 0.0)
        force, rotor, shaft = 0.0, dobby.rotor_torque, dobby.shaft_torque
        for count, frame in self.frames:
            for name in FOLLOWED:
                setattr(frame, name, getattr(dobby, name))
            frame.load = 0.0
            frame.step(0.0, 0.0)
            if self.warp:
                frame.load = -self.warp * eye_pull(frame.lift - 0.5 * frame.stroke, self.front, self.back)
                frame.step(0.0, 0.0)
            force = frame.drive_force if abs(frame.drive_force) > abs(force) else force
            rotor += count * frame.rotor_torque
            shaft += count * frame.shaft_torque
        return force, rotor, shaft


def dobby_loads(
    law: str = "sloped_sine",
    speed_reduction: float = 0.5,
    *,
    speed: Quantity = "400 rpm",
    stroke: Quantity = "98 mm",
    frame_mass: Quantity = "15 kg",
    gravity: Quantity = 9.80665,
    rotor_inertia: Quantity = 0.0,
    rising: int = 1,
    falling: int = 0,
    warp_tension: Quantity = 0.0,
    front_length: Quantity = "250 mm",
    back_length: Quantity = "500 mm",
) -> Loads:
    """Peaks of the loads that frames in plain weave put on the dobby, by the equations of the FMUs.

    Args:
        law: of the rotor, by its name in `DobbyDrive`
        speed_reduction: zeta, of the laws that have it [1]
        speed: of the main shaft [rad/s]
        stroke, frame_mass: of a frame [m, kg]
        gravity: 0 where springs carry the weight [m/s2]
        rotor_inertia: of the rotor, or of the cam shaft of spline_cam [kg m2]
        rising, falling: numbers of frames that rise and that fall in the first pick; all change at every pick
        warp_tension: of all threads of a frame together, held constant [N]
        front_length, back_length: of the warp, from the healds to the fell and to the back rest [m]

    Raises:
        LoomfmuError: a value outside its limits, an unknown law

    >>> loads = dobby_loads("uniform", speed="400 rpm", gravity=0.0)
    >>> round(loads.rotor_torque.value, 3)  # m H^2 w^2 / 64
    3.949
    """
    weave = _weave(
        law,
        read("speed_reduction", speed_reduction),
        read("speed", speed),
        read("stroke", stroke),
        read("frame_mass", frame_mass),
        read("gravity", gravity),
        read("rotor_inertia", rotor_inertia),
        whole("rising", rising, 0),
        whole("falling", falling, 0),
    )
    weave.warp = read("warp_tension", warp_tension)
    weave.front, weave.back = read("warp_length", front_length), read("warp_length", back_length)
    step = TURN / PLACES
    seen = [weave.at(place * step) for place in range(PLACES)]
    peaks = []
    for load in range(3):
        sizes = [abs(each[load]) for each in seen]
        peaks.append(_peak(lambda x, load=load: weave.at(x)[load], sizes, step))  # type: ignore[misc]
    return Loads(*peaks)


def _weave(
    law: str,
    reduction: float,
    speed: float,
    stroke: float,
    mass: float,
    gravity: float,
    inertia: float,
    rising: int,
    falling: int,
) -> Weave:
    """A dobby with its slow point at the shaft angle 0, and frames in plain weave."""
    if law not in LAWS:
        raise LoomfmuError(f"law = {law!r} must be one of {listed(LAWS, 'or')}")
    dobby = DobbyDrive(
        law=LAWS.index(law) + 1, speed_reduction=reduction, slow_point=0.0, speed=speed, rotor_inertia=inertia
    )
    dobby.initialize(0.0)
    frames = []
    for count, pegs in ((rising, 0b10), (falling, 0b01)):
        frame = HealdFrame(
            stroke=stroke,
            frame_mass=mass,
            gravity=gravity,
            inputs_at_step_end=True,
            follow_lift=dobby.law == SPLINE_CAM,
        )
        frame.pattern = (pegs, 0, 0, 0, 0, 0, 0, 0)
        frames += [(count, frame)] if count else []
    return Weave(dobby, frames, 0.0, 1.0, 1.0)


def _peak(load: Callable[[float], float], sizes: list[float], step: float) -> Peak:
    """The largest size of a load in two picks, from its sizes at even places: each crest that may be it."""
    from scipy.optimize import minimize_scalar

    places = len(sizes)
    best = max(range(places), key=sizes.__getitem__)
    found = Peak(load(best * step), best * step)
    for place in range(places):
        here, before, after = sizes[place], sizes[place - 1], sizes[(place + 1) % places]
        # a crest rises above its highest sample by less than that differs from its neighbours
        if here < max(before, after) or 2.0 * here - min(before, after) <= abs(found.value):
            continue
        crest = minimize_scalar(
            lambda x: -abs(load(x)),
            bounds=(max(place - 1, 0) * step, (place + 1) * step),
            method="bounded",
            options={"xatol": WITHIN},
        )
        if -crest.fun > abs(found.value):
            found = Peak(load(float(crest.x)), float(crest.x))
    return found


def least_loaded(
    law: str = "sloped_sine",
    load: str = "rotor_torque",
    *,
    lowest: float = 0.0,
    highest: float = 0.8,
    **given: Quantity | int,
) -> float:
    """Speed reduction zeta at which a load's peak is least.

    Args:
        law: of the rotor, one that has a zeta
        load: frame_force, rotor_torque or shaft_torque
        lowest, highest: bounds of zeta [1]
        given: as for `dobby_loads`

    Returns:
        zeta, within 1e-4; one of the bounds where the load rises or falls all the way

    >>> least_loaded("sloped_sine", "rotor_torque", gravity=0.0)  # of the inertia alone it only grows
    0.0
    """
    from scipy.optimize import minimize_scalar

    names = tuple(Loads.__dataclass_fields__)
    if load not in names:
        raise LoomfmuError(f"load = {load!r} must be one of {listed(names, 'or')}")
    low, high = read("speed_reduction", lowest), read("speed_reduction", highest)

    def peak(reduction: float) -> float:
        found: Peak = getattr(dobby_loads(law, reduction, **given), load)  # type: ignore[arg-type]
        return abs(found.value)

    pieces = 16
    tried = [low + (high - low) * piece / pieces for piece in range(pieces + 1)]
    peaks = [peak(reduction) for reduction in tried]
    best = min(range(pieces + 1), key=peaks.__getitem__)
    near = tried[max(best - 1, 0)], tried[min(best + 1, pieces)]
    found = minimize_scalar(peak, bounds=near, method="bounded", options={"xatol": 1e-5})
    return float(found.x) if found.fun < peaks[best] else tried[best]
