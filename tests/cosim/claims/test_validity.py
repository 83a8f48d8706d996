"""Claims on signals that are not known at all times, as a signal of their own says."""

import math
from pathlib import Path

import numpy as np
import pytest

from loomfmu import Trace, judge
from loomfmu.cli import main
from loomfmu.declaring.variables import Beside
from loomfmu.traces import Channel, TraceWriter

TIME = np.linspace(0.0, 1.0, 11)
TURN = 2.0 * math.pi


def recorded(directory: Path, values: np.ndarray, known: np.ndarray) -> Trace:
    """A trace of `a.x`, known where `a.sure` says so, over one turn of a shaft in small steps."""
    channels = [
        Channel("a", "x", "m", "mm", "X", 0, beside=Beside(valid_if="sure", lowest="x", highest="x")),
        Channel("a", "sure", "1", "1", "It is in sight", 0, real=False, boolean=True),
        Channel("shaft", "angle", "rad", "deg", "Angle", 1, rate="velocity"),
        Channel("shaft", "velocity", "rad/s", "rev/min", "Velocity", 2),
    ]
    angle = 0.1 * TURN * TIME
    reals = np.stack([values, angle, np.full(len(TIME), 0.1 * TURN)], axis=1)
    writer = TraceWriter(directory / "known.h5", {"title": "known", "software": "test"}, channels, {})
    writer.append(TIME, angle, reals, known.astype("i4")[:, np.newaxis])
    writer.complete([])
    return Trace(directory / "known.h5")


@pytest.fixture
def trace(tmp_path: Path) -> Trace:
    """x rises from 0 to 1; from 0.4 to 0.6 s it is not known, and shown as 5."""
    known = (TIME < 0.35) | (TIME > 0.65)
    return recorded(tmp_path, np.where(known, TIME, 5.0), known)


def test_what_is_known_keeps_the_bound_but_the_rest_is_open(trace: Trace) -> None:
    verdict = judge(trace, kind="below", signal="a.x", bound="2 m")
    assert (verdict.holds, verdict.decided, verdict.word) == (False, False, "undecided")
    assert math.isnan(verdict.worst) and math.isnan(verdict.time) and math.isnan(verdict.distance)
    assert "numerical error" not in str(verdict)
    assert "not known from 0.3 s, 10.8 deg, rev. 1 on, as a.sure is false" in verdict.note


def test_what_is_known_decides_a_claim_that_it_breaks(trace: Trace) -> None:
    verdict = judge(trace, kind="below", signal="a.x", bound="0.9 m")
    assert (verdict.holds, verdict.decided) == (False, True)
    assert (verdict.worst, verdict.time) == (1.0, 1.0)  # not the 5 m that nobody knows
    assert "a.sure is false" in verdict.note


@pytest.mark.parametrize("known", [TIME < 0.35, TIME > 0.65])
def test_the_end_of_a_run_in_which_it_is_not_known_is_no_more_known(
    tmp_path: Path, known: np.ndarray
) -> None:
    trace = recorded(tmp_path, np.where(known, TIME, 5.0), known)
    verdict = judge(trace, kind="below", signal="a.x", bound="2 m")
    assert verdict.word == "undecided"
    assert f"not known from {0.3 if known[0] else 0:g} s" in verdict.note


@pytest.mark.parametrize(
    ("window", "word"),
    [
        (["0 deg", "10 deg"], "holds"),
        (["25.5 deg", "36 deg"], "holds"),
        (["0 deg", "12 deg"], "undecided"),
        (["15 deg", "18 deg"], "undecided"),
    ],
)
def test_a_window_in_which_it_is_known_is_judged(trace: Trace, window: list[str], word: str) -> None:
    verdict = judge(trace, kind="above", signal="a.x", bound="-1 m", window=window)
    assert verdict.word == word
    assert ("a.sure" in verdict.note) == (word == "undecided")


def test_the_summary_says_what_is_not_known(trace: Trace, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", str(trace.path)]) == 0
    assert "a.sure is false at 3 of 11 samples; not known there: a.x" in capsys.readouterr().out


def test_a_signal_that_is_known_at_all_times_is_judged_as_any_other(tmp_path: Path) -> None:
    trace = recorded(tmp_path, TIME, np.full(len(TIME), True))
    assert trace.validity("a.x") == "a.sure"
    assert trace.validity("a.sure") is None
    verdict = judge(trace, kind="below", signal="a.x", bound="2 m", window=["0 deg", "36 deg"])
    assert verdict.holds
    assert "a.sure" not in verdict.note
