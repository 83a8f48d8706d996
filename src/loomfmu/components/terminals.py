"""Terminals: the variables that one connection carries from component to component."""

from dataclasses import replace

from ..declaring.variables import Terminal

SHAFT = Terminal("shaft", "Motion of the main shaft", ("angle", "velocity", "acceleration"))
HEAD = Terminal("head", "Motion of the rapier head", ("travel", "velocity", "acceleration"))
# one head of two: each fits what any rapier moves
GIVER = replace(HEAD, name="giver.head", description="Motion of the head that brings the weft")
TAKER = replace(HEAD, name="taker.head", description="Motion of the head that takes the weft")
ROTOR = Terminal(
    "rotor",
    "Motion of the dobby's rotor, and the lift it gives a frame",
    ("angle", "velocity", "acceleration", "lift_fraction", "lift_rate", "lift_acceleration"),
)
# the variables that carry it, at both of its ends
OF_ROTOR = (
    "rotor_angle",
    "rotor_velocity",
    "rotor_acceleration",
    "lift_fraction",
    "lift_rate",
    "lift_acceleration",
)
FRAME = Terminal("frame", "Motion of a heald frame", ("lift", "velocity", "acceleration"))
# a frame in a frame: fits what a frame lifts
CARRIER = replace(FRAME, name="carrier.frame", description="Motion of the heald carrier in its frame")
