"""Damaged WIF files."""

import random
from pathlib import Path

import pytest
from hostile import LONG, SHORT, attacked, damaged, revalued

from loomfmu.loom import weave

FILES = sorted((Path(__file__).parents[2] / "sims" / "weaves").glob("*.wif"))


@pytest.mark.parametrize("count", [SHORT, pytest.param(LONG, marks=pytest.mark.slow)])
def test_damaged_weaves_are_read_or_refused_in_one_line(tmp_path: Path, count: int) -> None:
    def make(chance: random.Random, number: int) -> Path:
        content = chance.choice(FILES).read_bytes()
        if chance.random() < 0.5:
            content = revalued(content.decode(), chance).encode()
        path = tmp_path / f"{number % 4}.wif"
        path.write_bytes(damaged(content, chance) if chance.random() < 0.7 else content)
        return path

    attacked("weaves", make, weave.read_wif, count)
