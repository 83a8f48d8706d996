"""Sweeps from end to end: the values of single runs in one table, whoever computed it."""

import json
import os
import pty
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import odd_tasks
import pandas
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from live_fmus import in_a_process
from sweep_files import HEAD, NO_TRACES, SCENE, written

import loomfmu
from loomfmu import LoomfmuError, Trace
from loomfmu.cli import main
from loomfmu.design import loom
from loomfmu.sweeps import plan as plans
from loomfmu.sweeps import run as sweeps_run
from loomfmu.sweeps import summary
from loomfmu.sweeps.ranking import beyond, traced_rows, worst_rows
from loomfmu.sweeps.worker import Job, identity

MACHINES = ["WL680-3600", "WL450-3600", "WL800-3600"]
CLEARANCES = [0.3e-3, 0.8e-3]
GRID = (
    '[grid]\nmachine = ["WL680-3600", "WL450-3600", "WL800-3600"]\n'
    '"belt.guide_clearance" = ["0.3 mm", "0.8 mm"]\n'
)
# the coupler of 500 mm does not let the linkage close
BROKEN = '[grid]\n"weft.coupler_length" = ["245 mm", "500 mm"]\n"shaft.speed" = ["600 rpm", "700 rpm"]\n'


def rows_of(table: pa.Table) -> list[dict[str, object]]:
    rows: list[dict[str, object]] = table.to_pylist()
    return rows


# ---- values


