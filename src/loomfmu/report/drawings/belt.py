"""The rapier's belt: across the loom's width, and between its guide and the head, buckled as it is."""

from dataclasses import dataclass
from math import asin, pi, sin

import numpy as np
from numpy.typing import NDArray

from ...physics.belt import LARGEST_BEND, MOST_BENT, complete_elliptic
from ..occasions import instances
from ..rules import TABLE, Rule, mm
from .moving import MOVING, Motion, motion_of
from .sketch import Figure, Sketch, Value, title
from .tracks import FINEST, Tracks

Floats = NDArray[np.float64]
FINER = FINEST  # a belt buckles within a degree
POINTS = 33  # of a buckled belt
SHAPES = 41  # between a straight belt and the one that is bent most
HEAD = 150.0  # mm: length drawn of the head, of which a trace knows only the length with its rigid section


def _quarters(halves: Floats) -> Floats:
    """Quarter periods of elasticas, by half the slope of their ends."""
    return np.array([complete_elliptic(sin(half)) for half in halves])


# All elasticas, by half the slope of its ends [rad]: deflections over the length up to the
# largest one, then loads over the critical one.
MOST = asin(MOST_BENT)
RISING = np.linspace(0.0, MOST, 400).round(9).tolist()
SHARES = (np.sin(RISING) / _quarters(RISING)).round(9).tolist()
BENT_BACK = (0.5 * pi - np.geomspace(0.5 * pi - MOST, 1e-6, 500)).round(9).tolist()
LOADS = ((2.0 / pi * _quarters(BENT_BACK)) ** 2).round(6).tolist()


def elastica(modulus: float) -> tuple[Floats, Floats]:
    """A pinned column of length 1 that has buckled, from x = 0 along x: x and y of its points.

    With `sin(t / 2) = k sin(p)` for its slope t, p from -pi/2 to pi/2,

        y = k cos(p) / K(k),  dx = (1 - 2 k^2 sin(p)^2) / sqrt(1 - k^2 sin(p)^2) dp / (2 K(k))

    so that its largest deflection is that of `loomfmu.physics.belt.elastica_deflection`.
    """
    p = np.linspace(-0.5 * pi, 0.5 * pi, 32 * (POINTS - 1) + 1)
    square = (modulus * np.sin(p)) ** 2
    slope = (1.0 - 2.0 * square) / np.sqrt(1.0 - square)
    quarter = complete_elliptic(modulus)
    x = np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]))]) * (p[1] - p[0]) / (2.0 * quarter)
    return x[::32], modulus * np.cos(p[::32]) / quarter


def half_slope(deflection: Rule, free_length: Rule, load: Rule) -> Rule:
    """Half the slope of the belt's ends [rad], from its recorded deflection.

    Beyond 2.2 times its critical load a column is bent back and its deflection falls again: `load` over the
    critical one, 0 if it is not known, tells which of the two shapes it has.
    """
    share: Rule = ["/", deflection, ["max", free_length, 1e-9]]
    bent = [
        "if positive",
        ["-", load, LOADS[0]],
        [TABLE, load, LOADS, BENT_BACK],
        [TABLE, share, SHARES, RISING],
    ]
    return ["if positive", ["min", deflection, free_length], bent, 0.0]


@dataclass(frozen=True)
class Belt:
    """The tracks of a belt: lengths from the end of its guide, inwards [mm]."""

    name: str
    outside: str
    inside: str
    tail: str
    tip: str
    within: Rule  # positive while the head is in the shed, the belt taken as straight
    deflection: str
    slope: str  # half that of its ends [rad]; empty if it never buckles
    pressed: str  # empty if its compression is not recorded
    idle: float
    head: float
    motion: Motion | None  # None where a load that lasts bends it


