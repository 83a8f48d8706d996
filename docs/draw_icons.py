"""Draws the icon of every FMU: one characteristic curve, computed by the component itself."""

from math import pi
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.patches import FancyBboxPatch

from loomfmu.components import (
    BeltDynamics,
    BeltMonitor,
    DobbyDrive,
    HealdDamper,
    HealdFrame,
    MainShaft,
    WeftInsertion,
)
from loomfmu.components.belt_wrap import BeltWrap
from loomfmu.components.detaching_roller import DetachingRoller
from loomfmu.components.driven_shaft import DrivenShaft
from loomfmu.components.heald_play import HealdPlay
from loomfmu.components.pattern_lock import PatternLock
from loomfmu.components.reed_beat_up import ReedBeatUp
from loomfmu.components.warp_tension import WarpTension
from loomfmu.components.weft_tension import WeftTension
from loomfmu.components.weft_transfer import WeftTransfer
from loomfmu.declaring.variables import Component

ROOT = Path(__file__).parents[1]
FMUS = ROOT / "fmus"
LOOM = ROOT / "src" / "loomfmu" / "fmi" / "system"  # where the icon of a whole scene lies
BLUE, RED, PALE, GROUND, EDGE = "#1f5f8b", "#d1495b", "#a9bfcd", "#f5f8fa", "#8fa5b3"
# an input of a component takes the output of the same name of the component before it
WIRES = ("rotor_angle", "rotor_velocity", "rotor_acceleration", "travel", "lift", "velocity", "acceleration")


def trace(chain: list[Component], turns: float, *names: str) -> list[list[float]]:
    """Shaft revolutions and the named outputs of the last component of a chain, run in dependency order."""
    period = 2 * pi / chain[0].speed
    samples = 720
    h = turns * period / samples
    rows = []
    for step in range(samples + 1):
        for before, component in zip([None, *chain], chain, strict=False):
            for name in WIRES:
                if hasattr(before, name) and hasattr(component, name):
                    setattr(component, name, getattr(before, name))
            problem = component.step((step - 1) * h, h) if step else component.initialize(0.0)
            assert problem == 0, f"{type(component).__name__} reports problem {problem}"
        rows.append([step * h / period, *(getattr(chain[-1], name) for name in names)])
    return [list(column) for column in zip(*rows, strict=True)]


def draw(
    name: str | Path,
    *curves: tuple[list[float], list[float], str],
    levels: tuple[float, ...] = (),
    level_colour: str = PALE,
) -> None:
    """Write one icon: curves over thin level lines on a light ground in a rounded frame."""
    figure = plt.figure(figsize=(1.28, 1.28), dpi=100)
    frame = FancyBboxPatch(
        (0.03, 0.03), 0.94, 0.94, boxstyle="round,pad=0,rounding_size=0.16", zorder=-1,
        transform=figure.transFigure, facecolor=GROUND, edgecolor=EDGE, linewidth=1.2,
    )  # fmt: skip
    figure.add_artist(frame)
    axes = figure.add_axes((0.13, 0.17, 0.74, 0.66))
    axes.axis("off")
    axes.margins(x=0.0, y=0.0)
    for level in levels:
        axes.axhline(level, color=level_colour, linewidth=1.3, clip_on=False)
    for x, y, colour in curves:
        axes.plot(x, y, color=colour, linewidth=2.8, solid_capstyle="round", clip_on=False)
    figure.savefig(FMUS / name / "icon.png", transparent=True, metadata={"Software": None})
    plt.close(figure)


def wrapped_load(diameter: float, clearance: float) -> float:
    """Load of a block on the belt around a wheel."""
    belt = BeltWrap(wheel_diameter=diameter, block_clearance=clearance)
    assert belt.initialize(0.0) == 0
    return belt.restraint_load


def braked(turns: int) -> tuple[list[float], list[float]]:
    """Shaft revolutions and velocity of a shaft that feels the weft insertion it drives."""
    shaft, weft = DrivenShaft(), WeftInsertion(follow_shaft=True, inputs_at_step_end=True)
    h = 2 * pi / shaft.speed / 720
    assert shaft.initialize(0.0) == weft.initialize(0.0) == 0
    rows = []
    for step in range(720 * (turns + 3)):
        weft.shaft_angle, weft.shaft_velocity = shaft.angle, shaft.velocity
        weft.shaft_acceleration = shaft.acceleration
        assert weft.step(step * h, 0.0) == 0
        shaft.torque_1 = weft.shaft_torque
        assert shaft.step(step * h, h) == 0
        rows.append((step / 720, shaft.velocity))
    time, velocity = zip(*rows[3 * 720 :], strict=True)
    return list(time), list(velocity)