def test_the_table_has_the_safe_speeds_that_the_design_finds(tmp_path: Path) -> None:
    found = loomfmu.sweep(written(tmp_path, GRID + NO_TRACES), processes=1, output=tmp_path / "out")
    assert isinstance(found, loomfmu.Sweep)
    for row, values in enumerate(rows_of(found.table)):
        machine, clearance = MACHINES[row // 2], CLEARANCES[row % 2]
        assert (values["row"], values["machine"]) == (row, machine)
        assert values["belt.guide_clearance"] == pytest.approx(clearance, rel=1e-15)  # rounding of 0.3 mm
        # 90 steps in a revolution, joined by quintics: 1.2e-6 off at the most
        wanted = loom.safe_speed(machine, clearance=clearance).speed
        assert values["belt.lowest_speed_limit"] == pytest.approx(wanted, rel=3e-6)
        assert values["claim_2.worst"] == values["belt.lowest_speed_limit"]
        assert values["claim_2.bound"] == pytest.approx(600.0 * loom.RPM, rel=1e-15)
        assert values["claim_2.holds"] is (wanted >= 600.0 * loom.RPM)
        assert values["claim_1.bound"] == 0.0
        assert values["claim_2.distance"] == values["claim_2.worst"] - values["claim_2.bound"]
    assert (found.rows, found.holding, found.failing, found.errors, found.ran) == (6, 2, 4, 0, 6)
    assert not found


def test_a_row_is_what_evaluate_gives(tmp_path: Path) -> None:
    ranges = '"shaft.speed" = ["500 rpm", "800 rpm"]\n"belt.head_mass" = [0.1, 0.2]\n'
    text = "[sample]\ncount = 5\nseed = 3\n" + ranges
    found = loomfmu.sweep(written(tmp_path, text + NO_TRACES), processes=1, output=tmp_path / "out")
    for values in rows_of(found.table):
        single = loomfmu.evaluate(
            tmp_path / "scene.toml",
            set={key: values[key] for key in ("shaft.speed", "belt.head_mass")},
            values=["belt.lowest_speed_limit"],
        )
        assert values["holds"] is single.holds
        assert values["belt.lowest_speed_limit"] == single.trace["belt.lowest_speed_limit"][-1]
        verdicts = [(verdict.holds, verdict.worst, verdict.bound) for verdict in single.claims]
        assert verdicts == [
            tuple(values[f"claim_{n}.{word}"] for word in ("holds", "worst", "bound")) for n in (1, 2)
        ]


def test_what_is_fixed_holds_for_all_rows(tmp_path: Path) -> None:
    text = '[set]\n"belt.guide_clearance" = "0.8 mm"\nsteps_per_revolution = 180\n'
    path = written(tmp_path, text + '[grid]\n"shaft.speed" = ["500 rpm"]\n' + NO_TRACES)
    found = loomfmu.sweep(path, processes=1, output=tmp_path / "out")
    single = loomfmu.evaluate(
        tmp_path / "scene.toml",
        set={"belt.guide_clearance": "0.8 mm", "steps_per_revolution": 180, "shaft.speed": "500 rpm"},
    )
    assert found.table["claim_1.worst"].to_pylist() == [single.claims[0].worst]


def test_final_values_keep_their_type(tmp_path: Path) -> None:
    head = HEAD.replace('"belt.lowest_speed_limit"', '"belt.buckled", "damper_1.stop_contacts"')
    scene = SCENE.replace("[shaft]", 'weave = "10"\ndampers = true\n[shaft]')
    path = written(tmp_path, '[grid]\n"shaft.speed" = ["500 rpm", "800 rpm"]\n' + NO_TRACES, scene, head)
    table = loomfmu.sweep(path, processes=1, output=tmp_path / "out").table
    assert table["belt.buckled"].to_pylist() == [False, True]
    assert table.schema.field("damper_1.stop_contacts").type == pa.int64()
    assert all(count > 0 for count in table["damper_1.stop_contacts"].to_pylist())


# ---- what the table says of itself


def test_columns_have_units_and_the_table_its_texts(tmp_path: Path) -> None:
    path = written(tmp_path, GRID + NO_TRACES)
    found = loomfmu.sweep(path, processes=1, output=tmp_path / "out")
    schema = pq.read_schema(tmp_path / "out" / "table.parquet")
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
    assert about["sweep"] == path.read_text() and about["scene"] == SCENE
    assert about["software"].startswith("loomfmu ") and about["flavour"] == "native"
    labels = [(each["unit"], each["display_unit"]) for each in json.loads(about["claims"])]
    assert labels == [("1", "1"), ("rad/s", "rev/min")]
    frame = pandas.read_parquet(found.path)
    assert list(frame.columns) == found.table.column_names
    assert frame.groupby("machine")["belt.lowest_speed_limit"].max()["WL680-3600"] > 71.0


def test_no_time_of_day_is_in_the_table(tmp_path: Path) -> None:
    path = written(tmp_path, GRID + NO_TRACES)
    tables = [
        loomfmu.sweep(path, processes=1, output=tmp_path / place).path.read_bytes()
        for place in ("one", "two")
    ]
    assert tables[0] == tables[1]


# ---- rows that cannot be run


def test_a_combination_that_cannot_run_has_its_reason_and_stops_nothing(tmp_path: Path) -> None:
    path = written(tmp_path, BROKEN)
    found = loomfmu.sweep(path, processes=1, output=tmp_path / "out")
    rows = rows_of(found.table)
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


def test_a_sweep_in_which_nothing_runs_is_still_a_table(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    drawn = '[map]\nx = "weft.coupler_length"\nvalue = "belt.lowest_speed_limit"\n'
    path = written(tmp_path, '[grid]\n"weft.coupler_length" = ["500 mm", "600 mm"]\n' + drawn)
    status = main(["sweep", str(path), "--output", str(tmp_path / "out"), "--processes", "1"])
    assert status == 1
    printed = capsys.readouterr().out
    assert "2 combinations: 0 hold, 0 fail and 2 could not be run" in printed
    assert "row 0 could not be run (weft.coupler_length = 500 mm): weft: the planar four-bar" in printed
    assert "no map: no row has a value of belt.lowest_speed_limit there" in printed
    assert sorted(os.listdir(tmp_path / "out")) == ["sweep.json", "table.parquet"]
    assert pq.read_table(tmp_path / "out" / "table.parquet").num_rows == 2


def test_a_row_that_ends_its_process_is_found_and_the_others_are_not_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    speeds = "".join(f"{60.0 + 0.125 * number}, " for number in range(12))
    path = written(tmp_path, f'[grid]\n"shaft.speed" = [{speeds}]\n' + NO_TRACES)
    whole = loomfmu.sweep(path, processes=1, output=tmp_path / "whole").table
    monkeypatch.setattr("loomfmu.sweeps.schedule.run_rows", odd_tasks.deadly_rows)
    found = loomfmu.sweep(path, processes=2, output=tmp_path / "out").table
    errors = found["error"].to_pylist()
    assert errors.pop(1) == "the process that ran it ended with SIGKILL"
    assert errors == [None] * 11
    assert found.take([0, *range(2, 12)]).equals(whole.take([0, *range(2, 12)]))


def test_a_process_that_ends_by_chance_costs_no_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path, '[grid]\n"shaft.speed" = [60.0, 60.125, 60.25]\n' + NO_TRACES)
    whole = loomfmu.sweep(path, processes=1, output=tmp_path / "whole").table
    monkeypatch.setattr("loomfmu.sweeps.schedule.run_rows", odd_tasks.unlucky_rows)
    found = loomfmu.sweep(path, processes=2, output=tmp_path / "out").table
    assert (tmp_path / "ended_once").exists()
    assert found.equals(whole, check_metadata=True)


def test_what_is_wrong_with_the_machine_and_not_with_a_row_ends_the_sweep(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_arguments: object, **_named: object) -> None:
        raise OSError(28, "No space left on device")

    path = written(tmp_path, GRID + NO_TRACES)
    with monkeypatch.context() as patched:
        patched.setattr("loomfmu.cosim.prepared.Prepared.evaluate", full)
        with pytest.raises(OSError, match="No space left"):
            loomfmu.sweep(path, processes=1, output=tmp_path / "out")
    assert loomfmu.sweep(path, processes=1, output=tmp_path / "out").errors == 0


# ---- processes


def test_two_processes_make_the_table_of_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("loomfmu.sweeps.store.Store.tidy", lambda _store: None)  # else none is left to see
    path = written(
        tmp_path, BROKEN + '[sample]\ncount = 20\nseed = 2\n"belt.head_mass" = [0.1, 0.2]\n' + NO_TRACES
    )
    one, two = (
        loomfmu.sweep(path, processes=count, output=tmp_path / f"by_{count}").path for count in (1, 2)
    )
    assert one.read_bytes() == two.read_bytes()
    batches = [sorted(os.listdir(place.parent / "batches")) for place in (one, two)]
    assert batches[0] != batches[1]  # else it shows nothing


def test_fewer_than_one_process_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, GRID)
    assert main(["sweep", str(path), "--processes", "0"]) == 2
    assert "processes = 0 must be 1 or more" in capsys.readouterr().err


