"""Claims on signals that are not known at all times, as a signal of their own says."""

import math
from pathlib import Path

import numpy as np
import pytest
from drawn_runs import drawn, turning

from loomfmu import judge
from loomfmu.cli import main
from loomfmu.declaring.variables import Beside
from loomfmu.traces import Channel, Recording, TraceWriter

TIME = np.linspace(0.0, 1.0, 11)
TURN = 2.0 * math.pi


def recorded(values: np.ndarray, known: np.ndarray) -> Recording:
    """A run of `a.x`, known where `a.sure` says so, over a tenth of a turn of a shaft in small steps."""
    beside = {"beside": Beside(valid_if="sure", lowest="x", highest="x")}
    signals = {"a.x": ("m", values, beside), "a.sure": ("1", known)}
    return drawn(TIME, {**signals, **turning(0.1 * TURN * TIME, 0.1 * TURN)})


@pytest.fixture
def trace() -> Recording:
    """x rises from 0 to 1; from 0.4 to 0.6 s it is not known, and shown as 5."""
    known = (TIME < 0.35) | (TIME > 0.65)
    return recorded(np.where(known, TIME, 5.0), known)


def test_what_is_known_keeps_the_bound_but_the_rest_is_open(trace: Recording) -> None:
    verdict = judge(trace, kind="below", signal="a.x", bound="2 m")
    assert (verdict.holds, verdict.decided, verdict.word) == (False, False, "undecided")
    assert math.isnan(verdict.worst) and math.isnan(verdict.time) and math.isnan(verdict.distance)
    assert "numerical error" not in str(verdict)
    assert "not known from 0.3 s, 10.8 deg, rev. 1 on, as a.sure is false" in verdict.note


def test_what_is_known_decides_a_claim_that_it_breaks(trace: Recording) -> None:
    verdict = judge(trace, kind="below", signal="a.x", bound="0.9 m")
    assert (verdict.holds, verdict.decided) == (False, True)
    assert (verdict.worst, verdict.time) == (1.0, 1.0)  # not the 5 m that nobody knows
    assert "a.sure is false" in verdict.note


@pytest.mark.parametrize("known", [TIME < 0.35, TIME > 0.65])
def test_the_end_of_a_run_in_which_it_is_not_known_is_no_more_known(known: np.ndarray) -> None:
    trace = recorded(np.where(known, TIME, 5.0), known)
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
def test_a_window_in_which_it_is_known_is_judged(trace: Recording, window: list[str], word: str) -> None:
    verdict = judge(trace, kind="above", signal="a.x", bound="-1 m", window=window)
    assert verdict.word == word
    assert ("a.sure" in verdict.note) == (word == "undecided")


def test_the_summary_says_what_is_not_known(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    channels = [
        Channel("a", "x", "m", "mm", "X", 0, beside=Beside(valid_if="sure")),
        Channel("a", "sure", "1", "1", "It is in sight", 0, real=False, boolean=True),
    ]
    known = (TIME < 0.35) | (TIME > 0.65)
    writer = TraceWriter(tmp_path / "known.h5", {"title": "known", "software": "test"}, channels, {})
    writer.append(TIME, TIME, TIME[:, np.newaxis], known.astype("i4")[:, np.newaxis])
    writer.complete([])
    assert main(["show", str(tmp_path / "known.h5")]) == 0
    assert "a.sure is false at 3 of 11 samples; not known there: a.x" in capsys.readouterr().out


def test_a_signal_that_is_known_at_all_times_is_judged_as_any_other() -> None:
    trace = recorded(TIME, np.full(len(TIME), True))
    assert trace.validity("a.x") == "a.sure"
    assert trace.validity("a.sure") is None
    verdict = judge(trace, kind="below", signal="a.x", bound="2 m", window=["0 deg", "36 deg"])
    assert verdict.holds
    assert "a.sure" not in verdict.note