def tracked(tracks: Tracks, name: str) -> Belt:
    """The tracks of a belt that records its free length and its deflection."""
    trace, live = tracks.trace, tracks.subject.live
    moving = trace.fmus[name] == MOVING
    force = f"{name}.{'compression' if moving else 'axial_force'}"
    free, bent = (f"{name}.{each}" for each in ("free_length", "deflection"))
    idle, head = (1000.0 * tracks.parameter(f"{name}.{each}") for each in ("idle_travel", "head_length"))
    slope, tail = "", mm(free)
    if moving:
        tail = mm(["-", free, f"{name}.shortening"])
    elif live or tracks.values(["highest", bent]) > 0.0:
        known = f"{name}.margin" in trace  # of the load
        load: Rule = ["-", 1.0, f"{name}.margin"] if known else 0.0
        slope = tracks.add(f"{name}.slope", half_slope(bent, free, load), 1e-4, FINER)
        grid = np.linspace(0.0, _steepest(tracks, slope), 100)
        chords = [round(float(elastica(sin(each))[0][-1]), 7) for each in grid]
        tail = ["if positive", free, ["*", mm(free), [TABLE, slope, grid.tolist(), chords]], mm(free)]
    finer = FINER if slope else 1
    pressed = tracks.add(f"{name}.pressed", ["min", mm(free), force], 1e-3) if force in trace else ""
    return Belt(
        name,
        tracks.add(f"{name}.outside", mm(["max", free, 0.0])),
        tracks.add(f"{name}.inside", mm(["min", free, 0.0])),
        tracks.add(f"{name}.tail", tail, finer=finer),
        tracks.add(f"{name}.tip", ["-", tail, -head], finer=finer),
        ["-", mm(free), -head],
        tracks.mm(bent, finer),
        slope,
        pressed,
        idle,
        head,
        motion_of(tracks, name, tail) if moving else None,
    )


def _steepest(tracks: Tracks, slope: str) -> float:
    """The largest half slope that is drawn: any, if the page itself runs the belt."""
    return BENT_BACK[-1] if tracks.subject.live else float(np.max(tracks.values(slope)))


def reached(tracks: Tracks, belt: Belt) -> float:
    """Return how far the head gets into the shed [mm]."""
    return float(tracks.values(["highest", mm(f"{belt.name}.free_length")])) + belt.head


def wheel_radius(tracks: Tracks, belt: Belt) -> float:
    """Radius of the wheel on which a belt is wound [mm]; 0 if the trace has none."""
    trace, source = tracks.trace, tracks.trace.wires.get(f"{belt.name}.travel", "").partition(".")[0]
    known = sorted(instances(trace, "WeftInsertion"), key=lambda name: name != source)
    wheels = [f"{each}.wheel_diameter" for each in (*known, *instances(trace, "BeltWrap"))]
    return 500.0 * tracks.parameter(wheels[0]) if wheels else 0.0


def wheel_centre(belt: Belt, radius: float) -> float:
    """Place of the wheel before the end of the guide [mm]."""
    return -belt.idle - belt.head - 1.3 * radius


def wound(sketch: Sketch, belt: Belt, radius: float) -> None:
    """A wheel from which a belt leaves at the height of the head."""
    centre = wheel_centre(belt, radius)
    sketch.circle((centre, radius), radius, "body")
    sketch.joint((centre, radius))
    around = [(centre - radius * np.sin(a), radius + radius * np.cos(a)) for a in np.linspace(0.0, pi, 25)]
    sketch.line(*around, role="link belt")


def through_guide(sketch: Sketch, belt: Belt, radius: float, half: float) -> None:
    """A belt from its wheel through its guide to its head, of which half the height is given."""
    centre = wheel_centre(belt, radius)
    for y in (-half, half):
        sketch.line((centre + 1.1 * radius, y), (0.0, y), role="rail")
    _belt(sketch, belt, centre, half)


