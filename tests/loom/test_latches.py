"""Claims on signals that are known only at the samples, whose extremes their component holds."""

import numpy as np
import pytest
from drawn_runs import drawn, turning
from scene_texts import LOOM, claim, verdicts

from loomfmu import judge
from loomfmu.cosim.claims.claims import read
from loomfmu.declaring.variables import Beside
from loomfmu.traces import Recording

TIME = np.linspace(0.0, 1.0, 21)  # one turn in 1 s, a sample at every 18 deg
TURN = 2.0 * np.pi


def wave(time: np.ndarray, peak: float, depth: float) -> np.ndarray:
    """A dip about a time that is narrower than the samples are apart."""
    return 1.0 - depth * np.exp(-(((time - peak) / 0.01) ** 2))


def recorded(*dips: tuple[float, float], latch: bool = True, error: float = 0.0) -> Recording:
    """A run of `a.x`, which is 1 but for dips; what `a.low` holds is exact."""
    fine = np.linspace(0.0, 1.0, 20001)
    curve = np.min([np.ones(len(fine)), *(wave(fine, *dip) for dip in dips)], axis=0)
    beside = {"beside": Beside(lowest="low" if latch else None, error="off" if error else None)}
    signals = {
        "a.x": ("m", curve[::1000], beside),
        "a.low": ("m", np.minimum.accumulate(curve)[::1000]),
        "a.off": ("m", np.where(TIME < 0.5, 0.1 * error, error)),
    }
    return drawn(TIME, {**signals, **turning(TURN * TIME, TURN)})


def judged(trace: Recording, window: list[str] | None = None, bound: float = 0.2) -> tuple[float, str, str]:
    """Worst value of `a.x`, whether that is above a bound, and the note."""
    verdict = judge(trace, kind="above", signal="a.x", bound=bound, window=window)
    return verdict.worst, verdict.word, verdict.note


def left(trace: Recording, window: list[str] | None = None) -> float:
    """How far `a.x` may be off whatever the steps."""
    table = {"kind": "above", "signal": "a.x", "bound": 0.2} | ({"window": window} if window else {})
    claim = read(table, trace.unit)
    return claim.left_by_model(trace, claim.judge(trace))


def test_what_is_held_decides_between_the_samples() -> None:
    trace = recorded((0.375, 0.9))
    worst, word, note = judged(trace)
    assert worst == pytest.approx(0.1, abs=1e-6)  # the finest samples miss the bottom by that
    assert word == "FAILS"
    assert judged(trace, bound=0.1 - 2e-6)[1] == "holds"
    assert note == "between the samples by a.low"
    assert 0.35 <= judge(trace, kind="above", signal="a.x", bound=0.2).time <= 0.4


def test_without_it_only_the_samples_are_known() -> None:
    worst, word, note = judged(recorded((0.375, 0.9), latch=False))
    assert worst > 0.99
    assert word == "undecided"  # it held, with an error of 1e-9
    assert note.startswith("a.x is known only at the samples; set at_samples = true")


@pytest.mark.parametrize(
    ("window", "worst", "possible"),
    [
        (["0 deg", "126 deg"], 1.0, 1.0),  # before the first dip
        (["144 deg", "200 deg"], 1.0, 0.5),  # between both: no deeper than the first one
        (["126 deg", "144 deg"], 0.5, 0.5),  # from the sample before it to the one after
        (["90 deg", "360 deg"], 0.1, 0.1),  # both
        (["90 deg", "290 deg"], 0.5, 0.1),  # an edge between the samples about the second one
        (["300 deg", "360 deg"], 1.0, 0.1),
    ],
)
def test_in_a_window_what_is_held_bounds_the_signal(window: list[str], worst: float, possible: float) -> None:
    trace = recorded((0.375, 0.5), (0.825, 0.9))
    near = 2e-3  # 0.9 exp(-2.5^2) of a dip reaches the samples about it
    assert judged(trace, window)[0] == pytest.approx(worst, abs=near)
    assert judged(trace, window, possible - near)[1] == "holds"
    assert judged(trace, window, worst + near)[1] == "FAILS"
    if possible < worst:
        _value, word, note = judged(trace, window, possible + near)
        assert word == "undecided"
        assert ("a.low was reached elsewhere" in note) == (worst == 1.0)


def test_what_a_signal_may_be_off_by_is_stated_beside_it() -> None:
    trace = recorded((0.3, 0.5), error=0.01)
    assert trace.error("a.x") == "a.off"
    assert trace.error("a.low") is None
    assert left(trace, ["0 deg", "140 deg"]) == pytest.approx(0.001)
    assert left(trace, ["200 deg", "360 deg"]) == pytest.approx(0.01)
    assert left(trace) == pytest.approx(0.001)


def test_where_it_is_as_near_to_the_worst_value_the_larger_error_counts() -> None:
    trace = recorded((0.3, 0.5), (0.8, 0.495), error=0.01)
    assert judged(trace)[0] == pytest.approx(0.5)
    assert left(trace) == pytest.approx(0.01)


def test_an_extreme_that_equal_samples_pass_is_the_one_that_is_held():
    """All samples of the margin were 1, and it held with an error of 1e-9 while the belt was at 0.2256."""
    both = claim("above", signal="belt.margin", bound=0.5), claim("lowest_margin", bound=0.5)
    part = {"shaft__start_angle": "241 deg", "revolutions": 0.5, "steps_per_revolution": 26}
    sampled, held = verdicts(LOOM, *both, shaft__speed="600 rpm", **part)
    # one is the lowest value of a cubic, the other a sample beside it
    assert sampled.worst == pytest.approx(held.worst, rel=1e-11)
    assert held.worst == pytest.approx(0.2254, abs=1e-3)
    assert not sampled.holds
