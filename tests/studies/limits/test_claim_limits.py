"""Limits: against closed forms and fine sweeps."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from loomfmu import Boundary, LoomfmuError, limit, prepare
from loomfmu.cosim.scenes.scene import Scene, parse
from loomfmu.design import loom as design
from loomfmu.machines import MACHINES
from loomfmu.studies.limits.results import ClaimLimits, Limits, Stretch, rows

DEMO = Path(__file__).parents[3] / "sims" / "wl680_3600.toml"
RPM = 2.0 * math.pi / 60.0
FOUND = 1e-9  # of the value: what limits are promised to

LOOM = 'revolutions = 4\nsteps_per_revolution = 360\n[loom]\nmachine = "WL680-3600"\nhead = "G6300 left"\n'
SPRUNG = f"""{LOOM}weave = "10/01"
dampers = true
[heald]
sprung_mass = "7.5 kg"
[shaft]
speed = "200 rev/min"
"""


def claims(*tables: dict[str, Any]) -> str:
    return "".join(
        "[[claims]]\n" + "".join(f"{key} = {value!r}\n" for key, value in table.items()) for table in tables
    )


def of(found: Limits, name: str) -> ClaimLimits:
    return next(each for each in found.claims if each.claim == name)


def belt_scene(machine: str, extra: str = "") -> Scene:
    tables = claims(
        {"name": "margin", "kind": "lowest_margin", "bound": 0.1},
        {"name": "speed", "kind": "above", "signal": "belt.lowest_speed_limit", "bound": "shaft.speed"},
    )
    text = LOOM.replace("WL680-3600", machine).replace("revolutions = 4", "revolutions = 1")
    text = text.replace("steps_per_revolution = 360", "steps_per_revolution = 1440")
    return parse(f'{text}[shaft]\nspeed = "600 rpm"\n{extra}{tables}')


def test_the_margin_of_the_demo_limits_its_speed() -> None:
    safe = design.safe_speed("WL680-3600", clearance="0.3 mm").speed
    assert safe / RPM == pytest.approx(681.804, abs=5e-4)
    found = limit(DEMO, vary="shaft.speed", from_="300 rpm", to="900 rpm")
    margin, speed = found.claims[:2]
    # the load grows with the square of the speed, the margin is 1 at rest and 0 at the safe speed
    assert [each.value for each in margin.limits] == pytest.approx([safe * math.sqrt(0.9)], rel=FOUND)
    assert [each.value for each in speed.limits] == pytest.approx([safe], rel=FOUND)
    assert [(each.begins, each.jumps) for each in (*margin.limits, *speed.limits)] == [("to fail", False)] * 2
    assert [each.depends for each in found.claims] == [True, True, False, False, False, True]
    (held,) = found.ranges
    assert (held.low, held.below, held.above) == (300.0 * RPM, "", "the belt keeps a margin of 10 %")
    assert held.high == margin.limits[0].value and found
    above = "The first to fail is 'the belt keeps a margin of 10 %' above this range."
    assert str(found) == f"All claims hold from 300 to 646.8164 rev/min. {above}"
    assert found.resolution == pytest.approx(15.0 * RPM)  # a range of 600 rev/min by 41 points
    # the time of the command is that of these runs and of its start
    assert found.runs < 60


def test_the_limit_hardly_depends_on_the_steps() -> None:
    safe = design.safe_speed("WL680-3600", clearance="0.3 mm").speed
    # the belt follows its travel over a step of 2 deg on a polynomial: of fourth order, 1e-7 with 180 steps
    for steps, off in ((180, 3e-7), (360, 2e-8), (1440, FOUND)):
        given = {"steps_per_revolution": steps, "revolutions": 1}
        found = limit(DEMO, vary="shaft.speed=600rpm..700rpm", set=given, points=5)
        assert found.claims[0].limits[0].value == pytest.approx(safe * math.sqrt(0.9), rel=off)


@pytest.mark.parametrize("machine", MACHINES)
def test_limits_of_all_machines_are_those_of_the_closed_form(machine: str) -> None:
    safe = design.safe_speed(machine, clearance="0.4 mm").speed
    scene = belt_scene(machine, '[belt]\nguide_clearance = "0.4 mm"\n')
    found = limit(scene, vary="shaft.speed", from_=0.5 * safe, to=1.5 * safe, points=9)
    assert of(found, "speed").limits[0].value == pytest.approx(safe, rel=FOUND)
    assert of(found, "margin").limits[0].value == pytest.approx(safe * math.sqrt(0.9), rel=FOUND)


@pytest.mark.parametrize(
    ("vary", "solve"),
    [
        ("belt.guide_clearance=0.2mm..0.8mm", design.clearance_for),
        ("belt.head_mass", design.mass_for),
        ("belt.bending_stiffness", design.stiffness_for),
    ],
)
def test_other_variables_have_limits_too(vary: str, solve: Callable[..., float]) -> None:
    wanted = 650.0 * RPM
    found = limit(belt_scene("WL680-3600"), vary=vary, set={"shaft.speed": wanted})
    (speed,) = of(found, "speed").limits
    assert speed.value == pytest.approx(solve(wanted, "WL680-3600"), rel=FOUND)
    if vary == "belt.bending_stiffness":
        assert speed.begins == "to hold"
        assert found.ranges[0].below == "margin" and found.ranges[0].above == ""
        assert found.span.source == "half to twice the scene's 0.25 N.m2"


# ---- claims that are not monotone


def swept(scene: Scene, number: int, speeds: Sequence[float]) -> list[bool]:
    """Whether a claim, counted from 0, holds at each speed [rev/min]."""
    with prepare(scene) as loom:
        return [loom.evaluate({"shaft.speed": f"{each} rpm"}).claims[number].holds for each in speeds]


def agrees(found: ClaimLimits, speeds: Sequence[float], held: Sequence[bool]) -> None:
    """The sweep and the ranges that were found say the same of every speed."""
    for speed, holds in zip(speeds, held, strict=True):
        inside = any(each.low <= speed * RPM <= each.high for each in found.ranges)
        assert inside == holds, speed


SWINGING = {
    "dwell": {"kind": "dwell", "heald": "heald_1", "tolerance": 0.1, "at_least": "192 deg"},
    "peak": {"kind": "peak_load", "damper": "damper_1", "at_most": "155 N"},
    "shed": {"kind": "clear_shed", "heald": "heald_1", "clearance": "6 mm", "at_least": "214 deg"},
}


@pytest.mark.slow
def test_all_intervals_of_a_carrier_that_swings_are_found() -> None:
    scene = parse(SPRUNG + claims(*({"name": name, **each} for name, each in SWINGING.items())))
    found = limit(scene, vary="shaft.speed=100rpm..400rpm")
    assert found.resolution == pytest.approx(7.5 * RPM)
    speeds = np.linspace(100.0, 400.0, 121).tolist()  # three times as fine
    for number, (name, turns) in enumerate({"dwell": 4, "peak": 3, "shed": 2}.items()):
        assert len(of(found, name).limits) == turns
        assert not any(each.jumps for each in of(found, name).limits)
        agrees(of(found, name), speeds, swept(scene, number, speeds))
    assert not found  # each holds in some ranges, but never all of them


def test_stop_contacts_jump_and_come_back() -> None:
    scene = parse(SPRUNG + claims({"kind": "stop_contacts", "damper": "damper_1", "at_most": 6}))
    found = limit(scene, vary="shaft.speed=340rpm..700rpm")
    (contacts,) = found.claims
    assert [each.begins for each in contacts.limits] == ["to fail", "to hold", "to fail"]
    assert all(each.jumps and 0.0 < each.high - each.low <= FOUND * each.high for each in contacts.limits)
    speeds = np.linspace(340.0, 700.0, 121).tolist()
    agrees(contacts, speeds, swept(scene, 0, speeds))
    assert "jumps" in " ".join(str(found).split()) and len(found.ranges) == 2


def test_an_interval_narrower_than_the_scan_is_found_where_the_distance_touches_0() -> None:
    text = SPRUNG + claims({"name": "shed", **SWINGING["shed"]})
    with prepare(parse(text)) as loom:
        best = minimize_scalar(
            lambda rpm: -loom.evaluate({"shaft.speed": f"{rpm} rpm"}).claims[0].worst,
            bounds=(270.0, 295.0),
            method="bounded",
            options={"xatol": 1e-7},
        )
    longest = -float(best.fun)
    scene = parse(text.replace("214 deg", f"{math.degrees(longest - 1e-5)!r} deg"))
    found = limit(scene, vary="shaft.speed=100rpm..400rpm")
    first, last = found.claims[0].limits
    assert last.value - first.value < 0.1 * found.resolution
    assert first.value < best.x * RPM < last.value


def test_a_claim_jumps_where_it_has_no_value_any_more() -> None:
    text = SPRUNG + claims({"kind": "rapier_in_open_shed", "head_height": "10 mm"})
    found = limit(parse(text), vary="belt.idle_travel=0.1m..2.5m", points=21)
    opens, never = found.claims[0].limits
    assert (opens.begins, opens.jumps) == ("to hold", False)
    assert (never.begins, never.jumps) == ("to fail", True)
    with prepare(parse(text)) as loom:
        within, beyond = (
            loom.evaluate({"belt.idle_travel": each}).claims[0] for each in (never.low, never.high)
        )
    assert within and within.distance > 0.0
    assert not beyond and math.isnan(beyond.distance) and "never enters the shed" in beyond.note


# ---- what does not depend, what holds nowhere


def test_a_variable_that_changes_nothing_is_named() -> None:
    found = limit(belt_scene("WL680-3600"), vary="weft.belt_length=1m..4m", points=5)
    assert found and not found.depends
    assert str(found).startswith("No claim depends on weft.belt_length between 1 and 4 m. All ")
    assert all(not each.limits for each in found.claims)


def test_a_claim_that_holds_nowhere_is_named() -> None:
    found = limit(belt_scene("WL680-3600"), vary="shaft.speed=700rpm..900rpm", points=5)
    assert not found and found.ranges == ()
    assert str(found) == (
        "There is no value from 700 to 900 rev/min at which all claims hold:"
        " 'margin' and 'speed' hold nowhere."
        " The scene's own value, 600 rev/min, is outside the range that was searched."
    )


def test_claims_that_hold_but_never_together_are_not_called_failing() -> None:
    tables = claims(
        {"name": "slow", "kind": "below", "signal": "shaft.velocity", "bound": "400 rpm"},
        {"name": "fast", "kind": "above", "signal": "shaft.velocity", "bound": "500 rpm"},
    )
    scene = parse(f'{LOOM}[shaft]\nspeed = "450 rpm"\n{tables}')
    found = limit(scene, vary="shaft.speed=300rpm..600rpm")
    assert [each.value for claim in found.claims for each in claim.limits] == pytest.approx(
        [400.0 * RPM, 500.0 * RPM], rel=FOUND
    )
    assert str(found) == (
        "There is no value from 300 to 600 rev/min at which all claims hold."
        " At the scene's own value, 450 rev/min, 'slow' and 'fast' fail."
    )


def test_numbers_that_were_probably_meant_in_another_unit_are_doubted() -> None:
    found = limit(belt_scene("WL680-3600"), vary="shaft.speed", from_="300 rpm", to=600, points=3)
    (warning,) = found.warnings
    assert warning.startswith("shaft.speed = 600 is read as 600 rad/s = 5729.578 rev/min; write")


def test_a_claim_that_cannot_be_judged_says_why() -> None:
    scene = parse(
        SPRUNG + claims({"name": "load", "kind": "below", "signal": "damper_1.peak_load", "bound": "1e6 N"})
    )
    found = limit(scene, vary="shaft.speed=300rpm..400rpm", set={"steps_per_revolution": 15}, points=3)
    assert not found and math.isnan(found.claims[0].verdict.distance)
    assert "undecided: the samples are too far apart to be sure; take more steps" in found._repr_html_()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"vary": "shaft.speed", "from_": "900 rpm", "to": 5}, "shaft.speed: the range from 900 rev/min to"),
        ({"vary": "shaft.speed=5rpm..5rpm"}, "shaft.speed: the range from 5 rev/min to 5 rev/min is empty"),
        ({"vary": "shaft.speed", "from_": "1300 rpm"},
         "shaft.speed: the range from 1300 rev/min to 1200 rev/min is empty (lower end given, upper end"
         " twice the scene's 600 rev/min); give both ends"),
        ({"vary": "shaft.speed=300rpm"}, "vary shaft.speed=300rpm: '300rpm' is not a range; write it as"),
        ({"vary": "shaft.speed=1..2", "to": 3}, "vary shaft.speed=1..2: the range is given twice"),
        ({"vary": "shaft.speed", "from_": "3 mm"}, "shaft.speed: '3 mm' is in mm, which does not fit rad/s"),
        ({"vary": "shaft.speed", "to": "20000 rpm"}, "shaft.speed = 20000 rev/min is outside [-9549"),
        ({"vary": "shaft.speed", "from_": "-9 rpm"}, "shaft.speed = -9 rev/min: claim 'the loom runs"),
        ({"vary": "shaft.sped"}, "shaft.sped is unknown; did you mean 'speed'?"),
        ({"vary": "belt.travel"}, "belt.travel cannot be set, it is wired to weft.travel"),
        ({"vary": "belt.margin"}, "belt.margin is an output of BeltMonitor and cannot be set"),
        ({"vary": "dobby.law"}, "dobby.law is not a real number; run a sweep over its values"),
        ({"vary": "revolutions"}, "revolutions cannot be varied here"),
        ({"vary": "machine"}, "machine cannot be varied here"),
        ({"vary": "shaft.start_angle"}, "shaft.start_angle is 0 in this scene, so there is no usual range"),
        ({"vary": 3}, "vary = 3 must be one variable such as 'shaft.speed', or a list of two"),
        ({"vary": []}, "vary = [] must be one variable"),
        ({"vary": [3]}, "vary = 3 is not a variable such as 'shaft.speed'"),
        ({"vary": "shaft.speed", "points": 2}, "points = 2 must be a whole number from 3 to"),
        ({"vary": ["shaft.speed", "shaft.speed=1..2"]}, "shaft.speed and shaft.speed both set shaft.speed"),
        ({"vary": ["shaft.speed", "heald.stroke"], "rows": 1}, "rows = 1 must be a whole number from 2 to"),
        ({"vary": "shaft.speed", "rows": 4}, "rows = 4 is how many values of a second variable are taken"),
        ({"vary": "damper.spring_stiffness=1..20N/mm"}, "vary damper.spring_stiffness: '1..20N/mm': 1 has"),
        ({"vary": "weft.speed=300rpm..900rpm"}, "weft.speed has no effect: set weft.follow_shaft = false"),
    ],
)  # fmt: skip
def test_what_cannot_be_searched_is_refused_in_one_line(given: dict[str, Any], said: str) -> None:
    short = {"steps_per_revolution": 90, "revolutions": 1}
    with pytest.raises(LoomfmuError) as raised:
        limit(DEMO, set=short, **given)
    assert str(raised.value).startswith(said)
    assert "\n" not in str(raised.value) and len(str(raised.value)) < 300


def test_values_that_cannot_be_run_are_refused_with_those_that_can() -> None:
    with pytest.raises(LoomfmuError, match=r"heald\.stroke = 49 mm: claim 'clear_shed' .* can be run$"):
        limit(DEMO, vary="heald.stroke", set={"steps_per_revolution": 90, "revolutions": 1})
    parts = r"of the values tried, -700 to -350 rev/min and 350 to 700 rev/min can be run$"
    with pytest.raises(LoomfmuError, match=parts):  # the shaft may not stand still between them
        scene = parse(LOOM + '[[claims]]\nkind = "lowest_margin"\nbound = 0.1\n')
        limit(scene, vary="shaft.speed=-700rpm..700rpm", points=5)


def test_a_scene_without_claims_has_no_limits() -> None:
    with pytest.raises(LoomfmuError, match=r"the scene has no claims, so there is no limit to find"):
        limit(parse(LOOM), vary="shaft.speed")


def test_a_range_in_which_a_claim_is_undecided_is_no_range_in_which_it_holds() -> None:
    """With 24 steps a blow of 0.34 m/s held; with 2880 it is 0.55 m/s, beyond the bound."""
    text = LOOM.replace("= 360", "= 24").replace("revolutions = 4", "revolutions = 2")
    text += 'weave = "10/01"\ndampers = true\nplay = true\n[shaft]\nspeed = "574 rpm"\n'
    text += claims({"kind": "heald_blows", "play": "play_1", "at_most": "0.4 m/s"})
    found = limit(parse(text, "blows"), vary="shaft.speed=574rpm..575.9rpm", points=3)
    assert not found and not found.claims[0].ranges
    assert "'hardest blow (play_1.hardest_blow)' is undecided: " in str(found)


def test_a_claim_is_undecided_away_from_its_bound_where_other_steps_count_other_blows() -> None:
    """Nearest to the bound, at 314.7 rev/min, the claim holds; at 323.9 rev/min it is undecided."""
    text = (
        LOOM.replace("= 360", "= 720")
        + """weave = "10/01"
