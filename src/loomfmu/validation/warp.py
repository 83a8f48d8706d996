"""Korolev, warp tensions (sections 3.5 and 5.1) and the springs of the heald carrier (section 5.3)."""

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..components.heald_damper import HealdDamper
from ..components.heald_play import HealdPlay
from ..components.warp_tension import WarpTension
from ..physics.damper import design_stiffness
from ..physics.rotor_laws.rotor import SLOPED_SINE, UNIFORM
from .chain import HealdLine
from .sections import Pair, Row, Section, number

Floats = NDArray[np.float64]
STEPS, TURNS = 360, 20


@cache
def woven(rpm: float, law: int, **thread: float) -> tuple[Floats, Floats]:
    """Tension of a thread over two picks, after its start has faded, and the height of its eye."""
    line = HealdLine(rpm, STEPS, law=law)
    threads = WarpTension(inputs_at_step_end=True, **thread)  # type: ignore[arg-type]
    line.feed(threads)
    threads.initialize(0.0)
    tension, height = [], []
    for _ in range(TURNS * STEPS):
        before = line.time
        line.advance()
        line.feed(threads)
        threads.step(before, line.step_size)
        tension.append(threads.tension)
        height.append(threads.lift - 0.5 * threads.stroke + threads.shed_offset)
    return np.array(tension[-2 * STEPS :]), np.array(height[-2 * STEPS :])


@cache
def blows(restitution: float) -> float:
    """Blows of a heald in one rise or fall at 300 rev/min, on a frame without dwell: mean of both."""
    line = HealdLine(300.0, STEPS, law=UNIFORM)
    threads = WarpTension(inputs_at_step_end=True)
    play = HealdPlay(inputs_at_step_end=True, restitution=restitution)
    counted = []
    for _ in range(5 * STEPS + 1):
        before = line.time - line.step_size
        line.feed(threads)
        line.feed(play)
        starts = line.done == 0
        _problem = threads.initialize(0.0) if starts else threads.step(before, line.step_size)
        play.warp_load = threads.frame_load
        _problem = play.initialize(0.0) if starts else play.step(before, line.step_size)
        counted.append(play.blows)
        line.advance()
    return 0.5 * (counted[-1] - counted[3 * STEPS])


def sections() -> tuple[Section, ...]:
    """Tensions and springs."""
    return tensions(), springs()


def maxima(**thread: float) -> tuple[float, float]:
    """Highest tension in the upper and in the lower part of the shed at 300 rev/min [cN]."""
    tension, height = woven(300.0, UNIFORM, **thread)
    return 100.0 * float(tension[height > 0.0].max()), 100.0 * float(tension[height < 0.0].max())


@cache
def fitted_to_maxima() -> tuple[float, float]:
    """Offset of the shed [mm] and stiffness of the thread [N/m] with which the measured maxima come out."""
    from scipy.optimize import root

    def off(values: Floats) -> Floats:
        found = maxima(shed_offset=1e-3 * float(values[0]), thread_stiffness=float(values[1]))
        return np.array(found) - (76.6, 26.2)

    found = root(off, (15.0, 65.0), tol=1e-8)
    return float(found.x[0]), float(found.x[1])


def tensions() -> Section:
    """Measured tensions."""
    tension, height = woven(280.0, SLOPED_SINE)
    upper, lower = maxima()
    offset, stiffness = fitted_to_maxima()
    chosen = "proves nothing: the default thread was chosen to give this"
    return Section(
        "Sections 3.5 and 5.1: measured tension of a warp thread",
        ("quantity", ""),
        (
            Row(("mean, upper part of the shed, 280 picks/min, N",
                 Pair("0.3", float(tension[height > 0.0].mean()), 3, measured=True)), chosen),
            Row(("mean, lower part of the shed, N",
                 Pair("0.27", float(tension[height < 0.0].mean()), 3, measured=True)), chosen),
            Row(("highest, upper part, 300 rev/min, pretension 15 cN, cN",
                 Pair("76.6", upper, 1, measured=True))),
            Row(("highest, lower part, cN", Pair("26.2", lower, 1, measured=True))),
            Row(("blows of the heald eyes in a rise or a fall, 300 rev/min",
                 Pair("40", blows(0.5), 0, measured=True)), "one heald; 40 to 42 counted on ten"),
        ),
        intro="The source gives no constants of the thread. The defaults are assumptions; two of them"
              " follow from the measured means.",
        remarks=(
            "The maxima are of another cloth and another drive. Their ratio of 2.9 requires a shed far less"
            " symmetric than the means do. Nothing was adjusted to them.",
            f"The maxima, possible explanations (inferences): an offset of the shed of {number(offset, 1)} mm"
            f" with a thread of {number(stiffness, 0)} N/m gives both. And the gauges sat on the bars of the"
            " frame: they measured the load on the heald eye, not the tension of the thread.",
            "The blows, possible explanations (inferences): with a restitution of 0.9 (0.5 is assumed)"
            f" a heald strikes {number(blows(0.9), 1)} times; and the gauge's bracket held ten healds, of"
            " which four blows each would be 40.",
        ),
    )  # fmt: skip


def springs() -> Section:
    """Design of the damper's springs."""
    load = 5040 * 0.76 / 4.0
    stiffness = design_stiffness(load, 15.0, 40.0, 0.015)
    settled = HealdDamper(inputs_at_step_end=True, acceleration=40.0, carrier_mass=15.0)
    settled.initialize(0.0)
    settled.warp_force = load
    settled.step(0.0, 0.0)
    way = (load - 15.0 * 40.0) / (4.0 * settled.spring_stiffness)
    frequency = math.sqrt(4.0 * stiffness / 15.0) / (2.0 * math.pi)
    return Section(
        "Section 5.3: springs of the heald carrier",
        ("quantity", ""),
        (
            Row(("load of the warp on a frame, N, (5.4)", Pair("957.6", load, 2)), "see Errata"),
            Row(("inertia force of the frame, N, (5.5)", Pair("600", 15.0 * 40.0, 1))),
            Row(("stiffness of a spring, N/m, (5.6)", Pair("5960", stiffness, 2))),
            Row(("stiffness of a spring, N/mm", Pair("59.6", 1e-3 * stiffness, 3, misprint=True))),
            Row(("displacement of a carrier of 15 kg under both forces, mm", Pair("15", 1e3 * way, 3))),
            Row(("its natural frequency, Hz", number(frequency, 3))),
        ),
    )  # fmt: skip
