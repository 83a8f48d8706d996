"""The page in which the loom runs judges each kind of claim as a run does: value, error, place, note."""

import json
import math
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from browser import until

import loomfmu
from loomfmu import live_page
from loomfmu.cosim.claims.claims import kinds
from loomfmu.cosim.composed import Composed
from loomfmu.cosim.planning.requested import Requested
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.traces import Verdict

Open = Callable[..., Any]

SIMS = Path(__file__).parents[1] / "sims"
pytestmark = [
    pytest.mark.skipif(find_spec("ziglang") is None, reason="ziglang is not installed: nothing is compiled"),
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="native FMUs are tested on Linux alone"),
]
NOWHERE = "\u2013"  # as the place of a claim
NEARER = "it is nearer to its bound than the page can tell; loomfmu run judges it"
# They hold, fail, have no value, or spans that the ends of the run cut off; on carriers and frames.
ON_THE_LOOM = [
    {"kind": "above", "signal": "belt.lowest_speed_limit", "bound": "shaft.speed"},
    {"kind": "below", "signal": "weft.velocity", "bound": "20 m/s", "window": ["30 deg", "150 deg"]},
    {"kind": "below", "signal": "damper_1.spring_force", "bound": "9 kN", "window": ["330 deg", "40 deg"]},
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
    {"kind": "below", "signal": "heald_1.inertia_force", "bound": "500 N", "at_samples": True},
    {
        "kind": "above",
        "signal": "belt.margin",
        "bound": 0.1,
        "window": ["330 deg", "331 deg"],
        "at_samples": True,
    },
]
ON_A_MOTOR = [
    {"kind": "motor_power", "at_most": "1 kW"},
    {"kind": "speed_fluctuation", "at_most": "5 %"},
    {"kind": "speed_fluctuation", "at_most": "5 %", "skip": 9},
    {"kind": "energy_balance"},
    {"kind": "nip_holds", "at_least": 0.5, "at_most": 4.0, "at_samples": True},
    {"kind": "nip_holds", "at_least": 3.5, "at_most": 5.0, "at_samples": True},
    {"kind": "nip_holds", "at_least": 0.5, "at_most": 4.0},
    {"kind": "belt_deflection", "at_most": "2 mm"},
    {"kind": "belt_deflection", "at_most": "10 mm"},
    {"kind": "above", "signal": "belt_motion.margin", "bound": 0.1},
    {"kind": "above", "signal": "belt_motion.margin", "bound": -5.0, "window": ["80 deg", "120 deg"]},
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
torque_32 = "5 N.m"
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
    assert {claim["kind"] for claim in ON_THE_LOOM + ON_A_MOTOR} == set(kinds())


SHORT = {"revolutions": 0.6, "steps_per_revolution": 25, "shaft.ramp_duration": "0 s"}
SCENES: dict[str, tuple[Callable[[], Any], tuple[float | None, ...]]] = {  # with speeds [rev/min]
    "loom": (lambda: on_the_loom({**SHORT, "revolutions": 2, "steps_per_revolution": 180}), (None, 500.0)),
    "motor": (lambda: with_claims(MOTOR, ON_A_MOTOR), (None, 410.0)),
    "short": (lambda: on_the_loom(SHORT), (None,)),
}


def on_the_loom(values: dict[str, Any]) -> Any:
    text = (SIMS / "full_loom.toml").read_text().partition("[[claims]]")[0]
    return with_claims(text, ON_THE_LOOM, values | {"loom.weave": "10/01/10/01"})


@pytest.fixture(scope="module")
def said(
    chromium: Any, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Callable[[str, float | None], Any]]:
    """Return the words of a page at a speed, None for its own, beside those of a run: made once."""
    pages: dict[str, Any] = {}
    known: dict[tuple[str, float | None], Any] = {}

    def of(name: str, speed: float | None) -> Any:
        if (name, speed) not in known:
            scene = SCENES[name][0]()
            if name not in pages:
                path = live_page.write(scene, [], tmp_path_factory.mktemp(name) / "page.html")
                pages[name] = chromium.new_page()
                pages[name].goto(path.as_uri())
            known[name, speed] = both(pages[name], scene, speed)
        return known[name, speed]

    yield of
    for page in pages.values():
        page.close()  # its loom would turn until the last test


def both(page: Any, scene: Any, speed: float | None) -> list[tuple[dict[str, Any], list[str], Verdict]]:
    if speed is not None:
        until(page, lambda: page.evaluate("Boolean(loomfmu.live.pace)"))
        page.locator(".knob input[type=number]").fill(str(speed))
    until(page, lambda: page.evaluate("Boolean(loomfmu.live.pace)"))
    rows = page.locator("#claims tbody tr").evaluate_all(
        "rows => rows.map(row => [...row.cells].map(cell => cell.innerText))"
    )
    settings = {} if speed is None else {"shaft.speed": f"{speed} rpm"}
    with loomfmu.prepare(scene) as loom:
        found = loom.evaluate(settings, errors="all")
    # the page judges between its samples, the run by the mechanisms' own functions where it can
    exact = Composed(requested := Requested(found.scene), requested.claims).claims
    native = [*found.claims]
    for number, claim in exact.items():
        sampled = claim.judge(found.trace)
        off = 3.0 * abs(sampled.worst - found.claims[number].worst)  # at least: the factor of coarser steps
        native[number] = replace(sampled, error=max(off, sampled.between))
    return list(zip(page.evaluate("loomfmu.live.verdicts"), rows, native, strict=True))


LATER = [("motor", None), ("loom", 500.0)]  # of two speeds one is slow: a knob is turned on the motor
CASES = [
    pytest.param(
        name,
        speed,
        number,
        id=f"{name}-{speed or 'own'}-{number}-{claim['kind']}",
        marks=[pytest.mark.slow] if (name, speed) in LATER else [],
    )
    for name, claims in (("loom", ON_THE_LOOM), ("motor", ON_A_MOTOR), ("short", ON_THE_LOOM))
    for speed in SCENES[name][1]
    for number, claim in enumerate(claims)
]


@pytest.mark.parametrize(("name", "speed", "number"), CASES)
def test_the_page_says_what_the_run_says(said: Any, name: str, speed: float | None, number: int) -> None:
    """At other values than the scene's it leaves a claim undecided that is near to its bound."""
    mine, (word, text, *shown, place), its = said(name, speed)[number]
    if NEARER in mine["note"]:  # by what other steps change, not by what the model leaves open
        assert speed is not None
        assert mine["holds"] is None
        assert abs(its.worst - its.bound) < max(20.0 * its.spread, 1.1e-4 * abs(its.bound))
        mine["note"] = mine["note"].removesuffix(NEARER).removesuffix("; ")
    else:
        assert word.strip("\u2713\u2717 \n") == its.word
        assert mine["holds"] == (its.holds if its.decided else None)
    said_too = its.note if speed is None else its.note.removesuffix(its.unsettled).removesuffix("; ")
    assert alike(mine["note"], said_too), (mine["note"], its.note)
    assert its.signal in text
    # 1e-9: edges of spans are times, sums of some 1e3 steps; blows amplify rounding
    for key in ("worst", "bound", "time"):
        value = mine[key] if mine[key] is not None else math.nan
        tolerance = {"rel": 1e-9, "abs": 1e-8 if key == "time" else 1e-12, "nan_ok": True}
        assert value == pytest.approx(getattr(its, key), **tolerance), key
    known = math.inf if mine["error"] is None else mine["error"]
    assert alike(shown[0], replace(its, error=known).shown_worst) and alike(shown[1], its.shown(its.bound))
    assert alike(place, its.place or NOWHERE), (place, its)
    if speed is None and math.isfinite(its.worst):
        # differences of values that agree to 1e-9
        error = mine["error"] if mine["error"] is not None else math.inf
        assert error == pytest.approx(its.error, rel=1e-3, abs=1e-8 * (abs(its.worst) + abs(its.bound)))


@pytest.mark.slow
def test_a_claim_that_coarser_steps_cannot_tell_is_not_judged(opened: Open, tmp_path: Path) -> None:
    """Its error was taken for 0, and the claim held, where a run says that it is undecided."""
    values = {"shaft.speed": "400 rpm", "steps_per_revolution": 1000, "revolutions": 1}
    values |= {"shaft.torque_32": "0 N.m", "belt_motion.guide_end": "play", "belt_motion.head_end": "guided"}
    scene = with_claims(MOTOR, [{"kind": "belt_deflection", "at_most": "5 mm"}], values)
    with loomfmu.prepare(scene) as loom:
        assert "coarser steps give no value" in loom.evaluate({}).claims[0].note
    page = opened(live_page.write(scene, [], tmp_path / "page.html"))
    until(page, lambda: page.evaluate("Boolean(loomfmu.live.pace)"))
    (found,) = page.evaluate("loomfmu.live.verdicts")
    assert found["holds"] is None
    assert "coarser steps give no value" in found["note"]


@pytest.mark.slow
def test_a_page_says_which_claims_it_does_not_judge(opened: Open, tmp_path: Path) -> None:
    lifts = {"kind": "below", "signal": "heald_1.lift + heald_2.lift", "bound": "99 mm"}
    force = {"kind": "below", "signal": "heald_1.inertia_force", "bound": "2 kN"}
    claims = [lifts, {"kind": "lowest_margin", "bound": 0.1}, force]
    scene = with_claims("[loom]\nmachine = 'WL680-3600'\nweave = '10/01'\n", claims)
    said: list[str] = []
    page = opened(live_page.write(scene, [], tmp_path / "page.html", warn=said.append))
    until(page, lambda: page.evaluate("Boolean(loomfmu.live.pace)"))
    first, second, third = page.evaluate("loomfmu.live.verdicts")
    assert third["left"] and third["note"].startswith("the page does not compute the rate of heald_1.inertia")
    assert first["left"] and first["note"] == (
        "a page judges signals, not expressions;"
        " loomfmu run judges it: it is undecided with the scene's own values"
    )
    assert second["holds"] and not second.get("left")
    reasons = [each["note"].partition(";")[0] for each in (first, third)]
    assert said[:2] == [f"claim 'below' is not judged in the page: {why}" for why in reasons]
    assert "2 not judged here" in page.inner_text(".outcome")


def alike(one: str, other: str) -> bool:
    """Whether two texts are the same but for the last digit of their numbers."""
    number = re.compile(r"(?<![\w.])-?\d+\.?\d*(?:e[+-]\d+)?")
    values = [[float(each) for each in number.findall(text)] for text in (one, other)]
    return number.sub("#", one) == number.sub("#", other) and values[0] == pytest.approx(values[1], rel=2e-6)
