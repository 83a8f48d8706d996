"""Damaged scenes and weaves, and scenes written to do harm."""

import random
from collections.abc import Callable
from pathlib import Path

import pytest
from hostile import attacked, damaged, few_and_many, guarded, revalued

from loomfmu import LoomfmuError
from loomfmu.cosim.reading import checked_claims
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.ssp import export as ssp
from loomfmu.loom import weave

SIMS = Path(__file__).parents[2] / "sims"
Reader = Callable[[Path], object]
LOOM = '[loom]\nmachine = "WL680-3600"\nhead = "G6300 left"\nweave = "10/01/10/01"\n'
MANY = 3000


def read(path: Path) -> None:
    """All that is done with a scene before its first step, and its way into a package."""
    scene = checked_claims(scenes.load(path)).scene
    if len(scene.instances) < 100:
        ssp.contents(scene, "live")


@few_and_many
@pytest.mark.parametrize(
    ("name", "files", "read", "revalues", "damages"),
    [("scenes", "*.toml", read, 0.7, 0.5), ("weaves", "weaves/*.wif", weave.read_wif, 0.5, 0.7)],
)
def test_damaged_files_are_read_or_refused_in_one_line(
    tmp_path: Path, name: str, files: str, read: Reader, revalues: float, damages: float, count: int
) -> None:
    found = sorted(SIMS.glob(files))

    def make(chance: random.Random, number: int) -> Path:
        content = chance.choice(found).read_bytes()
        if chance.random() < revalues:
            content = revalued(content.decode(), chance).encode()
        path = tmp_path / f"{number % 4}{found[0].suffix}"
        path.write_bytes(damaged(content, chance) if chance.random() < damages else content)
        return path

    attacked(name, make, read, count)


DEEP = "its tables or lists are nested more than 50 deep"
HOSTILE = {
    "lists": (f"record = {'[' * 5000}{']' * 5000}\n{LOOM}", DEEP),
    "dotted keys": (f"{LOOM}[wires]\n{'.'.join(['a'] * 3000)} = 1\n", DEEP),
    "dotted title": (f"title{'.a' * 3000} = 1\n{LOOM}", DEEP),
    "claims": (f"claims = [{{{'a.' * 3000}b = 1}}]\n{LOOM}", DEEP),
    "title": (f'title = "a\\u0000b"\n{LOOM}', "title contains the control character U+0000; remove it"),
    "escape": (f'[x]\n"\\u001b[1m" = 1\n{LOOM}', "a key contains the control character U+001B; remove it"),
    "no text": (f"title = {{a = 1}}\n{LOOM}", "title = {'a': 1} is not a text in quotes"),
    "long title": (f'title = "{"a" * 200_000}"\n{LOOM}', "title has 200000 characters; at most 1000"),
    "long key": (f"{LOOM}[belt]\n{'a' * 200_000} = 1\n", "a key has 200000 characters; at most 1000"),
    "400 digits": (f"revolutions = {'1' * 400}\n{LOOM}", "... is outside [1e-09, "),
    "5000 digits": (f"revolutions = {'1' * 5000}\n{LOOM}", "a number has too many digits"),
    "whole number": (
        f'{LOOM}[shaft]\nripple_order = "{"1" * 5000}"\n',
        "ripple_order = inf is not a finite number",
    ),
    "quantity": (f'{LOOM}[shaft]\nspeed = "{"1" * 100_000} x y"\n', "... is not a quantity such as"),
    "nan": (f'{LOOM}[inputs]\nbelt.guide_clearance = [[nan, "1 mm"]]\n', "nan is not within 1e+09"),
    "inf": (f'{LOOM}[inputs]\nbelt.guide_clearance = [[inf, "1 mm"]]\n', "inf is not within 1e+09"),
    "two lines": (f'{LOOM}[belt]\n"a\\nb" = 1\n', "belt.a\\nb is unknown"),
    "name": (f'{LOOM}[motor]\nfmu = "a\\u0000b"\n', "motor.fmu contains the control character U+0000"),
    "healds": (
        f'{LOOM}[[claims]]\nkind = "rapier_in_open_shed"\nhead_height = "18 mm"\nhealds = 5\n',
        "claim 'rapier_in_open_shed': healds = 5 must be a list of names, such as [\"heald_1\"]",
    ),
}


@pytest.mark.parametrize("case", HOSTILE)
def test_a_hostile_scene_is_refused_in_one_line(tmp_path: Path, case: str) -> None:
    text, said = HOSTILE[case]
    (tmp_path / "hostile.toml").write_text(text)
    with pytest.raises(LoomfmuError) as refused, guarded():
        read(tmp_path / "hostile.toml")
    assert said in str(refused.value) and str(refused.value).isprintable()


@pytest.mark.parametrize(
    "text",
    [
        "".join(f"[shaft_{number}]\n" for number in range(MANY)),
        '[weft]\nmachine = "WL680-3600"\n' + "".join(f"[weft_{number}]\n" for number in range(MANY)),
        "".join(f'[own{number}]\ncomponent = "WeftInsertion"\n' for number in range(MANY)),
    ],
)
def test_thousands_of_instances_are_read(tmp_path: Path, text: str) -> None:
    (tmp_path / "many.toml").write_text(text)
    with guarded():
        assert len(scenes.load(tmp_path / "many.toml").instances) == MANY + 1
