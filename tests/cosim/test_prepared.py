"""Prepared scenes: results and refusals are those of a scene that is read anew, whatever came before."""

import pickle
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foreign_motors import motor2
from motor_scenes import MOTOR

import loomfmu
from loomfmu import Evaluation, LoomfmuError, evaluate, prepare, run
from loomfmu.cosim import prepared
from loomfmu.cosim.importing import pool
from loomfmu.cosim.planning.requested import Requested
from loomfmu.cosim.scenes import scene as scenes

DEMO = Path(__file__).parents[2] / "sims" / "wl680_3600.toml"
SHORT: dict[str, Any] = {"revolutions": 2, "steps_per_revolution": 90}
# values alone, and what changes the wiring, the pattern, the steps or what a scene warns of
VALUES: list[dict[str, Any]] = [
    {"shaft.speed": "650 rpm"},
    {"shaft.speed": "650 rpm", "belt.guide_clearance": "0.6 mm"},
    {"heald.stroke": "110 mm", "heald_2.stroke": "120 mm"},
    {"heald_2.stroke": "120 mm", "heald.stroke": "110 mm"},
    {"dobby.law": "plateau", "damper_1.free_travel": "12 mm"},
]
OTHERS: list[dict[str, Any]] = [
    {"machine": "WL450-3600", "shaft.speed": "420 rpm"},
    {"heald_1.pattern": "1100", "shaft.speed": "500 rpm"},
    {"revolutions": 2},
    {"steps_per_revolution": 720},
    {"shaft.ramp_duration": "20 ms"},
    {"weft.follow_shaft": False, "weft.speed": "300 rpm"},
]


def same(one: Evaluation, other: Evaluation) -> None:
    """Both are equal to the last bit, in all that they say."""
    # texts too: of NaN only these are equal
    assert [str(each.as_dict()) for each in one.claims] == [str(each.as_dict()) for each in other.claims]
    assert (one.warnings, one.skipped, one.steps) == (other.warnings, other.skipped, other.steps)
    assert list(one.scene.overrides.items()) == list(other.scene.overrides.items())
    assert {name: each.values for name, each in one.scene.instances.items()} == {
        name: each.values for name, each in other.scene.instances.items()
    }
    assert list(one.trace) == list(other.trace)
    for signal in ("time", *one.trace):
        ours, theirs = (each.time if signal == "time" else each[signal] for each in (one.trace, other.trace))
        np.testing.assert_array_equal(ours, theirs, strict=True)


def anew(given: dict[str, Any]) -> Evaluation:
    """With what is set before first, as `prepare` has it."""
    return evaluate(DEMO, set={key: each for key, each in SHORT.items() if key not in given} | given)


@pytest.fixture(scope="module")
def loom() -> Iterator[loomfmu.Prepared]:
    with prepare(DEMO, set=SHORT) as made:
        yield made


@pytest.mark.parametrize("given", [*VALUES, *OTHERS], ids=str)
def test_results_are_those_of_a_scene_that_is_read_anew(
    loom: loomfmu.Prepared, given: dict[str, Any]
) -> None:
    wanted = anew(given)
    same(loom.evaluate(given), wanted)
    same(loom.evaluate(), anew({}))
    same(loom.evaluate(given), wanted)


def test_values_alone_are_not_read_anew(loom: loomfmu.Prepared, monkeypatch: pytest.MonkeyPatch) -> None:
    loom.evaluate(VALUES[0])

    def refused(*_arguments: Any) -> None:
        raise AssertionError("the scene is read")

    monkeypatch.setattr(prepared, "requested", refused)
    for given in VALUES:
        loom.evaluate(given)


@pytest.mark.parametrize(
    "given",
    [
        {"belt.guide_clearance": "3 m"},
        {"belt.guide_clearance": "1 N"},
        {"belt.guide_clearence": "1 mm"},
        {"belt.travel": "1 mm"},
        {"belt.margin": 1.0},
        {"shaft.speed": 0.0},
        {"shaft.speed": "-600 rpm"},
        {"shaft.speed": "-600 rpm", "heald_1.stroke": "no"},
        {"machine": "WL1"},
        {"revolutions": 0.5001},
        {"reed.crank_length": 1.0},
        {"shaft.speed": float("nan")},
        {"dobby.gear_ratio": 0.0},
    ],
    ids=str,
)
def test_refusals_are_those_of_a_scene_that_is_read_anew(
    loom: loomfmu.Prepared, given: dict[str, Any]
) -> None:
    with pytest.raises(LoomfmuError) as read_anew:
        anew(given)
    with pytest.raises(LoomfmuError) as prepared:
        loom.evaluate(given)
    assert str(prepared.value) == str(read_anew.value).removeprefix(f"{DEMO}: ")
    same(loom.evaluate(), anew({}))


def test_a_number_that_was_probably_meant_in_another_unit_is_refused(loom: loomfmu.Prepared) -> None:
    doubt = "shaft.speed = 600 is read as 600 rad/s = 5729.578 rev/min"
    with pytest.raises(
        LoomfmuError, match=f'^{doubt}; write "600 rev/min" if that is meant, else the unit as well$'
    ):
        loom.evaluate({"shaft.speed": 600})
    assert loom.evaluate({"shaft.speed": 62.0}).claims[0].holds
    with prepare(DEMO, set=SHORT | {"shaft.speed": 600}) as doubted:  # which says so once, not in a loop
        assert any(
            note.startswith(doubt) for note in doubted.evaluate({"belt.guide_clearance": 3e-4}).warnings
        )


