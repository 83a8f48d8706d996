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
from .sections import Pair, Row, Section, consistent, number

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
def blows(restitution: float, rpm: float = 300.0, **heald: float) -> float:
    """Blows of a heald in one rise or fall, on a frame without dwell: mean of both."""
    line = HealdLine(rpm, STEPS, law=UNIFORM)
    threads = WarpTension(inputs_at_step_end=True)
    play = HealdPlay(inputs_at_step_end=True, restitution=restitution, **heald)  # type: ignore[arg-type]
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
    """Tensions, blows and springs."""
    return tensions(), struck(), springs()


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
                 Pair("0.3", float(tension[height > 0.0].mean()), 3, measured=True, used=True)), chosen),
            Row(("mean, lower part of the shed, N",
                 Pair("0.27", float(tension[height < 0.0].mean()), 3, measured=True, used=True)), chosen),
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
            "The blows: possible explanations have a table of their own, next.",
        ),
    )  # fmt: skip


# restitution, rev/min, what else is changed, and its name
STRUCK: tuple[tuple[float, float, dict[str, float], str], ...] = (
    (0.5, 300.0, {}, "default"),
    (0.5, 300.0, {"play": 0.0005}, "play 0.5 mm (2 mm)"),
    (0.5, 300.0, {"play": 0.004}, "play 4 mm"),
    (0.5, 300.0, {"heald_mass": 0.001}, "heald of 1 g (3 g)"),
    (0.5, 300.0, {"heald_mass": 0.006}, "heald of 6 g"),
    (0.5, 150.0, {}, "150 rev/min"),
    (0.5, 300.0, {"least_speed": 1e-6}, "blows down to 0.001 mm/s (1 mm/s)"),
    (0.8, 300.0, {}, "restitution 0.8"),
    (0.9, 300.0, {}, "restitution 0.9"),
    (0.92, 300.0, {}, "restitution 0.92"),
    (0.94, 300.0, {}, "restitution 0.94"),
    (0.9, 300.0, {"play": 0.00025}, "restitution 0.9, play 0.25 mm"),
    (0.9, 300.0, {"least_speed": 1e-4}, "restitution 0.9, blows down to 0.1 mm/s"),
    (0.9, 300.0, {"heald_mass": 0.001}, "restitution 0.9, heald of 1 g"),
)


def struck() -> Section:
    """What would give the published count of blows."""
    rows = tuple(
        Row((name, number(blows(e, rpm, **heald), 1), number(10.0 * blows(e, rpm, **heald), 0)))
        for e, rpm, heald, name in STRUCK
    )
    return Section(
        "Section 5.1, possible explanations of the 40 to 42 blows (inferences, not counted)",
        (
            "changed, one or two at a time (default)",
            "blows of one heald in a rise or a fall",
            "of ten healds",
        ),
        rows,
        intro="A frame on a cosine without dwell, 300 rev/min, default threads. Nothing is adjusted: play,"
        " mass and restitution of a heald are not published.",
        remarks=(
            "The thread throws the heald over its play once in a rise or a fall, in the closed shed, at u ="
            " 0.23 m/s. Then it rebounds until it is slower than least_speed: ln(u / least_speed) / ln(1 /"
            " restitution) = 7.8 times by default, as long as the shed leaves it the time. An integration"
            " with events counts the same. Play, mass and speed of the loom change u alone, which counts by"
            " its logarithm: none of them gives 40 without another restitution.",
            "40 blows of one heald take a restitution of about 0.92, or 0.9 with blows counted down to 0.1"
            " mm/s.",
            "The gauges sat on a bracket with ten healds. If these strike at different times, four blows of"
            " each are 40; all blows of ten healds down to 1 mm/s would be 80. So the count may be that of"
            " the harder half of their blows.",
            "40 to 42 in a rise of 0.2 s are 200 to 210 Hz. A bracket that rings at this frequency would show"
            " as many; its natural frequency is not published.",
        ),
    )


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
            Row(("load of the warp on a frame, N, (5.4)", consistent("957.6", load, 2)), "see Errata"),
            Row(("inertia force of the frame, N, (5.5)", consistent("600", 15.0 * 40.0, 1))),
            Row(("stiffness of a spring, N/m, (5.6)", Pair("5960", stiffness, 2))),
            Row(("stiffness of a spring, N/mm", Pair("59.6", 1e-3 * stiffness, 3, misprint=True))),
            Row(("displacement of a carrier of 15 kg under both forces, mm",
                 Pair("15", 1e3 * way, 3, used=True)), "the springs are designed for it"),
            Row(("its natural frequency, Hz", number(frequency, 3))),
        ),
    )  # fmt: skip
