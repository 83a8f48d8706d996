"""What a signal is worth, on a curve that is known in closed form."""

import math

import numpy as np
import pytest
from drawn_runs import drawn

from loomfmu import LoomfmuError
from loomfmu.cosim.claims.measures import measure, signal_in
from loomfmu.traces import Recording

TURN = 2.0 * math.pi


def unit_of(signal: str) -> str:
    return swing().unit(signal)


def swing() -> Recording:
    """Two revolutions of a second each, in which a signal is 3 sin(angle) + time, and a count rises."""
    time = np.linspace(0.0, 2.0, 81)
    angle = TURN * time
    value, rate = 3.0 * np.sin(angle) + time, 3.0 * TURN * np.cos(angle) + 1.0
    signals = {
        "shaft.angle": ("rad", angle),
        "a.value": ("m", value, {"rate": "rate"}),
        "a.rate": ("m/s", rate),
        "a.count": ("1", np.floor(time)),
    }
    return drawn(time, signals)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("highest a.value", 1.25 + 3.0 + 0.00422),  # the slope of 1 m/s moves the vertex: 1 / (6 TURN^2)
        ("mean a.value", 1.0),
        ("a.value at 90 deg", 3.0 + 1.25),
        ("a.count", 2.0),
        ("highest 2 * a.value - 1 m", 2.0 * (4.25 + 0.00422) - 1.0),
        ("lowest abs(a.value) + 1 m", 1.0),
    ],
)
def test_numbers_of_a_signal(text: str, value: float) -> None:
    # a cubic through 40 samples of a revolution is off by 3 (TURN / 40)^4 / 384 = 5e-6
    found = measure(text, unit_of).judge(swing())
    assert found.worst == pytest.approx(value, abs=2e-5)
    assert signal_in(text) in ("a.value", "a.count", "2 * a.value - 1 m", "abs(a.value) + 1 m")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a.value", "a.value rises and falls in the run, so that its final value says little"),
        ("mean a.value at 90 deg", "is not one of 'highest SIGNAL'"),
        ("worst a.value", "is not one of"),
        ("a.value at 90 mm", "does not fit rad"),
        ("mean 2 * a.value", "of an expression, write 'highest ...' or 'lowest ...'"),
        ("highest 2 * a.value + 1", "in m beside 1 in a number without a unit"),
    ],
)
def test_what_says_nothing_of_a_signal_is_refused(text: str, said: str) -> None:
    with pytest.raises(LoomfmuError, match=said):
        measure(text, unit_of).judge(swing())