def between(tracks: Tracks, belt: Belt) -> Figure:
    """The free section between guide and head, large enough to see it bend."""
    motion, live = belt.motion, tracks.subject.live
    right, bottom, top = motion.box if motion else _box(tracks, belt)
    sketch = Sketch(tracks, -0.2 * right, bottom, right, top)
    half = max(9.0, 0.016 * right)
    for y in (-half, half):
        sketch.line((sketch.left, y), (0.0, y), role="rail")
    sketch.line((0.0, 0.0), (right, 0.0), role="path")
    _belt(sketch, belt, 2.0 * sketch.left, half)
    sketch.label(0.0, half, "guide", "end", (-4.0, -6.0))
    shape = (
        "The belt is drawn as its load bends it, without vibration: the exact elastica of the recorded"
        " deflection, pinned at both ends, bent upwards and not exaggerated. The head lags by the length that"
        " the bend takes up."
        if belt.slope
        else "In this run the belt does not buckle; it is drawn without vibration."
    )
    note = motion.note if motion else shape
    does = "" if live or motion else f", which {'buckles' if belt.slope else 'does not buckle'} in this run"
    values = [Value("free length", belt.outside, "mm"), Value("deflection", belt.deflection, "mm")]
    return sketch.figure(
        f"belt-{belt.name}",
        title("Belt in motion" if motion else "Belt between guide and head", belt.name, "belt"),
        f"The free section of the belt between its guide and the rapier head{does}.",
        [*values, Value("drawn", motion.magnified, "times as large", steps=True)] if motion else values,
        f"{note} Dark orange: outside the guide and compressed.",
    )


def _box(tracks: Tracks, belt: Belt) -> tuple[float, float, float]:
    """Right, bottom and top of the drawing of a belt that a load bends which lasts [mm]."""
    free, bent = (tracks.values(mm(f"{belt.name}.{each}")) for each in ("free_length", "deflection"))
    at_risk = np.asarray(bent > 0.0)
    if belt.pressed and not np.any(at_risk):
        at_risk = tracks.values(belt.pressed) > 0.0
    longest = float(np.max(free[at_risk])) if np.any(at_risk) else 200.0
    top = LARGEST_BEND * longest if tracks.subject.live else 1.15 * float(np.max(bent))
    return max(200.0, 1.6 * longest), -30.0, max(60.0, top)


def _belt(sketch: Sketch, belt: Belt, start: float, half: float) -> None:
    """The belt from its wheel to its head."""
    sketch.line((start, 0.0), (belt.inside, 0.0), role="link belt")
    _free(sketch, belt, "link belt")
    if belt.pressed:
        with sketch.group(shown=belt.pressed):
            _free(sketch, belt, "link risk")
    with sketch.group(shift=(belt.tail, 0.0)):
        front = max(belt.head - HEAD, 0.0)
        sketch.line((0.0, 0.0), (front, 0.0), role="link rigid")
        nose = belt.head - 0.4 * half
        outline = (front, half), (nose, half), (belt.head, 0.0), (nose, -half), (front, -half)
        sketch.line(*outline, role="body weft", closed=True)
        sketch.joint((0.0, 0.0))


def _free(sketch: Sketch, belt: Belt, role: str) -> None:
    if belt.motion:
        belt.motion.draw(sketch, belt.outside, belt.tail, role)
        return
    if not belt.slope:
        sketch.line((0.0, 0.0), (belt.outside, 0.0), role=role)
        return
    length = sketch.tracks.at(belt.outside)
    x, y = elastica(sin(sketch.tracks.at(belt.slope)))
    shape = " ".join(f"{length * a:.3f} {length * b:.3f}" for a, b in zip(x, y, strict=True))
    sketch.bow(belt.slope, belt.outside, (0.0, 0.0), shape, role)


def bows(tracks: Tracks) -> dict[str, object] | None:
    """Elasticas up to the largest slope that occurs, for the page; None if no belt buckles."""
    largest = [_steepest(tracks, name) for name in tracks.made if name.endswith(".slope")]
    if not largest:
        return None
    rows = [elastica(sin(half)) for half in np.linspace(0.0, max(largest), SHAPES)]
    return {
        "largest": max(largest),
        "x": [np.round(x, 5) for x, _y in rows],
        "y": [np.round(y, 5) for _x, y in rows],
    }
