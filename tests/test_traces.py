"""Traces: what is in the file, who can read it, and what is left of a run that was cut off."""

import hashlib
import json
import math
import os
import pickle
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import sdf
import xarray
from live_fmus import in_a_process
from made_traces import made

import loomfmu
from loomfmu import LoomfmuError, Trace, cli, units
from loomfmu.commit import commit
from loomfmu.cosim.importing import fmus
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.declaring.variables import variables_of
from loomfmu.traces import ROWS, TRACE, Channel, TraceWriter, damage
from loomfmu.traces.damage import check  # in a process of its own

SCENE = """
title = "Two frames"
revolutions = 1.5
steps_per_revolution = 1440
[loom]
machine = "WL680-3600"
weave = "10/01"
dampers = true
[heald]
stroke = "60 mm"
[[claims]]
name = "holds"
kind = "lowest_margin"
bound = 0.1
[[claims]]
kind = "stop_contacts"
damper = "damper_1"
at_most = 100
"""


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory, fmu_cache: None) -> loomfmu.Result:
    directory = tmp_path_factory.mktemp("traces")
    path = directory / "two_frames.toml"
    path.write_text(SCENE)
    return loomfmu.run(path, output=directory / "two_frames.h5")


@pytest.fixture
def file(result: loomfmu.Result):
    with h5py.File(result.path, "r") as opened:
        yield opened


@pytest.fixture
def copied(result: loomfmu.Result, tmp_path: Path) -> Path:
    return Path(shutil.copy(result.path, tmp_path / "run.h5"))


# ---- what is in the file


def test_the_root_says_what_was_run(file: h5py.File, result: loomfmu.Result) -> None:
    said = dict(file.attrs)
    assert said["Conventions"] == "CF-1.11"
    assert said["title"] == "Two frames"
    assert said["scene"] == SCENE
    assert said["status"] == "complete"
    assert said["software"] == f"loomfmu {metadata.version('loomfmu')}"
    assert said.get("commit", "") == commit()
    assert (said["revolutions"], said["steps_per_revolution"]) == (1.5, 1440)
    assert (said["set"], said["flavour"]) == ("{}", "native")
    assert said["command"] == f"loomfmu run {result.scene.file}"
    assert json.loads(said["claims"]) == [verdict.as_dict() for verdict in result.claims]
    kinds = {instance.fmu.name for instance in result.scene.instances.values()}
    assert len(kinds) == 6
    for kind in kinds - {"MainShaft"}:  # a shaft of constant speed needs no FMU
        fmu = fmus.of_component(kind, "native")
        assert said[f"fmu_{kind}_version"] == metadata.version("loomfmu")
        assert said[f"fmu_{kind}_sha256"] == hashlib.sha256(fmu.path.read_bytes()).hexdigest()


def test_the_layout_is_flat_and_along_one_time(file: h5py.File, result: loomfmu.Result) -> None:
    assert set(file) == {"time", "shaft_angle", *result.scene.instances}
    assert file["time"].is_scale
    assert file["time"].attrs["UNIT"] == file["time"].attrs["units"] == "s"
    assert file["shaft_angle"].attrs["UNIT"] == "rad"
    assert file["shaft_angle"].attrs["DISPLAY_UNIT"] == "deg"
    assert np.all(np.diff(file["time"][:]) > 0)
    assert file["shaft_angle"].dims[0][0] == file["time"]
    for name in result.scene.instances:
        assert file[f"{name}/time"] == file["time"]  # one object, not a copy
        assert file[f"{name}/shaft_angle"] == file["shaft_angle"]
        for variable, dataset in file[name].items():
            assert re.fullmatch("[A-Za-z][A-Za-z0-9_]*", variable)
            assert dataset.shape == (2161,)
            if variable != "time":
                assert list(dataset.dims[0].values()) == [file["time"]]


def test_viewers_open_on_a_plot(file: h5py.File) -> None:
    # the path that h5web follows: default, then NXdata with a signal and its axes, all numeric columns
    assert (file.attrs["NX_class"], file.attrs["default"]) == ("NXroot", "belt")
    assert file["belt"].attrs["signal"] == "margin"  # whose lowest value the first claim judges
    for group in (each for each in file.values() if isinstance(each, h5py.Group)):
        assert group.attrs["NX_class"] == "NXdata"
        assert group[group.attrs["axes"]].shape == group[group.attrs["signal"]].shape


def test_every_dataset_is_chunked_compressed_and_described(file: h5py.File, result: loomfmu.Result) -> None:
    for name, instance in result.scene.instances.items():
        declared = {v.name: v for v in variables_of(fmus.COMPONENTS[instance.fmu.name])}
        outputs = {v.name for v in declared.values() if v.causality == "output"}
        assert set(file[name]) == outputs | {"time", "shaft_angle"}
        for output in outputs:
            dataset, variable = file[name][output], declared[output]
            assert (dataset.chunks, dataset.maxshape) == ((2161,), (2161,))
            assert (dataset.compression, dataset.shuffle) == ("gzip", True)
            assert dataset.dtype == ("<f8" if variable.type is float else "<i4")
            assert dataset.attrs["UNIT"] == variable.unit
            assert dataset.attrs["units"] == units.udunits(variable.unit)
            assert "long_name" not in dataset.attrs  # silx and h5web would show it instead of the unit
            assert dataset.attrs["COMMENT"] == variable.description
            assert dataset.attrs.get("DISPLAY_UNIT", variable.unit) == variable.display
            assert dataset.attrs.get("rate") == variable.rate
            if variable.type is bool:
                np.testing.assert_array_equal(dataset.attrs["flag_values"], [0, 1])
                assert dataset.attrs["flag_meanings"] == "no yes"
                assert set(dataset[:]) <= {0, 1}
                assert dataset.attrs["dtype"] == "bool"
            else:
                assert not {"flag_values", "dtype"} & set(dataset.attrs)


