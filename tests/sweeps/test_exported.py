"""The table of a sweep for other tools: CSV, pandas, xarray; claims by their names."""

import csv
import math
from pathlib import Path

import numpy as np
import pandas
import pytest
from sweep_files import NO_TRACES, SCENE, sweep_file, swept

import loomfmu
from loomfmu import LoomfmuError
from loomfmu.cli import main
from loomfmu.sweeps import exported

NAME = "the loom runs below its safe speed"
GRID = (
    '[grid]\n"shaft.speed" = ["600 rpm", "700 rpm"]\n"belt.guide_clearance" = ["0.3 mm", "0.8 mm"]\n'
    + NO_TRACES
)
BROKEN = '[grid]\n"weft.coupler_length" = ["245 mm", "500 mm"]\n' + NO_TRACES


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fmu_cache: None) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_csv_has_the_values_of_the_table_in_the_units_of_people() -> None:
    assert main(["sweep", str(sweep_file(GRID)), "--processes", "1", "--output", "table.csv"]) == 1
    table = loomfmu.sweep("swept.toml", processes=1).table  # in the usual folder, finished already
    with Path("table.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["shaft.speed [rev/min]"]) for row in rows] == pytest.approx([600, 600, 700, 700])
    for row, safe, holds in zip(
        rows, *(table[f"claim_2.{part}"].to_pylist() for part in ("worst", "holds")), strict=True
    ):
        assert float(row[f"{NAME}.worst [rev/min]"]) == pytest.approx(safe * 30.0 / math.pi, rel=1e-15)
        assert row[f"{NAME}.holds"] == str(holds)
    about = table.schema.field("claim_2.note").metadata
    assert about[b"claim"] == NAME.encode()


def test_a_row_that_could_not_run_has_empty_cells_and_its_reason() -> None:
    swept(BROKEN, output="broken.csv")
    with Path("broken.csv").open(newline="") as file:
        _whole, broken = csv.DictReader(file)
    assert broken[f"{NAME}.worst [rev/min]"] == broken["holds"] == ""
    assert broken["error"]


def test_a_csv_replaces_no_other_file_and_says_so_before_the_runs() -> None:
    Path("mine.csv").write_text("a,b\n1,2\n")
    with pytest.raises(LoomfmuError, match=r"mine.csv: exists and is not the table of a sweep; --force"):
        swept(GRID, output="mine.csv")
    with pytest.raises(LoomfmuError, match=r"mine.xlsx is neither a directory nor a file .csv"):
        swept(GRID, output="mine.xlsx")
    assert not Path("results").exists()
    found = loomfmu.sweep("swept.toml", processes=1, output="mine.csv", overwrite=True)
    assert Path("mine.csv").read_text() == exported.csv(found.table)
    loomfmu.sweep("swept.toml", processes=1, output="mine.csv")  # now it is one


def test_a_sweep_is_a_frame_and_a_dataset_along_its_grid() -> None:
    found = swept(GRID)
    frame = found.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and f"{NAME}.distance" in frame
    data = found.to_xarray()
    assert data[f"{NAME}.worst"].dims == ("shaft.speed", "belt.guide_clearance")
    assert data[f"{NAME}.worst"].attrs["units"] == "rad s-1" and data["shaft.speed"].attrs["UNIT"] == "rad/s"
    one = data[f"{NAME}.worst"].sel({"shaft.speed": found.plan.axes[0].values[1]}).values
    np.testing.assert_array_equal(one, frame[f"{NAME}.worst"].values[2:])
    sampled = swept(
        '[sample]\ncount = 4\nseed = 1\n"shaft.speed" = ["600 rpm", "700 rpm"]\n' + NO_TRACES, output="other"
    )
    assert sampled.to_xarray()["holds"].dims == ("row",)


def test_claims_of_one_name_keep_their_numbers() -> None:
    table = swept(GRID, scene=SCENE.replace("the belt does not buckle", NAME)).table
    assert exported.names(table) == table.column_names
