"""Sweeps from end to end: the values of single runs in one table, whoever computed it."""

import json
import os
import pty
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import odd_tasks
import pandas
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from live_fmus import in_a_process
from sweep_files import HEAD, NO_TRACES, SCENE, sweep_file, swept

import loomfmu
from loomfmu import LoomfmuError, Trace
from loomfmu.cli import main
from loomfmu.design import loom
from loomfmu.sweeps import plan as plans
from loomfmu.sweeps import run as sweeps_run
from loomfmu.sweeps import summary
from loomfmu.sweeps.ranking import beyond, traced_rows, worst_rows
from loomfmu.sweeps.worker import Batch, Job, identity

MACHINES = ["WL680-3600", "WL450-3600", "WL800-3600"]
CLEARANCES = [0.3e-3, 0.8e-3]
GRID = f'[grid]\nmachine = {MACHINES}\n"belt.guide_clearance" = ["0.3 mm", "0.8 mm"]\n'
# the coupler of 500 mm does not let the linkage close
BROKEN = '[grid]\n"weft.coupler_length" = ["245 mm", "500 mm"]\n"shaft.speed" = ["600 rpm", "700 rpm"]\n'
TWO_SPEEDS = '[grid]\n"shaft.speed" = ["500 rpm", "750 rpm"]\n'


def again(**given: Any) -> loomfmu.Sweep:
    """The same sweep once more in the same folder."""
    return loomfmu.sweep("swept.toml", processes=1, output="out", **given)


def command(*more: str) -> int:
    return main(["sweep", "swept.toml", "--output", "out", "--processes", "1", *more])


# ---- values