def test_values_stand_as_they_ran(file: h5py.File, result: loomfmu.Result) -> None:
    assert file["heald_1"].attrs["stroke"] == 0.06
    assert file["belt"].attrs["head_length"] == 0.55
    about = {"fmu", "machine", "head", "parameter_units", "parameter_meanings", "NX_class", "signal", "axes"}
    fed = {wire.sink for wire in result.scene.wires}
    idle = {"shaft_angle", "shaft_velocity", "shaft_acceleration", "prescribed_length_factor"}
    idle |= {"lift_fraction", "lift_rate", "lift_acceleration"}
    for name, instance in result.scene.instances.items():
        found = {key: value for key, value in file[name].attrs.items() if key not in about}
        declared = {v.name: v for v in variables_of(fmus.COMPONENTS[instance.fmu.name]) if v.settable}
        alone = {key for key in declared if (name, key) not in fed} - idle
        if name.startswith("heald"):
            alone |= idle & set(declared)  # follow_lift is wired, and so on: it counts
            alone -= {key for owner, key in fed if owner == name}
        alone.discard("load_work")  # no damper states one here, so it is not used
        assert set(found) == alone
        for key, value in found.items():
            assert isinstance(value, np.float64 if declared[key].type is float else np.int64)
        units_ = {key: v.unit for key, v in declared.items() if key in alone and v.type is float}
        assert json.loads(file[name].attrs["parameter_units"]) == units_
        assert file[name].attrs["fmu"] == instance.fmu.name
    # the shaft turns at a constant speed, and what follows it by itself: that speed is the one that counted
    assert file["shaft"].attrs["speed"] == file["belt"].attrs["speed"] == 41.88790204786391
    assert file["belt"].attrs["follow_shaft"] == 0
    meanings = json.loads(file["dobby"].attrs["parameter_meanings"])
    assert meanings == {"follow_shaft": "false", "inputs_at_step_end": "true", "law": "sloped_sine"}
    assert (file["weft"].attrs["machine"], "machine" in file["dobby"].attrs) == ("WL680-3600", False)


SHARED_SPEED = """
revolutions = 0.5
steps_per_revolution = 60
[loom]
machine = "WL680-3600"
head = "G6300 left"
weave = "10/01"
[shaft]
ripple_amplitude = 0.02
[belt]
yarn_tension = "2 N"
"""


def test_a_trace_says_how_to_repeat_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], fmu_cache: None
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a loom.toml").write_text(SHARED_SPEED)
    set_ = {"shaft.speed": "500 rpm", "belt.guide_clearance": 0.00047, "shaft.ripple_order": 3}
    first = loomfmu.run("a loom.toml", set=set_, output="first.h5")
    with h5py.File("first.h5") as file:
        said, belt = dict(file.attrs), dict(file["belt"].attrs)
    texts = {"shaft.speed": "500 rpm", "belt.guide_clearance": "0.00047", "shaft.ripple_order": "3"}
    assert json.loads(said["set"]) == texts
    # a shaft that ripples is followed: the belt's own speed had no effect, its unwired inputs did
    assert belt["follow_shaft"] and "speed" not in belt and "start_angle" not in belt
    assert (belt["yarn_tension"], belt["guide_clearance"], belt["head"]) == (2.0, 0.00047, "G6300 left")
    assert "travel" not in belt  # it is wired
    # from the file alone
    Path("again.toml").write_text(said["scene"])
    again = loomfmu.run("again.toml", set=json.loads(said["set"]), flavour=said["flavour"], output="2.h5")
    # and by the command that it names
    command = shlex.split(said["command"])
    assert command[:3] == ["loomfmu", "run", "a loom.toml"]
    assert cli.main([*command[1:], "--output", "3.h5"]) == 0
    assert cli.main(["show", "3.h5"]) == 0
    assert "differs from the scene: belt.guide_clearance = 0.00047\n" in capsys.readouterr().out
    for other in (again.trace, Trace("3.h5")):
        assert set(other) == set(first.trace)
        for signal_ in other:
            np.testing.assert_array_equal(other[signal_], first.trace[signal_])
        assert other.attributes["set"] == said["set"]
    # a scene that was read with values of its own tells them too; others take their place
    read = scenes.load("a loom.toml", set_)
    third = loomfmu.run(read, output="4.h5")
    assert (third.trace.attributes["set"], third.trace.attributes["command"]) == (
        said["set"],
        said["command"],
    )
    other = loomfmu.run(read, set={"shaft.speed": "450 rpm"}, output="5.h5")
    assert json.loads(other.trace.attributes["set"]) == {"shaft.speed": "450 rpm"}
    assert other.trace.parameter("belt.guide_clearance") == 0.0003
    with pytest.raises(LoomfmuError, match=r"parameter 'belt\.head' is not recorded"):
        third.trace.parameter("belt.head")


def test_a_trace_keeps_the_files_that_its_scene_names(tmp_path: Path, fmu_cache: None) -> None:
    sims = Path(__file__).parents[1] / "sims"
    wif = tmp_path / "twill.wif"
    wif.write_bytes((sims / "weaves" / "twill_2_2.wif").read_bytes())
    (tmp_path / "loom.toml").write_text(SHARED_SPEED.replace("10/01", "twill.wif"))
    read = scenes.load(tmp_path / "loom.toml")
    text = wif.read_text()
    wif.write_text("edited since")
    first = loomfmu.run(read, output=tmp_path / "1.h5").trace
    files = json.loads(first.attributes["files"])
    assert files == {"twill.wif": text}
    # from the trace alone
    (tmp_path / "again").mkdir()
    (tmp_path / "again" / "loom.toml").write_text(first.attributes["scene"])
    for name, each in files.items():
        (tmp_path / "again" / name).write_text(each)
    again = loomfmu.run(tmp_path / "again" / "loom.toml", output=tmp_path / "2.h5").trace
    assert set(again) == set(first)
    for signal_ in first:
        np.testing.assert_array_equal(again[signal_], first[signal_])


def test_a_trace_names_the_content_of_its_package(tmp_path: Path, fmu_cache: None) -> None:
    (tmp_path / "loom.toml").write_text(SHARED_SPEED)
    package = tmp_path / "loom.ssp"
    assert cli.main(["export", str(tmp_path / "loom.toml"), "--ssp", str(package), "--flavour", "live"]) == 0
    trace = loomfmu.run(package, output=tmp_path / "1.h5").trace
    assert trace.attributes["package_sha256"] == hashlib.sha256(package.read_bytes()).hexdigest()