dampers = true
warps = true
play = true
[damper]
spring_stiffness = 3880.2
free_travel = "14.15 mm"
[play]
restitution = 0.50
play = "2.34 mm"
"""
        + claims({"kind": "below", "signal": "play_1.hardest_blow", "bound": 0.40747687907510827})
    )
    found = limit(parse(text, "blows"), vary="shaft.speed=314.6743rpm..327.01457rpm", points=5)
    (part,) = found.ranges
    assert (part.low, part.high) == (found.span.low, pytest.approx(320.844435 * RPM))
    said = "At 323.9295 rev/min 'highest value (play_1.hardest_blow)' is undecided: play_1.blows"
    assert said in str(found)


def test_a_claim_that_is_undecided_in_part_of_the_range_does_not_hold_everywhere() -> None:
    found = limit(DEMO, vary="shaft.speed=400rpm..500rpm", set={"steps_per_revolution": 90}, points=3)
    one, *others = (replace(each, limits=()) for each in found.claims)
    low, high = found.span.low, 450.0 * RPM
    doubtful = replace(one, ranges=(Stretch(low, high),), doubts=((500.0 * RPM, "numerical error 1"),))
    found = replace(found, claims=(doubtful, *others), ranges=(Stretch(low, high, above=one.claim),))
    assert rows(found)[0][1] == "up to 450 rev/min"
    assert f"The first that is not sure to hold is '{one.claim}' above this range." in str(found)
    assert f"At 500 rev/min '{one.claim}' is undecided: numerical error 1." in str(found)


# ---- over a second variable

TURNS = {"revolutions": 2}


def boundary() -> Boundary:
    vary = ["shaft.speed=300rpm..900rpm", "belt.guide_clearance=0.2mm..0.8mm"]
    found = limit(DEMO, vary=vary, set=TURNS, points=5, rows=3)
    assert isinstance(found, Boundary)
    return found


@pytest.mark.slow
def test_each_row_is_the_limit_at_a_value_of_the_second_variable() -> None:
    found = boundary()
    assert found and found.values == pytest.approx([0.2e-3, 0.5e-3, 0.8e-3], rel=1e-15)
    assert (found.values[0], found.values[-1]) == (0.2e-3, 0.8e-3)  # the ends are what was written
    for clearance, row in zip(found.values, found.rows, strict=True):
        safe = design.safe_speed("WL680-3600", clearance=clearance).speed
        (held,) = row.ranges
        assert held.high == pytest.approx(safe * math.sqrt(0.9), rel=1e-9)
        assert held.above == "the belt keeps a margin of 10 %"
        (speed,) = row.claims[1].limits
        assert speed.value == pytest.approx(safe, rel=1e-9)
    single = limit(
        DEMO, vary="shaft.speed=300rpm..900rpm", set=TURNS | {"belt.guide_clearance": "0.5 mm"}, points=5
    )
    assert found.rows[1].ranges == single.ranges


def test_a_boundary_is_shown_as_a_table() -> None:
    found = boundary()
    assert repr(found) == (
        "<Boundary of WL680-3600, G6300 left, weave 10/01/10/01; revolutions = 2: shaft.speed at 3 values of"
        " belt.guide_clearance>"
    )
    html = found._repr_html_()
    assert "belt.guide_clearance [mm]" in html and "300 to 679.7492 rev/min" in html


def test_a_value_of_the_second_variable_that_cannot_be_run_is_named() -> None:
    with pytest.raises(LoomfmuError, match=r"^at heald\.stroke = 10 mm: .*claim 'clear_shed' of heald_1"):
        limit(
            DEMO,
            vary=["shaft.speed=300rpm..900rpm", "heald.stroke=10mm..98mm"],
            set=TURNS,
            points=3,
            rows=2,
        )
