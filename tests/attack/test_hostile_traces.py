"""Traces from anywhere: `show` ends in one line, whatever is in the file, and reads no other file."""

from collections import Counter
from pathlib import Path

import h5py
import hostile_traces
import numpy as np
import pytest
from attack_figures import record

import loomfmu
from loomfmu import LoomfmuError, Trace
from loomfmu.cli import main

SCENE = """title = "Small"
revolutions = 1
steps_per_revolution = 90
record = ["belt.margin", "weft.travel"]
[loom]
machine = "WL680-3600"
[[claims]]
kind = "lowest_margin"
bound = 0.1
"""
SECRET = 1234.5678


@pytest.fixture(scope="module")
def valid(tmp_path_factory: pytest.TempPathFactory, fmu_cache: None) -> bytes:
    directory = tmp_path_factory.mktemp("valid")
    (directory / "scene.toml").write_text(SCENE)
    return loomfmu.run(directory / "scene.toml", output=directory / "valid.h5").path.read_bytes()


def shown(path: Path, capsys: pytest.CaptureFixture[str]) -> int:
    """The exit status of `show`; one line if it refuses, and nothing from another file."""
    status = main(["show", str(path)])
    printed = capsys.readouterr()
    assert "1234.5" not in printed.out + printed.err
    if status == 2:
        assert printed.err.startswith("loomfmu: ") and printed.err.count("\n") == 1
        assert "a bug in loomfmu" not in printed.err
    else:
        assert printed.err == ""
    return status


CRAFTED = dict(hostile_traces.crafted())


@pytest.mark.few(2)
@pytest.mark.parametrize("name", CRAFTED)
def test_what_somebody_crafts_is_refused(
    name: str,
    valid: bytes,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    with h5py.File("secret.h5", "w") as secret:
        for signal in ("secret", "time", "shaft_angle", "margin"):
            secret[signal] = np.full(10, SECRET)
    path = tmp_path / "crafted.h5"
    path.write_bytes(valid)
    with h5py.File(path, "r+") as file:
        CRAFTED[name](file)
    assert shown(path, capsys) == 2
    with pytest.raises(LoomfmuError) as raised, Trace(path) as trace:
        for signal in trace:
            assert SECRET not in trace[signal]
        assert SECRET not in trace.time
        _ = trace.verdicts
    assert str(raised.value).startswith(f"{path}: ")
    for command in (["report"], ["diagram"], ["plot", "belt.margin"], ["compare", str(path)]):
        status = main([command[0], str(path), *command[1:]])  # not each reads what was changed
        printed = capsys.readouterr().err
        assert printed.count("\n") == (status == 2) and "a bug in loomfmu" not in printed, printed
    record("traces crafted to do harm, shown", 1, 1)


@pytest.mark.parametrize("seeds", [range(6), pytest.param(range(1000, 2000), marks=pytest.mark.slow)])
def test_damaged_traces(
    valid: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str], seeds: range
) -> None:
    found: Counter[int] = Counter()
    path = tmp_path / "damaged.h5"
    for seed in seeds:
        path.write_bytes(hostile_traces.damaged(valid, seed))
        found[shown(path, capsys)] += 1
    assert set(found) <= {0, 1, 2}
    record("damaged traces, shown", len(seeds), found[2])