IDLE = {  # what is said of the loom, and values that have no effect then
    "[shaft]\nripple_amplitude = 0.02": {"belt.speed": 50.0, "weft.start_angle": 1.0, "dobby.speed": 9.0},
    "[belt]\nfollow_shaft = false\n[wires]\n'belt.shaft_angle' = false": {"belt.shaft_angle": 0.7},
    "[belt]\nprescribe_length_factor = false": {"belt.prescribed_length_factor": 0.7},
    "[belt]\nprescribe_length_factor = true": {"belt.guide_clearance": 0.9e-3},
    "[wires]\n'heald_1.lift_fraction' = false\n'heald_1.lift_rate' = false": {"heald_1.lift_rate": 0.7},
}


@pytest.mark.parametrize("said", IDLE)
def test_what_is_left_out_had_no_effect(tmp_path: Path, said: str, fmu_cache: None) -> None:
    scene = tmp_path / "loom.toml"
    scene.write_text(SHARED_SPEED.partition("[shaft]")[0] + said + "\n")
    one = loomfmu.run(scene, output=tmp_path / "1.h5").trace
    two = loomfmu.run(scene, set=IDLE[said], output=tmp_path / "2.h5").trace
    for name in IDLE[said]:
        with pytest.raises(LoomfmuError, match=r"parameter .* is not recorded"):
            two.parameter(name)
    for signal_ in one:
        np.testing.assert_array_equal(one[signal_], two[signal_])


def test_choices_are_flags_with_their_own_numbers(tmp_path: Path) -> None:
    channels = [Channel("dobby", "law", "1", "1", "Law", 0, False, None, ("uniform", "sloped_sine"), 1)]
    writer = TraceWriter(tmp_path / "law.h5", {"title": "t"}, channels, {})
    append(writer, np.arange(3.0), integers=np.array([[1], [2], [1]], dtype="i4"))
    writer.complete([])
    with h5py.File(tmp_path / "law.h5") as file:
        np.testing.assert_array_equal(file["dobby/law"].attrs["flag_values"], [1, 2])
        assert file["dobby/law"].attrs["flag_meanings"] == "uniform sloped_sine"


# ---- who can read it


def test_our_own_reader(result: loomfmu.Result, file: h5py.File) -> None:
    with Trace(result.path) as trace:
        assert (trace.rows, trace.status) == (2161, "complete")
        assert trace.verdicts == list(result.claims)
        assert trace.attributes["title"] == "Two frames"
        np.testing.assert_array_equal(trace.time, file["time"][:])
        np.testing.assert_array_equal(trace["belt.margin"], file["belt/margin"][:])
        assert "belt.margin" in trace and "belt.margn" not in trace and "belt" not in trace
        assert {"belt.margin", "heald_2.moving", "shaft.angle"} <= set(trace)
        assert (trace.unit("belt.free_length"), trace.display("belt.free_length")) == ("m", "mm")
        assert trace.description("weft.travel").startswith("Travel of the rapier head")
        assert (trace.rate("weft.travel"), trace.rate("weft.acceleration")) == ("weft.velocity", None)
        assert trace.parameter("heald_1.stroke") == 0.06
        assert trace["belt.buckled"].dtype == bool and not trace.is_real("belt.buckled")
        assert len(trace.time[trace["heald_1.moving"]]) == np.sum(file["heald_1/moving"][:])


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda t: t["belt.margn"], "signal 'belt.margn' is not recorded; did you mean 'belt.margin'?"),
        (lambda t: t["belt"], "signal 'belt' is not recorded; did you mean 'belt."),
        (lambda t: t.unit("weft.travl"), "signal 'weft.travl' is not recorded; did you mean 'weft.travel'?"),
        (lambda t: t.parameter("heald_1.strok"), "parameter 'heald_1.strok' is not recorded"),
        (lambda t: t.parameter("heald_9.stroke"), "parameter 'heald_9.stroke' is not recorded"),
    ],
)
def test_our_own_reader_names_what_it_does_not_find(result: loomfmu.Result, ask, said: str) -> None:
    with Trace(result.path) as trace, pytest.raises(LoomfmuError) as raised:
        ask(trace)
    assert str(raised.value).startswith(f"two_frames.h5: {said}")


def test_xarray_reads_a_group(result: loomfmu.Result, file: h5py.File) -> None:
    with xarray.open_dataset(result.path, engine="h5netcdf", group="belt") as belt:
        assert belt["margin"].dims == ("time",)
        assert set(belt.coords) == {"time", "shaft_angle"}
        assert belt["buckled"].dtype == bool and belt["margin"].where(belt["buckled"]).isnull().all()
        np.testing.assert_array_equal(belt["margin"].coords["shaft_angle"], file["shaft_angle"][:])
        assert belt.attrs["follow_shaft"] == False  # noqa: E712  a Boolean of HDF5, as xarray reads it
        np.testing.assert_array_equal(belt["time"], file["time"][:])
        np.testing.assert_array_equal(belt["margin"], file["belt/margin"][:])
        assert belt["free_length"].attrs["units"] == "m"
        middle = belt["margin"].sel(time=slice(0.05, 0.1))
        assert 470 < middle.size < 490  # 50 ms of steps of 104 us


@pytest.mark.slow
def test_xarray_reads_the_tree(result: loomfmu.Result, file: h5py.File) -> None:
    with xarray.open_datatree(result.path, engine="h5netcdf") as tree:
        assert set(tree.children) == set(result.scene.instances)
        np.testing.assert_array_equal(tree["heald_2/lift"], file["heald_2/lift"][:])
        np.testing.assert_array_equal(tree["shaft_angle"], file["shaft_angle"][:])
        assert tree.attrs["title"] == "Two frames"


