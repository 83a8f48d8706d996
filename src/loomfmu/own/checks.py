"""Checks for mechanisms on the shaft: rates and extremes are what they are declared to be.

The checks turn a mechanism by its own `speed` and `start_angle`, as a class on `ShaftDriven` has them.
Each raises AssertionError, naming the output; the tests that `loomfmu new` writes call them.
"""

from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from math import pi
from typing import Any

from ..declaring.variables import Component, variables_of

SPEED = 40.0  # of the shaft [rad/s]
FINE = 2.0 * pi / 1440.0  # rad
COARSE = pi / 12.0  # longest turn of a step where a component allows any [rad]
FIRST_STEPS = 8  # shares of a step that the first one takes, so that samples lie at as many places
BETTER = 0.1  # of the spread of samples: what the spread of an extreme may be
Rows = list[dict[str, float]]
ROUNDING = 1e-9  # of the largest value
OFF = 0.01  # of the largest rate: a wrong factor or sign is off by more, a jump of the second rate by less


def check_rates(component: type[Component], values: Mapping[str, Any] | None = None) -> None:
    """Every output with a rate changes by that rate, over a revolution in steps of a quarter of a degree.

    `values` are parameters that differ from the defaults, in SI.
    """
    rated = {v.name: v.rate for v in variables_of(component) if v.causality == "output" and v.rate}
    rows = list(_run(component, values or {}, FINE, FINE))
    h = FINE / SPEED
    for name, rate in rated.items():
        largest = max(abs(row[rate]) for row in rows)
        for before, after in pairwise(rows):
            change = (after[name] - before[name]) / h
            mean = 0.5 * (before[rate] + after[rate])
            assert abs(change - mean) <= OFF * largest + ROUNDING * abs(after[name]) / h, (
                f"near {before['time']:.6g} s {name} changes by {change:.6g} per second,"
                f" but its rate {rate} is {mean:.6g}"
            )


def check_extremes(component: type[Component], values: Mapping[str, Any] | None = None) -> None:
    """Every extreme is that of the continuous curve: no sample is beyond it, wherever the samples lie.

    Samples at several places of the coarsest steps that the component allows are off by more or less: all
    runs start alike, and the first step is shorter in some. What is declared as an extreme so far and does
    not spread ten times less than the samples was sampled itself.
    """
    turn = min(component.longest_turn or FINE, COARSE)
    first_turns = [turn * (share + 1) / FIRST_STEPS for share in range(FIRST_STEPS)]
    runs = [list(_run(component, values or {}, turn, first)) for first in first_turns]
    for variable in variables_of(component):
        for followed, best in ((variable.lowest_of, min), (variable.highest_of, max)):
            if followed and variable.type is float:
                sampled = [best(row[followed] for row in rows) for rows in runs]
                held = [rows[-1][variable.name] for rows in runs]
                noise = ROUNDING * max(map(abs, [*sampled, *held]))
                for rows in runs:
                    _check_beyond(variable.name, followed, best, noise, rows)
                assert _spread(held) <= BETTER * _spread(sampled) + noise, (
                    f"{variable.name} depends on where the samples lie, by {_spread(held):.3g}: it is sampled"
                    f" (samples of {followed} spread by {_spread(sampled):.3g});"
                    " use lowest_so_far or highest_so_far with the rate"
                )


def _check_beyond(
    name: str,
    followed: str,
    best: Callable[[float, float], float],
    noise: float,
    rows: list[dict[str, float]],
) -> None:
    """Check that an extreme is at every step at least as far out as every sample so far."""
    extreme = rows[0][followed]
    for row in rows:
        extreme = best(extreme, row[followed])
        missed = abs(best(extreme, row[name]) - row[name])
        assert missed <= noise, (
            f"{name} = {row[name]:.7g} at {row['time']:.6g} s, and {followed} has been {extreme:.7g}:"
            " it is not updated at every step, or follows the other side"
        )


def _spread(values: list[float]) -> float:
    return max(values) - min(values)


def _run(
    component: type[Component], values: Mapping[str, Any], turn: float, first: float
) -> Iterator[dict[str, float]]:
    """Time and outputs over two revolutions of a shaft of constant speed, with equal steps but the first."""
    names = [variable.name for variable in variables_of(component)]
    assert "speed" in names and "start_angle" in names, (
        f"{component.__name__} has no speed and start_angle to turn it by: these checks are for classes on"
        " ShaftDriven; write tests of your own for others"
    )
    running = component(**{"speed": SPEED, "start_angle": -pi, **values})
    outputs = [variable.name for variable in variables_of(component) if variable.causality == "output"]
    time = 0.0
    h = first / SPEED
    problem = running.initialize(time)
    for _ in range(int(4.0 * pi / turn) + 2):
        assert problem == 0 or component.problems[problem - 1].warning, component.problems[problem - 1].text
        yield {"time": time, **{name: getattr(running, name) for name in outputs}}
        problem = running.step(time, h)
        time = time + h
        h = turn / SPEED
