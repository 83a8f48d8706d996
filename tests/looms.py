"""Published looms as wired components: the weft insertion and the monitor of its belt."""

from collections.abc import Callable
from math import pi
from typing import Any

from loomfmu.components import BeltMonitor, WeftInsertion
from loomfmu.machines import parameters

RPM = pi / 30.0


class Loom:
    """A loom at constant speed, its belt monitored in steps of an equal angle."""

    def __init__(
        self,
        name: str = "WL680-3600",
        *,
        rpm: float = 600.0,
        steps: int = 720,
        head: str = "G6300 left",
        begin: float = 0.0,
        **belt: Any,
    ) -> None:
        turning = {"speed": rpm * RPM}
        self.weft = WeftInsertion(**parameters("WeftInsertion", machine=name), **turning)
        given = turning | {"inputs_at_step_end": True} | belt
        self.belt = BeltMonitor(**parameters("BeltMonitor", machine=name, head=head), **given)
        self.step_size = 60.0 / abs(rpm) / steps
        self.steps = steps
        self.done = round(begin * steps)  # steps since the outer dead centre
        assert self.weft.initialize(self.time) == 0
        self.wire()
        self.problem = self.belt.initialize(self.time)

    @property
    def time(self) -> float:
        return self.done * self.step_size

    def wire(self) -> None:
        self.belt.travel = self.weft.travel
        self.belt.velocity = self.weft.velocity
        self.belt.acceleration = self.weft.acceleration

    def turn(self, turns: float = 1.0, watch: Callable[[BeltMonitor], None] | None = None) -> BeltMonitor:
        """The belt's monitor after so many more turns; `watch` sees it after each step."""
        for _ in range(round(turns * self.steps)):
            if self.belt.inputs_at_step_end:
                self.weft.step(self.time, self.step_size)
            else:
                self.weft.step(self.time, 0.0)
            self.wire()
            self.problem = self.belt.step(self.time, self.step_size)
            self.done += 1
            if watch is not None:
                watch(self.belt)
        return self.belt
