"""The names that the file of a mechanism of your own imports.

Functions of `loomfmu.physics` can be imported, too: they are carried into the FMU with the rest.
"""

from .components.shaft_driven import TOO_FAR, ShaftDriven
from .components.terminals import FRAME, HEAD, ROTOR, SHAFT
from .declaring.arrays import array
from .declaring.declarations import at_step_end, auxiliary, indicator, input_, output, parameter, state
from .declaring.variables import EXTREMES, MOTION, NOTHING, Component, Problem, Terminal
from .physics.numerics.extremes import (
    highest_by_two_rates,
    highest_so_far,
    lowest_by_two_rates,
    lowest_so_far,
)
from .physics.shaft import carried, too_far

__all__ = [
    "EXTREMES",
    "FRAME",
    "HEAD",
    "MOTION",
    "NOTHING",
    "ROTOR",
    "SHAFT",
    "TOO_FAR",
    "Component",
    "Problem",
    "ShaftDriven",
    "Terminal",
    "array",
    "at_step_end",
    "auxiliary",
    "carried",
    "highest_by_two_rates",
    "highest_so_far",
    "indicator",
    "input_",
    "lowest_by_two_rates",
    "lowest_so_far",
    "output",
    "parameter",
    "state",
    "too_far",
]
