"""The warp threads of a frame: what both components are given that stretch them."""

from dataclasses import dataclass

from ..declaring.declarations import parameter
from ..declaring.variables import Component
from .quantities import CREEP, LENGTH, STROKE, TENSION, THREAD_LENGTH


@dataclass(slots=True)
class Threads(Component):
    """Number, lengths and constants of the threads that one frame lifts."""

    thread_count: int = parameter(
        "1", 1260, "Number of threads in the frame", minimum=1, maximum=1000000, source="warp_#.thread_count"
    )
    stroke: float = parameter(STROKE, 0.098, "Stroke of the frame", source="heald_#.stroke")
    shed_offset: float = parameter(
        LENGTH.within(-1.0, 1.0, nominal=0.001),
        0.0018,
        "Height of the heald eyes above the warp line with the frame half-way (assumed)",
        source="warp_#.shed_offset",
    )
    front_length: float = parameter(
        THREAD_LENGTH,
        0.25,
        "Length of warp from the cloth's fell to the healds (assumed)",
        source="warp_#.front_length",
    )
    back_length: float = parameter(
        THREAD_LENGTH, 0.5, "Length of warp, healds to back rest (assumed)", source="warp_#.back_length"
    )
    pretension: float = parameter(
        TENSION.within(0.0, 1e3),
        0.15,
        "Tension of a thread at rest in the closed shed",
        source="warp_#.pretension",
    )
    thread_stiffness: float = parameter(
        "N/m",
        67.0,
        "Stiffness b of a thread (assumed)",
        minimum=0.0,
        maximum=1e9,
        nominal=100.0,
        source="warp_#.thread_stiffness",
    )
    creep_rate: float = parameter(
        CREEP, 5.0, "Creep rate n of a thread (assumed)", source="warp_#.creep_rate"
    )
    relaxation_rate: float = parameter(
        CREEP, 10.0, "Relaxation rate r of a thread (assumed)", source="warp_#.relaxation_rate"
    )