def test_sdf_reads_it(result: loomfmu.Result, file: h5py.File) -> None:
    root = sdf.load(str(result.path))
    belt = next(group for group in root.groups if group.name == "belt")
    margin = belt["free_length"]
    np.testing.assert_array_equal(margin.data, file["belt/free_length"][:])
    assert (margin.unit, margin.display_unit, margin.is_scale) == ("m", "mm", False)
    assert margin.comment.startswith("Length of the belt between")
    assert margin.scales[0].unit == "s"
    np.testing.assert_array_equal(margin.scales[0].data, file["time"][:])


# ---- writing


def append(writer: TraceWriter, times: np.ndarray, integers: np.ndarray | None = None) -> None:
    """Samples of which time, shaft angle and all real signals are the same."""
    rows = len(times)
    reals = np.tile(times[:, None], sum(channel.real for channel in writer.channels))
    writer.append(times, times, reals, np.zeros((rows, 0), dtype="i4") if integers is None else integers)


def older_run(path: Path) -> None:
    writer = TraceWriter(path, {"title": "an older run"}, [], {})
    writer.complete([])


def title(path: Path) -> str:
    with Trace(path) as trace:
        return str(trace.attributes["title"])


# in a process of its own: where the writing failed, some runs ended with a corrupted heap
MANY = """
import sys
from pathlib import Path
import numpy as np
from loomfmu.traces import Channel, TraceWriter
count, path = 5000, Path(sys.argv[1])
channels = [Channel(f"loom{n % 100}", f"signal_{n}", "m", "m", "One of many", n) for n in range(count)]
groups = {f"loom{n}": {f"p{each}": 1.0 for each in range(12)} for n in range(100)}
writer = TraceWriter(path, {"title": "t"}, channels, groups)
for block in range(3):
    times = np.arange(3.0) + 3.0 * block
    writer.append(times, times, np.arange(count) + times[:, None], np.zeros((3, 1), dtype="i4"))
writer.complete([])
"""


@pytest.mark.slow
def test_thousands_of_variables_of_many_instances_along_one_time(tmp_path: Path) -> None:
    # a dimension scale lists its users in one attribute: above 4,000 an old file format has no room for it
    in_a_process(MANY, str(tmp_path / "many.h5"))
    with Trace(tmp_path / "many.h5") as trace:
        assert len(list(trace)) == 5000
        for number in (0, 1499, 4999):
            found = trace[f"loom{number % 100}.signal_{number}"]
            np.testing.assert_array_equal(found, number + np.arange(9.0))
    with h5py.File(tmp_path / "many.h5") as file:
        assert file["loom99/signal_4999"].dims[0][0] == file["time"]


VERDICT = loomfmu.Verdict("c" * 1000, "a.x", False, 1.0, 2.0, "m", "mm", 0.5, 0.1, 1)


def test_a_long_scene_and_many_verdicts_fit(tmp_path: Path) -> None:
    # attributes of more than 64 kB need dense storage
    text, verdicts = "# a long scene\n" * 20_000, [VERDICT] * 300
    times = np.zeros(1)
    with made(tmp_path / "long.h5", {}, time=times, attributes={"scene": text}, verdicts=verdicts) as trace:
        assert trace.attributes["scene"] == text
        assert trace.verdicts == verdicts and not any(trace.verdicts)
    assert repr(Trace(tmp_path / "long.h5")) == f"<Trace {tmp_path / 'long.h5'}>"


def test_the_final_name_is_given_last(tmp_path: Path) -> None:
    path = tmp_path / "sub" / "run.h5"
    writer = TraceWriter(path, {"title": "t"}, [], {})
    assert re.fullmatch(rf"run\.h5\.[0-9a-f]{{8}}-{os.getpid()}-[0-9a-f]{{8}}\.partial", writer.partial.name)
    append(writer, np.zeros(1))
    assert not path.exists()
    assert writer.complete([]).path == path
    assert [entry.name for entry in path.parent.iterdir()] == ["run.h5"]


def test_what_is_abandoned_keeps_what_was_written(tmp_path: Path) -> None:
    path = tmp_path / "run.h5"
    older_run(path)
    channels = [Channel("a", "x", "m", "m", "X", 0)]
    writer = TraceWriter(path, {"title": "t"}, channels, {})
    block = np.arange(ROWS) * 1.0
    for _ in range(3):
        append(writer, block)
    with Trace(writer.abandon("failed")) as trace:
        assert (trace.rows, trace.status, trace.verdicts) == (3 * ROWS, "failed", [])
        np.testing.assert_array_equal(trace["a.x"], np.tile(block, 3))
    assert title(path) == "an older run"


def test_samples_that_come_in_pieces_are_kept_in_place(tmp_path: Path) -> None:
    channels = [Channel("a", "x", "m", "m", "X", 0), Channel("a", "n", "1", "1", "N", 0, real=False)]
    values = np.sort(np.random.default_rng(1).random(2 * ROWS + 500))
    counts = np.arange(len(values), dtype="i4")[:, None]
    writer = TraceWriter(tmp_path / "run.h5", {"title": "t"}, channels, {})
    for start in range(0, len(values), 100):  # as a run does whose steps take long: every few steps
        append(writer, values[start : start + 100], counts[start : start + 100])
    trace = writer.complete([])
    for found in (trace.time, trace.shaft_angle, trace["a.x"]):
        np.testing.assert_array_equal(found, values)
    np.testing.assert_array_equal(trace["a.n"], counts[:, 0])
    # three chunks of 28 bytes a row; written anew each time, they would take twenty times as much
    assert trace.path.stat().st_size < 3 * ROWS * 28 + 50_000


def test_time_is_never_longer_than_a_signal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Readers of netCDF take the length of a live or killed run from it, and give zeros beyond a signal's."""
    channels = [Channel("a", "x", "m", "m", "X", 0), Channel("a", "n", "1", "1", "N", 0, real=False)]
    copy, lengths = tmp_path / "copy.h5", set()

    def flush(columns: Any) -> None:
        for dataset in columns._datasets:
            dataset.id.flush()
            shutil.copy(writer.partial, copy)  # what a kill leaves
            with h5py.File(copy, swmr=True) as file:
                names = ("time", "shaft_angle", "a/x", "a/n")
                lengths.add(tuple(len(file[name]) for name in names))

    monkeypatch.setattr("loomfmu.traces.chunks.Columns.flush", flush)
    writer = TraceWriter(tmp_path / "run.h5", {"title": "t"}, channels, {})
    for _ in range(2):
        append(writer, np.arange(100.0), np.zeros((100, 1), dtype="i4"))
    writer.complete([])
    assert len(lengths) > 4 and all(found[0] == min(found) for found in lengths)


