"""Traces that reports are written of, and their reports."""

import os
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

import loomfmu
from loomfmu import report
from loomfmu.traces import Trace

SIMS = Path(__file__).parents[2] / "sims"


@pytest.fixture(scope="session")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Trace:
    """The trace of the demo."""
    return loomfmu.run(SIMS / "wl680_3600.toml", output=tmp_path_factory.mktemp("demo") / "demo.h5").trace


@pytest.fixture(scope="session")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Trace:
    """The trace of a loom with every mechanism."""
    return loomfmu.run(SIMS / "full_loom.toml", output=tmp_path_factory.mktemp("whole") / "whole.h5").trace


@pytest.fixture(scope="session")
def yarn(tmp_path_factory: pytest.TempPathFactory) -> Trace:
    """The trace of a loom with its weft, over two revolutions."""
    return loomfmu.run(SIMS / "weft_tension.toml", output=tmp_path_factory.mktemp("yarn") / "yarn.h5").trace


@pytest.fixture(scope="session")
def fast(tmp_path_factory: pytest.TempPathFactory) -> Trace:
    """The trace of the demo, too fast for its belt."""
    output = tmp_path_factory.mktemp("fast") / "fast.h5"
    return loomfmu.run(SIMS / "wl680_3600.toml", set={"shaft.speed": "700 rpm"}, output=output).trace


@pytest.fixture(scope="session")
def written(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Writes the report of some traces, once for all tests."""

    @cache
    def write(*traces: Trace) -> Path:
        return report.write(list(traces), tmp_path_factory.mktemp("written") / "report.html")

    return write


@pytest.fixture
def copied(demo: Trace, tmp_path: Path) -> Path:
    os.link(demo.path, tmp_path / "demo.h5")
    return tmp_path / "demo.h5"
