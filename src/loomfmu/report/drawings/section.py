"""The loom in motion: a drawing of each mechanism that the trace records."""

from dataclasses import replace
from math import degrees, floor

from ..occasions import instances
from ..section import COARSEST, TURN, Section, Subject
from ..templates import template
from .belt import between, bows, tracked
from .drive import drive, figure
from .front import pairs, transfer, view
from .moving import MOVING, modes
from .reed import beat_up
from .side import shed_of, views
from .sketch import Figure
from .tracks import Tracks
from .yarn import yarn

WHOLE, DETAILS = "The loom", "Its mechanisms"  # titles
DRAWN = {
    "WeftInsertion": ("travel",),
    "BeltMonitor": ("free_length", "deflection"),
    MOVING: ("free_length", "deflection"),
    "WeftTension": ("length", "tension"),
    "HealdFrame": ("lift",),
    "ReedBeatUp": ("position",),
}


def sections(subject: Subject) -> list[Section]:
    """The whole loom and its mechanisms in motion; nothing if the trace records none of them."""
    if not any(instances(subject.trace, fmu, *signals) for fmu, signals in DRAWN.items()):
        return []
    if subject.turns and subject.gap > COARSEST:
        apart = f"{degrees(subject.gap):.0f}°"
        coarse = f"Not drawn: the samples are up to {apart} apart, too far to show a motion."
        return [Section("motion", DETAILS, template("motion.html.j2").render(coarse=coarse))]
    tracks = Tracks(subject, subject.start)
    whole, details = _figures(tracks)
    parts = [each for each in (("loom", WHOLE, whole), ("motion", DETAILS, details)) if each[2]]
    if not parts:
        return []
    place = _place(subject, tracks.still)
    pages = [
        template("motion.html.j2").render(
            coarse="", figures=figures, name=name, place="" if number else place
        )
        for number, (name, _title, figures) in enumerate(parts)
    ]
    moved = (tracks.rules() if subject.live else tracks.data()) | {
        "bows": bows(tracks),
        "modes": modes(tracks),
    }
    made = [Section(name, title, html) for (name, title, _figures), html in zip(parts, pages, strict=True)]
    return [*made[:-1], replace(made[-1], scripts=("motion.js",), data=moved)]


def _figures(tracks: Tracks) -> tuple[list[Figure], list[Figure]]:
    """The whole loom, then each mechanism: in the order of the weft's way, then of the warp's."""
    weft, belts, yarns, reeds = (
        instances(tracks.trace, fmu, *DRAWN[fmu])
        for fmu in ("WeftInsertion", "BeltMonitor", "WeftTension", "ReedBeatUp")
    )
    drives = {name: found for name in weft if (found := drive(tracks, name))}
    monitored = [tracked(tracks, name) for name in belts]
    moving = [tracked(tracks, name) for name in instances(tracks.trace, MOVING, *DRAWN[MOVING])]
    shed, met = shed_of(tracks, monitored[0] if monitored else None), pairs(tracks, monitored)
    whole = views(tracks, shed) if shed else []
    details = [
        *(figure(tracks, each) for each in drives.values()),
        *(transfer(tracks, pair) for pair in met),
        *(between(tracks, belt) for belt in (*monitored, *moving)),
        *(yarn(tracks, name) for name in yarns),
        *(beat_up(tracks, name) for name in reeds),
    ]
    whole += [view(tracks, pair, drives, shed) for pair in met]
    return whole, [each for each in details if each]


def _place(subject: Subject, position: float) -> str:
    if not subject.turns:
        return f"{position:.6g} s"
    turn = floor(position / TURN + 1e-12)
    return f"rev. {turn + 1}, {degrees(position - turn * TURN):.1f}°"
