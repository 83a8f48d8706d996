"""Claims in Python, in the scene and in the file: refused, judged, stored, printed."""

import json
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import pytest
from claimed import DAMPED, DEMO, LOOM, Looms, judged
from scene_texts import claim, parsed, table

from loomfmu import Evaluation, LoomfmuError, Trace, Verdict, evaluate, judge
from loomfmu.cosim.claims import judging
from loomfmu.cosim.claims.arguments import Name, Quantity, argument
from loomfmu.cosim.claims.claim import AT_MOST, Claim
from loomfmu.cosim.claims.claims import kinds
from loomfmu.cosim.claims.judging import Form, Question, Run
from loomfmu.cosim.run import run
from loomfmu.fmi.native import compiler, platforms
from loomfmu.loom.judged import Kind
from loomfmu.traces import Signals


def test_a_verdict_as_a_person_reads_it(looms: Looms) -> None:
    trace = looms(shaft__speed="700 rpm")
    said = str(judge(trace, kind="lowest_margin", bound=0.1, name="no buckling"))
    assert said.startswith("FAILS: no buckling: lowest margin (belt.lowest_margin), -0.05")
    assert said.endswith(" deg, rev. 1, bound 0.1")
    said = str(judge(trace, kind="dwell", heald="heald_1", at_least="80 deg"))
    assert said.startswith("holds: dwell within 1.5 % of the stroke (heald_1.lift), 85.92125 deg at ")
    assert said.endswith(", bound 80 deg")


def test_a_verdicts_numbers_stand_beside_their_own_units(looms: Looms) -> None:
    trace = looms()
    found = judge(trace, kind="above", signal="belt.lowest_speed_limit", bound="600 rpm")
    assert (found.unit, found.display_unit) == ("rad/s", "rev/min")
    assert math.isclose(found.bound, 20 * math.pi, rel_tol=1e-15)
    stored = found.as_dict()
    assert (stored["bound"], stored["worst"], stored["unit"]) == (found.bound, found.worst, "rad/s")
    shown = stored["display"]
    assert shown["unit"] == "rev/min"
    assert math.isclose(shown["bound"], 600.0, rel_tol=1e-14)
    assert math.isclose(shown["worst"], found.worst * 30 / math.pi, rel_tol=1e-14)
    # what pytest prints of a failing assert
    assert repr(judge(trace, kind="below", signal="belt.lowest_speed_limit", bound="600 rpm")) == (
        "<Verdict FAILS: highest value (belt.lowest_speed_limit), 95492.97 rev/min at 0 s, 0.000 deg, rev. 1,"
        " bound 600 rev/min>"
    )
    dwelling = judge(trace, kind="dwell_contains", heald="heald_2", angles=["180 deg"])
    assert (dwelling.unit, dwelling.display_unit, dwelling.bound) == ("1", "%", 0.015)
    assert dwelling.as_dict()["display"]["bound"] == 1.5


def test_a_verdict_comes_back_from_its_file(looms: Looms) -> None:
    for given in (
        {"kind": "above", "signal": "belt.lowest_speed_limit", "bound": "600 rpm"},
        {"kind": "dwell_contains", "heald": "heald_1", "angles": ["180 deg"], "tolerance": "0.1 %"},
        {"kind": "stop_contacts", "damper": "damper_1", "at_most": 9},
    ):
        found = judge(looms(**DAMPED), **given)
        stored = json.loads(json.dumps(found.as_dict()))
        assert str(Verdict.of(stored)) == str(found)
        assert Verdict.of(stored).as_dict() == stored
        # as version 0.1.0 stored them
        old = {key: value for key, value in stored.items() if key != "display"}
        assert str(Verdict.of(old | {"unit": found.display_unit})) == str(found)


def test_a_run_without_a_shaft_tells_the_time_alone() -> None:
    text = 'duration = "1 s"\nstep = "0.01 s"\n' + table("shaft_2", component="MainShaft", speed="60 rpm")
    found = evaluate(parsed(text, claim("below", signal="shaft_2.angle", bound="90 deg")))
    assert str(found.claims[0]) == "FAILS: highest value (shaft_2.angle), 360 deg at 1 s, bound 90 deg"
    stored = found.claims[0].as_dict()
    assert stored["angle"] is stored["revolution"] is None
    with pytest.raises(LoomfmuError, match=r"the claim needs shaft angles, but shaft\.angle is not recorded"):
        judge(found.trace, kind="below", signal="shaft_2.angle", bound=1.0, window=[0.0, 1.0])


