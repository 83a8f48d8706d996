"""FMUs that misbehave, in processes of their own: one line for each, and nothing else comes to harm."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import motor_scenes
import numpy as np
import pytest
from foreign_motors import misbehaving, motor2, motor3
from motor_scenes import MOTOR, SHAFT3, WEFT, exact

import loomfmu
from loomfmu import LoomfmuError, Trace
from loomfmu.cosim.importing import pool
from loomfmu.cosim.importing.isolated_slave import IsolatedSlave
from loomfmu.cosim.master import steppers
from loomfmu.cosim.run import evaluate
from loomfmu.cosim.scenes import scene as scenes

ran = partial(motor_scenes.ran, isolated=True)
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the misbehaving FMU is compiled for Linux")


@pytest.fixture(autouse=True)
def nothing_is_left() -> Iterator[None]:
    yield
    resting = [slave._process for slave in resting_processes()]
    pool.free_all()
    assert not any(process.alive or process._folder.exists() for process in resting)


def resting_processes() -> list[IsolatedSlave]:
    return [each for slaves in pool._resting.values() for each in slaves if isinstance(each, IsolatedSlave)]


RUN = ("-m", "loomfmu.cli", "run", "motor.toml")


def python(folder: Path, scene: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Python in a process of its own, where motor.toml is this scene."""
    (folder / "motor.toml").write_text(scene)
    command = [sys.executable, *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120)


# ---- results

LOOPED = (
    MOTOR
    + '[other]\nfmu = "Motor3.fmu"\n[weft]\n[wires]\n"weft.shaft_angle" = "motor.flange.phi"\n'
    + '"other.load" = "weft.shaft_torque"\n"motor.load.tau" = "weft.shaft_torque"\n'
)


@pytest.mark.few(1)
@pytest.mark.parametrize("text", [LOOPED, MOTOR + SHAFT3 + WEFT])
def test_results_are_equal_to_the_bit(tmp_path: Path, text: str) -> None:
    motor2(tmp_path), motor3(tmp_path)
    found = {each: ran(tmp_path, text, tmp_path / str(each), isolated=each) for each in (True, False)}
    assert list(found[True].trace) == list(found[False].trace)
    for signal_ in found[True].trace:
        np.testing.assert_array_equal(found[True].trace[signal_], found[False].trace[signal_])
    assert found[True].warnings == found[False].warnings


LOOM = """
revolutions = 0.5
steps_per_revolution = 360
coupling = "iterated"
[loom]
machine = "WL680-3600"
[shaft]
component = "DrivenShaft"
inertia = "0.1 kg.m2"
"""


@pytest.mark.few(1)
@pytest.mark.parametrize("flavour", ["live", "native"])
def test_ours_can_be_isolated_too_also_in_an_iterated_loop(flavour: str) -> None:
    found = [
        evaluate(scenes.parse(LOOM, "loom", {"isolated": each}), flavour=flavour, values=["belt.margin"])
        for each in (True, False)
    ]
    np.testing.assert_array_equal(found[0].trace["belt.margin"], found[1].trace["belt.margin"])


def test_which_are_isolated(tmp_path: Path) -> None:
    motor2(tmp_path)
    both = MOTOR + "[weft]\n"

    def isolates(text: str, **overrides: object) -> list[bool]:
        scene = scenes.parse(text, "x", {k.replace("__", "."): v for k, v in overrides.items()}, tmp_path)
        return [scene.isolates(name) for name in ("motor", "weft")]

    assert isolates(both) == [True, False]
    assert isolates(both, isolated="false") == [False, False]
    assert isolates("isolated = true\n" + both, motor__isolated=False) == [False, True]
    for key in ("isolated", "motor.isolated"):
        with pytest.raises(LoomfmuError, match=rf"^{key} = 5 must be true or false$"):
            scenes.parse(both, "x", {key: 5}, tmp_path)
    with pytest.raises(LoomfmuError, match=r"^step_timeout: '5 m' is in m, which does not fit s$"):
        scenes.parse(both, "x", {"step_timeout": "5 m"}, tmp_path)


