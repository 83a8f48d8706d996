"""Reports of long runs: in memory that does not grow with the run."""

import tracemalloc
from collections.abc import Callable
from pathlib import Path

import pytest

import loomfmu
from loomfmu.report import diagram, drawings
from loomfmu.report.drawings import tracks
from loomfmu.report.section import Subject
from loomfmu.traces import Trace

SIMS = Path(__file__).parents[2] / "sims"


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """A run, and a longer one that is too long for its signals to be kept."""
    return made(tmp_path_factory.mktemp("runs"), 40, 100)


def made(folder: Path, *revolutions: int) -> list[Path]:
    scene = SIMS / "wl680_3600.toml"
    return [
        loomfmu.run(scene, set={"revolutions": number}, output=folder / f"{number}.h5").path
        for number in revolutions
    ]


@pytest.mark.slow
@pytest.mark.parametrize("make", [diagram.section, drawings.sections], ids=["diagram", "motion"])
def test_memory_does_not_grow_with_the_signals_of_a_long_run(
    runs: list[Path], make: Callable[[Subject], object]
) -> None:
    peaks, rows = [], []
    for path in runs:
        with Trace(path) as trace:
            rows.append(trace.rows)
            tracemalloc.start()
            assert make(Subject([trace]))
            peaks.append(tracemalloc.get_traced_memory()[1])
            tracemalloc.stop()
    # the shaft's angle and the distances of its samples; signals that were kept took seven columns and more
    assert peaks[1] - peaks[0] < 3 * 8 * (rows[1] - rows[0])


def test_a_long_run_moves_in_its_first_revolutions_as_a_short_one_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tracks, "SAMPLES", tracks.SAMPLES // 10)
    runs = made(tmp_path, 4, 10)
    short, long = (drawings.sections(Subject([Trace(path)]))[-1] for path in runs)
    assert Trace(runs[1]).rows > tracks.SAMPLES
    for name, track in short.data["tracks"].items():
        other = long.data["tracks"][name]
        kept = len(other["shown"])
        assert 1 <= kept < 4  # of 10
        assert other["shown"] == track["shown"][:kept]
        for here, there in zip(other["frames"], track["frames"], strict=False):
            assert here.tolist() == there.tolist()
        assert 1 <= len(other["frames"]) <= len(track["frames"])
