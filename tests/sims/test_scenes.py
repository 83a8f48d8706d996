"""Every scene in sims/ runs by the command, and what it claims is true."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from loomfmu import Trace
from loomfmu.cli import main
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.loom.standard_loom import COMPONENT_OF

SIMS = Path(__file__).parents[2] / "sims"
SCENES = sorted(path.relative_to(SIMS).as_posix() for path in SIMS.glob("*.toml"))


@dataclass(frozen=True)
class Done:
    """What a command has said, and its exit status."""

    status: int
    out: str
    err: str


@pytest.fixture
def run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., Done]:
    """Runs a scene of `sims` by the command, in a folder of its own."""
    monkeypatch.chdir(tmp_path)

    def of(scene: str | Path, *arguments: str) -> Done:
        return Done(main(["run", str(SIMS / scene), *arguments]), *capsys.readouterr())

    return of


Run = Callable[..., Done]


@pytest.mark.parametrize("scene", SCENES)
def test_all_claims_of_a_scene_hold(run: Run, tmp_path: Path, scene: str) -> None:
    done = run(scene)
    assert done.status == 0, done.out + done.err
    assert "FAILS" not in done.out
    assert "warning" not in done.err
    with Trace(tmp_path / "results" / f"{Path(scene).stem}.h5") as trace:
        assert trace.status == "complete"
        assert trace.verdicts, "a scene claims something"
        assert all(trace.verdicts)
        for verdict in trace.verdicts:
            judged = verdict.claim.partition(": ")[2] or verdict.claim
            verbs = {"is", "are", "stays", "holds", "meet"} & {*judged.split()}
            assert not verbs, "the name states what must hold; what follows it names the quantity alone"


@pytest.mark.parametrize("kept", ['load = "100 N"', 'load = "10 kN"\n'])
def test_a_roller_that_lifts_off_has_no_pressure_to_claim(run: Run, tmp_path: Path, kept: str) -> None:
    scene = (SIMS / "cam_contact.toml").read_text().replace('load = "10 kN"', kept)
    if "kN" in kept:  # with 0.45 the least force would be -2574 N, by the roller's own equation of motion
        scene = scene.replace("[shaft]", "[shaft]\nripple_amplitude = 0.45\nripple_order = 10")
    (tmp_path / "light.toml").write_text(scene)
    (tmp_path / "cam_pressure.py").write_bytes((SIMS / "cam_pressure.py").read_bytes())
    done = run(tmp_path / "light.toml")
    assert done.status == 1 and "undecided" in done.out


def test_the_full_loom_has_every_mechanism_of_a_loom() -> None:
    instances = scenes.load(SIMS / "full_loom.toml").instances
    combing = {"DetachingRoller"}  # of another machine
    assert {each.fmu.name for each in instances.values()} == set(COMPONENT_OF.values()) - combing
    assert {"weft_2", "belt_2", "belt_motion_2"} <= set(instances)


def test_the_readme_shows_what_the_demonstration_prints(run: Run) -> None:
    printed = run("wl680_3600.toml").out.splitlines()
    readme = (SIMS.parent / "README.md").read_text()
    lines = readme.split("## Run a published loom")[1].split("```text\n")[1].split("\n```")[0].splitlines()
    assert len(lines) > 4
    pace = "us each; "  # differs from run to run
    assert [line for line in lines if line not in printed and pace not in line] == ["..."]
    assert any(pace in line for line in lines) and any(pace in line for line in printed)


BEYOND = sorted(path.name for path in (SIMS / "beyond_the_limit").glob("*.toml"))


@pytest.mark.parametrize("scene", BEYOND)
def test_a_loom_beyond_its_limit_fails_its_claims(run: Run, scene: str) -> None:
    done = run(f"beyond_the_limit/{scene}")
    assert done.status == 1, done.out + done.err
    assert "FAILS" in done.out


def test_the_demonstration_fails_beyond_the_belts_safe_speed(run: Run, tmp_path: Path) -> None:
    done = run("wl680_3600.toml", "--set", "shaft.speed=700rpm")
    assert done.status == 1, done.err
    failed = [line for line in done.out.splitlines() if "FAILS" in line]
    assert "the belt keeps a margin of 10 %: lowest margin" in failed[0]
    assert "the loom runs below its safe speed" in failed[1]
    (path,) = (tmp_path / "results").iterdir()
    assert path.name == "wl680_3600_shaft.speed=700rpm.h5"
    with Trace(path) as trace:
        failed_ones = [verdict for verdict in trace.verdicts if not verdict]
        signals = [verdict.signal for verdict in failed_ones]
        assert signals == ["belt.lowest_margin", "belt.lowest_speed_limit"]
        # the margin follows the square of the speed over the limit of 681.8 rev/min, 1 - (700 / 681.8)^2;
        # both are extremes of curves between samples, equal to some 1e-6
        limit = trace["belt.lowest_speed_limit"][-1]
        speed = trace["shaft.velocity"][-1]
        assert abs(failed_ones[0].worst - (1 - (speed / limit) ** 2)) < 1e-5
        assert bool(trace["belt.buckled"][-1])


@pytest.mark.parametrize(("speed", "status"), [("681 rpm", 0), ("683 rpm", 1)])
def test_the_margin_vanishes_at_the_speed_limit(run: Run, tmp_path: Path, speed: str, status: int) -> None:
    # 681.80 rev/min by the equations, 685 as published
    scene = (SIMS / "wl680_3600.toml").read_text().split("[[claims]]")[0]
    (tmp_path / "limit.toml").write_text(scene + '[[claims]]\nkind = "lowest_margin"\nbound = 0.0\n')
    once = ("--set", "revolutions=1", "--set", f"shaft.speed={speed}")
    done = run(tmp_path / "limit.toml", *once)
    assert done.status == status, done.out + done.err
