"""Both rapiers of a loom: what `both_rapiers` adds, how it is wired, and what both take from the shaft."""

import re
from typing import Any

import numpy as np
import pytest
import scene_texts as texts

import loomfmu
from loomfmu import LoomfmuError
from loomfmu.components.weft_insertion import WeftInsertion
from loomfmu.cosim.scenes.scene import Scene

TIMES = {"revolutions": 1, "steps_per_revolution": 180}
BOTH = 'both_rapiers = true\ntaker_head = "G6300 right"'


def parsed(both: str = BOTH, rest: str = "", **overrides: Any) -> Scene:
    return texts.parsed(texts.LOOM, both, "\n", rest, **TIMES | overrides)


def test_the_taker_is_wired_as_the_giver_is() -> None:
    scene = parsed()
    wires = {".".join(wire.sink): ".".join(wire.source) for wire in scene.wires}
    for name in ("travel", "velocity", "acceleration"):
        assert wires[f"belt.{name}"] == f"weft.{name}"
        assert wires[f"belt_2.{name}"] == f"weft_2.{name}"
        assert wires[f"transfer.giver_{name}"] == f"weft.{name}"
        assert wires[f"transfer.taker_{name}"] == f"weft_2.{name}"
    assert wires["weft_2.shaft_angle"] == "shaft.angle"
    values = {name: each.effective() for name, each in scene.instances.items()}
    assert (values["belt"]["taker"], values["belt_2"]["taker"]) == (False, True)
    assert (values["belt"]["head_mass"], values["belt_2"]["head_mass"]) == (0.1105, 0.107)
    assert (values["weft"]["moving_mass"], values["weft_2"]["moving_mass"]) == (0.1105, 0.107)
    assert values["transfer"]["separation"] == pytest.approx(3.6 + 2 * 0.243, rel=1e-15)
    assert scene.notes == ()


def test_one_rapier_is_as_before() -> None:
    assert list(parsed("").instances) == ["shaft", "weft", "belt"]
    assert list(parsed("both_rapiers = false").instances) == ["shaft", "weft", "belt"]


def test_two_belts_on_one_weft_insertion_both_follow_it() -> None:
    scene = parsed("", '[belt_2]\nmachine = "WL680-3600"\nhead = "G6300 left"\n')
    assert {wire.source[0] for wire in scene.wires if wire.sink == ("belt_2", "travel")} == {"weft"}


def test_one_weft_pulls_at_both_belts() -> None:
    wires = {wire.sink: wire.source for wire in parsed(f"{BOTH}\nyarn = true").wires}
    for belt in ("belt", "belt_2"):
        assert wires[belt, "yarn_tension"] == ("yarn", "tension")
    assert wires["yarn", "travel"] == ("weft", "travel")


def test_each_belt_has_its_own_motion() -> None:
    scene = parsed(f"{BOTH}\nbelt_motion = true")
    wires = {wire.sink: wire.source for wire in scene.wires}
    for number, (taker, mass) in {"": (False, 0.1105), "_2": (True, 0.107)}.items():
        assert wires[f"belt_motion{number}", "travel"] == (f"weft{number}", "travel")
        values = scene.instances[f"belt_motion{number}"].effective()
        assert (values["taker"], values["head_mass"]) == (taker, mass)
    assert scene.notes == ()


def test_heads_differ_between_the_rapiers_without_a_warning_but_not_within_one() -> None:
    (note,) = parsed(belt_2__head="GS900 right").notes
    assert note == (
        "the loom mixes heads: weft_2 has G6300 right and belt_2 has GS900 right;"
        " head = NAME sets all of them"
    )
    (note,) = parsed(weft_2__machine="WL450-3600").notes
    assert note.startswith("the loom mixes machines: weft has WL680-3600, belt has WL680-3600, weft_2 has")


