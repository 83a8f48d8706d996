"""The page in which the loom runs judges each kind of claim as a run does: verdict, value, place, note."""

import json
import math
import re
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from browser import until

import loomfmu
from loomfmu import live_page
from loomfmu.cosim.claims.claims import KINDS
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.traces import Verdict

Open = Callable[..., Any]

SIMS = Path(__file__).parents[1] / "sims"
pytestmark = [
    pytest.mark.skipif(find_spec("ziglang") is None, reason="ziglang is not installed: nothing is compiled"),
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="native FMUs are tested on Linux alone"),
]
NOWHERE = "\u2013"  # as the place of a claim
NOT_JUDGED = {"energy_balance"}  # by the page
# instances that each claim reads, beside those of which it is kept where they stay the same
OTHERS = """() => loomfmu.live.plan.claims.map(claim => {
    const { current } = loomfmu.live, read = new Set()
    const noted = look => name => { read.add(name.split(".")[0]); return look(name) }
    const [signal, parameter] = [current.signal, current.parameter].map(noted)
    loomfmu.judge({ ...current, signal, parameter, count: () => NaN })(claim)
    return [...read].filter(name => !claim.parts.includes(name)).join(" ")
})"""

# They hold, fail, have no value, or spans that the ends of the run cut off; on carriers and frames.
ON_THE_LOOM = [
    {"kind": "above", "signal": "belt.lowest_speed_limit", "bound": "shaft.speed"},
    {"kind": "below", "signal": "weft.velocity", "bound": "20 m/s", "window": ["30 deg", "150 deg"]},
    {"kind": "below", "signal": "heald_1.inertia_force", "bound": "500 N", "window": ["330 deg", "40 deg"]},
    {"kind": "lowest_margin", "bound": 0.4},
    {"kind": "lowest_margin", "belt": "belt_2", "bound": 0.99},
    {"kind": "dwell", "heald": "heald_1", "at_least": "80 deg"},
    {"kind": "dwell", "heald": "heald_1", "at_least": "80 deg", "lifted_by": "frame"},
    {"kind": "dwell", "heald": "heald_2", "at_least": "5 deg", "tolerance": 0.2},
    {"kind": "dwell", "heald": "heald_3", "at_least": "400 deg", "lifted_by": "frame"},
    {"kind": "dwell", "heald": "heald_4", "at_least": "700 deg", "tolerance": 0.49},
    {"kind": "clear_shed", "heald": "heald_1", "clearance": "10 mm", "at_least": "100 deg"},
    {"kind": "clear_shed", "heald": "heald_4", "clearance": "5 mm", "at_least": "600 deg"},
    {"kind": "dwell_contains", "heald": "heald_2", "angles": ["150 deg", "180 deg", "210 deg"]},
    {"kind": "dwell_contains", "heald": "heald_2", "angles": ["180 deg"], "lifted_by": "frame"},
    {"kind": "rapier_in_open_shed", "head_height": "17 mm"},
    {"kind": "rapier_in_open_shed", "head_height": "25 mm", "lifted_by": "frame", "healds": ["heald_2"]},
    {"kind": "reed_clear_of_rapier", "clearance": "30 mm"},
    {"kind": "locks_in_time"},
    {"kind": "peak_load", "damper": "damper_1", "at_most": "10 kN"},
    {"kind": "stop_contacts", "damper": "damper_1", "at_most": 0},
    {"kind": "heald_blows", "play": "play_1", "at_most": "0.1 m/s"},
    {"kind": "transfer_in_time", "window": ["170 deg", "190 deg"]},
    {"kind": "transfer_in_time", "window": ["100 deg", "120 deg"]},
    {"kind": "transfer_in_time", "window": ["0 deg", "360 deg"]},
    {"kind": "transfer_in_time", "window": ["100 deg", "460 deg"]},
    {"kind": "transfer_speed", "at_most": "30 m/s"},
]
ON_A_MOTOR = [
    {"kind": "motor_power", "at_most": "1 kW"},
    {"kind": "speed_fluctuation", "at_most": "5 %"},
    {"kind": "speed_fluctuation", "at_most": "5 %", "skip": 9},
    {"kind": "energy_balance"},
    {"kind": "nip_holds", "at_least": 0.5, "at_most": 4.0, "at_samples": True},
    {"kind": "nip_holds", "at_least": 3.5, "at_most": 5.0, "at_samples": True},
    {"kind": "belt_deflection", "at_most": "2 mm"},
    {"kind": "belt_deflection", "at_most": "10 mm"},
    {"kind": "above", "signal": "belt_motion.margin", "bound": -20.0, "window": ["80 deg", "120 deg"]},
    {"kind": "below", "signal": "belt_motion.deflection", "bound": "2 mm", "window": ["240 deg", "275 deg"]},
    {"kind": "below", "signal": "belt_motion.largest_deflection", "bound": "10 mm"},
    {"kind": "above", "signal": "belt.margin", "bound": 0.4},
]
MOTOR = """
title = "A shaft on its motor, a comber, a belt in motion"
revolutions = 2
steps_per_revolution = 360
[loom]
machine = "WL680-3600"
head = "G6300 left"
belt_motion = true
[belt_motion]
belt_mass = 0.05
[shaft]
component = "DrivenShaft"
speed = "400 rev/min"
[roller]
component = "DetachingRoller"
[wires]
"shaft.torque_1" = false
"shaft.torque_2" = false
"""


