"""BeltWrap: what holds the rapier belt on its wheel."""

from dataclasses import dataclass
from math import inf, pi
from typing import ClassVar

from ..declaring.declarations import input_, output, parameter
from ..declaring.variables import NOTHING, PUBLISHED, Component
from ..physics.belt_wrap import bending_moment, bending_strain, bending_stress, lever_arm, restraint_load
from .quantities import BENDING_STIFFNESS, LENGTH, STRESS, THICKNESS, TURN, WHEEL_DIAMETER
from .shared_declarations import found_once


@dataclass(slots=True)
class BeltWrap(Component):
    """Belt wrapped on the rapier wheel: load of the blocks that press it there."""

    keeps: ClassVar[str] = NOTHING
    origin: ClassVar[str] = PUBLISHED
    longest_turn: ClassVar[float] = inf

    bending_stiffness: float = parameter(BENDING_STIFFNESS, 0.25, "Bending stiffness EI of the belt")
    wheel_diameter: float = parameter(WHEEL_DIAMETER, 0.397, "Bottom diameter of the rapier wheel")
    thickness: float = parameter(
        THICKNESS, 1.35e-3, "Thickness of the belt, for its strain and stress (published)"
    )
    width: float = parameter(
        LENGTH.within(1e-4, 1.0, nominal=0.01), 0.030, "Width of the belt, for its stress (published)"
    )
    wrap_angle: float = parameter(TURN, pi, "Angle of the belt on the wheel, for information only: no effect")
    block_clearance: float = input_(
        LENGTH.within(1e-6, 0.01, nominal=1e-3), 0.3e-3, "Clearance between block and belt; grows with wear"
    )
    lever_arm: float = output(
        LENGTH, "Lever arm of the restraint load", nominal=0.01, follows="block_clearance"
    )
    restraint_load: float = output(
        "N", "Load of each block on the belt", nominal=10.0, follows="block_clearance"
    )
    bending_moment: float = found_once("N.m", "Moment that bends the belt onto the wheel")
    bending_strain: float = found_once("1", "Strain of the belt's outer face on the wheel", nominal=0.01)
    bending_stress: float = found_once(STRESS, "Stress in the belt's outer face on the wheel, by its strain")

    def initialize(self, time: float) -> int:
        """Bend the belt to the wheel."""
        self.bending_moment = bending_moment(self.bending_stiffness, self.wheel_diameter)
        self.bending_strain = bending_strain(self.thickness, self.wheel_diameter)
        self.bending_stress = bending_stress(
            self.bending_stiffness, self.width, self.thickness, self.wheel_diameter
        )
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Follow the clearance: a function of it alone."""
        self.lever_arm = lever_arm(self.wheel_diameter, self.block_clearance)
        self.restraint_load = restraint_load(
            self.bending_stiffness, self.wheel_diameter, self.block_clearance
        )
        return 0
