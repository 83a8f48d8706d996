"""The warp threads of a frame: what both components are given that stretch them."""

from dataclasses import dataclass

from ..declaring.declarations import parameter
from ..declaring.variables import Component


@dataclass(slots=True)
class Threads(Component):
    """Number, lengths and constants of the threads that one frame lifts."""

    thread_count: int = parameter(
        "1", 1260, "Number of threads in the frame", minimum=1, maximum=1000000, source="warp_#.thread_count"
    )
    stroke: float = parameter(
        "m",
        0.098,
        "Stroke of the frame",
        display="mm",
        minimum=0.0,
        maximum=1.0,
        nominal=0.1,
        source="heald_#.stroke",
    )
    shed_offset: float = parameter(
        "m",
        0.0018,
        "Height of the heald eyes above the warp line with the frame half-way (assumed)",
        display="mm",
        minimum=-1.0,
        maximum=1.0,
        nominal=0.001,
        source="warp_#.shed_offset",
    )
    front_length: float = parameter(
        "m",
        0.25,
        "Length of warp from the cloth's fell to the healds (assumed)",
        display="mm",
        minimum=1e-3,
        maximum=100.0,
        source="warp_#.front_length",
    )
    back_length: float = parameter(
        "m",
        0.5,
        "Length of warp, healds to back rest (assumed)",
        display="mm",
        minimum=1e-3,
        maximum=100.0,
        source="warp_#.back_length",
    )
    pretension: float = parameter(
        "N",
        0.15,
        "Tension of a thread at rest in the closed shed",
        display="cN",
        minimum=0.0,
        maximum=1e3,
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
        "1/s",
        5.0,
        "Creep rate n of a thread (assumed)",
        minimum=0.0,
        maximum=1e6,
        nominal=10.0,
        source="warp_#.creep_rate",
    )
    relaxation_rate: float = parameter(
        "1/s",
        10.0,
        "Relaxation rate r of a thread (assumed)",
        minimum=0.0,
        maximum=1e6,
        nominal=10.0,
        source="warp_#.relaxation_rate",
    )