def test_claims_of_a_scene_are_judged_stored_and_the_signals_they_need_recorded(tmp_path: Path) -> None:
    rest = claim(
        "above", name="fast enough", signal="weft.velocity", bound="0 m/s", window=["20 deg", "160 deg"]
    )
    rest += claim("dwell", heald="heald_2", at_least="90 deg") + claim(
        "peak_load", damper="damper_1", at_most="1 N"
    )
    text = "record = []\n" + LOOM.format(weave="10/01", rest="dampers = true\n" + rest)
    result = run(parsed(text), output=tmp_path / "claims.h5")
    assert [bool(verdict) for verdict in result.claims] == [True, False, False]
    assert not result.holds
    with Trace(tmp_path / "claims.h5") as trace:
        assert trace.verdicts == list(result.claims)
        assert trace.verdicts[0].claim == "fast enough: lowest value between 20 deg and 160 deg"
        assert {"weft.velocity", "weft.acceleration", "heald_2.lift", "heald_2.acceleration"} <= set(trace)
        assert "damper_1.peak_load" in trace
        assert "weft.travel" not in trace and "heald_1.lift" not in trace
        # judging the file anew gives the same, without the error, which takes other runs
        again = judge(trace, kind="dwell", heald="heald_2", at_least="90 deg")
        assert math.isnan(again.error)
        assert again == replace(trace.verdicts[1], error=again.error)


TRAVEL = {"kind": "above", "signal": "weft.travel", "bound": 0}
ROOM = {"kind": "rapier_in_open_shed", "head_height": 0.0}
WHOLE_TURN = "is empty; a whole revolution is [0 deg, 360 deg]"


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"kind": "abov", "signal": "weft.travel"}, "claim kind = 'abov' is unknown; did you mean 'above'?"),
        ({"kind": "above", "signal": "weft.travel"}, "claim 'above' needs 'bound'"),
        (TRAVEL | {"bond": 1}, "claim 'above' has no 'bond'; did you mean 'bound'?"),
        (TRAVEL | {"bound": "1 N"}, "claim 'above': bound: '1 N' is in N, which does not fit m"),
        (TRAVEL | {"bound": math.inf}, "claim 'above': bound = inf is not finite"),
        *(
            (TRAVEL | {"window": window}, f"claim 'above': window {said}")
            for window, said in (
                (["1 deg"], '= [\'1 deg\'] must be two shaft angles, such as ["330 deg", "30 deg"]'),
                (["90 deg", "90 deg"], f"= [90 deg, 90 deg] {WHOLE_TURN}"),
                (["360 deg", 0], f"= [360 deg, 0 deg] {WHOLE_TURN}"),
                ([0, "400 deg"], "= [0 deg, 400 deg] is longer than a revolution"),
                ([355, 5], 'has 355 rad, more than a revolution; did you mean "355 deg"?'),
                (["350", "20"], 'has 350 rad, more than a revolution; did you mean "350 deg"?'),
                ([350.0, 10.0], 'has 350.0 rad, more than a revolution; did you mean "350.0 deg"?'),
            )
        ),
        ({"kind": "dwell_contains", "heald": "heald_1", "angles": []},
         "claim 'dwell_contains': angles = [] must be a list of shaft angles, such as [\"140 deg\"]"),
        ({"kind": "dwell", "heald": "heald_1", "at_least": 1, "tolerance": 0.5},
         "claim 'dwell': tolerance = 0.5 is outside (0, 0.5) of the stroke"),
        ({"kind": "dwell", "heald": 5, "at_least": 1}, "claim 'dwell': heald = 5 is not a name in quotes"),
        ({"kind": "peak_load", "damper": "damper_1", "at_most": "1 mm"},
         "claim 'peak_load': at_most: '1 mm' is in mm, which does not fit N"),
        ({"kind": "dwell", "heald": "heald_9", "at_least": 1},
         "loom_0.h5: signal 'heald_9.lift' is not recorded; did you mean 'heald_2.lift'?"),
        *(
            (ROOM | {"healds": healds}, f"claim 'rapier_in_open_shed': healds = {healds!r} {said}")
            for healds, said in (
                *((each, 'must be a list of names, such as ["heald_1"]') for each in (5, "heald_1", [1])),
                ([], "names nothing; leave it out to judge all"),
            )
        ),
    ],
)  # fmt: skip
def test_a_claim_that_cannot_be_judged_is_refused_with_its_name(
    looms: Looms, given: dict[str, Any], said: str
) -> None:
    with pytest.raises(LoomfmuError) as raised:
        judge(looms(), **given)
    assert str(raised.value).replace(looms().path.name, "loom_0.h5") == said


