"""Which components have no memory: their outputs are functions of time, parameters and inputs alone.

Those are model-exchange FMUs as well, with no states. What they carry from step to step, if anything,
is computed from the parameters. A test holds each component to what is said of it here.
"""

from ..variables import Component

MEMORYLESS = (
    "MainShaft", "WeftInsertion", "DobbyDrive", "HealdFrame", "PatternLock", "ReedBeatUp", "BeltWrap",
    "DetachingRoller",
)  # fmt: skip


def is_memoryless(component: type[Component]) -> bool:
    """Whether no earlier step of a component has a part in its outputs.

    >>> from loomfmu.components import BeltMonitor, MainShaft
    >>> is_memoryless(MainShaft), is_memoryless(BeltMonitor)
    (True, False)
    """
    return component.__name__ in MEMORYLESS