def test_each_run_has_a_process_of_its_own(tmp_path: Path) -> None:
    motor2(tmp_path)
    scene = scenes.parse(MOTOR, directory=tmp_path)
    first = evaluate(scene, values=["motor.flange_w"]).trace["motor.flange_w"]
    assert resting_processes() == []
    assert evaluate(scene, values=["motor.flange_w"]).trace["motor.flange_w"].tolist() == first.tolist()


def test_a_process_serves_the_next_run_of_an_fmu_of_ours() -> None:
    def margins() -> list[float]:
        scene = scenes.parse(LOOM, "loom", {"belt.isolated": True})
        return evaluate(scene, flavour="native", values=["belt.margin"]).trace["belt.margin"].tolist()

    first = margins()
    (one,) = resting_processes()
    assert margins() == first
    assert resting_processes() == [one]
    one._process._popen.kill()
    one._process._popen.wait()
    assert margins() == first


# ---- failures

IN_A_STEP = {
    "CRASH": r"fmi2DoStep crashed its process \(SIGSEGV\)",
    "HANG": r"fmi2DoStep did not return within step_timeout = 0.5 s",
    "EXIT": r"fmi2DoStep ended its process \(exit status 0\)",
    "ABORT": r"fmi2DoStep crashed its process \(SIGABRT\); it printed: motor:  \[31massertion failed",
    "FLOOD": r"fmi2DoStep did not return within step_timeout = 0.5 s; it printed: the motor turns.*",
    "CLOSE": r"fmi2DoStep closed the connection to the master",
    "OVERWRITE": r"it overwrote memory that is not its own, and crashed its process \(SIGABRT\)",
    "CHILD": r"fmi2DoStep crashed its process \(SIGSEGV\)",
}


@pytest.mark.few(3)
@pytest.mark.parametrize("what", IN_A_STEP)
def test_one_that_fails_in_a_step_is_named_and_the_trace_kept(tmp_path: Path, what: str) -> None:
    misbehaving(tmp_path, what)
    with pytest.raises(LoomfmuError, match=rf"^motor at 0.05 s: {IN_A_STEP[what]}$"):
        ran(tmp_path, MOTOR + WEFT, tmp_path, step_timeout="0.5 s")
    with Trace(tmp_path / "motor.h5.partial") as trace:
        assert trace.rows == 51  # 0 to 0.05 s
        np.testing.assert_allclose(trace["motor.flange_phi"], exact(trace.time)[0], rtol=0, atol=1e-12)


@pytest.mark.few(1)
@pytest.mark.parametrize("what", ["CRASH", "HANG", "EXIT"])
def test_one_that_fails_in_initialization_is_named(tmp_path: Path, what: str) -> None:
    misbehaving(tmp_path, what, "INITIALIZATION")
    said = IN_A_STEP[what].replace("fmi2DoStep", "initialization")
    with pytest.raises(LoomfmuError, match=rf"^motor: {said}$"):
        ran(tmp_path, MOTOR, tmp_path, step_timeout="0.5 s")


@pytest.mark.few(1)
@pytest.mark.parametrize("where", ["TERMINATE", "FREE"])
@pytest.mark.parametrize("what", ["CRASH", "HANG", "EXIT"])
def test_what_fails_after_the_last_step_costs_nothing(tmp_path: Path, what: str, where: str) -> None:
    misbehaving(tmp_path, what, where)
    for _ in range(2):
        result = ran(tmp_path, MOTOR, tmp_path, step_timeout="0.5 s")
        assert result.holds and result.trace.rows == 201


@pytest.mark.parametrize("what", ["PRINT", "LOG"])
def test_what_disturbs_others_disturbs_nobody(
    tmp_path: Path, what: str, capfd: pytest.CaptureFixture[str]
) -> None:
    misbehaving(tmp_path, what)
    result = ran(tmp_path, MOTOR, tmp_path, duration="0.06 s")
    assert result.holds and capfd.readouterr() == ("", "")
    assert len(result.warnings) == (51 if what == "LOG" else 0)
    if what == "LOG":
        assert result.warnings[0] == "motor: 99950 earlier messages left out"
        assert result.warnings[-1] == "motor: line 9999"


