"""Flattening: what a module of one component holds, and what cannot be carried into one."""

import ast
import math
import random
from dataclasses import dataclass
from math import pi, sin

import pytest

from loomfmu.components import COMPONENTS
from loomfmu.declaring.declarations import output, parameter
from loomfmu.declaring.variables import Component, variables_of
from loomfmu.fmi.source import SourceError, flatten
from loomfmu.physics.shaft import carried

GAIN = 2.5
COUNT = 3
TABLE = [1.0, 2.0]


def doubled(x: float) -> float:
    """Twice."""
    return 2.0 * x


def waved(x: float) -> float:
    """A wave, and twice."""
    return GAIN * doubled(sin(pi * x))


SHARES = (0.25, 0.75)


@dataclass(frozen=True)
class Stroke:
    """A stroke."""

    force: float
    time: float


@dataclass(frozen=True, slots=True)
class Chime:
    """Several strokes."""

    forces: list[float]
    loudness: Stroke  # as the function below


def stroke(x: float) -> float:
    """One stroke."""
    return x * x


def loudness(chime: Chime) -> Stroke:
    """All together, as one."""
    return Stroke(chime.forces[0] + chime.forces[1], chime.loudness.time)


@dataclass(slots=True)
class Bell(Component):
    """A bell that only tests know."""

    pitch: float = parameter("1", 0.25, "Pitch")
    strikes: int = parameter("1", 2, "Strikes")
    muted: bool = parameter("1", False, "Whether it is muted")
    sound: float = output("1", "Sound")

    def initialize(self, time: float) -> int:
        """Silence."""
        self.sound = 0.0
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Ring."""
        self.sound = float(COUNT) * waved(self.pitch) + carried(time, step_size, 0.0, 1.0)
        return int(abs(min(0.0, 1.0)))


@dataclass(slots=True)
class LoudBell(Bell):
    """A bell that overrides one method of its base."""

    def initialize(self, time: float) -> int:
        """Ring at once."""
        self.sound = waved(time)
        return 0


def run(text: str) -> dict:
    space: dict = {}
    exec(compile(text, "flattened", "exec"), space)
    return space


def test_flattened_bell_rings_the_same():
    space = run(flatten(Bell))
    bell, flat = Bell(), space["Bell"]()
    for each in (bell, flat):
        each.initialize(0.0)
        each.step(0.5, 0.25)
    assert flat.sound == bell.sound != 0.0
    assert vars(flat) == {variable.name: getattr(bell, variable.name) for variable in variables_of(Bell)}


def test_docstrings_may_have_backslashes_and_quotes():
    @dataclass(slots=True)
    class Odd(Bell):
        r"""The angle \xi of a "crank\""""

    assert run(flatten(Odd))["Odd"].__doc__ == Odd.__doc__


def test_functions_stand_before_those_that_call_them():
    text = flatten(Bell)
    parts = ("from math", "GAIN = 2.5", "def doubled", "def waved", "class Bell")
    order = [text.index(part) for part in parts]
    assert order == sorted(order)
    assert "from math import pi, sin\n" in text
    assert "COUNT = 3" in text
    assert text.count("def doubled") == 1


def test_nearest_method_of_each_name():
    text = flatten(LoudBell)
    assert text.count("def initialize") == 1
    assert "Ring at once" in text
    assert "Silence" not in text
    assert "def step" in text
    assert "Bell)" not in text, "no base remains"


def test_starts_keep_their_types():
    flat = run(flatten(Bell))["Bell"]()
    assert [type(value) for value in vars(flat).values()] == [float, int, bool, float]


def test_what_is_no_number_cannot_be_carried():
    @dataclass(slots=True)
    class Tabled(Bell):
        def step(self, time: float, step_size: float) -> int:
            self.sound = TABLE[0]
            return 0

    with pytest.raises(SourceError, match="uses TABLE, which is neither a function"):
        flatten(Tabled)