def test_the_table_has_the_safe_speeds_that_the_design_finds() -> None:
    found = swept(GRID + NO_TRACES)
    assert isinstance(found, loomfmu.Sweep)
    for row, values in enumerate(found.table.to_pylist()):
        machine, clearance = MACHINES[row // 2], CLEARANCES[row % 2]
        assert (values["row"], values["machine"]) == (row, machine)
        assert values["belt.guide_clearance"] == pytest.approx(clearance, rel=1e-15)  # rounding of 0.3 mm
        # 90 steps in a revolution, joined by quintics: 1.2e-6 off at the most
        wanted = loom.safe_speed(machine, clearance=clearance).speed
        assert values["belt.lowest_speed_limit"] == pytest.approx(wanted, rel=3e-6)
        assert values["claim_2.worst"] == pytest.approx(wanted, rel=3e-6)  # near its bound it is exact
        assert values["claim_2.bound"] == pytest.approx(600.0 * loom.RPM, rel=1e-15)
        assert values["claim_2.holds"] is (wanted >= 600.0 * loom.RPM)
        assert values["claim_1.bound"] == 0.0
        assert values["claim_2.distance"] == values["claim_2.worst"] - values["claim_2.bound"]
    assert (found.rows, found.holding, found.failing, found.errors, found.ran) == (6, 2, 4, 0, 6)
    assert not found


def test_a_row_is_what_evaluate_gives() -> None:
    ranges = '"shaft.speed" = ["500 rpm", "800 rpm"]\n"belt.head_mass" = [0.1, 0.2]\n'
    fixed = {"belt.guide_clearance": "0.8 mm", "steps_per_revolution": 180}
    text = "".join(f'"{key}" = {value!r}\n' for key, value in fixed.items())
    for values in swept(f"[set]\n{text}[sample]\ncount = 5\nseed = 3\n{ranges}{NO_TRACES}").table.to_pylist():
        single = loomfmu.evaluate(
            "scene.toml",
            set=fixed | {key: values[key] for key in ("shaft.speed", "belt.head_mass")},
            values=["belt.lowest_speed_limit"],
            errors="near",
        )
        assert values["holds"] is single.holds
        assert values["belt.lowest_speed_limit"] == single.trace["belt.lowest_speed_limit"][-1]
        verdicts = [(verdict.holds, verdict.worst, verdict.bound) for verdict in single.claims]
        assert verdicts == [
            tuple(values[f"claim_{n}.{word}"] for word in ("holds", "worst", "bound")) for n in (1, 2)
        ]


def test_final_values_keep_their_type() -> None:
    head = HEAD.replace('"belt.lowest_speed_limit"', '"belt.buckled", "damper_1.stop_contacts"')
    scene = SCENE.replace("[shaft]", 'weave = "10"\ndampers = true\n[shaft]')
    table = swept(
        '[grid]\n"shaft.speed" = ["500 rpm", "800 rpm"]\n' + NO_TRACES, scene=scene, head=head
    ).table
    assert table["belt.buckled"].to_pylist() == [False, True]
    assert table.schema.field("damper_1.stop_contacts").type == pa.int64()
    assert all(count > 0 for count in table["damper_1.stop_contacts"].to_pylist())


def test_columns_have_units_and_the_table_its_texts() -> None:
    found = swept(GRID + NO_TRACES)
    schema = pq.read_schema("out/table.parquet")
    units = {
        field.name: (field.metadata[b"unit"], field.metadata[b"display_unit"])
        for field in schema
        if b"unit" in (field.metadata or {})
    }
    assert units["belt.guide_clearance"] == (b"m", b"mm")
    assert units["belt.lowest_speed_limit"] == (b"rad/s", b"rev/min")
    assert units["claim_1.worst"] == units["claim_1.bound"] == (b"1", b"1")
    assert units["claim_2.worst"] == (b"rad/s", b"rev/min")
    assert schema.field("claim_2.worst").metadata[b"signal"] == b"belt.lowest_speed_limit"
    assert schema.field("claim_1.holds").metadata[b"description"].startswith(b"the belt does not buckle")
    about = {key.decode(): text.decode() for key, text in schema.metadata.items()}
    assert about["title"] == "Swept"
    assert about["sweep"] == Path("swept.toml").read_text() and about["scene"] == SCENE
    assert about["software"].startswith("loomfmu ") and about["flavour"] == "native"
    labels = [(each["unit"], each["display_unit"]) for each in json.loads(about["claims"])]
    assert labels == [("1", "1"), ("rad/s", "rev/min")]
    frame = pandas.read_parquet(found.path)
    assert list(frame.columns) == found.table.column_names
    assert frame.groupby("machine")["belt.lowest_speed_limit"].max()["WL680-3600"] > 71.0


def test_the_first_claim_that_fails_has_a_column() -> None:
    scene = SCENE + '[[claims]]\nkind = "above"\nsignal = "belt.lowest_margin"\nbound = 2.0\n'
    words = ("the belt does not buckle", "the loom runs below its safe speed")
    rows = swept(GRID + NO_TRACES, scene=scene).table.to_pylist()
    for row in rows:
        failing = [word for number, word in enumerate(words, 1) if not row[f"claim_{number}.holds"]]
        assert row["first_failing_claim"] == [*failing, "lowest value (belt.lowest_margin)"][0]
    assert len({row["first_failing_claim"] for row in rows}) > 1
    for row in swept(GRID + NO_TRACES, "two").table.to_pylist():
        assert (row["first_failing_claim"] is None) == row["holds"]


def test_a_row_within_its_error_of_a_bound_is_undecided(capsys: pytest.CaptureFixture[str]) -> None:
    limit = loom.safe_speed(MACHINES[0], clearance="0.3 mm").speed / loom.RPM
    found = swept(f'[grid]\n"shaft.speed" = ["400 rpm", "{limit!r} rpm", "720 rpm"]\n{NO_TRACES}')
    assert (found.holding, found.failing, found.undecided, found.errors) == (1, 1, 1, 0)
    far, near, _beyond = found.table.to_pylist()
    assert near["claim_2.decided"] is False and near["claim_2.holds"] is False and near["holds"] is False
    assert near["claim_2.error"] >= abs(near["claim_2.distance"])
    assert far["claim_2.error"] is None and far["claim_2.decided"] is True  # too far away to matter
    summary.show(found)
    printed = capsys.readouterr().out
    assert "3 combinations: 1 hold, 1 fail and 1 undecided" in printed
    assert "undecided  row 1" in printed


# ---- rows that cannot be run


def test_a_combination_that_cannot_run_has_its_reason_and_stops_nothing() -> None:
    found = swept(BROKEN)
    rows = found.table.to_pylist()
    assert [row["holds"] for row in rows] == [True, False, None, None]
    assert [row["error"] is None for row in rows] == [True, True, False, False]
    for row in rows[2:]:
        assert str(row["error"]).startswith("weft: the planar four-bar does not close")
        assert row["belt.lowest_speed_limit"] is row["claim_1.holds"] is row["claim_1.worst"] is None
        assert row["weft.coupler_length"] == 0.5
    assert (found.holding, found.failing, found.errors) == (1, 1, 2)
    # in pandas a row without a verdict leaves Booleans what they are
    frame = pandas.read_parquet(found.path)
    assert frame["holds"].dtype == frame["claim_1.holds"].dtype == "boolean"
    assert (len(frame[frame["holds"]]), frame["holds"].isna().sum()) == (1, 2)
    # no trace of what has none
    assert [path.name for path in found.traces] == ["row_000000.h5", "row_000001.h5"]


def test_a_sweep_in_which_nothing_runs_is_still_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    drawn = '[map]\nx = "weft.coupler_length"\nvalue = "belt.lowest_speed_limit"\n'
    sweep_file('[grid]\n"weft.coupler_length" = ["500 mm", "600 mm"]\n' + drawn)
    assert command() == 1
    printed = capsys.readouterr().out
    assert "2 combinations: 0 hold, 0 fail and 2 could not be run" in printed
    assert "row 0 could not be run (weft.coupler_length = 500 mm): weft: the planar four-bar" in printed
    assert "no map: no row has a value of belt.lowest_speed_limit there" in printed
    assert sorted(os.listdir("out")) == ["sweep.json", "table.parquet"]
    assert pq.read_table("out/table.parquet").num_rows == 2


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("run_rows", "lost"), [(odd_tasks.deadly_rows, {1}), (odd_tasks.unlucky_rows, set())]
)
def test_a_process_that_ends_costs_no_more_than_the_row_that_ends_it(
    monkeypatch: pytest.MonkeyPatch, run_rows: Callable[[Job, list[dict[str, Any]]], Batch], lost: set[int]
) -> None:
    speeds = [60.0 + 0.125 * number for number in range(12)]
    whole = swept(f'[grid]\n"shaft.speed" = {speeds}\n{NO_TRACES}', "whole").table
    monkeypatch.setattr("loomfmu.sweeps.schedule.run_rows", run_rows)
    found = loomfmu.sweep("swept.toml", processes=2, output="out").table
    errors = {row: error for row, error in enumerate(found["error"].to_pylist()) if error}
    assert errors == dict.fromkeys(lost, "the process that ran it ended with SIGKILL")
    assert lost or Path("ended_once").exists()
    others = sorted({*range(12)} - lost)
    assert found.take(others).equals(whole.take(others), check_metadata=True)


