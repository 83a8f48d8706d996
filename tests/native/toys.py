"""Components made for the tests: what translates, and what does not."""

from dataclasses import dataclass
from math import ceil, exp, floor, pi, sqrt

from loomfmu.arrays import array
from loomfmu.declarations import input_, output, parameter, state
from loomfmu.variables import Component

TWO = 2
STEEP = -1.5


def shared(x: float, count: int) -> tuple[float, float]:
    """Two results, and a comment that says */ and /* in the middle."""
    # a line that says */ too
    return x * count, x / TWO


def weighted(x: float, a: float, b: float, c: float, d: float, e: float) -> float:
    """Five numbers, told apart."""
    return a + x * (b + x * (c + x * (d + x * e)))


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
class Arrays(Component):
    """Arrays: an element by its number, all of them as arguments, and all of them set at once."""

    index: int = parameter("1", 0, "Which element")
    weight: tuple[float, ...] = array(parameter("1", start, "A weight") for start in (0.1, 0.7, 1.9))
    bits: tuple[int, ...] = array(parameter("1", start, "Some bits") for start in (3, 5, 9))
    double: tuple[bool, ...] = array(parameter("1", start, "A truth") for start in (True, False, True))
    mean: tuple[float, ...] = array(state("1", "A mean") for _ in range(2))
    real: float = output("1", "A weight")
    whole: int = output("1", "Some bits", start=0, variability="discrete")
    truth: bool = output("1", "A truth", start=False, variability="discrete")
    total: float = output("1", "All of it")

    def initialize(self, time: float) -> int:
        """Start."""
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Step."""
        self.real = self.weight[self.index]
        self.whole = self.bits[self.index]
        self.truth = self.double[self.index]
        self.mean = shared(self.mean[-1] + self.weight[2], self.bits[0])
        self.mean = self.mean[1], self.mean[0]
        self.total = weighted(time, *self.weight, *self.mean)
        return 0


@dataclass(slots=True)
class CallsInWhile(Component):
    """A function in the condition of a while, called each time."""

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
    """A method that reads what its results are written to, all of them computed first."""

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
    """A name whose type changes."""

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


@dataclass(slots=True)
class DependsOnOrder(Component):
    """A line whose value depends on which part of it comes first."""

    value: float = output("1", "A value")
    total: float = output("1", "A total")

    def initialize(self, time: float) -> int:
        """Start."""
        return 0

    def counted(self, time: float) -> float:
        """Change a variable and return a value."""
        self.value = self.value + time
        return time

    def step(self, time: float, step_size: float) -> int:
        """Step."""
        self.total = self.value + self.counted(time)
        return 0


@dataclass(slots=True)
class Loops(Component):
    """Loops that change their own bounds, a variable kept after a loop, names that C keeps for itself."""

    register: float = output("1", "A name of C")
    last: int = output("1", "The last number", start=0, variability="discrete")
    chained: bool = output("1", "A chain of comparisons", start=False, variability="discrete")

    def initialize(self, time: float) -> int:
        """Start."""
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Step."""
        end = 5
        double = 0.0
        number = -1
        for number in range(end, -2, -2):
            end = end + 1
            if number == 3:
                continue
            # a loop within a loop
            for inner in range(end):
                number = number + inner
                double += 1 / (1 + number * number)
        self.register = double if -(-1.0 * double) > 0 else -double
        self.last = number
        self.chained = 0 < time <= 2.0 and not end < 3
        return 0


@dataclass(slots=True)
class Wraps(Component):
    """Adds to the largest integer, where the sum in C needs -fwrapv."""

    count: int = output("1", "Count", start=0, variability="discrete")
    grows: bool = output("1", "Grows", start=False, variability="discrete")

    def initialize(self, time: float) -> int:
        """Nothing."""
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Compare."""
        self.grows = self.count + 1 > self.count
        return 0