def test_records_and_tables_are_carried():
    @dataclass(slots=True)
    class Chimes(Bell):
        def step(self, time: float, step_size: float) -> int:
            strokes = [stroke(SHARES[n] * time) for n in range(len(SHARES))]
            self.sound = loudness(Chime(strokes, Stroke(time, step_size))).force
            return 0

    assert "SHARES = (0.25, 0.75)" in flatten(Chimes)
    chimes, flat = Chimes(), run(flatten(Chimes))["Chimes"]()
    for each in (chimes, flat):
        each.step(0.5, 0.25)
    assert flat.sound == chimes.sound != 0.0


@dataclass
class Changing:
    """Not frozen."""

    force: float


@dataclass(frozen=True)
class WithDefault:
    """With a default."""

    force: float = 1.0


@dataclass(frozen=True)
class WithMethod:
    """With a method."""

    force: float

    def doubled(self) -> float:
        return 2.0 * self.force


@dataclass(frozen=True)
class Derived(Stroke):
    """With a base."""

    more: float


@pytest.mark.parametrize("record", [Changing, WithDefault, WithMethod, Derived])
def test_a_record_is_a_frozen_dataclass_of_fields_alone(record):
    class Struck(Bell):
        def hit(self, given) -> float:
            return 1.0

        hit.__annotations__["given"] = record

    with pytest.raises(SourceError, match=f"{record.__name__} is not a frozen dataclass with fields alone"):
        flatten(Struck)


@dataclass(frozen=True)
class Pair:
    """A pair of any kind."""

    both: tuple[float, ...]


def deeper(x: float) -> float:
    return deeper(x - 1.0) if x > 0.0 else x


halved = lambda x: 0.5 * x  # noqa: E731
if True:

    def tripled(x: float) -> float:
        return 3.0 * x


@pytest.mark.parametrize(
    ("sound", "message"),
    [
        (lambda self, time: Pair((time,)).both[0], r"Pair\.both is tuple\[float, \.\.\.\], not a number"),
        (lambda self, time: deeper(time), "deeper calls itself"),
        (lambda self, time: halved(time), "a def of its own, at the left margin"),
        (lambda self, time: tripled(time), "a def of its own, at the left margin"),
    ],
)
def test_what_cannot_stand_by_itself_is_refused(sound, message):
    ringing = type("Ringing", (Component,), {"sounding": sound, "__module__": __name__})
    with pytest.raises(SourceError, match=message):
        flatten(ringing)


def test_modules_cannot_be_carried():
    @dataclass(slots=True)
    class Modular(Bell):
        def step(self, time: float, step_size: float) -> int:
            self.sound = random.random()
            return 0

    with pytest.raises(SourceError, match="uses random"):
        flatten(Modular)

    @dataclass(slots=True)
    class Dotted(Bell):
        def step(self, time: float, step_size: float) -> int:
            self.sound = math.sin(time)
            return 0

    with pytest.raises(SourceError, match="uses math"):
        flatten(Dotted)


def test_two_functions_of_one_name_are_refused():
    other = type(doubled)(doubled.__code__, {"doubled": None}, "doubled")
    code = (lambda self, time, step_size: waved(doubled(time))).__code__
    step = type(Bell.step)(code, {"waved": waved, "doubled": other}, "step")
    clashing = type("Clashing", (Component,), {"step": step, "__module__": __name__})
    with pytest.raises(SourceError, match="two functions are called doubled"):
        flatten(clashing)


@pytest.mark.parametrize("clashing", [101.9, 2, math.sin])  # in C, 2 divides otherwise than 2.0
def test_two_meanings_of_one_name_are_refused(clashing):
    methods = {
        name: type(Bell.step)((lambda self: sin).__code__, {"sin": meaning}, name)
        for name, meaning in (("first", 2.0), ("second", clashing))
    }
    with pytest.raises(SourceError, match=r"two constants are called sin|sin has two meanings"):
        flatten(type("Clashing", (Component,), {**methods, "__module__": __name__}))


@pytest.mark.parametrize("component", COMPONENTS.values(), ids=COMPONENTS)
def test_every_component_flattens_to_the_same_text_each_time(component):
    text = flatten(component)
    assert text == flatten(component)
    assert component.__name__ in text.splitlines()[0]
    assert "loomfmu." not in text.split("\n", 1)[1]
    imports = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Import | ast.ImportFrom)]
    assert [getattr(node, "module", None) for node in imports] in ([], ["math"])  # none where none is needed