# ---- traces


def test_the_worst_failures_and_a_sample_of_the_others_have_full_traces(tmp_path: Path) -> None:
    grid = '[grid]\n"shaft.speed" = ["500 rpm", "750 rpm", "600 rpm", "700 rpm", "800 rpm", "650 rpm"]\n'
    path = written(tmp_path, grid + "[traces]\nfailures = 2\nsample = 2\n")
    found = loomfmu.sweep(path, processes=1, output=tmp_path / "out")
    # the limit is 681.8 rev/min: 800 and 750 fail worst; spread over rows 0, 2, 3, 5: the first and the last
    assert [path.name for path in found.traces] == [f"row_{row:06d}.h5" for row in (0, 1, 4, 5)]
    for path in found.traces:
        row = int(path.stem.removeprefix("row_"))
        with Trace(path) as trace:
            assert trace.rows == 91 and "weft.stroke" in trace and "belt.deflection" in trace
            worst = [verdict.worst for verdict in trace.verdicts]
            # the whole scene against what the claims need: as exact as `evaluate` is, a few roundings
            assert worst == pytest.approx(
                [found.table[f"claim_{number}.worst"][row].as_py() for number in (1, 2)], rel=1e-12
            )


def test_a_trace_that_is_there_is_not_made_again(tmp_path: Path) -> None:
    path = written(tmp_path, '[grid]\n"shaft.speed" = ["500 rpm", "750 rpm"]\n')
    first = loomfmu.sweep(path, processes=1, output=tmp_path / "out")
    made = [path.stat().st_mtime_ns for path in first.traces]
    first.traces[1].unlink()
    again = loomfmu.sweep(path, processes=1, output=tmp_path / "out")
    assert again.ran == 0
    assert again.traces == first.traces
    assert again.traces[0].stat().st_mtime_ns == made[0]
    assert again.traces[1].exists()