def test_every_verdict_has_a_signed_distance_to_its_bound(looms: Looms) -> None:
    trace = looms(shaft__speed="600 rpm")
    for kind, way in (("above", 1.0), ("below", -1.0)):
        found = judge(trace, kind=kind, signal="weft.travel", bound="1 m")
        assert found.distance == way * (found.worst - 1.0)
        assert bool(found) == (found.distance >= 0.0)
        assert found.relative_distance == found.distance  # of a bound of 1 m
        stored = json.loads(json.dumps(found.as_dict()))
        assert Verdict.of(stored).distance == found.distance == stored["distance"]
        assert stored["display"]["distance"] == found.displayed(found.distance)
    # the bound of a share of the stroke is the most that is allowed, that of a margin the least
    contains = judge(trace, kind="dwell_contains", heald="heald_1", angles=["180 deg"])
    assert contains.distance == 0.015 - contains.worst > 0.0
    margin = judge(trace, kind="lowest_margin", bound="90 %")
    assert margin.distance == margin.worst - 0.9 < 0.0
    # nothing was judged, or a trace of an earlier version does not say
    short = judge(looms(90, revolutions=0.2), kind="dwell_contains", heald="heald_1", angles=["180 deg"])
    assert math.isnan(short.distance)
    old = {key: value for key, value in margin.as_dict().items() if key != "sense"}
    assert math.isnan(Verdict.of(old).distance)
    # no share of a bound of 0, and no distance where the samples, not the bound, make a claim fail
    zero = judge(trace, kind="above", signal="weft.travel", bound="0 m")
    assert zero and zero.distance >= 0.0 and math.isnan(zero.relative_distance)
    assert zero.as_dict()["relative_distance"] is None
    assert [each.shown_distance for each in (margin, zero, short)] == [
        f"{100.0 * margin.relative_distance:+.4g} %",
        f"{zero.distance:+.4g} m",
        "-",
    ]
    coarse = judge(looms(16), kind="lowest_margin", bound=-100.0)
    assert not coarse and coarse.worst > coarse.bound and math.isnan(coarse.distance)


@pytest.fixture
def kept_kinds() -> Iterator[None]:
    """The kinds of claims, as they were after the test."""
    before = dict(kinds())
    yield
    kinds().clear()
    kinds().update(before)