@pytest.mark.parametrize(
    ("where", "isolated"),
    [("STEP", True), *((where, False) for where in ("STEP", "INITIALIZATION", "TERMINATE", "FREE"))],
)
def test_a_changed_working_directory_is_changed_back(
    tmp_path: Path, where: str, isolated: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    misbehaving(tmp_path, "MOVE", where)
    assert ran(tmp_path, MOTOR, Path(), isolated=isolated).holds
    assert (tmp_path / "motor.h5").exists() and Path.cwd() == tmp_path


def test_a_run_that_takes_too_long_is_ended(tmp_path: Path) -> None:
    misbehaving(tmp_path, "HANG")
    # a busy machine may need that long to start the process
    said = r"^motor( at [\d.]+ s)?: the run took longer than run_timeout = 1 s$"
    with pytest.raises(LoomfmuError, match=said):
        ran(tmp_path, MOTOR, tmp_path, run_timeout="1 s")
    motor2(tmp_path)
    said = r"^motor( at [\d.]+ s)?: the run took longer than run_timeout = 0.5 s$"
    with pytest.raises(LoomfmuError, match=said):
        ran(tmp_path, MOTOR, tmp_path, run_timeout="0.5 s", duration="100000 s")


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("where", "said"), [("STEP", "interrupted; 51 samples are in "), ("INITIALIZATION", "interrupted")]
)
def test_ctrl_c_ends_a_hang(tmp_path: Path, where: str, said: str) -> None:
    misbehaving(tmp_path, "HANG", where)
    timer = threading.Timer(2.0, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt, match=f"^{said}"):
        ran(tmp_path, MOTOR, tmp_path)
    timer.join()


def test_the_processes_end_with_a_master_that_is_killed(tmp_path: Path) -> None:
    misbehaving(tmp_path, "HANG")
    (tmp_path / "motor.toml").write_text(MOTOR)
    (tmp_path / "tmp").mkdir()
    ours = subprocess.Popen(
        [sys.executable, "-m", "loomfmu.cli", "run", "motor.toml"],
        cwd=tmp_path,
        env=os.environ | {"TMPDIR": str(tmp_path / "tmp")},
    )
    results, temporary = tmp_path / "results", tmp_path / "tmp"
    until(lambda: list(results.glob("motor.h5.*.partial")) and list(temporary.glob("loomfmu-*")))
    ours.kill()
    ours.wait()
    until(lambda: not list((tmp_path / "tmp").glob("loomfmu-*")))  # the last that they do


def until(found: object) -> None:
    """Wait for something, for as long as a busy machine may need."""
    end = time.monotonic() + 60.0
    while not found():  # type: ignore[operator]
        assert time.monotonic() < end
        time.sleep(0.02)


SWEEP = """
scene = "motor.toml"
values = ["motor.flange_w"]
[grid]
"motor.mode" = ["both_ways", "no_way_back"]
"motor.J" = [0.5, 0.6]
"""


def swept(folder: Path, what: str, scene: str, processes: int) -> list[dict[str, Any]]:
    """The rows of a sweep in which an FMU misbehaves in the first two of four."""
    misbehaving(folder, what)
    (folder / "motor.toml").write_text(scene)
    (folder / "sweep.toml").write_text(SWEEP)
    found = loomfmu.sweep(folder / "sweep.toml", output=folder / "out", processes=processes)
    assert found.errors == 2 and found.holding == 2
    return found.table.to_pylist()


@pytest.mark.few(1)
@pytest.mark.parametrize("what", ["CRASH", "HANG", "EXIT"])
def test_other_rows_of_a_sweep_are_unharmed(tmp_path: Path, what: str) -> None:
    rows = swept(tmp_path, what, 'step_timeout = "0.5 s"\n' + MOTOR, 1)
    said = IN_A_STEP[what].replace("\\", "")
    assert [row["error"] for row in rows] == [f"motor at 0.05 s: {said}"] * 2 + [None] * 2
    for row in rows[2:]:
        constant = row["motor.J"] * 60.0 / 100.0
        assert row["motor.flange_w"] == pytest.approx(60.0 * (1.0 - np.exp(-0.2 / constant)), rel=1e-12)