def test_writers_of_one_output_do_not_meet(tmp_path: Path) -> None:
    path = tmp_path / "run.h5"
    writers = [TraceWriter(path, {"title": f"run {n}"}, [], {}) for n in range(3)]
    for number, writer in enumerate(writers):
        append(writer, number + np.arange(number + 1.0))
    traces = [writers[n].complete([]) for n in (0, 2)]
    assert (title(path), Trace(path).rows) == ("run 2", 3)  # the last one to finish
    for number, trace in zip((0, 2), traces, strict=True):  # each result keeps its own
        np.testing.assert_array_equal(trace.time, number + np.arange(number + 1.0))
    kept = writers[1].abandon("interrupted")
    assert kept == tmp_path / "run.h5.partial" and title(kept) == "run 1"


def test_a_finished_file_has_no_reserved_space_left(result: loomfmu.Result) -> None:
    with h5py.File(result.path) as file:
        # what all chunks and headers take, plus HDF5's own gaps: far less than a reserved block (0.6 MB)
        stored = sum(file[name].id.get_storage_size() for name in names(file))
        assert result.path.stat().st_size < stored + 4096 * (len(names(file)) + 1)


def names(file: h5py.File) -> list[str]:
    found: list[str] = []
    file.visititems(lambda name, item: found.append(name) if isinstance(item, h5py.Dataset) else None)
    return found


# ---- results that share a name

SHAFT = "revolutions = 1\nsteps_per_revolution = 8\n[shaft]\n"


def speeds(results: list[loomfmu.Result]) -> list[float]:
    return [float(found.trace["shaft.velocity"][0] * 30 / np.pi) for found in results]


def test_a_result_keeps_its_own_data_whatever_is_run_after_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fmu_cache: None
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("shaft.toml").write_text(SHAFT)
    wanted = [300.0, 400.0, 500.0, 600.0]

    def run_at(speed: float) -> loomfmu.Result:
        return loomfmu.run("shaft.toml", set={"shaft.speed": f"{speed} rpm"}, output="results/shaft.h5")

    results = [run_at(speed) for speed in wanted]
    assert speeds(results) == pytest.approx(wanted, rel=1e-15)
    assert [found.trace.parameter("shaft.speed") * 30 / np.pi for found in results] == pytest.approx(wanted)
    assert len(os.listdir("results")) == 4
    with results[1].trace as held:  # also one that is open, and one that was read from its file
        same = Trace("results/shaft.h5")
        results.append(run_at(700.0))
        assert held["shaft.angle"][-1] == pytest.approx(2 * np.pi)
    assert speeds(results) == pytest.approx([*wanted, 700.0], rel=1e-15)
    assert same["shaft.velocity"][0] * 30 / np.pi == pytest.approx(600.0, rel=1e-15)
    del results[:4], same, held
    assert os.listdir("results") == ["shaft.h5"]  # what nobody holds is gone


def test_what_was_kept_is_gone_with_the_process(tmp_path: Path, fmu_cache: None) -> None:
    (tmp_path / "shaft.toml").write_text(SHAFT)
    script = (
        "import loomfmu, os, sys; os.chdir(sys.argv[1])\n"
        "to = 'results/shaft.h5'\n"
        "at = [{'shaft.speed': f'{n}00 rpm'} for n in (4, 5)]\n"
        "kept = [loomfmu.run('shaft.toml', set=each, output=to) for each in at]\n"
        "if child := os.fork():\n"
        "    os.waitpid(child, 0)\n"
        "    print(len(os.listdir('results')), round(kept[0].trace['shaft.velocity'][0] * 1e6))\n"
        "else:\n"
        "    del kept\n"  # a forked process does not take its parent's files away
    )
    assert in_a_process(script, str(tmp_path)) == "2 41887902\n"  # 400 rev/min in 1e-6 rad/s
    assert os.listdir(tmp_path / "results") == ["shaft.h5"]


def test_what_a_killed_process_left_is_named_and_deleted_by_the_next_run(
    tmp_path: Path, fmu_cache: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("shaft.toml").write_text(SHAFT)
    script = (
        "import loomfmu, os, signal, sys; os.chdir(sys.argv[1])\n"
        "from loomfmu.traces import TraceWriter\n"
        "held = [loomfmu.run('shaft.toml') for _ in range(2)]\n"
        "begun = TraceWriter(held[0].path, {'title': 'begun'}, [], {})\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    done = subprocess.run([sys.executable, "-c", script, str(tmp_path)], check=False, capture_output=True)
    assert done.returncode == -signal.SIGKILL
    left = sorted({*os.listdir("results")} - {"shaft.h5"})
    assert [(name.startswith("."), name.endswith(".partial")) for name in left] == [
        (True, False),
        (False, True),
    ]
    mine = TraceWriter(Path("results/shaft.h5"), {"title": "mine"}, [], {})  # of a process that runs
    assert cli.main(["run", "shaft.toml"]) == 0
    assert capsys.readouterr().err.splitlines() == [
        f"results/{name}: left by a killed process; deleted when this run is complete" for name in left
    ]
    assert sorted(os.listdir("results")) == ["shaft.h5", mine.partial.name]


@pytest.mark.slow
def test_more_traces_can_be_held_at_once_than_files_may_be_open(result: loomfmu.Result) -> None:
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(256, limits[0]), limits[1]))
    try:
        traces = [Trace(result.path) for _ in range(300)]
        assert all(trace["belt.margin"][0] == traces[0]["belt.margin"][0] for trace in traces)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, limits)


