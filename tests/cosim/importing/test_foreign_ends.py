"""Third-party FMUs that end the simulation themselves: nothing holds, unless the scene allows them to."""

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from foreign_motors import motor2, motor3
from motor_scenes import LENGTH, MOTOR, SHAFT3, WEFT, exact, ran

from loomfmu import LoomfmuError, Trace, evaluate, fit, judge, limit, optimize, sweep, tolerances
from loomfmu.cli import main
from loomfmu.cosim.master import steppers
from loomfmu.cosim.scenes import scene as scenes

SECOND, THIRD = MOTOR + WEFT, LENGTH + SHAFT3 + '[weft]\nmachine = "WL680-3600"\n'
CLAIM = '[[claims]]\nkind = "below"\nsignal = "{}"\nbound = {}\n'


@pytest.fixture(scope="module", params=["0.05", "0.0505"])
def ending(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A directory with motors that end the simulation, and when: at the end of a step or within one."""
    directory = tmp_path_factory.mktemp("ending")
    motor2(directory, defines=(f"ENDS_AT={request.param}",))
    motor3(directory, defines=(f"ENDS_AT={request.param}",))
    return directory, request.param


@pytest.mark.few(4)
@pytest.mark.parametrize("stepped", ["isolated", "compiled", "in Python"])
@pytest.mark.parametrize(
    ("text", "instance", "velocity"), [(SECOND, "motor", "flange_w"), (THIRD, "shaft", "velocity")]
)
def test_the_trace_goes_as_far_as_the_fmu(
    ending: tuple[Path, str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    text: str,
    instance: str,
    velocity: str,
    stepped: str,
) -> None:
    if stepped == "in Python":
        monkeypatch.setattr(steppers, "library_of", lambda _source: None)
    place, end = ending
    result = ran(place, text, tmp_path, isolated=stepped == "isolated")
    assert (result.ended, result.steps) == (f"{instance} at {end} s", 50)
    assert result.warnings == (
        f"{instance} ended the simulation at {end} s; the run would have gone on to 0.2 s",
    )
    trace = result.trace
    assert (trace.status, trace.ended_by) == ("complete", f"{instance} at {end} s")
    assert not result.path.with_name(f"{result.path.name}.partial").exists()
    np.testing.assert_allclose(trace.time, np.arange(51) * 1e-3, rtol=1e-14)
    # some dozen roundings of sums that grow to 10 rad/s
    np.testing.assert_allclose(trace[f"{instance}.{velocity}"], exact(trace.time)[1], rtol=0, atol=1e-12)
    assert len(trace["weft.travel"]) == 51 and np.all(np.diff(trace["weft.travel"][1:]) > 0.0)


@pytest.mark.few(1, each="word")
@pytest.mark.parametrize(
    ("head", "bound", "word"),
    [
        ("", 10.0, "undecided"),
        ("", 9.0, "FAILS"),  # after 50 ms it is at 9.2 rad/s, whatever the rest of the run would show
        ("may_end = true\n", 10.0, "holds"),
        ("may_end = true\n", 9.0, "FAILS"),
    ],
)
def test_no_claim_holds_on_what_there_is_unless_the_scene_allows_an_end(
    ending: tuple[Path, str],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    head: str,
    bound: float,
    word: str,
) -> None:
    place, end = ending
    (place / "x.toml").write_text(f'{head}title = "M"\n' + SECOND + CLAIM.format("motor.flange_w", bound))
    status = int(word != "holds")
    assert main(["run", str(place / "x.toml"), "--output", str(tmp_path / "x.h5")]) == status
    said = capsys.readouterr()
    heading = f"WL680-3600, G6300 left: ended by motor at {end} s, 50 steps"
    assert said.out.startswith(f'{heading}\nscene "M"\n\n{word} ')
    assert ("the run ended at 25" in said.out) == (word == "undecided")
    assert said.err == (
        f"warning: motor ended the simulation at {end} s; the run would have gone on to 0.2 s\n"
    )
    assert main(["show", str(tmp_path / "x.h5")]) == status
    extent = "complete" if head else "cut short"
    assert f"{extent}, ended by motor at {end} s)" in capsys.readouterr().out
    again = judge(Trace(tmp_path / "x.h5"), kind="below", signal="motor.flange_w", bound=bound)
    assert again.word == word


@pytest.mark.parametrize(
    "claim", ["", pytest.param(CLAIM.format("motor.flange_w", 1e3), marks=pytest.mark.slow)]
)
def test_evaluate_tells_it_too(ending: tuple[Path, str], claim: str) -> None:
    place, end = ending
    found = evaluate(scenes.parse(SECOND + claim, "m", directory=place))
    assert not found.holds and found.ended == f"motor at {end} s"
    assert found.warnings[0].startswith("motor ended the simulation at ")
    assert len(found.trace.time) == 51
    assert evaluate(scenes.parse("may_end = true\n" + SECOND + claim, "m", directory=place)).holds


def test_one_that_ends_it_in_the_first_step_leaves_the_sample_at_the_start(tmp_path: Path) -> None:
    motor2(tmp_path, defines=("ENDS_AT=0.0005",))
    result = ran(tmp_path, SECOND + CLAIM.format("weft.travel", 10.0), tmp_path)
    assert result.steps == 0 and result.trace.rows == 1
    assert result.claims[0].note.startswith("the run ended at 0.25 % of its length, by motor; set may_end")


SHORT = r"the run ended at 0\.5 % of its length, by motor; set may_end = true if it may"
VARIED = "motor.J=0.3..0.7"
STUDY = "scene = 'm.toml'\nminimise = 'motor.J'\n[ranges]\n'motor.J' = [0.3, 0.7]\n[search]\nruns = 50\n"
SWEEP = "title = 'S'\nscene = 'm.toml'\n[grid]\n'motor.J' = [0.1, 0.3]\n[traces]\nfailures = 0\nsample = 0\n"


@pytest.fixture
def brief(tmp_path: Path) -> Path:
    """A folder with a motor that ends the simulation after 1 of 200 steps, and what may be asked of it."""
    motor2(tmp_path, defines=("ENDS_AT=0.001",))
    (tmp_path / "m.toml").write_text(SECOND + CLAIM.format("weft.travel", 10.0))
    (tmp_path / "study.toml").write_text(STUDY)
    (tmp_path / "swept.toml").write_text(SWEEP)
    rows = "".join(f"{number}e-4,0\n" for number in range(9))
    (tmp_path / "data.csv").write_text(f"time [s],weft.travel [m]\n{rows}")
    return tmp_path


STUDIES: list[Callable[[Path], object]] = [
    lambda place: limit(place / "m.toml", vary=VARIED, points=3),
    lambda place: tolerances(place / "m.toml", vary=[VARIED]),
    lambda place: fit(place / "m.toml", place / "data.csv", vary=VARIED),
    lambda place: optimize(place / "study.toml", output=place, processes=1),
]


@pytest.mark.parametrize(
    "study", [STUDIES[0], *(pytest.param(each, marks=pytest.mark.slow) for each in STUDIES[1:])]
)
def test_a_run_that_is_cut_short_has_no_value_in_a_study(
    brief: Path, study: Callable[[Path], object]
) -> None:
    with pytest.raises(LoomfmuError, match=SHORT):
        study(brief)


def test_rows_that_are_cut_short_cannot_be_run(brief: Path) -> None:
    swept = sweep(brief / "swept.toml", output=brief / "rows", processes=1)
    assert (swept.errors, swept.holding, swept.holds) == (2, 0, False)
    assert all(re.search(SHORT, text) for text in swept.table["error"].to_pylist())


@pytest.mark.few(1)
@pytest.mark.parametrize("claims", [0, 1])
def test_a_scene_as_a_test_does_not_pass(brief: Path, claims: int) -> None:
    if not claims:  # such a scene is collected for its loom
        (brief / "m.toml").write_text(f"loom = {{}}\n{SECOND}")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "m.toml"]
    tested = subprocess.run(command, cwd=brief, capture_output=True, text=True)
    assert tested.returncode == 1 and re.search(SHORT, tested.stdout), tested.stdout


def test_one_that_ends_it_at_the_end_of_the_run_is_not_worth_a_word(tmp_path: Path) -> None:
    motor2(tmp_path, defines=("ENDS_AT=0.2",))
    result = ran(tmp_path, SECOND, tmp_path)
    assert (result.ended, result.warnings, result.trace.rows) == ("", (), 201)
    assert "ended_by" not in Trace(result.path).attributes


def test_a_flag_of_fmi_3_counts_whatever_it_is_raised_for(tmp_path: Path) -> None:
    motor3(tmp_path)
    result = ran(tmp_path, LENGTH + SHAFT3 + "stalled = true\n", tmp_path)
    assert (result.ended, result.trace.rows) == ("shaft at 0.001 s", 2)
