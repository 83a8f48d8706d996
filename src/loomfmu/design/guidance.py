"""Rigid-body guidance: the joint between a rod and a rocker, from two or more places of the rod.

Source: Yuan and others, Journal of Textile Research (2017), doi 10.13475/j.fzxb.20170102406, section 2.1,
equations (1) to (8). Equation (3) and the coefficients of (4) are lost; they are derived anew here.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, hypot, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import LoomfmuError
from .quantities import Quantity, listed, read
from .reed import crank_place, crank_rocker_without_quick_return, frame_angle_for, reed_dyad

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Guidance:
    """Joint Q of rod and rocker at the first place, seen from the rocker's pivot.

    `x`, `y` [m]; `arm` from the pivot to Q and `rod` from Q to the guided point P [m]; `angles` of the arm at
    each place [rad]; `swing` between its extremes [rad]; `error`, by how much the arm would have to change
    its length at the worst place [m]: rounding for two places and for three.
    """

    x: float
    y: float
    arm: float
    rod: float
    angles: tuple[float, ...]
    swing: float
    error: float


def guided_joint(
    points: Sequence[ArrayLike], turns: ArrayLike, pressure_angle: Quantity | None = None
) -> Guidance:
    """Joint that keeps its distance from the rocker's pivot while the rod takes the given places, (1) to (8).

    With the rod turned by t from its first place, P1 moved to Pj, and R the rotation by t,

        Qj = R (Q1 - P1) + Pj,  |Qj| = |Q1|   =>   2 (R^T d) . Q1 + d . d = 0,   d = Pj - R P1

    which is (4) with its coefficients. With a pressure angle, Q1 lies on (1), the line of the rod at its
    first
    place: two places then are enough, and more are met by least squares. Without one, three places are met
    exactly and more by least squares.

    Args:
        points: P1, P2, ... of the guided point, as (x, y) from the rocker's pivot [m]
        turns: of the rod at each point from the first, so the first is 0 [rad]
        pressure_angle: slope of the rod at its first place, alpha [rad]

    Raises:
        LoomfmuError: too few places, or places that leave the joint undetermined

    >>> from math import radians
    >>> joint = guided_joint([(0.49, 0.66933), (0.33, 0.66933)], [0, 0.03789047], radians(-1.235))
    >>> round(1000 * joint.arm, 1), round(1000 * joint.rod, 1)
    (679.8, 487.5)
    """
    places = np.array([listed(f"points[{index}]", point, "m") for index, point in enumerate(points)])
    angles = listed("turns", turns, "rad")
    needed = 3 if pressure_angle is None else 2
    if places.ndim != 2 or places.shape[1:] != (2,) or len(places) != angles.size or angles.size < needed:
        raise LoomfmuError(
            f"{len(places)} points and {angles.size} turns: give as many (x, y) as turns, at least {needed}"
            f" {'without' if pressure_angle is None else 'with'} a pressure angle"
        )
    if not (np.all(np.isfinite(places)) and np.all(np.isfinite(angles))) or angles[0] != 0.0:
        raise LoomfmuError(f"turns[0] = {angles[0]:.7g} rad must be 0, and all points and turns finite")
    joint = _solve(places, angles, None if pressure_angle is None else read("pressure_angle", pressure_angle))
    joints = np.array([_turned(joint - places[0], turn) for turn in angles]) + places
    arms = np.hypot(*joints.T)
    if arms[0] == 0.0:
        raise LoomfmuError("these places put the joint on the rocker's pivot: there is no rocker")
    along = np.unwrap(np.arctan2(joints[:, 1], joints[:, 0]))
    return Guidance(
        float(joint[0]),
        float(joint[1]),
        float(arms[0]),
        hypot(*(joint - places[0])),
        tuple(float(each) for each in along),
        float(np.ptp(along)),
        float(np.max(np.abs(arms - arms[0]))),
    )


def _turned(vector: Floats, angle: float) -> Floats:
    return np.array(
        [
            vector[0] * cos(angle) - vector[1] * sin(angle),
            vector[0] * sin(angle) + vector[1] * cos(angle),
        ]
    )


def _solve(places: Floats, angles: Floats, slope: float | None) -> Floats:
    """Q1 from equation (4) for every place after the first, on the line (1) if a slope is given."""
    moved = [point - _turned(places[0], turn) for point, turn in zip(places[1:], angles[1:], strict=True)]
    rows = np.array([2.0 * _turned(each, -turn) for each, turn in zip(moved, angles[1:], strict=True)])
    right = np.array([-each @ each for each in moved])
    if slope is None:
        found, _rest, rank, _values = np.linalg.lstsq(rows, right, rcond=1e-12)
        if rank == 2:
            return np.asarray(found)
    else:
        line = np.array([cos(slope), sin(slope)])
        column = rows @ line
        if column @ column > 1e-24 * float(np.sum(rows * rows)):
            share = column @ (right - rows @ places[0]) / (column @ column)
            return np.asarray(places[0] + share * line)
    raise LoomfmuError(
        "these places leave the joint undetermined: let the rod turn, differently from place to place"
    )


def beat_up_linkage(
    *,
    front: Quantity,
    back: Quantity,
    swing: Quantity,
    slope: float,
    pressure_angle: Quantity,
    rocker: Quantity,
    frame_angle: Quantity | None = None,
    smallest_transmission_angle: Quantity | None = None,
) -> dict[str, float]:
    """Parameters of a `ReedBeatUp` without quick return, the whole synthesis of sections 2 and 3.

    Args:
        front, back: limits of the reed, from the rocker's pivot [m]
        swing: of the rocker [rad]
        slope: of the chord of the swing, dy/dx [1]
        pressure_angle: slope of the reed's rod at the front limit [rad]
        rocker: its length [m]
        frame_angle: b, between the frame and the middle of the swing [rad], or instead of it
        smallest_transmission_angle: that the crank-rocker is to have [rad]

    Raises:
        LoomfmuError: neither or both of the last two, an angle out of its range, or no rod for these limits

    >>> lengths = beat_up_linkage(front="490 mm", back="330 mm", swing="13.61 deg", slope=0.1154,
    ...     pressure_angle="-1.235 deg", rocker="550 mm", frame_angle="15 deg")
    >>> round(1000 * lengths["crank_length"], 2)  # published 65.168
    65.17
    """
    psi, length = read("swing", swing), read("rocker", rocker)
    b = _frame_angle(psi, frame_angle, smallest_transmission_angle)
    crank, coupler, _frame, _smallest = crank_rocker_without_quick_return(length, psi, b)
    x, y = crank_place(length, psi, slope, b)
    limits = read("reed_limit", front), read("reed_limit", back)
    arm, rod, height = reed_dyad(*limits, psi, slope, read("pressure_angle", pressure_angle))
    if arm == 0.0:
        raise LoomfmuError(
            f"no rod takes the reed to {1e3 * limits[0]:.7g} and {1e3 * limits[1]:.7g} mm with this swing,"
            " slope and pressure angle: the front limit must exceed the back one, and the reed stay ahead of"
            " the arm"
        )
    return {
        "crank_length": crank,
        "coupler_length": coupler,
        "rocker_length": length,
        "crank_x": x,
        "crank_y": y,
        "arm_length": arm,
        "rod_length": rod,
        "reed_height": height,
    }


def _frame_angle(psi: float, given: Quantity | None, transmission_angle: Quantity | None) -> float:
    """Angle between the frame and the middle of a swing [rad], given or from the transmission angle."""
    if (given is None) == (transmission_angle is None):
        raise LoomfmuError(
            "give either frame_angle or smallest_transmission_angle: each follows from the other"
        )
    if given is None:
        smallest = read("smallest_transmission_angle", transmission_angle)
        if not 2.0 * smallest < np.pi - psi:
            raise LoomfmuError(
                f"smallest_transmission_angle = {np.degrees(smallest):.7g} deg must be below 90 deg less half"
                f" the swing, {np.degrees(0.5 * (np.pi - psi)):.7g} deg"
            )
        b = frame_angle_for(psi, smallest)
    else:
        b = read("frame_angle", given)
    if not 0.5 * psi < b < 0.5 * np.pi:
        raise LoomfmuError(
            f"frame_angle = {np.degrees(b):.7g} deg must lie between half the swing,"
            f" {np.degrees(0.5 * psi):.7g} deg, and 90 deg"
        )
    return b