def test_a_trace_whose_file_another_process_replaced_says_so(
    result: loomfmu.Result, copied: Path, tmp_path: Path
) -> None:
    trace = Trace(copied)
    sent = pickle.dumps(trace)  # to another process: a copy reads the file that it was made of
    np.testing.assert_array_equal(pickle.loads(sent)["belt.margin"], result.trace["belt.margin"])
    shutil.copy(copied, tmp_path / "other.h5").replace(copied)
    for each in (trace, copy := pickle.loads(sent)):  # which takes it over: only what is read is refused
        with pytest.raises(LoomfmuError, match=r"run\.h5: another trace has replaced it"):
            _ = each["belt.margin"]
    copied.unlink()
    with pytest.raises(LoomfmuError, match=r"run\.h5: there is no such file"):
        _ = copy.rows


def test_results_of_other_processes_never_have_the_trace_of_another_run(
    tmp_path: Path, fmu_cache: None
) -> None:
    (tmp_path / "shaft.toml").write_text(SHAFT)
    script = (
        "import loomfmu, os, pickle, sys; os.chdir(sys.argv[1])\n"
        "at = [{'shaft.speed': f'{n}00 rpm'} for n in (4, 5)]\n"
        "own = [pickle.dumps(loomfmu.run('shaft.toml', set=each)) for each in at]\n"
        "one = [pickle.dumps(loomfmu.run('shaft.toml', set=each, output='x.h5')) for each in at]\n"
        "for sent in own + one:\n"
        "    try:\n"
        "        print(round(pickle.loads(sent).trace['shaft.velocity'][0] * 30 / 3.14159265))\n"
        "    except loomfmu.LoomfmuError as error:\n"
        "        print('another' in str(error))\n"
    )
    assert in_a_process(script, str(tmp_path)).split() == ["400", "500", "True", "500"]


# ---- runs that are cut off

LONG = 'revolutions = 3000\nrecord = ["belt.margin"]\n[loom]\nmachine = "WL680-3600"\n'
RUN = [sys.executable, "-m", "loomfmu.cli", "run", "long.toml", "--output", "out/long.h5"]


def start(directory: Path) -> subprocess.Popen:
    """A run that would take minutes, some blocks of it written."""
    (directory / "long.toml").write_text(LONG)
    older_run(directory / "out" / "long.h5")
    running = subprocess.Popen(RUN, cwd=directory, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60
    while rows(directory) < 3 * ROWS:
        assert running.poll() is None, running.stderr.read()
        assert time.monotonic() < deadline
        time.sleep(0.05)
    return running


def rows(directory: Path) -> int:
    """Samples that can be read while the run goes on."""
    try:
        with Trace(partial(directory)) as trace:
            assert trace.status == "running"
            return trace.rows
    except (LoomfmuError, StopIteration):
        return 0  # not yet there, or its header is being written


def partial(directory: Path) -> Path:
    """What a run has written so far."""
    return next((directory / "out").glob("long.h5.*.partial"))


def check_kept(directory: Path, kept: Trace) -> None:
    """Every sample is what a shorter run gives, and the final name still bears the older run."""
    text = LONG.replace("3000", "1.0")
    (directory / "short.toml").write_text(text)
    short = loomfmu.run(directory / "short.toml", output=directory / "short.h5").trace
    assert set(kept) == set(short)
    for signal_ in short:
        assert len(kept[signal_]) == kept.rows
        np.testing.assert_array_equal(kept[signal_][: short.rows], short[signal_])
    step = kept.time[1]
    np.testing.assert_array_equal(kept.time, np.arange(kept.rows) * step)
    assert title(directory / "out" / "long.h5") == "an older run"


def test_after_a_kill_every_whole_block_can_be_read(tmp_path: Path) -> None:
    running = start(tmp_path)
    seen = rows(tmp_path)
    running.kill()
    assert running.wait(30) == -signal.SIGKILL
    running.communicate()
    left = partial(tmp_path)
    assert sorted(os.listdir(tmp_path / "out")) == ["long.h5", left.name]
    with Trace(left) as kept:
        assert kept.rows >= seen
        assert kept.status == "running"
        assert kept.verdicts == []
        check_kept(tmp_path, kept)
    check(left)
    with h5py.File(left, swmr=True) as plain:  # as docs/traces.md has it
        assert len(plain["belt/margin"]) >= seen


def test_after_ctrl_c_every_sample_can_be_read(tmp_path: Path) -> None:
    running = start(tmp_path)
    running.send_signal(signal.SIGINT)
    output, errors = running.communicate(timeout=30)
    assert running.returncode == 130
    assert output == ""
    assert sorted(os.listdir(tmp_path / "out")) == ["long.h5", "long.h5.partial"]
    with h5py.File(tmp_path / "out" / "long.h5.partial", "r"):
        pass  # an ordinary file, closed: it needs no leave to be read while it is written
    with Trace(tmp_path / "out" / "long.h5.partial") as kept:
        assert errors == f"loomfmu: interrupted; {kept.rows} samples are in out/long.h5.partial\n"
        assert kept.status == "interrupted"
        assert kept.rows >= 3 * ROWS
        check_kept(tmp_path, kept)
    (tmp_path / "long.toml").write_text(LONG.replace("3000", "0.1"))  # a new run replaces it
    assert subprocess.run(RUN, cwd=tmp_path, capture_output=True).returncode == 0
    assert os.listdir(tmp_path / "out") == ["long.h5"]
    assert Trace(tmp_path / "out" / "long.h5").rows == 145


@pytest.mark.skipif(not hasattr(os, "posix_fallocate"), reason="space cannot be reserved here")
@pytest.mark.parametrize(("limit", "left"), [(1000, False), (500_000, True), (2_000_000, True)])
def test_a_file_that_may_not_grow_is_told_in_one_line(tmp_path: Path, limit: int, left: bool) -> None:
    (tmp_path / "long.toml").write_text(LONG)
    older_run(tmp_path / "out" / "long.h5")
    done = subprocess.run(
        RUN,
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
    )
    where = "; see out/long.h5.partial" if left else ""
    assert done.stderr == f"loomfmu: out/long.h5: cannot be written (File too large){where}\n"
    assert (done.returncode, done.stdout) == (2, "")
    check_left(tmp_path, left)


def check_left(directory: Path, left: bool) -> None:
    assert title(directory / "out" / "long.h5") == "an older run"
    assert (directory / "out" / "long.h5.partial").exists() is left
    if left:
        with Trace(directory / "out" / "long.h5.partial") as kept:
            assert kept.status == "failed"
            for signal_ in kept:
                assert np.all(np.isfinite(kept[signal_]))


@pytest.fixture
def small_disk(tmp_path: Path):
    disk = tmp_path / "out"
    disk.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=3m", "tmpfs", str(disk)], capture_output=True
    )
    if mounted.returncode:
        pytest.skip("no leave to mount a small disk")
    older_run(disk / "long.h5")
    (tmp_path / "long.toml").write_text(LONG)
    yield disk
    subprocess.run(["umount", str(disk)], check=True)


