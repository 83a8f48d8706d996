"""Korolev, possible explanations of the dwells of Table 3.1: inferences, not counted as reproduced."""

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, minimize_scalar

from loomfmu.machines import table
from loomfmu.physics.heald import lift_fraction
from loomfmu.physics.rotor_laws.rotor import SLOPED_LINE, rotor_law
from validation.computed import rotor

Floats = NDArray[np.float64]
POINTS = 2048  # in two picks, in which a frame in plain weave rises and falls
HARMONICS = np.arange(POINTS // 2 + 1) / 2.0  # per turn of the shaft
START = (3.0, 0.1)  # natural frequency and damping from which the fit of the elastic drive starts


def measured() -> dict[float, float]:
    """Measured dwells [rad] by speed reduction."""
    rows = table("heald_dwell_experiment")
    return {float(row["speed_reduction"]): math.radians(float(row["upper_dwell_deg"])) for row in rows}


def of_plateau(plateau: float, ramp: float) -> list[float]:
    """Dwells of the law with a plateau; all angles in rad."""
    shape = {"plateau_angle": plateau, "ramp_angle": ramp}
    return [rotor.drive("plateau", z, **shape).dwell_angle for z in measured()]


@cache
def plateau() -> tuple[float, float]:
    """Plateau and ramp that come closest to the measured dwells [rad]."""
    start = np.radians((80.0, 50.0))
    found = least_squares(lambda shape: misses(of_plateau(*shape)), start, xtol=1e-12, ftol=1e-12)
    return float(found.x[0]), float(found.x[1])


def of_play(tolerance: float) -> list[float]:
    """Dwells of the sloped line within another share of the stroke, as play would widen it [rad]."""
    return [rotor.dwell("sloped line", z, tolerance) for z in measured()]


@cache
def play() -> float:
    """Share of the stroke that comes closest to the measured dwells."""
    bounds, options = (0.015, 0.1), {"xatol": 1e-12}
    of = minimize_scalar(
        lambda share: off_by(of_play(share)), bounds=bounds, method="bounded", options=options
    )
    return float(of.x)


@cache
def spectrum(reduction: float) -> NDArray[np.complex128]:
    """Harmonics of the lift of a frame in plain weave, sloped line, as a share of its stroke."""
    lift = []
    for x in 4.0 * math.pi * np.arange(POINTS) / POINTS:
        turns = 2.0 * math.pi * math.floor(x / (2.0 * math.pi))
        angle, first, second = rotor_law(SLOPED_LINE, x - turns, reduction)
        lift.append(lift_fraction(turns + angle, first, second)[0])
    return np.fft.rfft(np.array(lift))


def elastic(reduction: float, frequency: float, damping: float) -> NDArray[np.complex128]:
    """Harmonics of a frame on a spring behind that drive; natural frequency in turns of the shaft.

    Steady state of `y'' + 2 d n y' + n^2 y = n^2 (lift)`, derivatives by the shaft angle.
    """
    share = HARMONICS / frequency
    return np.asarray(spectrum(reduction) / (1.0 - share * share + 2j * damping * share))


@cache
def of_elasticity(frequency: float, damping: float) -> list[float]:
    """Dwells of the elastic frame, about its position at the slow point [rad]."""
    found = []
    for reduction in measured():
        lift = np.fft.irfft(elastic(reduction, frequency, damping), POINTS)
        off = np.abs(np.roll(lift, -POINTS // 2) - lift[POINTS // 2]) - rotor.TOLERANCE
        after, before = _crossing(off), _crossing(np.roll(off[::-1], 1))
        found.append((after + before) * 4.0 * math.pi / POINTS)
    return found


def _crossing(off: Floats) -> float:
    """Place at which values first pass 0, on the line between two of them."""
    k = int(np.argmax(off > 0.0))
    return float(k - off[k] / (off[k] - off[k - 1]))


@cache
def elasticity() -> tuple[float, float]:
    """Natural frequency, in turns of the shaft, and damping that come closest to the measured dwells."""
    found = least_squares(lambda given: misses(of_elasticity(*given)), START, xtol=1e-12, ftol=1e-12)
    return float(found.x[0]), float(found.x[1])


def at_speed(speed: float) -> float:
    """Dwell of the elastic frame at zeta = 0.7 and another speed of the shaft [rad]."""
    frequency, damping = elasticity()
    return of_elasticity(frequency * rotor.SPEED / speed, damping)[-1]


@cache
def explained(explanation: str) -> list[float]:
    """Dwells by an explanation [rad]."""
    if explanation == "constant":
        return [rotor.drive("uniform").dwell_angle / (1.0 - z) for z in measured()]
    if explanation == "default":
        return [rotor.drive("plateau", z).dwell_angle for z in measured()]
    if explanation == "plateau":
        return of_plateau(*plateau())
    return of_play(play()) if explanation == "play" else of_elasticity(*elasticity())


def dwell(explanation: str, reduction: float) -> float:
    """One of these dwells [rad]."""
    return explained(explanation)[list(measured()).index(reduction)]


def misses(dwells: list[float]) -> Floats:
    """Computed minus measured dwells [deg]."""
    return np.degrees(np.array(dwells) - np.array(list(measured().values())))


def off_by(dwells: list[float]) -> float:
    """Root mean square of the misses [deg]."""
    return float(np.sqrt(np.mean(misses(dwells) ** 2)))


def rms(explanation: str) -> float:
    """Root mean square of the misses of an explanation [deg]."""
    return off_by(explained(explanation))


def elastic_growth() -> float:
    """Growth of the elastic frame's largest acceleration from zeta = 0.3 to 0.7, as a share."""
    slow, fast = (
        np.abs(np.fft.irfft(-(HARMONICS**2) * elastic(z, *elasticity()), POINTS)).max() for z in (0.3, 0.7)
    )
    return float(fast / slow - 1.0)