@pytest.mark.parametrize("content", [b"", b"garbage", b"\x89HDF\r\n\x1a\n and then nothing"])
def test_a_trace_that_is_garbage_is_made_again(tmp_path: Path, content: bytes) -> None:
    path = written(tmp_path, '[grid]\n"shaft.speed" = ["500 rpm", "750 rpm"]\n')
    first = loomfmu.sweep(path, processes=1, output=tmp_path / "out")
    first.traces[0].write_bytes(content)
    (first.traces[0].parent / "row_000000.h5.01234567.partial").write_bytes(
        content
    )  # of a run that was killed
    again = loomfmu.sweep(path, processes=1, output=tmp_path / "out")
    with Trace(again.traces[0]) as trace:
        assert (trace.status, trace.rows) == ("complete", 91)
    assert sorted(os.listdir(tmp_path / "out" / "traces")) == ["row_000000.h5", "row_000001.h5"]


@pytest.mark.parametrize("width", ["60", "300"])
def test_the_note_on_a_verdict_is_shown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, width: str
) -> None:
    monkeypatch.setenv("COLUMNS", width)
    text = '[set]\nsteps_per_revolution = 12\n[grid]\n"shaft.speed" = ["500 rpm"]\n' + NO_TRACES
    main(["sweep", str(written(tmp_path, text)), "--output", str(tmp_path / "out"), "--processes", "1"])
    note = pq.read_table(tmp_path / "out" / "table.parquet")["claim_1.note"][0].as_py()
    verdict = loomfmu.evaluate(tmp_path / "scene.toml", set={"steps_per_revolution": 12}).claims[0]
    assert "samples" in note and note == verdict.note
    assert " ".join(note.split()) in " ".join(capsys.readouterr().out.split())


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
    holds = [False, False, True, None, True, False, False]
    table = made_up(worst, holds)
    # row 5 fails without a value; 2 holds narrowly, 4 by far; 3 was not run
    assert worst_rows(table, 10) == [5, 1, 0, 6, 2, 4]
    assert worst_rows(table, 2) == [5, 1]
    assert traced_rows(table, 2, 0) == [1, 5]
    assert traced_rows(table, 2, 10) == [0, 1, 2, 4, 5, 6]
    assert traced_rows(table, 0, 1) == [0]
    assert traced_rows(table, 0, 0) == []


def test_a_claim_that_fails_everywhere_alike_hides_no_row() -> None:
    # claim 1 fails by as much in all rows but for roundings, claim 2 (bound 0.1) by far in row 2
    table = made_up([30.0, 30.0 * (1 + 1e-12), 30.0 * (1 - 1e-12), 30.0], [False] * 4)
    second = {"holds": [True, False, False, True], "worst": [0.3, 0.0, -6.07, 0.2], "bound": [0.1] * 4}
    label = {"claim": "margin", "signal": "b.c", "unit": "1", "display_unit": "1"}
    labels = [*json.loads(table.schema.metadata[b"claims"]), label]
    for word, values in second.items():
        table = table.append_column(f"claim_2.{word}", pa.array(values))
    table = table.replace_schema_metadata({"claims": json.dumps(labels)})
    assert worst_rows(table, 4) == [2, 1, 3, 0]
    # and it is named with the claim that it is furthest beyond, measured by that claim's bound
    assert beyond(table).claim.tolist() == [0, 0, 1, 0]


