"""Components that misbehave, and the fixture that makes FMUs of them."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import pytest

from loomfmu import components
from loomfmu.cosim.importing import fmus
from loomfmu.declaring.declarations import input_, output, parameter
from loomfmu.declaring.variables import Component, Problem
from loomfmu.fmi import fmu_files


@dataclass(slots=True)
class Overflowing(Component):
    """A value that is no number after 0.1 s, or a very large one."""

    kind: int = parameter("1", 0, "0 inf, 1 nan, 2 -inf, 3 large", minimum=0, maximum=3)
    taken: float = input_("1", 0.0, "Taken")
    value: float = output("1", "Value")
    counted: int = output("1", "Counted", start=0, variability="discrete")

    def initialize(self, time: float) -> int:
        """Begin at 0."""
        self.value = 0.0
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Go wrong."""
        self.value = 0.0
        if time > 0.1:
            self.value = 1.7e308
            if self.kind < 3:
                self.value = self.value * 10.0
            if self.kind == 1:
                self.value = self.value - self.value
            if self.kind == 2:
                self.value = -self.value
        return 0


@dataclass(slots=True)
class Raising(Component):
    """An exception after 0.1 s."""

    value: float = output("1", "Value")

    def initialize(self, time: float) -> int:
        """Begin at 0."""
        self.value = 0.0
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Divide by zero."""
        self.value = 1.0
        if time > 0.1:
            self.value = 1.0 / (step_size - step_size)
        return 0


@dataclass(slots=True)
class Complaining(Component):
    """A complaint at the start."""

    problems: ClassVar[tuple[Problem, ...]] = (Problem("the level of {level} is no level"),)

    level: int = parameter("1", 7, "Level")
    value: float = output("1", "Value")

    def initialize(self, time: float) -> int:
        """Complain."""
        return 1

    def step(self, time: float, step_size: float) -> int:
        """Never reached."""
        return 0


@dataclass(slots=True)
class Undeclared(Component):
    """A problem that is not declared after 0.1 s."""

    value: float = output("1", "Value")

    def initialize(self, time: float) -> int:
        """Begin at 0."""
        self.value = 0.0
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Complain."""
        problem = 0
        if time > 0.1:
            problem = 5
        return problem


@dataclass(slots=True)
class Switched(Component):
    """A value that an integer and a boolean input make."""

    gear: int = input_("1", 1, "Gear", minimum=-3, maximum=5)
    engaged: bool = input_("1", False, "Whether it is engaged")
    ratio: float = input_("1", 0.5, "Ratio of a gear")
    value: float = output("1", "Value")
    gear_in_use: int = output("1", "Gear in use", start=0, variability="discrete")
    running: bool = output("1", "Whether it runs", start=False, variability="discrete")

    def initialize(self, time: float) -> int:
        """As in every step."""
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Multiply."""
        self.gear_in_use = self.gear
        self.running = self.engaged
        self.value = 0.0
        if self.engaged:
            self.value = self.gear * self.ratio
        return 0


ODD = (Overflowing, Raising, Complaining, Undeclared, Switched)


@pytest.fixture
def odd(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Components that misbehave, as FMUs."""
    home = fmu_files.folder(components.MainShaft)
    for component in ODD:
        monkeypatch.setitem(fmus.COMPONENTS, component.__name__, component)
    monkeypatch.setattr(fmu_files, "folder", lambda component: home)
    yield
    fmus._known.clear()
