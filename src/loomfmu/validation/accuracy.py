"""Accuracy of the components: damper, belt and dwell over the number of steps in a revolution."""

import math
from collections.abc import Sequence
from functools import cache

import numpy as np

from ..components.belt_monitor import BeltMonitor
from ..components.weft_insertion import WeftInsertion
from ..machines import parameters
from ..physics.rotor_laws.rotor import SLOPED_SINE, UNIFORM, dwell_angle
from . import belt, driven
from .chain import RPM, HealdLine
from .damper_reference import reference, simulated
from .sections import Chapter, Row, Section, number, small

STEPS = (45, 90, 180, 360, 720, 1440, 2880, 5760)  # in a revolution
DAMPER_STEPS = (9, 18, 36, 72, 144, 288, 576, 1152)
# errors below these come near to rounding, of the component or of the reference
FLOOR, DAMPER_FLOOR, ORDER_FLOOR = 1e-8, 1e-10, 1e-9
MACHINE, SPEED = "WL680-3600", 600.0
TOLERANCE = 0.015

# name, law, speed and parameters of the damper's cases
CASES: tuple[tuple[str, int, float, dict[str, float]], ...] = (
    ("uniform law, 200 rev/min", UNIFORM, 200.0, {}),
    ("200 rev/min", SLOPED_SINE, 200.0, {}),
    ("600 rev/min, stops out of reach", SLOPED_SINE, 600.0, {"free_travel": 1.0}),
    ("600 rev/min, with contacts", SLOPED_SINE, 600.0, {}),
)


def chapter() -> Chapter:
    """All tables."""
    return Chapter(
        "Numerical accuracy",
        "",
        (damper(), belt_and_dwell(), driven.section()),
    )


@cache
def damper_errors(law: int, rpm: float, **given: float) -> tuple[float, ...]:
    """Largest error of the displacement for each number of steps, over the largest displacement."""
    finest = max(DAMPER_STEPS)
    exact = reference(rpm, finest, law, **given).displacement
    peak = float(np.max(np.abs(exact)))
    errors = []
    for steps in DAMPER_STEPS:
        found = simulated(rpm, steps, law, **given).displacement
        errors.append(float(np.max(np.abs(found - exact[:: finest // steps]))) / peak)
    return tuple(errors)


def _order(errors: Sequence[float], index: int) -> str:
    """Order seen from one number of steps to the next."""
    if index == 0 or errors[index] < ORDER_FLOOR:
        return "-"
    return number(math.log2(errors[index - 1] / errors[index]), 1)


def damper() -> Section:
    """HealdDamper compared with an integration."""
    found = [damper_errors(law, rpm, **given) for _name, law, rpm, given in CASES]
    rows = []
    for index, steps in enumerate(DAMPER_STEPS):
        cells = [str(steps)]
        for errors in found:
            cells += [small(errors[index], DAMPER_FLOOR), _order(errors, index)]
        rows.append(Row(tuple(cells)))
    heads = [head for name, _law, _rpm, _given in CASES for head in (f"{name}: error", "order")]
    return Section(
        "Heald damper against an independent integration",
        ("steps", *heads),
        tuple(rows),
        intro="Displacement of the carrier over the first turn in plain weave, compared with scipy's DOP853"
        " with events (rtol = 1e-12). Errors are relative to the largest displacement; the order is that from"
        " one number of steps to the next. The law is the sloped sine with zeta = 0.5 unless another is"
        " named.",
        remarks=(
            "Between two samples the frame is taken to move along the quintic that joins them, which is of"
            " sixth order. With the default law the frame's jerk jumps 22.5 deg to either side of the slow"
            " point, and the order is four until, from 144 steps on, the jumps fall on samples.",
        ),
        figures=(("accuracy.png", "Error of the heald damper over the steps in a revolution"),),
    )


def lowest_margin(steps: int) -> tuple[float, float]:
    """Lowest margin and lowest speed limit of a revolution in so many steps [1, rad/s]."""
    turning = {"speed": SPEED * RPM}
    weft = WeftInsertion(**parameters("WeftInsertion", machine=MACHINE), **turning)  # type: ignore[arg-type]
    of_belt = parameters("BeltMonitor", machine=MACHINE, head="G6300 left")
    monitor = BeltMonitor(**of_belt, **turning, inputs_at_step_end=True)  # type: ignore[arg-type]
    step = 60.0 / SPEED / steps
    weft.initialize(0.0)
    for n in range(steps + 1):
        weft.step(n * step, 0.0)
        monitor.travel, monitor.velocity, monitor.acceleration = (
            weft.travel, weft.velocity, weft.acceleration
        )  # fmt: skip
        if n == 0:
            monitor.initialize(0.0)
        else:
            monitor.step((n - 1) * step, step)
    return monitor.lowest_margin, monitor.lowest_speed_limit


def sampled_dwell(steps: int) -> float:
    """Dwell of a frame from samples of its motion, on the quintics that join them [rad]."""
    from scipy.interpolate import BPoly
    from scipy.optimize import brentq

    line = HealdLine(SPEED, steps)
    angles, rows = [], []
    for n in range(steps + 1):
        angles.append(2.0 * math.pi * n / steps)
        rate = SPEED * RPM
        rows.append([line.heald.lift, line.heald.velocity / rate, line.heald.acceleration / rate**2])
        if n < steps:
            line.advance()
    lift = BPoly.from_derivatives(angles, rows)
    stroke = line.heald.stroke
    middle = float(lift(math.pi))
    level = (1.0 - TOLERANCE) * stroke if middle > 0.5 * stroke else TOLERANCE * stroke
    ends = [
        brentq(lambda x: float(lift(x)) - level, low, high, xtol=1e-15)
        for low, high in ((0.5 * math.pi, math.pi), (math.pi, 1.5 * math.pi))
    ]
    return float(ends[1] - ends[0])


def belt_and_dwell() -> Section:
    """Lowest margin, speed limit and dwell over the number of steps."""
    limit = belt.rpm(belt.safe(MACHINE, "G6300 left", 0.8))
    margin = 1.0 - (SPEED / limit) ** 2
    dwell = dwell_angle(SLOPED_SINE, 0.5, TOLERANCE)
    rows = []
    for steps in STEPS:
        found, found_limit = lowest_margin(steps)
        errors = (found - margin, found_limit / RPM / limit - 1.0, sampled_dwell(steps) - dwell)
        of_margin, of_limit, of_dwell = (small(abs(error), FLOOR) for error in errors)
        values = (number(found, 6), of_margin, number(found_limit / RPM, 4), of_limit, of_dwell)
        rows.append(Row((str(steps), *values)))
    return Section(
        f"Belt and dwell over the steps in a revolution ({MACHINE} at {number(SPEED, 0)} rev/min)",
        (
            "steps", "lowest margin", "error", "lowest speed limit, rev/min", "relative error",
            "error of the sampled dwell, rad",
        ),
        tuple(rows),
        intro=f"Exact: lowest margin {number(margin, 6)}, limit {number(limit, 4)} rev/min, dwell of the"
        f" default drive {number(math.degrees(dwell), 5)} deg.",
        remarks=(
            "`dwell_angle` of `DobbyDrive` follows from the law itself and does not depend on the step. The"
            " column is for the dwell as a claim finds it, from samples of lift, velocity and acceleration.",
        ),
    )  # fmt: skip