def struck(turns: int) -> tuple[list[float], list[float]]:
    """Revolutions, and the displacement of a heald on a frame whose threads pull it from bar to bar."""
    dobby, frame = DobbyDrive(), HealdFrame(inputs_at_step_end=True)
    warp = WarpTension(inputs_at_step_end=True)
    heald = HealdPlay(inputs_at_step_end=True)
    samples = 720 * turns
    h = turns * 2 * pi / dobby.speed / samples
    rows = []
    for step in range(samples + 1):
        for before, component in ((None, dobby), (dobby, frame), (frame, warp), (frame, heald)):
            for name in WIRES:
                if hasattr(before, name) and hasattr(component, name):
                    setattr(component, name, getattr(before, name))
            heald.warp_load = warp.frame_load
            assert (component.step((step - 1) * h, h) if step else component.initialize(0.0)) == 0
        rows.append((turns * step / samples, heald.displacement))
    return [row[0] for row in rows], [row[1] for row in rows]


def main() -> None:
    """Draw all of them."""
    time, velocity = trace([MainShaft(ramp_duration=0.2, ripple_amplitude=0.06)], 2, "velocity")
    draw("main_shaft", (time, velocity, BLUE), levels=(0.0,))

    time, velocity = braked(2)
    draw("driven_shaft", (time, velocity, BLUE), levels=(DrivenShaft().speed,), level_colour=RED)

    time, travel = trace([WeftInsertion()], 1, "travel")
    draw("weft_insertion", (time, travel, BLUE), levels=(0.0,))

    fast = 650 * 2 * pi / 60
    chain = [WeftInsertion(speed=fast), BeltMonitor(speed=fast, inputs_at_step_end=True)]
    time, load, critical, free = trace(chain, 1, "axial_force", "critical_force", "free_length")
    rows = zip(time, critical, free, strict=True)
    window = [(at, force) for at, force, length in rows if length > 0.0 and force < max(load)]
    draw("belt_monitor", (*map(list, zip(*window, strict=True)), RED), (time, load, BLUE), levels=(0.0,))

    chain = [WeftInsertion(), BeltDynamics(bow_of=2, inputs_at_step_end=True)]
    time, deflection = trace(chain, 0.5, "deflection")
    draw("belt_dynamics", (time[300:], deflection[300:], BLUE), levels=(0.0,))

    chain = [WeftInsertion(), WeftTension(inputs_at_step_end=True)]
    time, behind, tension = trace(chain, 1, "eye_tension", "tension")
    draw("weft_tension", (time, behind, PALE), (time, tension, BLUE), levels=(0.0,))

    time, travel = trace([WeftInsertion()], 1, "travel")
    other = [WeftTransfer().separation - each for each in travel]
    draw("weft_transfer", (time, other, RED), (time, travel, BLUE))

    time, velocity = trace([DobbyDrive(speed_reduction=0.7)], 2, "rotor_velocity")
    draw("dobby_drive", (time, velocity, BLUE), levels=(DobbyDrive().speed,))

    time, lift = trace([DobbyDrive(), HealdFrame(inputs_at_step_end=True)], 2, "lift")
    time, other = trace([DobbyDrive(), HealdFrame(inputs_at_step_end=True, pattern_1=2)], 2, "lift")
    draw("heald_frame", (time, other, PALE), (time, lift, BLUE))

    time, travel = trace([WeftInsertion()], 2, "travel")
    scale = max(lift) / max(travel)
    draw(LOOM, (time, other, PALE), (time, lift, BLUE), (time, [scale * x for x in travel], RED))

    carrier = HealdDamper(inputs_at_step_end=True)
    frame = HealdFrame(inputs_at_step_end=True)
    time, displacement = trace([DobbyDrive(speed=20 * pi), frame, carrier], 2, "displacement")
    stops = (-carrier.free_travel, carrier.free_travel)
    draw("heald_damper", (time, displacement, BLUE), levels=stops, level_colour=RED)

    time, acceleration = trace([ReedBeatUp(beat_up_angle=pi)], 1, "acceleration")
    draw("reed_beat_up", (time, acceleration, BLUE), levels=(0.0,))

    clearances = [1e-5 * step for step in range(5, 106)]
    small, large = (
        [wrapped_load(diameter, clearance) for clearance in clearances] for diameter in (0.250, 0.397)
    )
    draw("belt_wrap", (clearances, small, PALE), (clearances, large, BLUE), levels=(0.0,))

    time, torque, drafting = trace([DetachingRoller(speed=10 * pi)], 1, "unit_torque", "drafting_torque")
    window = [(at, drafts) for at, drafts in zip(time, drafting, strict=True) if drafts > 0.0]
    draw(
        "detaching_roller", (*map(list, zip(*window, strict=True)), RED), (time, torque, BLUE), levels=(0.0,)
    )

    warp = WarpTension(inputs_at_step_end=True)
    time, tension = trace([DobbyDrive(), HealdFrame(inputs_at_step_end=True), warp], 2, "tension")
    draw("warp_tension", (time, tension, BLUE), levels=(0.0, warp.pretension))

    time, displacement = struck(2)
    bars = (-0.5 * HealdPlay().play, 0.5 * HealdPlay().play)
    draw("heald_play", (time, displacement, BLUE), levels=bars, level_colour=RED)

    time, turn, velocity = trace([PatternLock()], 2, "turn", "turn_velocity")
    largest = max(velocity) / max(turn)
    draw("pattern_lock", (time, [rate / largest for rate in velocity], PALE), (time, turn, BLUE))


if __name__ == "__main__":
    main()