def test_if_all_hold_the_worst_are_the_nearest_to_their_bound() -> None:
    assert worst_rows(made_up([14.0, 10.5, 11.0], [True] * 3), 2) == [1, 2]


# ---- again


def test_a_finished_sweep_runs_nothing_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, GRID + NO_TRACES)
    arguments = ["sweep", str(path), "--output", str(tmp_path / "out"), "--processes", "1"]
    assert main(arguments) == 1
    assert "Swept: 6 combinations: 2 hold" in capsys.readouterr().out
    table = tmp_path / "out" / "table.parquet"
    before, written_at = table.read_bytes(), table.stat().st_mtime_ns
    assert sorted(os.listdir(tmp_path / "out")) == ["sweep.json", "table.parquet"]
    assert main(arguments) == 1
    assert "Swept: 6 combinations (6 run before): 2 hold" in capsys.readouterr().out
    assert (table.read_bytes(), table.stat().st_mtime_ns) == (before, written_at)
    assert sorted(os.listdir(tmp_path / "out")) == ["sweep.json", "table.parquet"]


def test_the_first_claim_that_fails_has_a_column(tmp_path: Path) -> None:
    scene = SCENE + '[[claims]]\nkind = "above"\nsignal = "belt.lowest_margin"\nbound = 2.0\n'
    path = written(tmp_path, GRID + NO_TRACES, scene=scene)
    table = loomfmu.sweep(path, processes=1, output=tmp_path / "out").table
    for row in table.to_pylist():
        failing = [number for number in (1, 2, 3) if not row[f"claim_{number}.holds"]]
        words = {
            1: "the belt does not buckle",
            2: "the loom runs below its safe speed",
            3: "lowest value (belt.lowest_margin)",
        }
        assert row["first_failing_claim"] == words[failing[0]]
    assert len(set(table["first_failing_claim"].to_pylist())) > 1
    held = loomfmu.sweep(written(tmp_path, GRID + NO_TRACES), processes=1, output=tmp_path / "two").table
    for row in held.to_pylist():
        assert (row["first_failing_claim"] is None) == row["holds"]


def test_a_sweep_writes_over_nothing_that_it_reads_or_that_is_not_its_own(tmp_path: Path) -> None:
    path = written(tmp_path, GRID + NO_TRACES)
    for name in ("table.parquet", "sweep.json", "lock", "map.png"):
        own = path.rename(tmp_path / name)
        with pytest.raises(LoomfmuError, match=rf"{name}: cannot be written \(it is an input of this"):
            loomfmu.sweep(own, processes=1, output=tmp_path, restart=True)
        path = own.rename(tmp_path / "swept.toml")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "lock").write_text("my package manager's")
    with pytest.raises(LoomfmuError, match="lock: not the lock of a sweep"):
        loomfmu.sweep(path, processes=1, output=tmp_path / "out", restart=True)
    assert os.listdir(tmp_path / "out") == ["lock"]
    (tmp_path / "out" / "lock").rename(tmp_path / "out" / "map.png")
    with pytest.raises(LoomfmuError, match="contains files that no loomfmu sweep wrote"):
        loomfmu.sweep(path, processes=1, output=tmp_path / "out")
    assert os.listdir(tmp_path / "out") == ["map.png"]