def test_what_is_not_a_dictionary_is_refused(loom: loomfmu.Prepared) -> None:
    with pytest.raises(LoomfmuError, match=r"set = 3 is not a dictionary"):
        loom.evaluate(3)  # type: ignore[arg-type]
    with pytest.raises(LoomfmuError, match=r"values = 3 is not a list"):
        prepare(DEMO, values=3)  # type: ignore[arg-type]


def test_earlier_results_stay_as_they_are(loom: loomfmu.Prepared) -> None:
    first = loom.evaluate(VALUES[0])
    kept = {signal: first.trace[signal].copy() for signal in first.trace}
    loom.evaluate(VALUES[1])
    loom.evaluate({"revolutions": 2})
    for signal, values in kept.items():
        np.testing.assert_array_equal(first.trace[signal], values)
    assert first.trace.parameter("shaft.speed") == pytest.approx(68.068, rel=1e-4)
    again = loomfmu.judge(first.trace, kind="peak_load", damper="damper_1", at_most="9 kN")
    assert again.worst == first.claims[5].worst


def test_a_recorded_run_is_that_of_run(loom: loomfmu.Prepared, tmp_path: Path) -> None:
    found = loom.run(VALUES[1], output=tmp_path / "prepared.h5")
    wanted = run(DEMO, set=SHORT | VALUES[1], output=tmp_path / "run.h5")
    assert found.claims == wanted.claims
    for signal in wanted.trace:
        np.testing.assert_array_equal(found.trace[signal], wanted.trace[signal])
    assert dict(found.trace.attributes) == dict(wanted.trace.attributes)
    same(loom.evaluate(), anew({}))


def test_threads_take_turns(loom: loomfmu.Prepared) -> None:
    wanted = [loom.evaluate(given).claims for given in VALUES]
    found: dict[int, Any] = {}

    def work(place: int) -> None:
        for _ in range(3):
            found[place] = loom.evaluate(VALUES[place]).claims

    threads = [threading.Thread(target=work, args=(place,)) for place in range(len(VALUES))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [str(found[place]) for place in range(len(VALUES))] == [str(each) for each in wanted]


def test_a_copy_is_prepared_where_it_is_loaded(loom: loomfmu.Prepared) -> None:
    copied = pickle.loads(pickle.dumps(loom))
    same(copied.evaluate(VALUES[1]), anew(VALUES[1]))


def test_an_evaluation_can_be_sent_to_another_process(loom: loomfmu.Prepared) -> None:
    found = loom.evaluate(VALUES[1])
    copied = pickle.loads(pickle.dumps(found))
    assert copied.claims == found.claims and list(copied.trace) == list(found.trace)
    for signal in found.trace:
        np.testing.assert_array_equal(copied.trace[signal], found.trace[signal])
    stroke = "heald_1.stroke"
    assert copied.trace.parameter(stroke) == found.trace.parameter(stroke)
    # what is judged on it is read where it lies now, not where it lay in the other process
    assert [claim.judge(copied.trace).worst for claim in Requested(copied.scene).claims] == [
        claim.judge(found.trace).worst for claim in Requested(found.scene).claims
    ]


def test_further_signals_are_kept() -> None:
    with prepare(DEMO, set=SHORT, values=["belt.deflection"]) as loom:
        assert "belt.deflection" in loom.evaluate(VALUES[0]).trace


def test_closing_frees_the_instances_and_a_later_run_makes_new_ones() -> None:
    pool.free_all()
    with prepare(DEMO, set=SHORT) as loom:
        loom.evaluate()
        assert any(pool._resting.values())
    assert not any(pool._resting.values())
    same(loom.evaluate(), anew({}))


@pytest.mark.parametrize("isolated", [True, False])
def test_each_run_has_a_new_instance_of_a_third_party_fmu(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, isolated: bool
) -> None:
    motor2(tmp_path)
    made: list[str] = []
    borrow = pool.borrow
    monkeypatch.setattr(
        "loomfmu.cosim.master.master.borrow", lambda *each: made.append(each[1]) or borrow(*each)
    )
    text = f"isolated = {str(isolated).lower()}\n" + MOTOR
    loom = prepare(scenes.parse(text, directory=tmp_path), values=["motor.flange_w"])
    first = loom.evaluate().trace["motor.flange_w"]
    for _ in range(2):
        np.testing.assert_array_equal(loom.evaluate().trace["motor.flange_w"], first)
    assert made == ["motor"] * 3
    assert not any(slave.name == "motor" for each in pool._resting.values() for slave in each)


def test_what_does_not_fit_in_memory_is_refused_in_one_line() -> None:
    scene = loomfmu.prepare(scenes.parse('[loom]\nmachine = "WL680-3600"\n', "long"))
    with pytest.raises(
        LoomfmuError, match=r"^long: \d+ samples do not fit in memory; take fewer revolutions"
    ):
        scene.evaluate({"revolutions": 1e9})
