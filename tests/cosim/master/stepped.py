"""Runs of the master with a stepper that a test chooses."""

import numpy as np

from loomfmu.cosim.master.grid import Grid
from loomfmu.cosim.master.loops import CompiledIteration
from loomfmu.cosim.master.master import Master
from loomfmu.cosim.master.steppers import CompiledStepper
from loomfmu.cosim.scenes.scene import Scene

Samples = list[np.ndarray]


def stepped(scene: Scene, stepper: type, grid: Grid | None = None, block: int = 100) -> Samples:
    """All samples of a run by a stepper of this class: times, reals and integers."""
    with Master(scene, grid, compiled=stepper in (CompiledStepper, CompiledIteration)) as master:
        master.initialize()
        assert type(master._stepper) is stepper
        return sampled(master, block)


def sampled(master: Master, block: int = 100) -> Samples:
    """All samples of an initialized master's run: times, reals and integers, over all blocks."""
    blocks: list[Samples] = []
    master.run(block, lambda *parts: blocks.append([part.copy() for part in parts]), lambda _step: None)
    return [np.concatenate(parts) for parts in zip(*blocks, strict=True)]


def same_bits(one: Samples, other: Samples) -> None:
    for part, its in zip(one, other, strict=True):
        np.testing.assert_array_equal(part, its)
