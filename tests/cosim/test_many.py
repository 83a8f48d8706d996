"""Many runs at once: each is that of `evaluate`, to the last bit, whether it was run in C or by itself."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scene_texts import SAFE, claim, loom, parsed, table, unsolved

from loomfmu import LoomfmuError, Prepared, prepare
from loomfmu.cosim import composed
from loomfmu.cosim import rows as rows_in_c
from loomfmu.cosim.many import Rows
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.traces import Verdict
from loomfmu.units import Si

SIMS = Path(__file__).parents[2] / "sims"
# whose rows are run in C, all but those that are near a bound
IN_C = (
    "belt_alone",
    "both_rapiers",
    "damper",
    "satin",
    "spline_cam",
    "start_up",
    "weft_tension",
    "wl680_3600",
)
RANGES = {
    "shaft.speed": (58.0, 71.0),
    "belt.guide_clearance": (2e-4, 1.3e-3),  # beyond 1 mm it warns
    "belt.bending_stiffness": (0.1, 0.3),
    "belt.head_mass": (0.09, 0.13),
}
MARGIN = claim("lowest_margin", name="margin", bound=0.1)


def belt(*more: str, **values: Any) -> Scene:
    keys = "steps_per_revolution = 90\nrevolutions = 1\n"
    return parsed(keys, loom(table("shaft", speed="600 rpm"), MARGIN, SAFE, *more), **values)


def drawn(ranges: Mapping[str, tuple[float, float]], count: int, seed: int = 1) -> dict[str, Any]:
    generator = np.random.default_rng(seed)
    return {key: generator.uniform(*ends, count) for key, ends in ranges.items()}


def row_of(values: Mapping[str, Sequence[Any]], row: int) -> dict[str, Any]:
    single = {key: given[row] for key, given in values.items()}
    return {key: Si(each) if isinstance(each, float) else each for key, each in single.items()}


def shown(verdicts: Sequence[Verdict]) -> list[list[str]]:
    """All that verdicts say, texts because of NaN."""
    return [[repr(getattr(each, field.name)) for field in fields(each)] for each in verdicts]


def checked(
    found: Prepared, values: Mapping[str, Any], signals: Sequence[str] = (), errors: Any = "near"
) -> Rows:
    """The rows, each compared with `evaluate`."""
    many = found.evaluate_many(values, errors=errors)
    for row in range(len(many)):
        try:
            one = found.evaluate(row_of(values, row), errors=errors)
        except LoomfmuError as error:
            assert str(many.errors[row]) == str(error)
            assert np.all(np.isnan(many.worst[row])) and np.all(many.codes[row] < 0)
            continue
        assert shown(many.verdicts(row)) == shown(one.claims)
        assert (many.near(row), many.warnings(row)) == (one.near, one.warnings)
        assert str(many.worst[row].tolist()) == str([each.worst for each in one.claims])
        assert str(many.distance[row].tolist()) == str([each.distance for each in one.claims])
        assert [("holds", "FAILS", "undecided")[code] for code in many.codes[row]] == [
            each.word for each in one.claims
        ]
        for signal in signals:
            assert many.values[signal][row] == one.trace[signal][-1]
    return many


def test_rows_of_a_belt_are_those_of_single_runs() -> None:
    """Warnings, values near a bound and others; the last values of signals of each type as well."""
    signals = ["belt.lowest_margin", "belt.at_risk", "belt.buckled"]
    with prepare(belt(), values=signals) as found:
        many = checked(found, drawn(RANGES, 60), signals)
        assert not many.errors
        assert any(many.warnings(row) for row in range(60))
        assert 60 > len(many.single) > 0


def test_verdicts_near_their_bounds_are_exact_in_c_too() -> None:
    """By the mechanisms' own functions, which need no coarser steps."""
    ranges = {key: RANGES[key] for key in ("shaft.speed", "belt.bending_stiffness")}
    window = claim("above", signal="belt.margin", bound=0.2, window=["90 deg", "270 deg"])
    for scene in (belt(), belt(window)):
        with prepare(scene) as found:
            many = checked(found, drawn(ranges, 40))
            assert any(map(many.near, range(40))) and not many.single


def test_rows_whose_steps_are_divided_as_often_as_may_be_are_those_of_single_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for place in (composed, rows_in_c):
        monkeypatch.setattr(place, "MOST", 400)  # 181 samples, and 31 steps in eight parts
    with prepare(belt()) as found:
        many = checked(found, drawn({"shaft.speed": RANGES["shaft.speed"]}, 10), errors="none")
        assert len(many.single) == 10


def test_only_what_a_value_reaches_runs_again() -> None:
    """The rows of a belt alone, whose weft insertion runs once."""
    with prepare(belt(), values=["weft.travel", "belt.margin"]) as found:
        ranges = {key: ends for key, ends in RANGES.items() if key != "shaft.speed"}
        many = checked(found, drawn(ranges, 20), ["weft.travel", "belt.margin"])
        assert len(many.single) < 20


