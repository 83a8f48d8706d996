"""Components made for the tests: what translates, and what does not."""

from dataclasses import dataclass
from math import ceil, exp, floor, pi, sqrt

from loomfmu.declaring.arrays import array
from loomfmu.declaring.declarations import input_, output, parameter, state
from loomfmu.declaring.variables import Component

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
class UsesDictionary(Component):
    """A dictionary."""

    value: float = output("1", "A value")

    def initialize(self, time: float) -> int:
        """Start."""
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Step."""
        values = {0: time}
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


WEIGHTS = (0.5, 0.25, 2.0, 1.0)


@dataclass(frozen=True)
class Place:
    """A place and how it moves."""

    at: list[float]
    rate: float
    step: int


@dataclass(frozen=True)
class Two:
    """A record within a record."""

    first: Place
    register: list[bool]


def inner(a: list[float], b: list[float]) -> float:
    """Sum of products."""
    total = 0.0
    for n in range(len(a)):
        total = total + a[n] * b[n]
    return total


def advance(q: list[float], by: float) -> int:
    """Write the elements of an argument, from the last to the first."""
    for n in range(len(q) - 1, -1, -1):
        q[n] += by * n
    return len(q)


def passed_on(q: list[float], by: float) -> None:
    """Pass an argument on to be written."""
    advance(q, by)


def placed(two: Two, time: float) -> tuple[Place, list[float]]:
    """A record and an array as results."""
    place = two.first
    further = [place.at[n] + time * place.rate for n in range(len(place.at))]
    further[-1] = 1.0 if two.register[1] else 2.0
    return Place(at=list(further), rate=inner(place.at, place.at), step=place.step + 1), further


def moved(time: float) -> tuple[Place, list[float]]:
    """What another function returns, as it is."""
    place = Place([time, 2.0 * time, 0.5, WEIGHTS[0]], 0.25, 3)
    return placed(Two(place, [time > 0.0, time > 1.0]), time)


def shifted(q: list[float]) -> list[float]:
    """Every other element, from the second on."""
    return [q[n + 1] for n in range(0, 4, 2)]


@dataclass(slots=True)
class Vectors(Component):
    """Arrays and records: as locals, arguments, results and state."""

    place: int = parameter("1", 1, "Which element is written")
    held: tuple[float, ...] = array(state("1", "A place", start=start) for start in (0.1, 0.2, 0.3, 0.4))
    written: tuple[float, ...] = array(output("1", "An element") for _ in range(2))
    count: int = output("1", "A count", start=0, variability="discrete")
    flags: tuple[bool, ...] = array(state("1", "A flag", start=False) for _ in range(3))
    total: float = output("1", "A sum")

    def initialize(self, time: float) -> int:
        """Start."""
        return self.step(time, 0.0)

    def drawn(self, q: list[float], flags: list[bool]) -> list[float]:
        """A method with arrays."""
        flags[0] = not flags[0]
        self.count = self.count + 1
        return [self.total + q[2 - n] for n in range(3)]

    def weighed(self, place: Place) -> float:
        """A method that changes nothing, and reads a field that is called as a method that does."""
        _first, second, _third, _fourth = place.at
        return place.rate * place.step + second

    def step(self, time: float, step_size: float) -> int:
        """Step."""
        q = list(self.held)
        counted = advance(q, step_size)
        passed_on(q, time)
        copy = list(q)
        q[0] = -1.0
        self.total = inner(q, copy) + inner(list(WEIGHTS), q) + len(WEIGHTS) * counted
        place, further = moved(time)
        flags = list(self.flags)
        d1, d2, d3 = self.drawn(further, flags)
        for number in range(3):
            q = [d1, d2, d3, time + number]
            self.total += inner(place.at, q) + self.total * self.weighed(place)
            flags[number] = flags[number] or q[number] > 0.5
        first, last = shifted(q)
        written = [0.0] * 2
        written[self.place] = first
        written[-1 - self.place] += last
        written[number - 2] += inner(written, written)
        self.flags = flags
        self.held = [0.5 * copy[n] + 1e-3 * q[n] for n in range(4)]
        self.written = written
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
                NAN = 1 + number * number
                double += 1 / NAN
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
