"""Third-party FMUs that end the simulation themselves: what there is counts, and it is told who did."""

from pathlib import Path

import numpy as np
import pytest
from foreign_motors import motor2, motor3
from motor_scenes import LENGTH, MOTOR, SHAFT3, WEFT, exact, ran

from loomfmu import Trace, evaluate
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


@pytest.mark.parametrize("stepped", ["isolated", "compiled", "in Python"])
@pytest.mark.parametrize(
    ("text", "instance", "velocity"), [(SECOND, "motor", "flange_w"), (THIRD, "shaft", "velocity")]
)
def test_the_trace_goes_as_far_as_the_fmu(
    ending: tuple[Path, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    text: str, instance: str, velocity: str, stepped: str,
) -> None:  # fmt: skip
    if stepped == "in Python":
        monkeypatch.setattr(steppers, "library_of", lambda _source: None)
    place, end = ending
    result = ran(place, text if stepped == "isolated" else f"isolated = false\n{text}", tmp_path)
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


def test_claims_are_judged_on_what_there_is(
    ending: tuple[Path, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    place, end = ending
    for bound, status in ((10.0, 0), (9.0, 1)):  # after 50 ms it is at 9.2 rad/s
        (place / "x.toml").write_text('title = "M"\n' + SECOND + CLAIM.format("motor.flange_w", bound))
        assert main(["run", str(place / "x.toml"), "--output", str(tmp_path / "x.h5")]) == status
        said = capsys.readouterr()
        assert said.out.startswith(f"M: ended by motor at {end} s, 50 steps\n")
        assert said.err == (
            f"warning: motor ended the simulation at {end} s; the run would have gone on to 0.2 s\n"
        )
        assert main(["show", str(tmp_path / "x.h5")]) == status
        assert f"complete, ended by motor at {end} s)" in capsys.readouterr().out


def test_evaluate_tells_it_too(ending: tuple[Path, str]) -> None:
    place, end = ending
    text = SECOND + CLAIM.format("weft.travel", 10.0)
    found = evaluate(scenes.parse(text, "m", directory=place))
    assert found.holds and found.ended == f"motor at {end} s"
    assert found.warnings[0].startswith("motor ended the simulation at ")
    assert len(found.trace.time) == 51


def test_one_that_ends_it_in_the_first_step_leaves_the_sample_at_the_start(tmp_path: Path) -> None:
    motor2(tmp_path, defines=("ENDS_AT=0.0005",))
    result = ran(tmp_path, SECOND + CLAIM.format("weft.travel", 10.0), tmp_path)
    assert result.holds and result.steps == 0 and result.trace.rows == 1


def test_one_that_ends_it_at_the_end_of_the_run_is_not_worth_a_word(tmp_path: Path) -> None:
    motor2(tmp_path, defines=("ENDS_AT=0.2",))
    result = ran(tmp_path, SECOND, tmp_path)
    assert (result.ended, result.warnings, result.trace.rows) == ("", (), 201)
    assert "ended_by" not in Trace(result.path).attributes


def test_a_flag_of_fmi_3_counts_whatever_it_is_raised_for(tmp_path: Path) -> None:
    motor3(tmp_path)
    result = ran(tmp_path, LENGTH + SHAFT3 + "stalled = true\n", tmp_path)
    assert (result.ended, result.trace.rows) == ("shaft at 0.001 s", 2)
