"""The loom in motion: a drawing of each mechanism that the trace records."""

from math import degrees, floor

from ..occasions import instances
from ..section import COARSEST, TURN, Section, Subject
from ..templates import template
from .belt import MOVING, between, shapes, tracked
from .drive import drive
from .rapiers import across
from .reed import beat_up
from .shed import frames, shed
from .sketch import Figure
from .tracks import Tracks
from .yarn import yarn

DRAWN = {
    "WeftInsertion": ("travel",),
    "BeltMonitor": ("free_length", "deflection"),
    MOVING: ("free_length", "deflection"),
    "WeftTension": ("length", "tension"),
    "HealdFrame": ("lift",),
    "ReedBeatUp": ("position",),
}


def section(subject: Subject) -> Section | None:
    """Drawings of the first trace's mechanisms; None if it records none that can be drawn."""
    if not any(instances(subject.trace, fmu, *signals) for fmu, signals in DRAWN.items()):
        return None
    if subject.turns and subject.gap > COARSEST:
        apart = f"{degrees(subject.gap):.0f}°"
        coarse = f"Not drawn: the samples are up to {apart} apart, too far to show a motion."
        return Section("motion", "The loom in motion", template("motion.html.j2").render(coarse=coarse))
    tracks = Tracks(subject, subject.start)
    figures = _figures(tracks)
    if not figures:
        return None
    place = _place(subject, tracks.still)
    html = template("motion.html.j2").render(coarse="", place=place, figures=figures)
    moved = tracks.rules() if subject.live else tracks.data()
    data = moved | {"bows": shapes(tracks)}
    return Section("motion", "The loom in motion", html, ("motion.js",), data)


def _figures(tracks: Tracks) -> list[Figure]:
    """Drawings in the order of the weft's way, then of the warp's."""
    weft, belts, yarns, reeds = (
        instances(tracks.trace, fmu, *DRAWN[fmu])
        for fmu in ("WeftInsertion", "BeltMonitor", "WeftTension", "ReedBeatUp")
    )
    drives = [drive(tracks, name) for name in weft]
    found = [tracked(tracks, name) for name in belts]
    ways = [*across(tracks, found), *(between(tracks, belt) for belt in found)]
    moving = instances(tracks.trace, MOVING, *DRAWN[MOVING])
    ways += [between(tracks, tracked(tracks, name)) for name in moving]
    warp = [shed(tracks, found[0].tip if found else ""), frames(tracks)]
    drawn = [yarn(tracks, name) for name in yarns]
    every = [*drives, *ways, *drawn, *warp, *(beat_up(tracks, name) for name in reeds)]
    return [figure for figure in every if figure]


def _place(subject: Subject, position: float) -> str:
    if not subject.turns:
        return f"{position:.6g} s"
    turn = floor(position / TURN + 1e-12)
    return f"rev. {turn + 1}, {degrees(position - turn * TURN):.1f}°"
