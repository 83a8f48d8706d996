"""The benchmarks in their tiniest size: tables, report, references. No time is asserted."""

import math
import os
import re
import runpy
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cost
import numpy as np
import pruning
import pytest
import records
import running
import start_up
import written
from children import Child, Failed
from limits import HOST, LOOP, NUMPY, WHOLE
from precision import delay
from running import run

Done = Callable[[str], Path]


@pytest.fixture(scope="module")
def done(natives: None, tmp_path_factory: pytest.TempPathFactory) -> Done:
    """Runs a benchmark, once for all tests, and gives the directory of the results."""
    results = tmp_path_factory.mktemp("results")
    ran: set[str] = set()

    def once(name: str) -> Path:
        if name not in ran:
            assert run(name, "tiny", results)
            ran.add(name)
        return results

    return once


def find(results: Path, name: str) -> list[dict[str, Any]]:
    return records.read(results / written.FOLDER, name)


QUICKEST = "pruning"


@pytest.mark.parametrize(
    "name",
    [pytest.param(each, marks=[pytest.mark.slow] * (each != QUICKEST)) for each in written.BENCHMARKS],
)
def test_a_benchmark_gives_tables_of_finite_numbers(done: Done, name: str) -> None:
    results = done(name)
    rows = find(results, name) or find(results, f"{name}_steps")
    assert rows
    for table in (results / written.FOLDER).glob("*.csv"):
        for row in find(results, table.stem):
            for key, value in row.items():
                assert not isinstance(value, float) or math.isfinite(value), (table.name, key, value)
    assert written.text(results)  # the report can be made of them


def test_the_report_has_every_benchmark_and_its_figures(tmp_path: Path) -> None:
    shutil.copytree(records.ROOT / "results" / written.FOLDER, tmp_path / written.FOLDER)
    paths = written.write(tmp_path)
    text = paths[0].read_text(encoding="utf-8")
    for title, _module in written.BENCHMARKS.values():
        assert f"## {title}\n" in text
    assert "*Not run.*" not in text
    assert "PyFMI: " in text  # what was not run is named
    shown = set(re.findall(r"\(benchmarks/(\w+\.png)\)", text))
    assert shown == {path.name for path in paths[1:]}
    made = [path.stat() for path in paths]
    assert all(each.st_size > 0 and each.st_mtime_ns > made[0].st_mtime_ns for each in made[1:])
    # after a change of words: python tests/benchmarks --report
    assert text == (records.ROOT / "results" / written.REPORT).read_text(encoding="utf-8")


def test_the_first_page_has_its_numbers_from_the_tables(tmp_path: Path) -> None:
    folder = tmp_path / written.FOLDER
    start = records.Table(start_up.NAME, ("what", "time [ms]", "spread [%]", "repeats"))
    start.add(start_up.BASE, 100.0, 1.0, 7)
    start.add(start_up.RUN, 230.0, 1.0, 7)
    costs = records.Table(cost.NAME, cost.COLUMNS)
    for master, recording, step in (
        (cost.PLAIN, "none", 10.0),
        (cost.ISOLATED, "none", 250.0),
        ("loomfmu", "HDF5", 4.0),
        ("ecos", "CSV", 36.0),
        ("libcosim", "CSV", 90.0),
        ("ecos", "none", 8.0),
    ):
        costs.add("native", "one", master, recording, step, 1.0, 1.0, 7)
    for table in (start, costs):
        table.write(folder)
    text = written.text(tmp_path)
    page = text[: text.index("## How it was measured")]
    assert f"| 230 ms | 2.3 times {start_up.BASE} (100 ms) |" in page
    assert "| 4 us | 1/9 of ecos, CSV (36 us) |" in page  # the fastest of those that record
    assert "| 20 us | 5 times a step (4 us) |" in page  # (250 - 10) us for twelve FMUs
    assert "live FMUs (Python) | not run |" in page
    assert "| native | one | 10 | 250 | 20 |" in text


def test_an_interrupted_run_leaves_a_report_of_what_was_measured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(name: str, _effort: str, results: Path) -> bool:
        if name == "cost":
            raise KeyboardInterrupt
        rows = records.Table("pruning", pruning.COLUMNS)
        rows.add("the whole loom", "HDF5", 5.0, 1.0, 7, "11 of 12 FMUs")
        return bool(rows.write(results / written.FOLDER))

    monkeypatch.setattr(running, "run", stopped)
    monkeypatch.setattr(sys, "argv", ["benchmarks", "pruning", "cost", "--output", str(tmp_path)])
    with pytest.raises(KeyboardInterrupt):
        runpy.run_path(str(records.HERE / "__main__.py"), run_name="__main__")
    assert "11 of 12 FMUs" in (tmp_path / written.REPORT).read_text(encoding="utf-8")


@pytest.mark.slow
def test_programs_in_c_give_the_bits_of_the_native_fmus_and_numpy_their_digits(done: Done) -> None:
    away = {row["what"]: row["largest difference [share]"] for row in find(done("limits"), "limits")}
    assert away[LOOP] == 0.0
    assert away[HOST] == 0.0
    assert away[WHOLE] == 0.0
    assert 0.0 < away[NUMPY] < 1e-13  # some hundred roundings: the terms stand in another order


@pytest.mark.slow
def test_signals_that_follow_from_the_angle_have_the_digits_of_the_references(done: Done) -> None:
    (row,) = (row for row in find(done("precision"), "precision") if row["method"] == "loomfmu, native FMUs")
    assert row["error of heald_1.lift [share of largest]"] < 1e-14  # tens of roundings
    assert row["error of belt.margin [share of largest]"] < 1e-13
    # 45 steps are quintics over 8 deg: as the components' own tests have it
    assert row["error of damper_1.displacement [share of largest]"] < 1e-8
    assert row["error of peak load [share]"] < 1e-7


def test_a_delay_is_found_from_an_error_and_the_rate() -> None:
    time = np.linspace(0.0, 1.0, 46)
    late = 1e-6
    error = np.sin(6.0 * (time - late)) - np.sin(6.0 * time)
    # what is left is of second order in the delay
    assert delay(error, 6.0 * np.cos(6.0 * time)) == pytest.approx(late, rel=1e-4)


def dies(_directory: Path) -> None:
    os._exit(3)


def refuses(_directory: Path) -> None:
    raise ValueError("it is not to be had\nhere")


@pytest.mark.few(1)
@pytest.mark.parametrize(("make", "said"), [(dies, "status 3"), (refuses, "it is not to be had$")])
def test_a_configuration_that_cannot_be_run_is_named(make: Callable[[Path], None], said: str) -> None:
    with pytest.raises(Failed, match=said):
        Child(make)


def test_results_of_one_benchmark_replace_its_own_alone(tmp_path: Path) -> None:
    columns = ("benchmark", "what", "why")
    for name, why in (("cost", "a"), ("pruning", "b"), ("cost", "c")):
        notes = records.Notes(name)
        notes("something", why)
        notes("something", why)
        records.replaced(tmp_path, "notes", name, notes.rows(), columns)
    assert [(row["benchmark"], row["why"]) for row in records.read(tmp_path, "notes")] == [
        ("pruning", "b"),
        ("cost", "c"),
    ]