def test_a_trace_that_does_not_fit_is_refused_before_the_run(tmp_path: Path, small_disk: Path) -> None:
    done = subprocess.run(RUN, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    # 4,321,280 samples of time, angle, margin and the shaft's three, 48 bytes each, and book-keeping
    said = r"\(it takes up to 207\.8 MB, and the disk has 3\.\d MB free\)\n"
    assert re.fullmatch(rf"loomfmu: out/long\.h5: cannot be written {said}", done.stderr)
    assert (done.returncode, done.stdout) == (2, "")
    assert [path.name for path in small_disk.iterdir()] == ["long.h5"]
    assert title(small_disk / "long.h5") == "an older run"


def test_a_disk_that_fills_up_is_told_in_one_line(tmp_path: Path, small_disk: Path) -> None:
    script = "import sys; from loomfmu import cli; from loomfmu.cosim import recorded;"
    script += "recorded.check_room = lambda *_: None; sys.exit(cli.main(sys.argv[1:]))"  # full only later
    command = [sys.executable, "-c", script, *RUN[3:]]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.stderr == (
        "loomfmu: out/long.h5: cannot be written (No space left on device); see out/long.h5.partial\n"
    )
    assert (done.returncode, done.stdout) == (2, "")
    check_left(tmp_path, left=True)


def test_a_large_trace_is_told_before_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], fmu_cache: None
) -> None:
    (tmp_path / "one.toml").write_text(LONG.replace("3000", "1"))
    monkeypatch.setattr("loomfmu.cosim.recorded.LARGE_TRACE", 50_000)
    result = loomfmu.run(tmp_path / "one.toml", output=tmp_path / "one.h5", progress=True)
    assert capsys.readouterr().err == (  # 1441 samples of 48 bytes
        f"{tmp_path}/one.h5: the trace takes up to 0.3 MB; record = [...] keeps less\n"
    )
    assert result.path.stat().st_size < 69168 + 40_000  # less than that, with what describes it


def test_the_example_of_many_traces_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fmu_cache: None
) -> None:
    page = (Path(__file__).parents[1] / "docs" / "traces.md").read_text()
    block = re.search(r"^(import pathlib, xarray\n.*?)^```$", page, re.DOTALL | re.MULTILINE)
    assert block is not None
    monkeypatch.chdir(tmp_path)
    Path("loom.toml").write_text(LONG.replace("3000", "1"))
    speeds = [450.0, 550.0, 700.0]
    for speed in speeds:
        path = f"results/safe_speed/traces/row_{speed:.0f}.h5"
        loomfmu.run("loom.toml", set={"shaft.speed": f"{speed} rpm"}, output=path)
    found: dict[str, Any] = {}
    exec(block[1], found)
    runs, table = found["runs"], found["table"]
    assert runs["margin"].dims == ("run", "sample")
    np.testing.assert_allclose(runs["speed"] * 30 / np.pi, speeds, rtol=1e-15)
    assert {"time", "shaft_angle"} <= set(runs.coords)
    lowest = runs["margin"].min("sample")
    for number, path in enumerate(found["paths"]):
        with Trace(path) as trace:
            assert lowest[number] == trace["belt.margin"].min()
    assert len(table) == 3 * 1441
    assert list(table.groupby("speed")["margin"].min()) == list(lowest)


# ---- files that are no traces


