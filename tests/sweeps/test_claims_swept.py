"""Sweeps whose scene has a claim of one's own: its Python file is part of what the results depend on."""

from pathlib import Path

import pytest
from sweep_files import NO_TRACES, SCENE, swept

import loomfmu
from loomfmu import LoomfmuError

CLAIM = """
from loomfmu.claim import OwnClaim, Quantity, argument

class Final(OwnClaim):
    at_least: float = argument(Quantity("m"))

    def signals(self, run):
        return ["weft.travel"]

    def value(self, run):
        return 1.0 * run["weft.travel"].max()
"""
OWN = SCENE + '\n[[claims]]\nname = "far"\nkind = "own.py:Final"\nat_least = "1 m"\n'
GRID = '[grid]\n"shaft.speed" = ["500 rpm", "600 rpm"]\n' + NO_TRACES


def test_rows_are_judged_by_it_and_another_text_is_another_sweep(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fmu_cache: None
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("own.py").write_text(CLAIM)
    table = swept(GRID, scene=OWN).table
    # the stroke of the head, 2 m or so, whatever the speed; samples 4 deg apart miss less than 1 %
    assert table["claim_3.worst"].to_pylist() == pytest.approx([2.1, 2.1], rel=0.01)
    assert table["claim_3.holds"].to_pylist() == [True, True]
    Path("own.py").write_text(CLAIM.replace("1.0 *", "0.1 *"))
    with pytest.raises(LoomfmuError, match="changed since; --restart deletes the old results"):
        loomfmu.sweep("swept.toml", processes=1, output="out")
    again = loomfmu.sweep("swept.toml", processes=1, output="out", restart=True)
    assert again.table["claim_3.holds"].to_pylist() == [False, False]
