"""Components made for the tests: what translates, and what does not."""

from dataclasses import dataclass
from math import ceil, exp, floor, pi, sqrt

from loomfmu.variables import Component, input_, output, parameter, state

TWO = 2
STEEP = -1.5


def shared(x: float, count: int) -> tuple[float, float]:
    """Two results, and a comment that says */ and /* in the middle."""
    # a line that says */ too
    return x * count, x / TWO


def mixed(x: float, y: float) -> float:
    """All operations that C and Python do not share without care."""
    total = x % y + x // y + STEEP * x
    total = total + floor(x) + ceil(y) + int(x)
    if (x > 0.0) == (y > 0.0):
        total = total + 7 // -2 + (-7) % 3 + 3 / 2
    return total + x**2 + pi


@dataclass(slots=True)
class Arithmetic(Component):
    """Arithmetic where Python and C have their own ways."""

    share: float = parameter("1", 0.5, "A share", display="%", minimum=0.0, maximum=1.0)
    count: int = parameter("1", 3, "A count", minimum=-100, maximum=100)
    x: float = input_("1", 2.5, "First operand", rate="y")
    y: float = input_("1", -1.25, "Second operand")
    total: float = output("1", "All of it")
    shared: float = output("1", "Named as a function is")
    whole: int = output("1", "A whole number", start=0, variability="discrete")
    half: float = state("1", "Half of it")

    def initialize(self, time: float) -> int:
        """Start."""
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Step."""
        self.total = mixed(self.x, self.y)
        self.shared, self.half = shared(self.x, self.count)
        self.total, self.half = self.half, self.total
        whole = self.count % 7 - self.count // 4
        for index in range(self.count, 10, 2):
            whole = whole + index
        while whole > 40 and sqrt(self.share) >= 0.0:
            whole = whole - 3
        self.whole = whole * TWO
        return 0


@dataclass(slots=True)
class UsesList(Component):
    """A list."""

    value: float = output("1", "A value")

    def initialize(self, time: float) -> int:
        """Start."""
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Step."""
        values = [time, step_size]
        self.value = values[0]
        return 0


@dataclass(slots=True)
class CallsInWhile(Component):
    """A function in the condition of a while."""

    value: float = output("1", "A value")

    def initialize(self, time: float) -> int:
        """Start."""
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Step."""
        while mixed(self.value, 1.0) < 3.0 and exp(self.value) < 9.0:
            self.value = self.value + 1.0
        return 0


@dataclass(slots=True)
class ReadsItsResult(Component):
    """A method that reads what its results are written to."""

    value: float = output("1", "A value")
    other: float = output("1", "Another")

    def initialize(self, time: float) -> int:
        """Start."""
        return 0

    def both(self, time: float) -> tuple[float, float]:
        """Two results."""
        return self.value + time, self.value - time

    def step(self, time: float, step_size: float) -> int:
        """Step."""
        self.value, self.other = self.both(time)
        return 0


@dataclass(slots=True)
class ChangesType(Component):
    """A name whose type changes, which the translator itself refuses."""

    value: float = output("1", "A value")

    def initialize(self, time: float) -> int:
        """Start."""
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Step."""
        count = 1
        count = 0.5 * time
        self.value = count
        return 0
