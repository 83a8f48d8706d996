"""The belt in motion as it bends: by its modes and end shapes, where a trace has them, magnified across."""

from dataclasses import dataclass
from functools import cache
from math import pi, sin

import numpy as np
from numpy.typing import NDArray

from ...components import COMPONENTS
from ...physics.belt_ends import end_shape
from ...physics.belt_shape import shape_at
from ..rules import TABLE, Rule, mm
from .sketch import Shapes, Sketch
from .tracks import Tracks

MOVING = "BeltDynamics"  # the FMU of a belt whose deflection is integrated
FLAT = 1e-2  # mm: nothing of less width or height is drawn at all
QUARTER = [(round(x, 4), round(sin(0.5 * pi * x), 4)) for x in np.linspace(0.0, 1.0, 17)]  # of a wave
POINTS = 49  # along the belt: sixteen on each wave of the sixth mode
FINE = 1e-4  # mm, of which the largest magnification makes a twentieth
ROOM = 0.15  # of the length that is drawn, for the deflection to either side
MAGNIFICATIONS = [each * 10.0**power for power in (2, 1, 0, -1) for each in (5.0, 2.0, 1.0)]
WHOLE = "The belt has the shape that the run has computed."
QUARTERS = (
    "The trace has the largest deflection and its place alone: the belt is drawn bent upwards, between"
    " quarter waves. loomfmu run --report records its whole shape."
)


@dataclass(frozen=True)
class Motion:
    """The tracks of a belt's shape in motion: amplitudes or, where a trace has none, two quarter waves.

    `length` is that which is drawn [mm], `magnified` how many times deflections are drawn.
    """

    length: float
    magnified: str
    amplitudes: tuple[str, ...]
    place: str = ""
    bend: str = ""
    rest: str = ""

    @property
    def note(self) -> str:
        """The note on what is drawn."""
        shape = WHOLE if self.amplitudes else QUARTERS
        scales = "Lengths along the belt are to scale, and deflections are magnified."
        return f"{shape} {scales} The head lags by the recorded shortening."

    @property
    def box(self) -> tuple[float, float, float]:
        """Right, bottom and top of its drawing [mm]."""
        room = max(60.0, 1.05 * ROOM * self.length)
        return self.length, -room, room

    def draw(self, sketch: Sketch, outside: str, tail: str, role: str) -> None:
        """The belt from its guide to its head."""
        with sketch.group(shown=outside):
            if self.amplitudes:
                sketch.curve(tail, self.magnified, self.amplitudes, basis(), role)
            else:
                for at, wide in ((0.0, self.place), (tail, self.rest)):
                    with sketch.group(stretch=(at, 0.0, wide, self.bend)):
                        sketch.line(*QUARTER, role=role)


def motion_of(tracks: Tracks, name: str, tail: Rule) -> Motion:
    """The tracks of a belt in motion; `tail` is where its head begins [mm]."""
    free, bent = (mm(f"{name}.{each}") for each in ("free_length", "deflection"))
    length = max(200.0, 1.15 * float(tracks.values(["highest", free])))
    magnified = tracks.add(f"{name}.magnified", _magnification(bent, ROOM * length), 0.1)
    signals = [f"{name}.{each}" for each in COMPONENTS[MOVING].drawn]
    if all(each in tracks.trace for each in signals):
        return Motion(length, magnified, tuple(tracks.add(f"{each}_mm", mm(each), FINE) for each in signals))
    return Motion(
        length,
        magnified,
        (),
        tracks.add(f"{name}.place", ["max", mm(f"{name}.deflection_place"), FLAT]),
        tracks.add(f"{name}.bend", ["max", ["*", magnified, bent], FLAT]),
        tracks.add(f"{name}.rest", ["min", ["-", f"{name}.place", tail], -FLAT]),
    )


def _magnification(bent: Rule, room: float) -> Rule:
    """The largest number of times with which the largest deflection of all fits a room [mm]."""
    ends = [room / each for each in MAGNIFICATIONS]
    steps = np.array([(end, np.nextafter(end, np.inf)) for end in ends]).ravel()
    values = np.repeat(MAGNIFICATIONS, 2)
    return [TABLE, ["highest", bent], steps[:-1].tolist(), values[1:].tolist()]


def modes(tracks: Tracks) -> Shapes | None:
    """The shapes of which belts are drawn, for the page; None if there is no such belt."""
    return basis() if any(name.endswith(".magnified") for name in tracks.made) else None


@cache
def basis() -> Shapes:
    """Deflections from the guide to the head by one unit of each amplitude.

    >>> basis().shape, [float(max(abs(row))) for row in basis()[:3]]
    ((8, 49), [1.0, 1.0, 1.0])
    """
    along = np.linspace(1.0, 0.0, POINTS)
    return np.array([[round(_deflection(unit, x), 6) for x in along] for unit in np.eye(8)])


def _deflection(amplitudes: NDArray[np.float64], x: float) -> float:
    *modes, guide, head = amplitudes.tolist()
    return shape_at(x, end_shape(guide, head, modes), guide, head)[0]
