"""Enclosures hold what the components compute, whatever the branches."""

import math
from dataclasses import dataclass
from math import atan2, floor, sin, sqrt
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from loomfmu.components import COMPONENTS
from loomfmu.declaring.declarations import input_, output
from loomfmu.declaring.variables import NOTHING, Component, variables_of
from loomfmu.fmi.native.slicing import settings_of
from loomfmu.studies.proving.enclosed import Enclosed

CASES = {
    "WeftInsertion": ("shaft_angle", "shaft_velocity"),
    "BeltMonitor": ("travel", "acceleration", "velocity", "guide_clearance"),
    "DobbyDrive": ("shaft_angle", "shaft_velocity"),
    "HealdFrame": ("rotor_angle", "rotor_velocity"),
    "ReedBeatUp": ("shaft_angle",),
    "BeltWrap": (),
    "WeftTransfer": ("shaft_angle",),
}
RANGES = {
    "shaft_angle": (-7.0, 14.0),
    "rotor_angle": (-7.0, 14.0),
    "shaft_velocity": (10.0, 80.0),
    "rotor_velocity": (10.0, 80.0),
    "travel": (0.0, 1.9),
    "velocity": (-90.0, 90.0),
    "acceleration": (-4000.0, 4000.0),
    "guide_clearance": (0.0, 1e-3),
}


def _placed(component: type[Component], values: dict[str, Any]) -> Any:
    made = component()
    for name, value in values.items():
        setattr(made, name, value)
    made.initialize(0.0)
    return made


@pytest.mark.parametrize("name", CASES)
@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_what_a_component_computes_at_a_point_lies_in_the_enclosures_about_it(name: str, data: Any) -> None:
    component = COMPONENTS[name]
    fixed = {"follow_shaft": True, "inputs_at_step_end": True}
    variables = {each.name: each for each in variables_of(component)}
    fixed = {key: value for key, value in fixed.items() if key in variables}
    varied = [each for each in CASES[name] if each in variables]
    outputs = (each for each in variables.values() if each.causality == "output" and each.type is float)
    wanted = [each.name for each in outputs if not each.one_way or each.variability == "fixed"]
    enclosed = Enclosed(
        component, wanted, settings_of(variables.values(), lambda key: fixed.get(key, variables[key].start))
    )
    sides, point = [], {}
    for each in varied:
        low, high = RANGES[each]
        value = data.draw(st.floats(low, high))
        width = (high - low) * 10.0 ** data.draw(st.integers(-9, -1))
        sides.append((value - width * data.draw(st.floats(0, 1)), value + width * data.draw(st.floats(0, 1))))
        point[each] = value
    given_bounds = {}
    for place, (each, ends) in enumerate(zip(varied, sides, strict=True)):
        bounds = np.zeros((1, 1 + len(sides), 2))
        bounds[0, 0], bounds[0, 1 + place] = ends, 1.0
        given_bounds[each] = bounds
    found = enclosed.bounds({k: float(v) for k, v in fixed.items()}, given_bounds, (1, len(sides)))
    made = _placed(component, fixed | point)
    nudged = [_placed(component, fixed | point | {each: point[each] * (1 + 1e-7) + 1e-9}) for each in varied]
    for output_name in wanted:
        low, high = found[output_name][0, 0]
        value = getattr(made, output_name)
        # the component rounds what the enclosure holds exactly
        slack = 1e-9 * max(1.0, abs(value))
        assert low - slack <= value <= high + slack, output_name
        for place, (each, near) in enumerate(zip(varied, nudged, strict=True)):
            step = getattr(near, each) - getattr(made, each)
            if point[each] + step > sides[place][1]:
                continue
            slope = (getattr(near, output_name) - value) / step
            first, last = found[output_name][0, 1 + place]
            blur = 1e-5 * max(1.0, abs(slope)) + 1e-12 * max(1.0, abs(value)) / abs(step)
            assert first - blur <= slope <= last + blur, (output_name, each)


