"""Scenes written with other values: the same scene when they are read again."""

import shutil
from pathlib import Path

import pytest

import loomfmu
from loomfmu import LoomfmuError
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.studies import rewritten
from loomfmu.units import Si

SIMS = Path(__file__).parents[2] / "sims"


@pytest.mark.parametrize("name", sorted(path.name for path in SIMS.glob("*.toml")))
def test_every_scene_is_the_same_with_its_own_text(name: str, tmp_path: Path) -> None:
    scene = scenes.load(SIMS / name)
    assert rewritten.rewritten(scene, {}) == scene.text


def test_values_heads_and_choices_go_where_the_scene_has_them(tmp_path: Path) -> None:
    values = {"head": "GS900 left", "dobby.law": "uniform", "shaft.speed": Si(70.1), "heald.stroke": "90 mm"}
    scene = scenes.load(SIMS / "wl680_3600.toml", {"revolutions": 2})
    path = rewritten.write(scene, values, tmp_path / "best.toml")
    again = loomfmu.prepare(path).scene
    assert again.periods == 2 and again.instances["shaft"].effective()["speed"] == 70.1
    assert again.instances["heald_3"].effective()["stroke"] == 0.09
    assert 'head = "GS900 left"' in path.read_text() and "# a new belt: length factor 0.8" in path.read_text()


def test_what_a_scene_names_is_found_from_another_folder(tmp_path: Path) -> None:
    shutil.copytree(SIMS / "weaves", tmp_path / "weaves")
    source = shutil.copy(SIMS / "twill.toml", tmp_path)
    (tmp_path / "deep").mkdir()
    assert rewritten.write(scenes.load(source), {}, tmp_path / "again.toml").exists()
    moved = rewritten.write(scenes.load(source), {}, tmp_path / "deep" / "own.toml")
    assert 'weave = "../weaves/twill_2_2.wif"' in moved.read_text()
    assert scenes.load(moved).instances["heald_1"].values == scenes.load(source).instances["heald_1"].values
    component = rewritten._moved(
        '[a]\ncomponent = "own/cam.py:Cam"\n[b]\nfmu = "/m.fmu"\n', tmp_path, moved.parent
    )
    assert component == '[a]\ncomponent = "../own/cam.py:Cam"\n[b]\nfmu = "/m.fmu"\n'
    more = '[[claims]]\nkind = "own.py:Gap"\n[[claims]]\nkind = "dwell"\n'
    more += '[tolerances]\n"a.b" = { measured = "c.csv" }\n"a.c" = [0, 1]\n'
    files = rewritten._moved(more, tmp_path, moved.parent)
    assert files == more.replace("own.py", "../own.py").replace("c.csv", "../c.csv")
    with pytest.raises(LoomfmuError, match="is an input of this command"):
        scene = scenes.load(SIMS / "wl680_3600.toml")
        rewritten.write(scene, {}, SIMS / "wl680_3600.toml")


def test_an_accuracy_replaces_steps_and_numbers_of_the_command_line_are_numbers(tmp_path: Path) -> None:
    path = rewritten.write(
        scenes.load(SIMS / "wl680_3600.toml", {"accuracy": "1e-3"}), {}, tmp_path / "accurate.toml"
    )
    again = scenes.load(path)
    assert again.accuracy == 1e-3 and "steps_per_revolution" not in path.read_text()
    back = rewritten.write(scenes.load(path, {"steps_per_revolution": "90"}), {}, tmp_path / "steps.toml")
    assert "\nsteps_per_revolution = 90\n" in back.read_text() and scenes.load(back).accuracy is None