def test_a_file_that_is_cut_short_is_refused_at_once(result: loomfmu.Result, tmp_path: Path) -> None:
    whole = result.path.read_bytes()
    cut = tmp_path / "cut.h5"
    for length in (0, 7, 8, 30, 100, 5000, len(whole) // 2, len(whole) - 1):
        cut.write_bytes(whole[:length])
        begun = time.monotonic()
        with pytest.raises(LoomfmuError, match="cannot be read as a trace"):
            Trace(cut)
        # reading it as one that is being written takes HDF5 minutes of repetition
        assert time.monotonic() - begun < 5
    marked = bytearray(whole[:5000])
    marked[11] |= 5  # as a killed writer marks it
    cut.write_bytes(marked)
    with pytest.raises(LoomfmuError, match="cannot be read as a trace"):
        Trace(cut)


def test_files_that_are_something_else_are_refused(tmp_path: Path) -> None:
    (tmp_path / "text.h5").write_text("not HDF5")
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["time"] = [0.0, 1.0]
    with h5py.File(tmp_path / "alike.h5", "w") as other:  # another tool's, much like ours
        other["time"] = other["shaft_angle"] = [0.0, 1.0]
        other.attrs.update({"title": "theirs", "status": "complete"})
    reasons = {
        "missing.h5": "there is no such file$",
        "": "cannot be read as a trace",
        "text.h5": "cannot be read as a trace",
        "other.h5": r"not a trace of loomfmu \(the dataset /shaft_angle is missing\)",
        "alike.h5": r"the attribute 'software' is missing\)$",
    }
    for name, reason in reasons.items():
        with pytest.raises(LoomfmuError, match=f"{name}: .*{reason}"):
            Trace(tmp_path / name)
    assert not TRACE.ours(tmp_path / "alike.h5")  # it is not replaced


def zeroed(path: Path, place: int, length: int) -> Path:
    content = bytearray(path.read_bytes())
    content[place : place + length] = bytes(length)
    path.write_bytes(content)
    return path


def test_a_damaged_group_is_not_taken_for_a_missing_one(tmp_path: Path) -> None:
    made(tmp_path / "lost.h5", {"a.x": np.zeros(3), "b.x": np.zeros(3)})
    with h5py.File(tmp_path / "lost.h5") as file:
        header = h5py.h5o.get_info(file["a"].id).addr
    trace = Trace(zeroed(tmp_path / "lost.h5", header, 8))
    for ask in (list, lambda trace: "b.x" in trace, lambda trace: trace["a.x"], lambda trace: trace.check()):
        with pytest.raises(LoomfmuError, match=r"lost\.h5: the file is damaged \("):
            ask(trace)


def test_damage_that_hdf5_loops_over_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    made(tmp_path / "run.h5", {}, time=np.arange(3.0))
    check(tmp_path / "run.h5")
    assert TRACE.ours(tmp_path / "run.h5")
    texts = (tmp_path / "run.h5").read_bytes().index(b"GCOL")  # where HDF5 keeps texts, without a checksum
    zeroed(tmp_path / "run.h5", texts + 16, 4000)
    assert TRACE.ours(tmp_path / "run.h5")  # a new run may replace it, and does not read it for that
    monkeypatch.setattr(damage, "SECONDS", 0.5)
    monkeypatch.setattr(damage, "check", check)
    assert cli.main(["show", str(tmp_path / "run.h5")]) == 2
    said = capsys.readouterr().err
    assert "run.h5: " in said and re.search(r" \(HDF5 has not finished .* 1 s of CPU time\)", said)


def test_a_busy_machine_is_not_taken_for_damage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(damage, "SECONDS", 0.5)
    monkeypatch.setattr(damage, "READER", "import time; time.sleep(1.5)")  # it waits, it does not work
    check(tmp_path / "run.h5")
    monkeypatch.setattr(damage, "PATIENCE", 1.0)
    with pytest.raises(LoomfmuError, match=r"HDF5 has not finished reading its attributes after 1 s\)"):
        check(tmp_path / "run.h5")
    monkeypatch.setattr(damage, "READER", "import os; os.abort()")  # a process that crashes over a file
    with pytest.raises(LoomfmuError, match=r"the file is damaged \(HDF5 fails: exit status -6\)"):
        check(tmp_path / "run.h5")


def test_a_damaged_block_is_named(copied: Path) -> None:
    with h5py.File(copied) as file:
        chunk = file["belt/margin"].id.get_chunk_info(0)
    zeroed(copied, chunk.byte_offset, chunk.size)
    with Trace(copied) as trace, pytest.raises(LoomfmuError, match="/belt/margin cannot be read"):
        _ = trace["belt.margin"]


@pytest.mark.parametrize(
    ("command", "change", "why"),
    [
        ("show", lambda time, _: time.__setitem__(7, 0.0), "after "),
        ("diagram", lambda time, _: time.__setitem__(7, math.nan), "comes nan s"),
        ("plot", lambda _, belt: belt["margin"].resize((300,)), "belt.margin has 300 samples, time has"),
    ],
)
def test_samples_that_no_run_gives_are_refused(
    copied: Path,
    capsys: pytest.CaptureFixture[str],
    command: str,
    change: Callable[[Any, Any], None],
    why: str,
) -> None:
    with h5py.File(copied, "r+") as file:
        change(file["time"], file["belt"])
    named = ["belt.margin"] if command == "plot" else []
    assert cli.main([command, str(copied), *named]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"loomfmu: {copied}: the file is damaged (") and why in said


def test_a_unit_that_no_run_writes_is_named_with_its_file(copied: Path) -> None:
    with h5py.File(copied, "r+") as file:
        file["weft/travel"].attrs["UNIT"] = file["weft/travel"].attrs["DISPLAY_UNIT"] = "furlong"
    with pytest.raises(LoomfmuError, match=r"run\.h5: weft\.travel: unknown unit 'furlong'"):
        Trace(copied).displayed("weft.travel")


def test_reading_needs_nothing_but_numpy_and_h5py() -> None:
    script = "import sys, loomfmu.traces; print(sorted({'fmpy', 'scipy', 'pythonfmu'} & set(sys.modules)))"
    assert in_a_process(script) == "[]\n"


def test_a_relative_path_means_the_same_file_after_a_change_of_directory(
    copied: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(copied.parent)
    trace = Trace("run.h5")
    monkeypatch.chdir("/")
    assert trace.path == copied
    assert len(trace["belt.margin"]) == trace.rows


@pytest.mark.few(3)
@pytest.mark.parametrize(
    ("claims", "why"),
    [
        ("7", "7 is not a list"),
        ("[1]", "1 is not a JSON object"),
        ("[{}]", "claim is missing"),
        ('[{"claim": "x", "signal": "s", "holds": "no"}]', "holds = 'no'"),
        (
            '[{"claim": "x", "signal": "s", "holds": true, "unit": "m", "bound": 1, "time": 0, "angle": 0,'
            f' "revolution": 1, "worst": {10**400}}}]',
            "int too large to convert to float",
        ),
    ],
)
def test_claims_that_are_not_verdicts_are_named(
    copied: Path, capsys: pytest.CaptureFixture[str], claims: str, why: str
) -> None:
    with h5py.File(copied, "r+") as file:
        file.attrs["claims"] = claims
    assert cli.main(["show", str(copied)]) == 2
    said = f"loomfmu: {copied}: the file is damaged (its claims are not verdicts: {why})\n"
    assert capsys.readouterr().err == said


@pytest.mark.parametrize("text", ["{", "[]", "7"])
@pytest.mark.parametrize(
    ("place", "name", "ask"),
    [
        ("/", "set", lambda trace: trace.overrides),
        ("/", "wires", lambda trace: trace.wires),
        ("belt", "parameter_units", lambda trace: trace.parameter_unit("belt.speed")),
        ("belt", "parameter_meanings", lambda trace: trace.parameter_text("belt.speed")),
    ],
)
def test_tables_that_are_none_are_named(
    copied: Path, place: str, name: str, ask: Callable[[Trace], Any], text: str
) -> None:
    with h5py.File(copied, "r+") as file:
        file[place].attrs[name] = text
    with pytest.raises(LoomfmuError, match=rf"run\.h5: the file is damaged \(its `{name}` is not a table\)"):
        ask(Trace(copied))