def with_claims(text: str, claims: list[dict[str, Any]], values: dict[str, Any] | None = None) -> Any:
    """A scene with these claims."""
    tables = ("".join(f"\n{key} = {json.dumps(each)}" for key, each in claim.items()) for claim in claims)
    return scenes.parse(text + "".join(f"\n[[claims]]{table}" for table in tables), "kinds", values, SIMS)


def test_each_kind_is_here() -> None:
    assert {claim["kind"] for claim in ON_THE_LOOM + ON_A_MOTOR} == set(KINDS)


def test_the_claims_of_a_loom(opened: Open, tmp_path: Path) -> None:
    text = (SIMS / "full_loom.toml").read_text().partition("[[claims]]")[0]
    values = {"revolutions": 2, "steps_per_revolution": 360, "shaft.ramp_duration": "0 s"}
    values["loom.weave"] = "10/01/10/01"
    agree(opened, tmp_path, with_claims(text, ON_THE_LOOM, values), 500.0)


def test_those_of_a_motor_a_comber_and_a_belt_in_motion(opened: Open, tmp_path: Path) -> None:
    agree(opened, tmp_path, with_claims(MOTOR, ON_A_MOTOR), 410.0)


def test_a_claim_that_coarser_steps_cannot_tell_is_not_judged(opened: Open, tmp_path: Path) -> None:
    """Its error was taken for 0, and the claim held, where a run says that it is undecided."""
    values = {"shaft.speed": "400 rpm", "steps_per_revolution": 1000, "revolutions": 1}
    values |= {"belt_motion.guide_end": "play", "belt_motion.head_end": "guided"}
    scene = with_claims(MOTOR, [{"kind": "belt_deflection", "at_most": "5 mm"}], values)
    with loomfmu.prepare(scene) as loom:
        assert "coarser steps give no value" in loom.evaluate({}).claims[0].note
    page = opened(live_page.write(scene, [], tmp_path / "page.html"))
    until(page, lambda: page.evaluate("Boolean(loomfmu.live.pace)"))
    (found,) = page.evaluate("loomfmu.live.verdicts")
    assert found["holds"] is None
    assert "too far apart" in found["note"]


def agree(opened: Open, tmp_path: Path, scene: Any, other: float) -> None:
    """The page says what native runs say, at the scene's own speed and at another one [rev/min]."""
    page = opened(live_page.write(scene, [], tmp_path / "page.html"))
    for speed in (None, other):
        if speed is not None:
            page.locator(".knob input[type=number]").fill(str(speed))
        until(page, lambda: page.evaluate("Boolean(loomfmu.live.pace)"))
        assert not any(page.evaluate(OTHERS))
        found = page.evaluate("loomfmu.live.verdicts")
        rows = page.locator("#claims tbody tr").evaluate_all(
            "rows => rows.map(row => [...row.cells].map(cell => cell.innerText))"
        )
        settings = {} if speed is None else {"shaft.speed": f"{speed} rpm"}
        with loomfmu.prepare(scene) as loom:
            native = loom.evaluate(settings, errors="none").claims
        for claim, mine, row, its in zip(scene.claims, found, rows, native, strict=True):
            verdict_agrees(claim, mine, row, its)


def verdict_agrees(claim: dict[str, Any], mine: dict[str, Any], row: list[str], its: Verdict) -> None:
    nothing = math.isnan(its.worst)
    judged = its.decided and claim["kind"] not in NOT_JUDGED
    assert (mine["holds"] is None) != judged, (claim, mine, its)
    if mine["holds"] is None:
        same = nothing and claim["kind"] not in NOT_JUDGED
        assert alike(mine["note"], its.note) if same else mine["note"]
        return
    assert mine["holds"] == its.holds, (mine, its)
    assert "nan" not in its.note
    assert alike(mine["note"], its.note), (mine["note"], its.note)
    word, name, *shown, place = row
    assert word.strip("✓✗ \n") == its.word
    assert its.signal in name and mine["note"] in name
    for text, value in zip(shown, (its.worst, its.bound), strict=False):
        assert alike(text, its.shown(value)), (text, its)
    assert alike(place, its.place or NOWHERE), (place, its)
    # 1e-9: edges of spans are times, sums of some 1e3 steps; blows amplify rounding
    assert mine["worst"] == pytest.approx(its.worst, rel=1e-9, abs=1e-12, nan_ok=True), (mine, its)
    assert mine["bound"] == pytest.approx(its.bound, rel=1e-14)
    if math.isfinite(its.time):
        assert mine["time"] == pytest.approx(its.time, abs=1e-8), its


def alike(one: str, other: str) -> bool:
    """Whether two texts are the same but for the last digit of their numbers."""
    number = re.compile(r"(?<![\w.])-?\d+\.?\d*(?:e[+-]\d+)?")
    values = [[float(each) for each in number.findall(text)] for text in (one, other)]
    return number.sub("#", one) == number.sub("#", other) and values[0] == pytest.approx(values[1], rel=2e-6)