def test_refused_rows_say_what_a_single_run_says() -> None:
    """The first one included; a zero with a sign, which an inherited value loses, is run by itself."""
    values = {"belt.guide_clearance": np.array([-1.0, 2e-4, 3e-4, np.nan, 4e-4, -0.0])}
    with prepare(belt()) as found:
        many = checked(found, values, errors="none")
        assert sorted(many.errors) == [0, 3]
        assert list(many.single) == [5]
        assert list(checked(found, {"shaft.speed": [60.0, 0.0, 61.0, 62.0, 63.0]}).errors) == [1]


def test_an_fmu_refuses_single_rows() -> None:
    """The first one included: its four-bar does not close."""
    with prepare(belt()) as found:
        many = checked(found, {"weft.coupler_length": np.linspace(0.5, 0.24, 8)}, errors="none")
        assert 0 in many.errors
        assert len(many.single) == 0 < len(many.errors) < 8


def test_a_claim_refuses_single_rows() -> None:
    """Half the stroke times the ratio must be above the clearance."""
    parts = (
        'weave = "10/01"\n',
        claim("clear_shed", heald="heald_1", clearance="6 mm", at_least="1 deg"),
    )
    with prepare(belt(*parts)) as found:
        many = checked(found, {"heald_1.stroke": np.linspace(0.02, 0.1, 8)}, errors="none")
        assert 0 < len(many.errors) < 8


def test_names_and_switches_make_groups() -> None:
    """A row is run in C with those that share all that is no number."""
    law = ["plateau", "sloped_sine"] * 8
    values = {"dobby.law": law, "shaft.speed": np.linspace(58.0, 66.0, 16)}
    dwell = claim("dwell", heald="heald_1", at_least="20 deg", lifted_by="frame")
    with prepare(belt('weave = "10/01"\n', dwell)) as found:
        many = checked(found, values, errors="none")
        assert not many.single
        machines = {"machine": ["WL680-3600", "WL450-3600"] * 5, "shaft.speed": np.linspace(40.0, 44.0, 10)}
        assert not checked(found, machines, errors="none").single


def test_driven_inputs_repeat_in_each_row() -> None:
    table_ = '[inputs]\n"belt.yarn_tension" = [[0, 0], [0.31, "2 N"], [1, 0]]\n'
    with prepare(belt(table_)) as found:
        ranges = {"belt.head_mass": (0.09, 0.13)}
        assert len(checked(found, drawn(ranges, 12)).single) < 12
        assert not checked(found, drawn({"shaft.speed": (58.0, 66.0)}, 5)).errors  # the steps meet other rows


@pytest.mark.parametrize(
    ("scene", "why"),
    [
        (lambda folder: parsed(unsolved(0.5, 0.6)), "the wires close a loop"),
        (lambda folder: belt(accuracy=0.01), "the steps are chosen anew"),
    ],
)
def test_scenes_that_are_run_row_by_row_say_why(scene: Any, why: str, tmp_path: Path) -> None:
    assert why in prepare(scene(tmp_path))._base.rows.unfit


def test_live_fmus_run_row_by_row() -> None:
    with prepare(belt(), flavour="live") as found:
        assert "no native FMU" in found._base.rows.unfit
        assert len(checked(found, {"belt.head_mass": [0.1, 0.11, 0.12, 0.13]}).single) == 4


def test_values_that_are_no_columns_are_refused() -> None:
    with prepare(belt()) as found:
        for wrong in ([], [{"shaft.speed": 60.0}]):
            with pytest.raises(LoomfmuError, match="the values must be a mapping, not list"):
                found.evaluate_many(wrong)  # type: ignore[arg-type]
        with pytest.raises(LoomfmuError, match=r"differ in number: 2 of shaft\.speed, 1 of belt\.head_mass"):
            found.evaluate_many({"shaft.speed": [60.0, 61.0], "belt.head_mass": [0.1]})
        with pytest.raises(LoomfmuError, match=r"shaft\.speed = '600 rpm' is not a sequence"):
            found.evaluate_many({"shaft.speed": "600 rpm"})


def around(found: Prepared, count: int, seed: int) -> dict[str, Any]:
    """Values of the shaft's speed and of three other parameters with an effect, about those of the scene."""
    generator = np.random.default_rng(seed)
    known = {
        f"{name}.{port.name}": float(instance.effect(port.name) or 0.0)
        for name, instance in found.scene.instances.items()
        for port in instance.fmu.ports.values()
        if port.causality == "parameter" and port.kind == "Real"
        if found._base.rows.takes(f"{name}.{port.name}")
    }
    keys = [key for key, value in known.items() if value]
    chosen = dict.fromkeys(["shaft.speed", *generator.permutation(keys)[:3].tolist()])
    return {key: known[key] * generator.uniform(0.85, 1.05, count) for key in chosen if key in known}


@pytest.mark.slow
@pytest.mark.parametrize("name", IN_C)
def test_rows_of_scenes_are_those_of_single_runs(name: str) -> None:
    """125 rows of each of eight scenes, which makes 1,000."""
    with prepare(SIMS / f"{name}.toml") as found:
        for seed in range(5):
            checked(found, around(found, 25, seed), errors="none")