@pytest.mark.parametrize("change", ["sweep", "scene", "machine data"])
def test_a_sweep_that_has_changed_does_not_go_on_where_another_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, change: str
) -> None:
    path = written(tmp_path, GRID + NO_TRACES)
    loomfmu.sweep(path, processes=1, output=tmp_path / "out")
    if change == "sweep":
        path.write_text(path.read_text().replace("0.8 mm", "0.9 mm"))
    elif change == "scene":
        (tmp_path / "scene.toml").write_text(SCENE.replace("bound = 0.0", "bound = 0.01"))
    else:
        monkeypatch.setitem(loomfmu.sweeps.worker.machines.MACHINES["WL680-3400"], "dc_mm", "151")
    with pytest.raises(LoomfmuError, match="contains another sweep"):
        loomfmu.sweep(path, processes=1, output=tmp_path / "out")
    assert loomfmu.sweep(path, processes=1, output=tmp_path / "out", restart=True).ran == 6


def test_the_other_flavour_is_another_sweep(tmp_path: Path) -> None:
    live = plans.load(written(tmp_path, GRID))
    # the FMUs of the scene as they are: only the word differs
    assert identity(live.scene, "live") == identity(live.scene, "live")
    given = {
        name: replace(each, fmu=replace(each.fmu, flavour="", given=each.fmu.file))
        for name, each in live.scene.instances.items()
    }
    as_files = replace(live.scene, instances=given)
    assert identity(as_files, "live") == identity(live.scene, "live") != identity(as_files, "native")


@pytest.mark.slow
def test_native_fmus_make_the_table_of_live_ones(tmp_path: Path) -> None:
    path = written(tmp_path, GRID + NO_TRACES)
    live = loomfmu.sweep(path, processes=1, output=tmp_path / "live").table
    path.write_text('flavour = "native"\n' + path.read_text())
    native = loomfmu.sweep(path, processes=2, output=tmp_path / "native").table
    assert native.schema.metadata[b"flavour"] == b"native"
    for name in ("belt.lowest_speed_limit", "claim_1.worst"):
        # C and Python round alike but for the last bits of their sines
        np.testing.assert_allclose(native[name].to_numpy(), live[name].to_numpy(), rtol=1e-12)


def test_a_scene_that_changes_while_its_sweep_runs_ends_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = written(tmp_path, GRID + NO_TRACES)
    loaded = plans.load(path)
    (tmp_path / "scene.toml").write_text(SCENE.replace("bound = 0.0", "bound = 0.5"))
    monkeypatch.setattr(plans, "load", lambda _path: loaded)
    with pytest.raises(
        LoomfmuError, match=r"scene\.toml: a worker has another version of loomfmu, or the file has ch"
    ):
        loomfmu.sweep(path, processes=1, output=tmp_path / "out")


# ---- the command