@pytest.mark.parametrize(("head", "notes"), [("GS900 right", 0), ("G6300 left", 1)])
def test_a_rapier_is_what_is_wired_together_whatever_it_is_called(head: str, notes: int) -> None:
    weft, belt = (
        {"component": "WeftInsertion", "head": "GS900 right"},
        {"component": "BeltMonitor", "head": head},
    )
    tables = (
        texts.table(name, machine="WL680-3600", **given)
        for name, given in (("second", weft), ("its_belt", belt))
    )
    motion = {f"its_belt__{each}": f"second.{each}" for each in ("travel", "acceleration")}
    found = texts.parsed(texts.LOOM, *tables, "[wires]\n", texts.wires(**motion)).notes
    start = "the loom mixes heads: second has GS900 right and its_belt has G6300 left;"
    assert [note.startswith(start) for note in found] == [True] * notes


def test_machine_and_head_set_both_rapiers() -> None:
    scene = parsed(machine="WL450-5400", head="GS900 left")
    assert scene.notes == ()
    masses = [scene.instances[name].values["head_mass"] for name in ("belt", "belt_2")]
    assert masses == [0.1222, 0.1222]
    assert scene.instances["transfer"].values["separation"] == pytest.approx(5.4 + 2 * 0.322, rel=1e-15)


@pytest.mark.parametrize(
    ("both", "message"),
    [
        (
            'taker_head = "G6300 right"',
            "loom.taker_head needs the second rapier: set loom.both_rapiers = true",
        ),
        ('both_rapiers = "yes"', "loom.both_rapiers = 'yes' must be true or false"),
        ("both_rapier = true", "loom.both_rapier is unknown; did you mean 'both_rapiers'?"),
        ('both_rapiers = true\ntaker_head = "G6300"', "there is no head 'G6300'"),
    ],
)
def test_what_is_wrong_is_said(both: str, message: str) -> None:
    with pytest.raises(LoomfmuError, match=re.escape(message)):
        parsed(both)


DRIVEN = """
[shaft]
component = "DrivenShaft"
torque_slope = 0
inertia = "5 kg.m2"
[weft]
belt_mass = "0.06 kg/m"
wheel_inertia = "0.03 kg.m2"
[weft_2]
belt_mass = "0.05 kg/m"
wheel_inertia = "0.02 kg.m2"
lead = "5 deg"
[[claims]]
kind = "energy_balance"
"""


def test_both_drives_are_in_the_energy_of_a_free_shaft(fmu_cache: None) -> None:
    # without a motor the energy of shaft and both rapiers stays: it gives the velocity at any angle
    scene = parsed(rest=DRIVEN, coupling="iterated")
    values = ["shaft.velocity", "shaft.angle", "shaft.load_torque", "shaft.load_work"]
    result = loomfmu.evaluate(scene, values=values)
    (balance,) = result.claims
    assert balance, balance
    trace = result.trace
    torques = trace["weft.shaft_torque"] + trace["weft_2.shaft_torque"]
    # the loop converges to 1e-12 of each wire
    np.testing.assert_allclose(trace["shaft.load_torque"], torques, atol=2e-12 * np.max(np.abs(torques)))
    inertia = np.full(len(trace.time), 5.0)
    for name in ("weft", "weft_2"):
        given = scene.instances[name].effective()
        known = set(WeftInsertion.__dataclass_fields__)
        weft = WeftInsertion(**{key: value for key, value in given.items() if key in known})
        weft.follow_shaft, weft.speed = False, 1.0
        assert weft.initialize(0.0) == 0
        radius = 0.5 * weft.wheel_diameter
        mass = weft.moving_mass + weft.belt_mass * weft.belt_length + weft.wheel_inertia / radius**2
        for row, angle in enumerate(trace["shaft.angle"]):
            assert weft.step(float(angle), 0.0) == 0
            inertia[row] += mass * weft.velocity**2
    exact = trace["shaft.velocity"][0] * np.sqrt(inertia[0] / inertia)
    # the loop converges to 1e-12 of each wire, in each of 180 steps
    np.testing.assert_allclose(trace["shaft.velocity"], exact, rtol=1e-10)
    assert np.ptp(exact) > 0.1 * exact[0]  # the rapiers do brake the shaft
