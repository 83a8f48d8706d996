"""The sweeps that come with the project run, and say what they are there to say."""

import re
from pathlib import Path

import numpy as np
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest

from loomfmu.cli import main
from loomfmu.design import loom

SWEEPS = Path(__file__).parents[2] / "sims" / "sweeps"


def test_there_is_a_test_for_each() -> None:
    assert sorted(path.name for path in SWEEPS.iterdir()) == [
        "belt_motion.toml",
        "damper.toml",
        "safe_speed.toml",
        "what_matters.toml",
    ]


def test_safe_speed_falls_with_wear_and_is_that_of_the_design(capsys: pytest.CaptureFixture[str]) -> None:
    output = Path("out")
    assert main(["sweep", str(SWEEPS / "safe_speed.toml"), "--output", str(output), "--processes", "1"]) == 1
    assert "70 combinations: 38 hold and 32 fail" in capsys.readouterr().out
    table = pq.read_table(output / "table.parquet")
    for row in table.to_pylist():
        wanted = loom.safe_speed(row["machine"], clearance=row["belt.guide_clearance"]).speed
        # 90 steps in a revolution, joined by quintics: 1.2e-6 off for the WL680-3600
        assert row["belt.lowest_speed_limit"] == pytest.approx(wanted, rel=3e-6)
    by_machine = table["belt.lowest_speed_limit"].to_numpy().reshape(7, 10)
    assert np.all(np.diff(by_machine, axis=1) <= 0.0)
    assert len(list((output / "traces").iterdir())) == 2
    assert (output / "map.png").stat().st_size > 10_000


def test_stiff_springs_keep_the_carrier_off_its_stops() -> None:
    output = Path("out")
    assert main(["sweep", str(SWEEPS / "damper.toml"), "--output", str(output), "--processes", "1"]) == 1
    table = pq.read_table(output / "table.parquet")
    assert table.num_rows == 64 and table["error"].null_count == 64
    # resonance at 2 N/mm and 7.5 kg moves the carrier by less than 15 mm or so
    short = table.filter(pc.field("damper.free_travel") < 0.015)
    soft = short.filter(pc.field("damper.spring_stiffness") < 2e3)["damper_1.stop_contacts"].to_pylist()
    stiff = table.filter(pc.field("damper.spring_stiffness") > 15e3)["damper_1.stop_contacts"].to_pylist()
    assert len(soft) > 5 and min(soft) > 0
    assert len(stiff) > 5 and max(stiff) == 0
    assert (output / "map.png").stat().st_size > 10_000


@pytest.mark.slow
def test_clearance_matters_most_for_the_belt_and_the_law_for_the_dwell(
    capsys: pytest.CaptureFixture[str],
) -> None:
    short = (SWEEPS / "what_matters.toml").read_text().replace("samples = 256", "samples = 64")
    path = Path("what_matters.toml")
    path.write_text(short.replace("../wl680_3600.toml", str(SWEEPS.parent / "wl680_3600.toml")))
    assert main(["sweep", str(path), "--output", "out", "--processes", "1"]) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert "distance of the belt keeps a margin of 10 %: lowest margin: belt.guide_clearance 0." in said
    assert re.search(r"warp beyond 6 mm: dobby\.speed_reduction [\d.]+ ± [\d.]+ distance of", said)  # alone
    assert Path("out/sensitivity.png").stat().st_size > 10_000


@pytest.mark.slow
def test_a_bow_over_the_whole_span_deflects_farther_than_the_belts_own() -> None:
    output = Path("out")
    assert main(["sweep", str(SWEEPS / "belt_motion.toml"), "--output", str(output), "--processes", "1"]) == 1
    table = pq.read_table(output / "table.parquet")
    assert table.num_rows == 162 and table["error"].null_count == 162
    deflection = table["belt_motion.largest_at_risk"].to_numpy().reshape(9, 3, 3, 2)
    assert np.all(deflection[..., 1] > deflection[..., 0])
    assert np.all(np.diff(deflection, axis=0) > 0.0)  # faster
    assert np.all(np.diff(deflection, axis=2) > 0.0)  # more bow
    assert (output / "map.png").stat().st_size > 10_000
