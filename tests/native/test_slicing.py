"""A slice computes what the whole component does, whatever leads to it."""

import ast
from dataclasses import dataclass
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from loomfmu.declaring.declarations import auxiliary, input_, output, parameter
from loomfmu.declaring.variables import NOTHING, Component
from loomfmu.fmi import source
from loomfmu.fmi.native.slicing import sliced

mode = 3


def filled(to: list[float], x: float) -> float:
    """Set the elements of an array, and return something else."""
    for index in range(2):
        to[index] = x + index
    return x


def early(x: float) -> float:
    """Return early."""
    for index in range(5):
        if index == 3:
            break
        if x > 1.0 * index:
            continue
        return 1.0 * index
    return 10.0


@dataclass(slots=True)
class Tricky(Component):
    """Outputs that depend on things which are easily overlooked."""

    keeps = NOTHING
    x: float = input_("1", 0.0, "A number")
    choose: bool = parameter("1", True, "A setting")
    by_effect: float = output("1", "Changed by the test of a branch that is empty")
    by_range: float = output("1", "Changed by the bounds of a loop")
    by_loop: float = output("1", "The last value of a loop's variable")
    by_array: float = output("1", "From an array that a function fills")
    by_or: float = output("1", "Changed within a condition that a setting decides")
    by_name: float = output("1", "From a variable that is called like a constant")
    by_setting: float = output("1", "From a setting that the component changes")
    by_return: float = output("1", "From a function that returns early")
    by_method: float = output("1", "From a method and a function of one name")
    hidden: float = auxiliary("1", "What methods change")
    flag: bool = parameter("1", False, "A setting that is changed")

    def initialize(self, time: float) -> int:
        """Compute everything."""
        return self.step(time, 0.0)

    def change(self) -> bool:
        """Change something, and say whether it is positive."""
        self.hidden = self.hidden + self.x
        return self.hidden > 0.0

    def early(self, x: float) -> float:
        """Call the function of this name."""
        return early(x) + 1.0

    def step(self, time: float, step_size: float) -> int:
        """Compute everything."""
        self.hidden = self.x
        ignored = 0.0
        if self.change():
            ignored = 1.0
        self.by_effect = self.hidden
        for index in range(3 if self.change() else 2):
            ignored = ignored + index
        self.by_range = self.hidden
        last = 0
        for last in range(4 if self.x > 0.5 else 2):  # noqa: B007
            ignored = ignored + 1.0
        self.by_loop = 1.0 * last
        array = [0.0, 0.0]
        ignored = filled(array, self.x)
        self.by_array = array[1]
        if self.change() or self.choose:
            ignored = 2.0
        self.by_or = self.hidden
        mode = 3 if self.x > 0.2 else 4
        if mode == 3:
            self.by_name = 1.0
        else:
            self.by_name = 2.0
        self.flag = self.x > 0.3
        self.by_setting = 5.0 if self.flag else 6.0
        self.by_return = early(self.x)
        self.by_method = self.early(self.x)
        return 0


OUTPUTS = [each.name for each in Tricky.declared() if each.causality == "output"]
SETTINGS = {"choose": True, "flag": False}


def _made(tree: ast.Module) -> Any:
    space: dict[str, Any] = {}
    exec(compile(ast.fix_missing_locations(tree), "sliced", "exec"), space)
    return space["Tricky"]


WHOLE = _made(ast.parse(source.flatten(Tricky)))


@pytest.mark.parametrize("name", OUTPUTS)
def test_a_slice_computes_what_the_component_does(name: str) -> None:
    part = _made(sliced(ast.parse(source.flatten(Tricky)), ("initialize", "step"), [name], SETTINGS))

    @given(st.floats(-1.0, 5.0))
    def law(x: float) -> None:
        found = []
        for kind in (WHOLE, part):
            made = kind()
            made.x = x
            status = made.initialize(0.0)
            found.append((status, getattr(made, name), made.step(0.0, 0.0), getattr(made, name)))
        assert found[0] == found[1]

    law()


def test_a_slice_leaves_the_rest_out() -> None:
    text = ast.unparse(
        sliced(ast.parse(source.flatten(Tricky)), ("initialize", "step"), ["by_loop"], SETTINGS)
    )
    assert "self.by_loop = 1.0 * last" in text
    assert "self.by_array = array" not in text