@pytest.mark.parametrize("crashes", [0, 1])
def test_what_an_fmu_starts_in_a_session_of_its_own_ends_with_it(
    tmp_path: Path, crashes: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MARK", str(tmp_path))  # what it starts has the same
    misbehaving(tmp_path, "DAEMON", returned=crashes)
    if crashes:
        with pytest.raises(LoomfmuError, match=r"fmi2DoStep crashed its process \(SIGSEGV\)$"):
            ran(tmp_path, MOTOR, tmp_path)
    else:
        assert ran(tmp_path, MOTOR.replace('"0.2 s"', '"0.055 s"'), tmp_path).holds
    assert [each for each in Path("/proc").glob("[0-9]*/environ") if str(tmp_path) in content(each)] == []


def content(path: Path) -> str:
    """The content of a file of /proc; nothing of a process that has ended."""
    try:
        return path.read_text(errors="replace")
    except OSError:
        return ""


# ---- not isolated

IN_THIS_PROCESS = "isolated = false\n" + MOTOR


@pytest.mark.few(1)
@pytest.mark.parametrize("where", ["INITIALIZATION", "STEP", "TERMINATE", "FREE"])
@pytest.mark.parametrize(
    ("what", "how"),
    [
        ("EXIT", "ended the process (exit status 0)"),
        ("QUIT", "ended the process (exit status 0)"),
        ("CRASH", "crashed the process (SIGSEGV)"),
    ],
)
def test_the_command_outlives_an_fmu_that_ends_its_process(
    tmp_path: Path, what: str, how: str, where: str
) -> None:
    misbehaving(tmp_path, what, where)
    done = python(tmp_path, IN_THIS_PROCESS, *RUN)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        f"loomfmu: motor {how} before the run was finished; isolated = true keeps the trace up to there\n"
    )


def test_exit_in_a_script_is_a_failure(tmp_path: Path) -> None:
    misbehaving(tmp_path, "EXIT")
    done = python(tmp_path, IN_THIS_PROCESS, "-c", "import loomfmu; loomfmu.run('motor.toml')")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        "loomfmu: an FMU ended the process (exit) before the run was finished, one of motor;"
        " isolated = true says which one and keeps the trace\n"
    )
    assert not (tmp_path / "results" / "motor.h5").exists()


@pytest.mark.parametrize(("bound", "status"), [(100.0, 0), pytest.param(1.0, 1, marks=pytest.mark.slow)])
def test_a_run_in_a_child_process_is_like_any_other(tmp_path: Path, bound: float, status: int) -> None:
    motor2(tmp_path)
    claim = f'[[claims]]\nkind = "below"\nsignal = "motor.flange_w"\nbound = {bound}\n'
    done = [
        python(
            tmp_path,
            MOTOR + claim,
            *RUN,
            "--set",
            f"isolated={isolated}",
            "--output",
            f"{bound}_{isolated}.h5",
        )
        for isolated in ("true", "false")
    ]
    assert [each.returncode for each in done] == [status, 1], done[1].stderr
    printed = [
        [line for line in each.stdout.splitlines() if "us each" not in line and "trace: " not in line]
        for each in done
    ]
    words = [
        " ".join(" ".join(lines).split()).replace(f"motor; isolated = {isolated}:", "motor:")
        for lines, isolated in zip(printed, ("true", "false"), strict=True)
    ]
    # errors take further runs, which an FMU in this process could spoil, and nothing holds without
    (known, _, note), (unknown, _, why) = (line.partition(" highest value ") for line in words)
    assert known.split()[-1] == ("holds" if status == 0 else "FAILS")
    assert unknown.split()[-1] == ("undecided" if status == 0 else "FAILS")
    assert note.partition(",")[0] == why.partition(",")[0]
    assert "(motor may do more within a step than it shows at its ends)" in note
    assert "(numerical error not estimated: motor runs in this process; set isolated = true)" in why
    assert done[0].stderr == done[1].stderr == ""


