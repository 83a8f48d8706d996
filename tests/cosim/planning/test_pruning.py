"""What a run leaves out: found backwards from what is requested, and explained."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scene_texts as texts
from direct_loom import small
from scene_texts import claim, parsed

import loomfmu
from loomfmu import LoomfmuError
from loomfmu.cosim.importing import fmus, pool
from loomfmu.cosim.planning.plan import explained
from loomfmu.cosim.planning.pruning import Pruned, prune
from loomfmu.cosim.planning.requested import Requested
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.scene import Scene

DEMO = Path(__file__).parents[3] / "sims" / "wl680_3600.toml"
LOOM = texts.loom('weave = "10/01/10/01"\ndampers = true\n')


def needed_for(scene: Scene) -> Pruned:
    requested = Requested(scene)
    return prune(scene, requested.needed(requested.claims, requested.recorded))


def margin(rest: str = "") -> Scene:
    lowest = claim("lowest_margin", bound=0.1)
    return parsed("record = []\n", LOOM, rest, lowest, steps_per_revolution=360)


def test_a_scene_that_claims_the_belts_margin_alone_needs_two_fmus() -> None:
    needed = needed_for(margin())
    assert set(needed.scene.instances) == {"weft", "belt"}
    assert needed.fetched == {
        ("weft", "travel"),
        ("weft", "velocity"),
        ("weft", "acceleration"),
        ("belt", "margin"),
        ("belt", "lowest_margin"),
    }
    assert set(needed.shafts) == {"shaft"}


def test_what_is_not_needed_is_neither_built_nor_loaded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pool.free_all()
    fmus._known.clear()
    monkeypatch.setenv("LOOMFMU_CACHE", str(tmp_path / "cache"))
    result = loomfmu.run(margin(), output=tmp_path / "margin.h5")
    assert result.holds
    built = sorted(path.name for path in (tmp_path / "cache" / "fmus").glob("*/*.fmu"))
    # that of the shaft has the derivatives of its angle, but does not run
    assert built == ["BeltMonitor.fmu", "MainShaft.fmu", "WeftInsertion.fmu"]
    assert result.skipped[-1].startswith("ran 2 of")
    pool.free_all()
    fmus._known.clear()


def test_what_is_left_out_is_explained_with_its_reason_and_what_it_saves() -> None:
    scene = margin()
    skipped = loomfmu.evaluate(scene).skipped
    assert "shaft (MainShaft): not run; its speed is constant, so its angle needs no FMU" in skipped
    assert "damper_3 (HealdDamper): not run; nothing that is recorded or claimed depends on it" in skipped
    assert any(line.startswith("belt: 11 of 13 outputs not read: free_length, ") for line in skipped)
    # 12 FMUs and 360 steps against 2 and 360
    assert skipped[-1] == ("ran 2 of 12 FMUs, 360 steps each: 720 FMU steps instead of 4320, 6 times fewer")


def test_less_gives_the_same_bits(tmp_path: Path) -> None:
    text = DEMO.read_text()
    whole = loomfmu.run(scenes.parse(text, "demo"), output=tmp_path / "whole.h5")
    less = loomfmu.run(scenes.parse(f"record = []\n{text}", "less"), output=tmp_path / "less.h5")
    assert [str(verdict) for verdict in less.claims] == [str(verdict) for verdict in whole.claims]
    assert set(less.trace) < set(whole.trace)
    for signal in less.trace:
        np.testing.assert_array_equal(less.trace[signal], whole.trace[signal])


def test_an_evaluation_gives_the_verdicts_of_a_run_and_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    evaluated = loomfmu.evaluate(DEMO, values=["heald_3.lift"])
    assert list(tmp_path.iterdir()) == []
    result = loomfmu.run(DEMO, output=tmp_path / "demo.h5")
    assert evaluated.claims == result.claims
    assert evaluated.holds
    np.testing.assert_array_equal(evaluated.trace["heald_3.lift"], result.trace["heald_3.lift"])
    assert evaluated.trace.parameter("heald_3.stroke") == result.trace.parameter("heald_3.stroke")
    assert "damper_3.rate" not in evaluated.trace
    with pytest.raises(LoomfmuError, match=r"signal 'damper_3.rate' is not recorded"):
        evaluated.trace["damper_3.rate"]
    with pytest.raises(LoomfmuError, match=r"record: heald_3 has no output 'lifft'; did you mean 'lift'"):
        loomfmu.evaluate(DEMO, values=["heald_3.lifft"])


@pytest.mark.parametrize(
    "rest",
    [
        '[shaft]\nramp_duration = "0.1 s"\n',
        "[shaft]\nripple_amplitude = 0.01\n",
        "[weft]\nfollow_shaft = false\n[belt]\nguide_clearance = 0.0004\n",
        '[wires]\n"belt.shaft_acceleration" = false\n',
    ],
)
def test_a_shaft_stays_where_it_is_more_than_a_product(rest: str) -> None:
    needed = needed_for(margin(rest))
    assert "shaft" in needed.scene.instances
    assert not needed.shafts


def test_a_shaft_that_others_read_stays() -> None:
    with pytest.raises(LoomfmuError, match=r"shaft.acceleration is in rad/s2, belt.guide_clearance in m"):
        margin('[wires]\n"belt.guide_clearance" = "shaft.acceleration"\n')
    rest = '[other]\ncomponent = "HealdFrame"\n[wires]\n"other.rotor_angle" = "shaft.angle"\n'
    assert "shaft" in needed_for(parsed('record = ["other.*"]\n', rest)).scene.instances


def test_a_driven_input_goes_with_its_instance() -> None:
    rest = '[inputs]\n"damper_1.warp_force" = [[0, "10 N"], [1, "20 N"]]\n'
    scene = margin(rest)
    assert "damper_1" in needed_for(scene).scene.instances  # what drives an input is recorded
    requested = Requested(scene)
    needed = prune(scene, requested.judged(requested.claims))
    assert "damper_1" not in needed.scene.instances
    assert needed.scene.drives == []


def test_loops_are_kept_whole() -> None:
    scene = small(90, rest='[wires]\n"belt.yarn_tension" = "belt.inertia_force"\n')
    needed = prune(scene, ["belt.margin"])
    assert ("belt", "inertia_force") in needed.fetched
    assert set(needed.scene.instances) == {"weft", "belt"}


def test_without_a_request_nothing_runs() -> None:
    evaluated = loomfmu.evaluate(parsed("[shaft]", revolutions=2, steps_per_revolution=8))
    assert evaluated.skipped[-1] == "ran none of 1 FMUs; 16 FMU steps skipped"
    # the closed form of a constant speed: 400 rev/min
    np.testing.assert_allclose(evaluated.trace["shaft.angle"], np.arange(17) * np.pi / 4, rtol=1e-15)
    assert evaluated.trace["shaft.velocity"][-1] == evaluated.trace.parameter("shaft.speed")


@pytest.mark.parametrize(
    ("taken", "expected"),
    [
        (50, "ran 1 of 1 FMUs, 50 steps each: 50 FMU steps instead of 100, 2 times fewer"),
        (100, "ran 1 of 1 FMUs, 100 steps each; nothing skipped"),
        (108, "ran 1 of 1 FMUs, 108 steps each: 108 FMU steps instead of 100, 8 % more"),
    ],
)
def test_what_a_grid_saves_or_costs_is_reported(taken: int, expected: str) -> None:
    whole = SimpleNamespace(instances={"a": 1}, steps=100)
    plan: Any = SimpleNamespace(
        scene=whole,
        pruned=SimpleNamespace(scene=whole, skipped=()),
        grid=SimpleNamespace(steps=taken),
    )
    assert explained(plan) == (expected,)
