"""What outputs depend on, by all the ways that values take through a source.

That they depend on nothing else is tested of all components in `components/test_contract.py`.
"""

from dataclasses import dataclass

import pytest

from loomfmu.declaring.arrays import array
from loomfmu.declaring.declarations import auxiliary, input_, output, parameter, state
from loomfmu.declaring.variables import NOTHING, Component, Problem
from loomfmu.fmi.dataflow.dependencies import dependencies


@dataclass(frozen=True)
class Pair:
    """Two numbers that go together."""

    first: float
    second: float


def swapped(pair: Pair) -> Pair:
    """Return the other order."""
    return Pair(pair.second, pair.first)


def filled(to: list[float], x: float) -> float:
    """Set the elements of a list, and return something else."""
    for index in range(2):
        to[index] = x
    return 1.0


def early(x: float, y: float) -> float:
    """Return early."""
    if x > 0.0:
        return 1.0
    return y


def counted(x: float, y: float) -> tuple[float, float]:
    """Leave a loop."""
    turns = 0.0
    last = 0.0
    for _ in range(5):
        if x > turns:
            break
        last = y
        turns = turns + 1.0
    return turns, last


@dataclass(slots=True)
class Ways(Component):
    """Outputs that are easily said to depend on too little, or on too much."""

    keeps = NOTHING
    problems = (Problem("c is too large"), Problem("d is large", warning=True))
    a: float = input_("1", 0.0, "A number")
    b: float = input_("1", 0.0, "Another", rate="b_rate")
    b_rate: float = input_("1/s", 0.0, "Its rate")
    c: float = input_("1", 0.0, "A number that ends the step")
    d: float = input_("1", 0.0, "A number that warns")
    p: float = parameter("1", 1.0, "A parameter")
    q: float = parameter("1", 1.0, "A parameter that is used once")
    table: tuple[float, ...] = array(parameter("1", 0.0, "A number") for _ in range(2))
    by_branch: float = output("1", "Set in a branch")
    beside_branch: float = output("1", "Set beside it")
    by_field: float = output("1", "A field of a record")
    by_list: float = output("1", "From a list that a function fills")
    by_return: float = output("1", "From a function that returns early")
    by_break: float = output("1", "From a loop that is left")
    by_element: float = output("1", "An element of an array")
    by_index: float = output("1", "Any element of it")
    by_method: float = output("1", "Changed within a condition")
    by_time: float = output("1", "The time")
    by_start: float = output("1", "Computed once")
    beside_problem: float = output("1", "Set after a problem")
    at_end: float = output("1", "Set after a warning")
    hidden: float = auxiliary("1", "What a method changes")

    def initialize(self, time: float) -> int:
        """Compute everything."""
        self.by_start = self.q
        return self.step(time, 0.0)

    def change(self) -> bool:
        """Change something."""
        self.hidden = self.hidden + self.b
        return True

    def step(self, time: float, step_size: float) -> int:
        """Compute everything."""
        if self.c > 1.0:
            return 1
        self.hidden = 0.0
        self.by_branch = 0.0
        self.beside_branch = self.p
        if self.a > 0.0:
            self.by_branch = self.p
        pair = swapped(Pair(self.a, self.p))
        self.by_field = pair.first
        numbers = [0.0, 0.0]
        ignored = filled(numbers, self.a)
        self.by_list = numbers[0] + ignored
        self.by_return = early(self.a, self.p)
        turns, last = counted(self.a, self.p)
        self.by_break = last
        self.by_element = self.table[1]
        self.by_index = self.table[int(turns)]
        if self.d > 0.0 and self.change():
            turns = 0.0
        self.by_method = self.hidden
        self.by_time = time + step_size
        self.beside_problem = self.p
        if self.d > 1.0:
            return 2
        self.at_end = self.p
        return 0


def test_each_output_depends_on_what_leads_to_it():
    assert {name: " ".join(sorted(needed)) for name, needed in dependencies(Ways).once.items()} == {
        "by_branch": "a p",
        "beside_branch": "p",
        "by_field": "p",
        "by_list": "a",
        "by_return": "a p",
        "by_break": "a p",
        "by_element": "table_2",
        "by_index": "a table_1 table_2",
        "by_method": "b b_rate d",  # a host may have b go on with its rate
        "by_time": "time",
        "by_start": "q",
        "beside_problem": "p",
        "at_end": "d p",
    }


@dataclass(slots=True)
class Filter(Component):
    """A number that follows another one with a delay."""

    x: float = input_("1", 0.0, "A number")
    unused: float = input_("1", 0.0, "Another")
    p: float = parameter("1", 1.0, "A parameter")
    delayed: float = output("1", "The number of the step before")
    smooth: float = output("1", "Its mean with the present one")
    last: float = state("1", "The number of the step before")

    def initialize(self, time: float) -> int:
        """Start at the first number."""
        self.last = self.x
        self.delayed = self.x
        self.smooth = self.x * self.p
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Go on."""
        self.delayed = self.last
        self.smooth = self.p * 0.5 * (self.x + self.last)
        self.last = self.x
        return 0


def test_what_is_kept_is_held_for_a_step_and_counts_for_several():
    assert dependencies(Filter).once == {"delayed": set(), "smooth": {"x"}}
    assert dependencies(Filter).always == {"delayed": {"x"}, "smooth": {"x"}}


def test_at_the_start_parameters_count_though_something_is_kept():
    assert dependencies(Filter).start == {"delayed": {"x"}, "smooth": {"x", "p"}}
    assert dependencies(Ways).start["by_method"] == {"b", "d"}  # no host has inputs go on there


@dataclass(slots=True)
class Foreign(Filter):
    """A component beyond the Python that translates."""

    def step(self, time: float, step_size: float) -> int:
        """Go on."""
        try:
            self.smooth = self.x
        finally:
            self.delayed = self.x
        return 0


@dataclass(slots=True)
class Shared(Filter):
    """A component whose list has two names."""

    def step(self, time: float, step_size: float) -> int:
        """Go on."""
        one = [0.0]
        other = one
        one[0] = self.x
        self.smooth = other[0]
        return 0


@pytest.mark.parametrize("component", [Foreign, Shared])
def test_where_the_source_cannot_be_followed_all_counts(component):
    everything = {"x", "unused", "time"}
    assert dependencies(component).once == {"delayed": everything, "smooth": everything}