def test_the_second_ctrl_c_ends_a_run_whose_fmu_hangs(tmp_path: Path) -> None:
    misbehaving(tmp_path, "HANG")
    (tmp_path / "motor.toml").write_text(IN_THIS_PROCESS)
    running = subprocess.Popen(
        [sys.executable, "-m", "loomfmu.cli", "run", "motor.toml"],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
    )
    until(lambda: list((tmp_path / "results").glob("motor.h5.*.partial")))
    for _ in range(2):
        time.sleep(0.5)  # the first must have arrived
        running.send_signal(signal.SIGINT)
    assert running.communicate(timeout=60)[1] == "loomfmu: interrupted; an FMU did not return\n"
    assert running.returncode == 130


@pytest.mark.slow
@pytest.mark.parametrize("processes", [1, 2])
def test_a_row_whose_fmu_ends_the_process_leaves_the_others_unharmed(tmp_path: Path, processes: int) -> None:
    for row in swept(tmp_path, "QUIT", IN_THIS_PROCESS, processes)[:2]:
        assert row["error"] == (
            "the process that ran it ended with status 0, with motor in it;"
            " isolated = true says which call of which FMU"
        )


@pytest.mark.few(3)
@pytest.mark.parametrize("compiled", [False, True])
@pytest.mark.parametrize("where", ["STEP", "INITIALIZATION", "TERMINATE", "FREE"])
def test_a_changed_rounding_is_changed_back_before_others_compute(
    tmp_path: Path, where: str, compiled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not compiled:
        monkeypatch.setattr(steppers, "library_of", lambda _source: None)
    weft = '[weft]\nspeed = "500 rpm"\nfollow_shaft = false\n'
    found = []
    for what in ("ROUND", "STATUS"):
        misbehaving(tmp_path, what, where)
        result = ran(tmp_path, MOTOR + weft, tmp_path / what, isolated=False)
        found.append(result.trace["weft.travel"])
        tiny = 1e-300
        assert 1.0 + tiny == 1.0
    np.testing.assert_array_equal(*found)


@pytest.mark.few(1)
@pytest.mark.parametrize("where", ["STEP", "INITIALIZATION"])
@pytest.mark.parametrize("text", [MOTOR, IN_THIS_PROCESS])
def test_of_a_process_that_an_fmu_has_forked_one_goes_on(tmp_path: Path, text: str, where: str) -> None:
    misbehaving(tmp_path, "FORK", where)
    done = python(tmp_path, text.replace('"0.2 s"', '"0.055 s"'), *RUN)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("trace: ") == 1
    assert os.listdir(tmp_path / "results") == ["motor.h5"]
    with Trace(tmp_path / "results" / "motor.h5") as trace:
        assert trace.status == "complete" and trace.rows == 56


@pytest.mark.few(4)
@pytest.mark.parametrize("isolated", [True, False])
@pytest.mark.parametrize("status", [5, -1, 6, 2**31 - 1, -(2**31)])
def test_a_status_that_the_master_does_not_know_is_a_failure(
    tmp_path: Path, status: int, isolated: bool
) -> None:
    misbehaving(tmp_path, "STATUS", returned=status)
    said = "fmi2Pending: steps in the background are not" if status == 5 else f"status {status}: "
    with pytest.raises(LoomfmuError, match=rf"^motor at 0\.05 s: fmi2DoStep returned {said}"):
        ran(tmp_path, MOTOR, tmp_path, isolated=isolated)


@pytest.mark.parametrize("study", [loomfmu.limit, loomfmu.tolerances])
def test_a_study_whose_process_an_fmu_could_end_is_refused(
    tmp_path: Path, study: Callable[..., object]
) -> None:
    """One that called _exit made each of them a success without a word."""
    motor2(tmp_path)
    claim = '[[claims]]\nkind = "below"\nsignal = "motor.flange_w"\nbound = 100.0\n'
    scene = scenes.parse(f"isolated = false\n{MOTOR}{claim}", "motor", directory=tmp_path)
    with pytest.raises(LoomfmuError, match=r"motor could end this process .*; set isolated = true"):
        study(scene, vary="motor.setpoint=1..2")
