"""Korolev, possible explanations of the dwells of Table 3.1: inferences, not counted as reproduced."""

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..machines import table
from ..physics.heald import lift_fraction
from ..physics.rotor_laws.rotor import SLOPED_LINE, dwell_angle, rotor_law
from . import rotor
from .sections import USED, Row, Section, number

Floats = NDArray[np.float64]
POINTS = 2048  # in two picks, in which a frame in plain weave rises and falls
HARMONICS = np.arange(POINTS // 2 + 1) / 2.0  # per turn of the shaft
SPEED = 280.0 / 60.0  # 1/s, of the measured loom
START = (3.0, 0.1)  # natural frequency and damping from which the fit of the elastic drive starts


def measured() -> dict[float, float]:
    """Measured dwells [deg] by speed reduction."""
    rows = table("heald_dwell_experiment")
    return {float(row["speed_reduction"]): float(row["upper_dwell_deg"]) for row in rows}


def misses(dwells: list[float]) -> Floats:
    """Computed minus measured dwells [deg]."""
    return np.asarray(np.array(dwells) - np.array(list(measured().values())))


def rms(dwells: list[float]) -> float:
    """Root mean square of the misses [deg]."""
    return float(np.sqrt(np.mean(misses(dwells) ** 2)))


def of_plateau(plateau: float, ramp: float) -> list[float]:
    """Dwells of the law with a plateau [deg]; both angles in degrees."""
    shape = {"plateau_angle": math.radians(plateau), "ramp_angle": math.radians(ramp)}
    return [math.degrees(rotor.new_drive("plateau", z, **shape).dwell_angle) for z in measured()]


@cache
def fitted_plateau() -> tuple[float, float]:
    """Plateau and ramp that come closest to the measured dwells [deg]."""
    from scipy.optimize import least_squares

    found = least_squares(lambda shape: misses(of_plateau(*shape)), (80.0, 50.0), xtol=1e-12, ftol=1e-12)
    return float(found.x[0]), float(found.x[1])


def of_play(tolerance: float) -> list[float]:
    """Dwells of the sloped line within another share of the stroke, as play would widen it [deg]."""
    return [math.degrees(dwell_angle(SLOPED_LINE, z, tolerance)) for z in measured()]


@cache
def fitted_play() -> float:
    """Share of the stroke that comes closest to the measured dwells."""
    from scipy.optimize import minimize_scalar

    bounds = (0.015, 0.1)
    found = minimize_scalar(
        lambda share: rms(of_play(share)), bounds=bounds, method="bounded", options={"xatol": 1e-12}
    )
    return float(found.x)


@cache
def spectrum(reduction: float) -> NDArray[np.complex128]:
    """Harmonics of the lift of a frame in plain weave, sloped line, as a share of its stroke."""
    angles = 4.0 * math.pi * np.arange(POINTS) / POINTS
    lift = []
    for x in angles:
        turns = math.floor(x / (2.0 * math.pi))
        angle, first, second = rotor_law(SLOPED_LINE, x - 2.0 * math.pi * turns, reduction)
        lift.append(lift_fraction(2.0 * math.pi * turns + angle, first, second)[0])
    return np.fft.rfft(np.array(lift))


def elastic(reduction: float, frequency: float, damping: float) -> NDArray[np.complex128]:
    """Harmonics of a frame on a spring behind that drive; natural frequency in turns of the shaft.

    Steady state of `y'' + 2 d n y' + n^2 y = n^2 (lift)`, derivatives by the shaft angle.
    """
    share = HARMONICS / frequency
    return np.asarray(spectrum(reduction) / (1.0 - share * share + 2j * damping * share))


def of_elasticity(frequency: float, damping: float) -> list[float]:
    """Dwells of the elastic frame, about its position at the slow point [deg]."""
    found = []
    for reduction in measured():
        lift = np.fft.irfft(elastic(reduction, frequency, damping), POINTS)
        off = np.abs(np.roll(lift, -POINTS // 2) - lift[POINTS // 2]) - rotor.TOLERANCE
        after, before = _crossing(off), _crossing(np.roll(off[::-1], 1))
        found.append((after + before) * 720.0 / POINTS)
    return found


def _crossing(off: Floats) -> float:
    """Where values that start below 0 first pass it, on the line between two of them."""
    k = int(np.argmax(off > 0.0))
    return float(k - off[k] / (off[k] - off[k - 1]))


@cache
def fitted_elasticity() -> tuple[float, float]:
    """Natural frequency, in turns of the shaft, and damping that come closest to the measured dwells."""
    from scipy.optimize import least_squares

    found = least_squares(lambda given: misses(of_elasticity(*given)), START, xtol=1e-12, ftol=1e-12)
    return float(found.x[0]), float(found.x[1])


def elastic_growth() -> float:
    """Growth of the elastic frame's largest acceleration from zeta = 0.3 to 0.7, %."""
    slow, fast = (
        np.abs(np.fft.irfft(-(HARMONICS**2) * elastic(z, *fitted_elasticity()), POINTS)).max()
        for z in (0.3, 0.7)
    )
    return 100.0 * float(fast / slow - 1.0)


def section() -> Section:
    """The measured dwells beside their possible explanations."""
    uniform = math.degrees(rotor.drive("uniform").dwell_angle)
    frequency, damping = fitted_elasticity()
    slower = of_elasticity(frequency * 280.0 / 200.0, damping)[-1]
    plateau, ramp = fitted_plateau()
    shape = {"plateau_angle": math.radians(plateau), "ramp_angle": math.radians(ramp)}
    inferred = [math.degrees(rotor.drive("plateau", z).dwell_angle) for z in measured()]
    columns = (
        [uniform / (1.0 - z) for z in measured()], inferred, of_plateau(plateau, ramp),
        of_play(fitted_play()), of_elasticity(frequency, damping),
    )  # fmt: skip
    rows = [
        Row((number(z, 1), number(dwell, 0), *(number(column[k], 1) for column in columns)))
        for k, (z, dwell) in enumerate(measured().items())
    ]
    line = number(rotor.drive("sloped line", 0.7).highest_speed, 3)
    rows += [
        Row(("rms of the differences, deg", "", *(number(rms(column), 1) for column in columns))),
        Row((
            "growth of the acceleration, %", "28", "", number(rotor.growth("plateau"), 1),
            number(rotor.growth("plateau", **shape), 1), number(rotor.growth("sloped line"), 1),
            number(elastic_growth(), 1),
        )),
        Row((
            "largest rotor speed relative to the shaft's, zeta = 0.7", "1.4", "",
            number(rotor.drive("plateau", 0.7).highest_speed, 3) + USED,
            number(rotor.new_drive("plateau", 0.7, **shape).highest_speed, 3), line, line,
        )),
    ]  # fmt: skip
    return Section(
        "Table 3.1, possible explanations of the measured dwell, deg (inferences, not counted)",
        (
            "zeta", "measured", "constant 1 - zeta", "plateau, default", "plateau, fitted",
            "sloped line and play, fitted", "sloped line and elasticity, fitted",
        ),
        tuple(rows),
        remarks=(
            "These are inferences from the measurements. A plateau contradicts the source, which attributes"
            " the dwells to its modulator: by the laws of its section 3.1 the speed is lowest at one point"
            " only.",
            "Constant 1 - zeta: the rotor keeps its lowest speed all through the dwell. With nothing fitted"
            " that is the measured dwell at zeta = 0.3 and 0.4.",
            "Plateau, default: the law `plateau` of `DobbyDrive` with its defaults. Its plateau of 90 deg"
            " is the prototype's dwell of 135 to 225 deg (section 2.5); its ramp of 40.9 deg was chosen to"
            " give the published ratio of 1.4, which therefore proves nothing. Fitted: a plateau of"
            f" {number(plateau, 1)} deg and a ramp of {number(ramp, 1)} deg.",
            f"Play would widen the tolerance: {number(100.0 * fitted_play(), 1)} % of the stroke come"
            " closest. Play does not explain the dwells.",
            "Elasticity: a frame in plain weave on a spring behind the drive, in its steady state, dwelling"
            f" about its position at the slow point. A natural frequency of {number(frequency, 2)} times the"
            f" shaft's, {number(frequency * SPEED, 1)} Hz, and {number(damping, 2)} of critical damping come"
            " closest. So an elastic drive explains the dwells too, and nothing published decides between the"
            " two. A measurement at another speed would: at 200 picks/min the elastic frame would dwell for"
            f" {number(slower, 0)} deg at zeta = 0.7, and with a plateau the dwell does not depend on the"
            " speed.",
        ),
    )  # fmt: skip
