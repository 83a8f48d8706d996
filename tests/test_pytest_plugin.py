"""Scenes as tests: what pytest collects, what it says of a claim that fails, and what it leaves alone."""

from pathlib import Path

import pytest
from live_fmus import in_a_process

from loomfmu.cosim import run
from loomfmu.cosim.scenes import scene as scenes

pytest_plugins = ["pytester"]

SCENE = """
revolutions = 1
steps_per_revolution = 360
[loom]
machine = "WL680-3600"
head = "G6300 left"
[shaft]
speed = "SPEED rpm"
[[claims]]
name = "the belt does not buckle"
kind = "lowest_margin"
bound = 0.0
[[claims]]
kind = "above"
signal = "belt.lowest_speed_limit"
bound = "300 rpm"
"""
FAST, SLOW = SCENE.replace("SPEED", "720"), SCENE.replace("SPEED", "600")
TABLE = '[inputs]\n"belt.guide_clearance" = [[0, "0.3 mm"], [1, "0.3 mm"]]\n'  # so that steps matter
NEAR = SCENE.replace("SPEED", "681.805").replace("= 360", "= 90") + TABLE  # the equations give 681.804


def write(pytester: pytest.Pytester, name: str, text: str) -> Path:
    path = pytester.path / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


@pytest.fixture(scope="module", autouse=True)
def imported(fmu_cache: None) -> None:
    """Import what a run imports: a pytest within this process forgets what it imports."""
    run.evaluate(scenes.parse(SLOW, "slow"))


def test_each_claim_is_a_test_and_nothing_is_written(pytester: pytest.Pytester) -> None:
    write(pytester, "slow.toml", SLOW)
    result = pytester.runpytest_inprocess("slow.toml", "-v", "-p", "no:cacheprovider")
    result.assert_outcomes(passed=2)
    result.stdout.fnmatch_lines(["slow.toml::the belt does not buckle PASSED*", "slow.toml::above PASSED*"])
    assert not [*pytester.path.rglob("*.h5"), *pytester.path.rglob("results")]


def test_an_undecided_claim_fails_with_its_error(pytester: pytest.Pytester) -> None:
    write(pytester, "near.toml", NEAR)
    result = pytester.runpytest_inprocess("near.toml")
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["undecided: *lowest margin", "distance:*", "error: *[0-9]*"])


def test_a_failure_says_where_and_how_to_repeat_it(pytester: pytest.Pytester) -> None:
    write(pytester, "sims/fast.toml", FAST)
    result = pytester.runpytest_inprocess("sims/fast.toml")
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(
        [
            "claim fails:  the belt does not buckle: lowest margin",
            "signal:       belt.lowest_margin",
            "worst:        -0.*",
            "bound:        at least 0",
            "distance:     -0.*",
            "at:           * s, * deg, rev. 1",
            "to reproduce: loomfmu run sims/fast.toml",
            "to see it:    loomfmu run sims/fast.toml --report",
        ]
    )
    assert "Traceback" not in result.stdout.str() and "pytest_plugin.py" not in result.stdout.str()


def test_traces_and_reports_are_kept_where_wanted(pytester: pytest.Pytester) -> None:
    write(pytester, "sims/fast.toml", FAST)
    write(pytester, "sims/slow.toml", SLOW)
    result = pytester.runpytest_subprocess("sims/fast.toml", "sims/slow.toml", "--loomfmu-traces", "kept")
    result.assert_outcomes(passed=3, failed=1)
    result.stdout.fnmatch_lines(["trace:        kept/sims/fast.h5", "report:       kept/sims/fast.html"])
    kept = sorted(path.name for path in (pytester.path / "kept" / "sims").iterdir())
    assert kept == ["fast.h5", "fast.html", "slow.h5"]


def test_a_scene_runs_once(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    runs, evaluate = [], run.evaluate
    monkeypatch.setattr(run, "evaluate", lambda scene: runs.append(scene) or evaluate(scene))
    write(pytester, "slow.toml", SLOW)
    pytester.runpytest_inprocess("slow.toml").assert_outcomes(passed=2)
    assert len(runs) == 1


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[loom]\nmachine = 7\n", "bad.toml: *machine*"),
        ("title = \n", "bad.toml: not valid TOML*"),
        (SLOW.replace("lowest_margin", "lowest"), "bad.toml: claim kind = 'lowest' is unknown*"),
    ],
)
def test_a_scene_that_cannot_be_read_is_an_error_of_one_line(
    pytester: pytest.Pytester, text: str, said: str
) -> None:
    write(pytester, "bad.toml", text)
    result = pytester.runpytest_inprocess("bad.toml")
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines([said])
    assert "Traceback" not in result.stdout.str()


def test_other_files_are_left_alone(pytester: pytest.Pytester) -> None:
    write(pytester, "pyproject.toml", "[project]\nname = 'theirs'\n")
    write(pytester, "slow.toml", SLOW)  # not named
    write(pytester, "test_theirs.py", "def test_it(): pass\n")
    pytester.runpytest_inprocess().assert_outcomes(passed=1)
    theirs = pytester.runpytest_inprocess("pyproject.toml")
    assert theirs.ret == pytest.ExitCode.USAGE_ERROR  # as without the plugin


def test_the_configuration_names_scenes(pytester: pytest.Pytester) -> None:
    pytester.makeini("[pytest]\nloomfmu_scenes = sims/*.toml\n")
    for name in ("sims/slow.toml", "sims/sub/slow.toml", "slow.toml"):
        write(pytester, name, SLOW)
    result = pytester.runpytest_inprocess("--collect-only", "-q")
    result.stdout.fnmatch_lines(["sims/slow.toml::the belt does not buckle", "sims/slow.toml::above"])
    assert "sub/" not in result.stdout.str() and "2 tests collected" in result.stdout.str()


def test_a_scene_without_claims_is_tested_to_run(pytester: pytest.Pytester) -> None:
    write(pytester, "bare.toml", SLOW.partition("[[claims]]")[0])
    result = pytester.runpytest_inprocess("bare.toml", "-v")
    result.assert_outcomes(passed=1)
    result.stdout.fnmatch_lines(["bare.toml::runs PASSED*"])


@pytest.mark.slow
def test_several_processes_share_the_work(pytester: pytest.Pytester) -> None:
    write(pytester, "fast.toml", FAST)
    result = pytester.runpytest_subprocess("fast.toml", "-n", "2", "--dist", "loadfile")
    result.assert_outcomes(passed=1, failed=1)


def test_the_plugin_imports_next_to_nothing() -> None:
    script = (
        "import pytest, sys; before = set(sys.modules); import loomfmu.pytest_plugin;"
        "print(sorted(name for name in set(sys.modules) - before))"
    )
    machine = "'loomfmu.cosim', 'loomfmu.cosim.standard'"  # whoever imports loomfmu hands it down
    assert in_a_process(script) == f"['loomfmu', {machine}, 'loomfmu.pytest_plugin', 'loomfmu.version']\n"