@dataclass(slots=True)
class Jumping(Component):
    """Odd functions of one number: jumps, poles, and what is not defined everywhere."""

    keeps = NOTHING
    x: float = input_("1", 0.0, "A number")
    jump: float = output("1", "1 above a third, 0 below")
    hidden: float = output("1", "The same, by a loop")
    pole: float = output("1", "Its inverse")
    root: float = output("1", "Its square root")
    angle: float = output("1", "The angle of a point that goes round")
    whole: float = output("1", "Its whole part")
    sign: float = output("1", "Its square, or the opposite of it below 0")
    cube: float = output("1", "Its third power")
    nothing: float = output("1", "0 times a root")
    bounded: float = output("1", "The sine of an inverse")
    clamped: float = output("1", "A root that is limited")

    def initialize(self, time: float) -> int:
        """Compute everything."""
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Compute everything."""
        self.jump = 1.0 if self.x > 1.0 / 3.0 else 0.0
        self.hidden = 0.0
        for number in range(3):
            if number * 1.0 + 1.0 / 3.0 < self.x + number * 1.0:
                self.hidden = 1.0
        self.pole = 1.0 / self.x
        self.root = sqrt(self.x)
        self.angle = atan2(0.0 - self.x, -1.0)
        self.whole = 1.0 * floor(self.x)
        self.cube = self.x * self.x * self.x
        self.nothing = 0.0 * sqrt(self.x)
        self.bounded = sin(1.0 / self.x)
        self.clamped = sqrt(self.x) if sqrt(self.x) < 1.0 else 1.0
        self.sign = self.x * self.x if self.x > 0.0 else -self.x * self.x
        return 0


# of an output over a box: its bounds, and whether its slope is known
ODD = [
    ("jump", (0.3, 0.4), (0.0, 1.0), False),
    ("jump", (0.4, 0.5), (1.0, 1.0), True),
    ("hidden", (0.3, 0.4), (0.0, 1.0), False),
    ("pole", (-0.1, 0.1), (-math.inf, math.inf), False),
    ("pole", (0.5, 1.0), (1.0, 2.0), True),
    ("root", (-0.1, 0.1), (-math.inf, math.inf), False),
    ("root", (0.25, 1.0), (0.5, 1.0), True),
    ("angle", (-0.1, 0.1), (-math.pi, math.pi), False),
    ("whole", (0.9, 1.1), (0.0, 1.0), False),
    ("cube", (3e204, 8e204), (0.0, math.inf), False),
    ("nothing", (-0.1, 0.1), (-math.inf, math.inf), False),
    ("bounded", (-0.1, 0.1), (-math.inf, math.inf), False),
    ("clamped", (-0.1, 0.1), (-math.inf, math.inf), False),
    ("sign", (-0.5, 0.5), (-0.25, 0.25), False),
]


@pytest.mark.parametrize(("name", "box", "values", "smooth"), ODD)
def test_jumps_poles_and_gaps_are_enclosed(name: str, box: Any, values: Any, smooth: bool) -> None:
    bounds = np.zeros((1, 2, 2))
    bounds[0, 0], bounds[0, 1] = box, 1.0
    found = Enclosed(Jumping, [name], {}).bounds({}, {"x": bounds}, (1, 1))[name][0]
    assert found[0, 0] <= values[0]
    assert found[0, 1] >= values[1]
    assert found[0] == pytest.approx(values, abs=1e-14)
    assert np.isfinite(found[1]).all() == smooth


@pytest.mark.parametrize("name", ["sin", "cos", "asin", "acos", "atan", "sqrt", "exp", "log", "atan2"])
def test_the_functions_of_libm_are_as_exact_as_the_enclosures_take_them_for(name: str) -> None:
    # LIBRARY_ERROR of enclosure.h is 4 units of the last place
    random = np.random.default_rng(1)
    for x in random.uniform(0.0, 1.0, 2000) * (100.0 if name in ("sin", "cos", "exp") else 1.0):
        given_numbers = (float(x), 0.7) if name == "atan2" else (float(x),)
        with mpmath.workprec(200):
            exact = getattr(mpmath, name)(*map(mpmath.mpf, given_numbers))
            here = getattr(math, name)(*given_numbers)
            assert abs(mpmath.mpf(here) - exact) <= 2 * math.ulp(here)