def test_the_command_says_how_many_hold_which_are_worst_and_where_all_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    drawn = '[map]\nx = "shaft.speed"\nvalue = "claim_1.worst"\n'
    written(tmp_path, '[grid]\n"shaft.speed" = ["500 rpm", "750 rpm", "700 rpm"]\n' + drawn)
    monkeypatch.setenv("COLUMNS", "200")
    assert main(["sweep", "swept.toml", "--processes", "1"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "Swept: 3 combinations: 1 hold and 2 fail"
    table = [line.split() for line in lines if "rev/min" in line]
    assert [row[:4] for row in table] == [
        ["FAILS", "1", "750", "rev/min"],
        ["FAILS", "2", "700", "rev/min"],
        ["holds", "0", "500", "rev/min"],
    ]
    assert lines[-3:] == [
        "table: results/swept/table.parquet",
        "map: results/swept/map.png",
        "traces: 3 in results/swept/traces",
    ]
    monkeypatch.setenv("COLUMNS", "80")
    assert main(["sweep", "swept.toml", "--processes", "1"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert all(len(line) <= 80 and line == line.rstrip() for line in lines)
    assert [line for line in lines if "row" in line] == [
        "FAILS  row 1 (shaft.speed = 750 rev/min)",
        "FAILS  row 2 (shaft.speed = 700 rev/min)",
        "holds  row 0 (shaft.speed = 500 rev/min)",
    ]
    written(tmp_path, '[grid]\n"shaft.speed" = ["500 rpm", "600 rpm"]\n')
    assert main(["sweep", "swept.toml", "--processes", "1", "--restart"]) == 0
    assert not Path("results/swept/map.png").exists()


def test_warnings_are_kept_and_told_on_the_error_stream(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path, '[grid]\n"belt.guide_clearance" = ["0.3 mm", "2 mm"]\n' + NO_TRACES)
    main(["sweep", str(path), "--output", str(tmp_path / "out"), "--processes", "1"])
    assert (
        "row 1 warned (belt.guide_clearance = 2 mm): belt: guide_clearance = 2 mm" in capsys.readouterr().err
    )
    warnings = pq.read_table(tmp_path / "out" / "table.parquet")["warnings"].to_pylist()
    assert warnings[0] is None and "above 1 mm replace the belt" in warnings[1]


def test_a_terminal_sees_how_far_it_is_and_how_long_it_takes(tmp_path: Path) -> None:
    path = written(tmp_path, '[grid]\n"shaft.speed" = { from = 40.0, to = 60.0, count = 60 }\n' + NO_TRACES)
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "loomfmu.cli", "sweep", str(path), "--processes", "1"]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=theirs, text=True) as running:
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


def test_a_sweep_may_begin_with_a_mark_of_its_encoding(tmp_path: Path) -> None:
    path = written(tmp_path, GRID + NO_TRACES)
    plain = plans.load(path)
    path.write_bytes(path.read_text(encoding="utf-8").encode("utf-8-sig"))
    assert plans.load(path).text == plain.text


def test_a_trace_that_cannot_be_written_is_a_line_of_the_report(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """As on a full disk: the table and the other traces are there, and the next run writes the rest."""
    path, traced = written(tmp_path, GRID), sweeps_run.run_trace

    def full(job: Job, settings: dict[str, object], target: Path) -> None:
        if target.name == "row_000002.h5":
            raise LoomfmuError(f"{target}: cannot be written (No space left on device)")
        traced(job, settings, target)

    monkeypatch.setattr(sweeps_run, "run_trace", full)
    found = loomfmu.sweep(path, processes=1, output=tmp_path / "out")
    target = tmp_path / "out" / "traces" / "row_000002.h5"
    assert found.untraced == {2: f"{target}: cannot be written (No space left on device)"}
    assert found.path.exists() and target not in found.traces and all(each.exists() for each in found.traces)
    assert main(["sweep", str(path), "--processes", "1", "--output", str(tmp_path / "out")]) == 1
    assert f"row 2 has no trace: {target}: cannot be" in capsys.readouterr().err
    monkeypatch.setattr(sweeps_run, "run_trace", traced)
    found = loomfmu.sweep(path, processes=1, output=tmp_path / "out")
    assert found.untraced == {} and target in found.traces


def test_a_row_within_its_error_of_a_bound_is_undecided(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = f'[grid]\n"shaft.speed" = ["400 rpm", "681.805 rpm", "720 rpm"]\n{NO_TRACES}'
    found = loomfmu.sweep(written(tmp_path, text), output=tmp_path / "out", processes=1)
    assert (found.holding, found.failing, found.undecided, found.errors) == (1, 1, 1, 0)
    far, near, _beyond = rows_of(found.table)
    assert near["claim_2.decided"] is False and near["claim_2.holds"] is False and near["holds"] is False
    assert near["claim_2.error"] >= abs(near["claim_2.distance"])
    assert far["claim_2.error"] is None and far["claim_2.decided"] is True  # too far away to matter
    summary.show(found)
    printed = capsys.readouterr().out
    assert "3 combinations: 1 hold, 1 fail and 1 undecided" in printed
    assert "undecided  row 1" in printed