@pytest.mark.usefixtures("fmu_cache")
def test_without_the_library_a_scene_with_claims_is_refused_before_it_runs(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(platforms, "SHIPPED", tmp_path)
    monkeypatch.setattr(platforms, "compiler", lambda: None)
    monkeypatch.setattr(compiler, "compiler", lambda: None)
    judging.library.cache_clear()
    with pytest.raises(LoomfmuError) as raised:
        run(DEMO, output=tmp_path / "run.h5")
    said = 'this needs a compiler, which is not installed: pip install "loomfmu[native]"'
    assert str(raised.value) == f"claims cannot be judged: {said}"
    assert not list(tmp_path.iterdir())
    judging.library.cache_clear()


@pytest.mark.usefixtures("kept_kinds", "fmu_cache")
def test_a_new_kind_of_claim_is_one_class() -> None:
    class EndsNear(Claim):
        """A signal of a frame ends near a height."""

        heald: str = argument(Name())
        height: float = argument(Quantity("m", "mm", usual=0.05, low=0.0))

        needs = ("heald.lift",)
        sense, unit = AT_MOST, ("m", "mm")

        def question(self, trace: Signals) -> Question:
            signal = f"{self.heald}.lift"
            worst, time = float(trace[signal][-1]), float(trace.time[-1])
            numbers = [self.height, worst, time, 0.0]
            return Question("given", [self.form("ends near", signal)], [signal], numbers)

    def evaluated(height: Any, **values: Any) -> Evaluation:
        ends = claim("ends_near", heald="heald_1", height=height)
        return evaluate(parsed("record = []\n", LOOM.format(weave="10/01", rest=ends), **values))

    found = evaluated("200 mm")
    assert found and found.claims[0].claim == "ends near"
    assert "heald_1.lift" in found.trace and "heald_2.lift" not in found.trace
    # its usual value, its unit and its limit are known
    assert "height = 50" in evaluated(50).warnings[0]
    with pytest.raises(LoomfmuError, match=r"claim 'ends_near': height: '1 N' is in N, which does not fit m"):
        evaluated("1 N")


LIMIT = {"signal": "belt.lowest_speed_limit"}


@pytest.mark.parametrize(
    ("bound", "message"),
    [
        ("shaft.sped", "= 'shaft.sped' is not a parameter; did you mean 'shaft.speed'?"),
        ("belt.head_mass", "belt.head_mass is in kg, but belt.lowest_speed_limit is in rad/s"),
    ],
)
def test_a_bound_that_does_not_fit_its_signal_is_refused(bound: str, message: str) -> None:
    with pytest.raises(LoomfmuError, match=re.escape(f"claim on belt.lowest_speed_limit: bound {message}")):
        judged("above", LIMIT | {"bound": bound})


def test_a_negative_speed_is_refused_as_a_bound(looms: Looms) -> None:
    said = r'claim .*: bound shaft.speed = -800 rev/min is negative, .*, such as bound = "800 rev/min"'
    with pytest.raises(LoomfmuError, match=said):
        evaluate(DEMO, set={"shaft.speed": "-800 rpm"})
    backwards = looms(shaft__speed="-800 rpm")
    with pytest.raises(LoomfmuError, match=said):
        judge(backwards, kind="above", signal="belt.lowest_speed_limit", bound="shaft.speed")
    assert not judge(backwards, kind="above", signal="belt.lowest_speed_limit", bound="800 rpm")


def test_a_limit_of_speed_that_turns_negative_in_a_page_is_not_compared(looms: Looms) -> None:
    trace = looms(90)
    question = kinds()["above"](signal="belt.lowest_speed_limit", bound="shaft.speed").question(trace)
    negative = question._replace(numbers=[-80.0, *question.numbers[1:]])
    found = Run(trace).verdict(trace, negative)
    assert found.word == "undecided"
    assert found.note == "the bound is negative, but a limit of speed is positive"


@pytest.mark.parametrize("start", [0, 45])
@pytest.mark.parametrize("way", [1, -1])
def test_revolutions_are_counted_from_1_the_way_that_the_shaft_turns(
    looms: Looms, start: int, way: int
) -> None:
    trace = looms(360, shaft__speed=f"{600 * way} rpm", shaft__start_angle=f"{start * way} deg")
    steps = [round(360 * revolutions) for revolutions in (0.0, 0.3, 1.3, 2.6)]
    form = Form("", "shaft.angle", ("rad", "deg"), 1)
    asked = [
        Question("given", [form], [form.signal], [0.0, 1.0, float(trace.time[step]), 0.0]) for step in steps
    ]
    found = [Run(trace).verdict(trace, each) for each in asked]
    assert [each.revolution for each in found] == [1, 1, 2, 3]
    expected = [(way * (start + turned)) % 360 for turned in (0, 108, 108, 216)]
    assert [math.degrees(each.angle) for each in found] == pytest.approx(expected, abs=1e-9)


def test_the_type_of_kinds_names_all_kinds() -> None:
    assert sorted(get_args(Kind)) == sorted(Claim.kinds)