def test_what_is_wrong_with_the_machine_and_not_with_a_row_ends_the_sweep(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def full(*_arguments: object, **_named: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr("loomfmu.cosim.prepared.Prepared.evaluate", full)
        with pytest.raises(OSError, match="No space left"):
            swept(GRID + NO_TRACES)
    assert again().errors == 0


def test_two_processes_make_the_table_of_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("loomfmu.sweeps.store.Store.tidy", lambda _store: None)  # else none is left to see
    path = sweep_file(BROKEN + '[sample]\ncount = 20\nseed = 2\n"belt.head_mass" = [0.1, 0.2]\n' + NO_TRACES)
    one, two = (loomfmu.sweep(path, processes=count, output=f"by_{count}").path for count in (1, 2))
    assert one.read_bytes() == two.read_bytes()
    batches = [sorted(os.listdir(place.parent / "batches")) for place in (one, two)]
    assert batches[0] != batches[1]  # else it shows nothing


# ---- traces


def test_the_worst_failures_and_a_sample_of_the_others_have_full_traces() -> None:
    grid = '[grid]\n"shaft.speed" = ["500 rpm", "750 rpm", "600 rpm", "700 rpm", "800 rpm", "650 rpm"]\n'
    found = swept(grid + "[traces]\nfailures = 2\nsample = 2\n")
    # the limit is 681.8 rev/min: 800 and 750 fail worst; spread over rows 0, 2, 3, 5: the first and the last
    rows = (0, 1, 4, 5)
    assert [path.name for path in found.traces] == [f"row_{row:06d}.h5" for row in rows]
    for path, row in zip(found.traces, rows, strict=True):
        with Trace(path) as trace:
            assert trace.rows == 91 and "weft.stroke" in trace and "belt.deflection" in trace
            worst = [verdict.worst for verdict in trace.verdicts]
            # far from its bound a row is judged between the samples: 90 in a revolution, as above
            expected = [found.table[f"claim_{number}.worst"][row].as_py() for number in (1, 2)]
            assert worst == pytest.approx(expected, rel=5e-6, abs=5e-6)  # a margin is a difference from 1


@pytest.mark.parametrize("content", [None, b"", b"garbage", b"\x89HDF\r\n\x1a\n and then nothing"])
def test_a_trace_that_is_missing_or_garbage_is_made_again_and_no_other(content: bytes | None) -> None:
    bad, good = swept(TWO_SPEEDS).traces
    made = good.stat().st_mtime_ns
    bad.unlink()
    if content is not None:
        bad.write_bytes(content)
        (bad.parent / "row_000000.h5.01234567.partial").write_bytes(content)  # of a run that was killed
    found = again()
    assert found.ran == 0 and found.traces == (bad, good) and good.stat().st_mtime_ns == made
    with Trace(bad) as trace:
        assert (trace.status, trace.rows) == ("complete", 91)
    assert sorted(os.listdir("out/traces")) == ["row_000000.h5", "row_000001.h5"]


def test_a_trace_that_cannot_be_written_is_a_line_of_the_report(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """As on a full disk: the table and the other traces are there, and the next run writes the rest."""
    traced, target = sweeps_run.run_trace, Path("out/traces/row_000002.h5")

    def full(job: Job, settings: dict[str, object], path: Path) -> None:
        if path == target:
            raise LoomfmuError(f"{path}: cannot be written (No space left on device)")
        traced(job, settings, path)

    monkeypatch.setattr(sweeps_run, "run_trace", full)
    found = swept(GRID)
    assert found.untraced == {2: f"{target}: cannot be written (No space left on device)"}
    assert found.path.exists() and target not in found.traces and all(each.exists() for each in found.traces)
    assert command() == 1
    assert f"row 2 has no trace: {target}: cannot be" in capsys.readouterr().err
    monkeypatch.setattr(sweeps_run, "run_trace", traced)
    found = again()
    assert found.untraced == {} and target in found.traces


# ---- the worst rows


def made_up(worst: list[float | None], holds: list[bool | None]) -> pa.Table:
    columns = {
        "claim_1.holds": pa.array(holds),
        "claim_1.worst": pa.array(worst, pa.float64()),
        "claim_1.bound": pa.array([None if each is None else 10.0 for each in holds], pa.float64()),
        "holds": pa.array(holds),
        "error": pa.array([None if each is not None else "why" for each in holds]),
    }
    about = {"claims": json.dumps([{"claim": "a", "signal": "b.c", "unit": "1", "display_unit": "1"}])}
    return pa.table(columns).replace_schema_metadata(about)


def test_the_worst_rows_are_the_furthest_beyond_a_bound() -> None:
    worst = [11.0, 14.0, 9.0, None, 30.0, None, 10.5]
    table = made_up(worst, [False, False, True, None, True, False, False])
    # row 5 fails without a value; 2 holds narrowly, 4 by far; 3 was not run
    assert worst_rows(table, 10) == [5, 1, 0, 6, 2, 4]
    assert worst_rows(table, 2) == [5, 1]
    for failures, sample, rows in ((2, 0, [1, 5]), (2, 10, [0, 1, 2, 4, 5, 6]), (0, 1, [0]), (0, 0, [])):
        assert traced_rows(table, failures, sample) == rows
    # if all hold, the nearest to their bounds
    assert worst_rows(made_up([14.0, 10.5, 11.0], [True] * 3), 2) == [1, 2]


def test_a_claim_that_fails_everywhere_alike_hides_no_row() -> None:
    # claim 1 fails by as much in all rows but for roundings, claim 2 (bound 0.1) by far in row 2
    table = made_up([30.0, 30.0 * (1 + 1e-12), 30.0 * (1 - 1e-12), 30.0], [False] * 4)
    second = {"holds": [True, False, False, True], "worst": [0.3, 0.0, -6.07, 0.2], "bound": [0.1] * 4}
    labels = json.loads(table.schema.metadata[b"claims"]) * 2
    for word, values in second.items():
        table = table.append_column(f"claim_2.{word}", pa.array(values))
    table = table.replace_schema_metadata({"claims": json.dumps(labels)})
    assert worst_rows(table, 4) == [2, 1, 3, 0]
    # and it is named with the claim that it is furthest beyond, measured by that claim's bound
    assert beyond(table).claim.tolist() == [0, 0, 1, 0]


# ---- again


def test_a_finished_sweep_runs_nothing_again(capsys: pytest.CaptureFixture[str]) -> None:
    sweep_file(GRID + NO_TRACES)
    table = Path("out/table.parquet")
    states = []
    for before in ("", " (6 run before)"):
        assert command() == 1
        assert f"Swept: 6 combinations{before}: 2 hold" in capsys.readouterr().out
        states.append((table.read_bytes(), table.stat().st_mtime_ns))
        assert sorted(os.listdir("out")) == ["sweep.json", "table.parquet"]
    assert states[0] == states[1]


def test_a_sweep_writes_over_nothing_that_it_reads_nor_over_a_lock_of_others() -> None:
    path = sweep_file(GRID + NO_TRACES)
    for name in ("table.parquet", "sweep.json", "lock", "map.png"):
        own = path.rename(name)
        with pytest.raises(LoomfmuError, match=rf"{name}: cannot be written \(it is an input of this"):
            loomfmu.sweep(own, processes=1, output=".", restart=True)
        path = own.rename("swept.toml")
    Path("out").mkdir()
    Path("out/lock").write_text("my package manager's")
    with pytest.raises(LoomfmuError, match="lock: not the lock of a sweep"):
        again(restart=True)
    assert os.listdir("out") == ["lock"]


@pytest.mark.parametrize("change", ["sweep", "scene", "machine data"])
def test_a_sweep_that_has_changed_does_not_go_on_where_another_was(
    monkeypatch: pytest.MonkeyPatch, change: str
) -> None:
    swept(GRID + NO_TRACES)
    if change == "sweep":
        sweep_file(GRID.replace("0.8 mm", "0.9 mm") + NO_TRACES)
    elif change == "scene":
        sweep_file(GRID + NO_TRACES, SCENE.replace("bound = 0.0", "bound = 0.01"))
    else:
        monkeypatch.setitem(loomfmu.sweeps.worker.machines.MACHINES["WL680-3400"], "dc_mm", "151")
    with pytest.raises(LoomfmuError, match="contains another sweep"):
        again()
    assert again(restart=True).ran == 6


def test_the_other_flavour_is_another_sweep() -> None:
    scene = plans.load(sweep_file(GRID)).scene
    # the FMUs of the scene as they are: only the word differs
    given = {
        name: replace(each, fmu=replace(each.fmu, flavour="", given=each.fmu.file))
        for name, each in scene.instances.items()
    }
    as_files = replace(scene, instances=given)
    assert identity(as_files, "live") == identity(scene, "live") != identity(as_files, "native")


@pytest.mark.slow
def test_native_fmus_make_the_table_of_live_ones() -> None:
    live, native = (
        swept(GRID + NO_TRACES, flavour, head=f'flavour = "{flavour}"\n{HEAD}').table
        for flavour in ("live", "native")
    )
    assert [each.schema.metadata[b"flavour"] for each in (live, native)] == [b"live", b"native"]
    for name in ("belt.lowest_speed_limit", "claim_1.worst"):
        # C and Python round alike but for the last bits of their sines
        np.testing.assert_allclose(native[name].to_numpy(), live[name].to_numpy(), rtol=1e-12)


def test_a_scene_that_changes_while_its_sweep_runs_ends_it(monkeypatch: pytest.MonkeyPatch) -> None:
    loaded = plans.load(sweep_file(GRID + NO_TRACES))
    sweep_file(GRID + NO_TRACES, SCENE.replace("bound = 0.0", "bound = 0.5"))
    monkeypatch.setattr(plans, "load", lambda _path: loaded)
    with pytest.raises(
        LoomfmuError, match=r"scene\.toml: a worker has another version of loomfmu, or the fi"
    ):
        again()


# ---- the command


def test_the_command_says_how_many_hold_which_are_worst_and_where_all_is(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    drawn = '[map]\nx = "shaft.speed"\nvalue = "claim_1.worst"\n'
    sweep_file('[grid]\n"shaft.speed" = ["500 rpm", "750 rpm", "700 rpm"]\n' + drawn)
    monkeypatch.setenv("COLUMNS", "200")
    here = ["sweep", "swept.toml", "--processes", "1"]
    assert main(here) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "Swept: 3 combinations: 1 hold and 2 fail"
    worst = [("FAILS", 1, 750), ("FAILS", 2, 700), ("holds", 0, 500)]
    table = [line.split()[:4] for line in lines if "rev/min" in line]
    assert table == [[word, str(row), str(speed), "rev/min"] for word, row, speed in worst]
    assert lines[-3:] == [
        "table: results/swept/table.parquet",
        "map: results/swept/map.png",
        "traces: 3 in results/swept/traces",
    ]
    monkeypatch.setenv("COLUMNS", "80")
    assert main(here) == 1
    lines = capsys.readouterr().out.splitlines()
    assert all(len(line) <= 80 and line == line.rstrip() for line in lines)
    entries = [f"{word}  row {row} (shaft.speed = {speed} rev/min)" for word, row, speed in worst]
    assert [line for line in lines if "row" in line] == entries
    sweep_file('[grid]\n"shaft.speed" = ["500 rpm", "600 rpm"]\n')
    assert main([*here, "--restart"]) == 0
    assert not Path("results/swept/map.png").exists()


@pytest.mark.parametrize("width", ["60", "300"])
def test_the_note_on_a_verdict_is_shown(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, width: str
) -> None:
    monkeypatch.setenv("COLUMNS", width)
    sweep_file('[set]\nrevolutions = 0.5\n[grid]\n"shaft.speed" = ["500 rpm"]\n' + NO_TRACES)
    command()
    note = pq.read_table("out/table.parquet")["claim_1.note"][0].as_py()
    assert "revolution" in note
    assert note == loomfmu.evaluate("scene.toml", set={"revolutions": 0.5}).claims[0].note
    assert " ".join(note.split()) in " ".join(capsys.readouterr().out.split())


def test_warnings_are_kept_and_told_on_the_error_stream(capsys: pytest.CaptureFixture[str]) -> None:
    sweep_file('[grid]\n"belt.guide_clearance" = ["0.3 mm", "2 mm"]\n' + NO_TRACES)
    command()
    said = "row 1 warned (belt.guide_clearance = 2 mm): belt: guide_clearance = 2 mm"
    assert said in capsys.readouterr().err
    warnings = pq.read_table("out/table.parquet")["warnings"].to_pylist()
    assert warnings[0] is None and "above 1 mm replace the belt" in warnings[1]


def test_a_terminal_sees_how_far_it_is_and_how_long_it_takes() -> None:
    sweep_file('[grid]\n"shaft.speed" = { from = 40.0, to = 60.0, count = 60 }\n' + NO_TRACES)
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "loomfmu.cli", "sweep", "swept.toml", "--processes", "1"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=theirs, text=True) as running:
        os.close(theirs)
        seen = b""
        try:
            while block := os.read(ours, 4096):
                seen += block
        except OSError:  # how a terminal ends whose other side is closed
            pass
        os.close(ours)
    assert running.returncode == 0
    text = seen.decode()
    assert "Swept" in text and "/60" in text and ":" in text


def test_importing_loomfmu_and_its_command_stays_light() -> None:
    script = (
        "import sys, loomfmu, loomfmu.cli\n"
        "heavy = {'pyarrow', 'dask', 'distributed', 'matplotlib', 'numpy', 'scipy'}\n"
        "print(sorted(heavy & set(sys.modules)), loomfmu.sweep.__name__, sorted(heavy & set(sys.modules)))"
    )
    light, name, after = in_a_process(script).split(maxsplit=2)
    assert (light, name) == ("[]", "sweep")
    assert "pyarrow" not in after and "distributed" not in after and "matplotlib" not in after
