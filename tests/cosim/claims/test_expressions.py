"""Claims on expressions of signals: grammar, units, rates, cases, errors."""

import math
from typing import Any

import numpy as np
import pytest
from drawn_runs import drawn, turning
from hypothesis import given
from hypothesis import strategies as st
from scene_texts import claim, loom, parsed, verdicts

from loomfmu import judge
from loomfmu.cosim.claims import claims, expressions
from loomfmu.cosim.claims.expressed import Expressed
from loomfmu.cosim.planning.requested import Requested
from loomfmu.cosim.reading import checked_claims
from loomfmu.declaring.variables import Beside
from loomfmu.errors import LoomfmuError
from loomfmu.traces import Recording

TIME = np.linspace(0.0, 2.0 * math.pi, 401)
UNITS = {"a.x": "m", "a.v": "m/s", "b.x": "m", "b.v": "m/s", "c.force": "N", "c.share": "1", "d.lux": "lx"}
UNITS |= {"s.torque": "N.m", "s.velocity": "rad/s", "s.angle": "rad"}


def run(t: np.ndarray = TIME, **more: Any) -> Recording:
    """x of a is cos t, that of b 2 + sin(2 t), both with two rates; c has none."""
    signals = {
        "a.x": ("m", np.cos(t), {"rate": "v"}),
        "a.v": ("m/s", -np.sin(t), {"rate": "w"}),
        "a.w": ("m/s2", -np.cos(t)),
        "b.x": ("m", 2.0 + np.sin(2.0 * t), {"rate": "v"}),
        "b.v": ("m/s", 2.0 * np.cos(2.0 * t), {"rate": "w"}),
        "b.w": ("m/s2", -4.0 * np.sin(2.0 * t)),
        "c.share": ("1", np.sin(t)),
        **more,
    }
    return drawn(t, {**signals, **turning(t, 1.0, 0.0)})


def read(text: str) -> expressions.Expression:
    return expressions.read(text, UNITS.__getitem__, "signal")


# ---- grammar and units


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("a.x - b.x", "m"),
        ("-(a.x + 5 mm) * 2", "m"),
        ("max(a.x, b.x, 1e-3 m)/b.x", "1"),
        ("a.x / (3 ms)", "m/s"),
        ("c.force * a.v", "W"),
        ("s.torque * s.velocity", "W"),  # an angle counts as a number here
        ("s.angle / (2 s)", "rad/s"),  # and here it does not
        ("c.force * a.v + s.torque * s.velocity", "W"),
        ("+abs(a.x) - 5 mm/2", "m"),
        ("a.v + 5 m/s", "m/s"),
        ("5 %*a.x", "m"),
        ("c.share + 0.5", "1"),
    ],
)
def test_an_expression_has_the_unit_that_its_signals_give(text: str, unit: str) -> None:
    assert read(text).unit == unit


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("a.x + b.v", "has a.x in m beside b.v in m/s"),
        ("a.x - 40", "has a.x in m beside 40 in a number without a unit"),
        ("max(a.x, 3 s)", "has a.x in m beside 3 s in s"),
        ("a.x * b.x", "is in m2, a unit without a name; divide by a quantity"),
        ("a.x + 5 mn", "has the unknown unit 'mn'; did you mean 'm"),
        ("sin(a.x)", "has the unknown function 'sin'"),
        ("a.x.sum()", "has the unknown function 'a.x.sum'"),
        ("5 mm (a.x)", "lacks an operator after 5 mm"),
        ("abs(a.x, b.x)", "must have 1 argument in abs(...)"),
        ("min(a.x)", "must have 2 to 9 arguments in min(...)"),
        ("a.x / 0", "divides by 0"),
        ("a.x / (1 - 1)", "divides by 0"),
        ("a.x + 1e999 m", "has 1e999 m in it, which is too large"),
        ("lift - a.x", "has 'lift', which is not a signal such as heald_1.lift"),
        ("_0 - a.x", "has '_0', which is not a signal such as heald_1.lift"),
        ("5 mm - 3 mm", "has no signal in it"),
        ("3 mm", "has no signal in it"),
        (" ", "has no signal in it"),
        ("a.x ** 2", "is not an expression of +, -, *, /, abs"),
        ("(a.x if a.x else b.x)", "is not an expression of"),
        ("a.x - [1][0]", "is not an expression of"),
        ("a.x - 'b'", "is not an expression of"),
        ("(a.x", "is not an expression of"),
        ("a.x -\x00 b.x", "is not an expression of"),
        ("(a.x := b.x)", "is not an expression of"),
        ("(lambda: a.x)()", "has the unknown function"),
        ("a.x - d.lux", "has d.lux in it, whose unit 'lx' is not known"),
        ("-" * 400 + "a.x", "is nested too deeply"),
        ("(" * 240 + "a.x" + ")" * 240, "is not an expression of"),
        ("a.x+" * 200 + "a.x", "has 803 characters; at most 500 are possible"),
    ],
)
def test_what_is_not_an_expression_is_refused_in_one_line(text: str, why: str) -> None:
    with pytest.raises(LoomfmuError) as error:
        read(text)
    assert why in str(error.value) and "\n" not in str(error.value)


NUMBERS = st.floats(0.5, 4.0).map(lambda value: f"{value:.3f}")
SMOOTH = st.recursive(
    st.sampled_from(["a.x / (1 m)", "b.x / (1 m)"]) | NUMBERS,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+-*"), inner).map(lambda each: "({} {} {})".format(*each)),
        inner.map(lambda each: f"-{each}"),
        inner.map(lambda each: f"({each} / (b.x / (1 m) + 1))"),
    ),
    max_leaves=6,
).filter(lambda text: "." in text and "x" in text)
ANY = st.recursive(
    SMOOTH,
    lambda inner: st.one_of(
        inner.map(lambda each: f"abs({each})"),
        st.tuples(st.sampled_from(["min", "max"]), inner, inner).map(lambda each: "{}({}, {})".format(*each)),
        st.tuples(inner, st.sampled_from("+-"), inner).map(lambda each: "({} {} {})".format(*each)),
        st.tuples(NUMBERS, inner).map(lambda each: "-{} * {}".format(*each)),
    ),
    max_leaves=3,
)


def evaluated(text: str, t: Any) -> Any:
    """The value at a time, or at several, by Python itself."""
    plain = text.replace("a.x / (1 m)", "a").replace("b.x / (1 m)", "b")
    names = {"a": np.cos(t), "b": 2.0 + np.sin(2.0 * t), "min": np.minimum, "max": np.maximum}
    return eval(plain, names)


@given(ANY)
def test_its_samples_are_those_that_python_computes(text: str) -> None:
    found = Expressed(run(), read(text))[text]
    wanted = np.array([evaluated(text, t) for t in TIME[::40]])
    scale = 1.0 + np.max(np.abs(wanted))
    assert np.allclose(found[::40], wanted, rtol=1e-12, atol=1e-12 * scale)  # some tens of operations


@given(SMOOTH)
def test_its_rates_are_the_slopes_of_its_values(text: str) -> None:
    trace = Expressed(run(), read(text))
    rate = trace.rate(text)
    second = rate and trace.rate(rate)
    assert rate is not None and second is not None
    step, times = 1e-4, TIME[::40]
    before, here, after = (np.array([evaluated(text, t + s) for t in times]) for s in (-step, 0.0, step))
    scale = 1.0 + np.max(np.abs([before, here, after]))
    # differences are off by h^2 times a third, or fourth, rate: of six factors up to 20^4; and by rounding
    assert np.allclose(trace[rate][::40], (after - before) / (2 * step), atol=1e-3 * scale)
    assert np.allclose(trace[second][::40], (after - 2 * here + before) / step**2, atol=2e-2 * scale)


@given(ANY, st.sampled_from([1, -1]))
def test_its_cases_keep_a_bound_together_where_it_does(text: str, sense: int) -> None:
    expression = read(text)
    cases, trace = expression.cases(sense), run()
    values = np.array([Expressed(trace, case)[case] for case in cases])
    worst = values.min(axis=0) if sense > 0 else values.max(axis=0)
    assert np.allclose(worst, Expressed(trace, expression)[text], rtol=1e-12, atol=1e-9)
    if len(cases) > 1:
        assert all(case.node.smooth for case in cases)


# ---- verdicts


@given(ANY, st.integers(80, 300), st.floats(-1.0, 1.0), st.sampled_from(["above", "below"]))
def test_a_verdict_is_true_between_the_samples_too(text: str, steps: int, away: float, kind: Any) -> None:
    fine = evaluated(text, np.linspace(0.0, 2.0 * math.pi, 20_001))
    worst = float(np.min(fine) if kind == "above" else np.max(fine))
    scale = float(np.ptp(fine)) + 1e-6
    bound = worst + away**5 * scale  # most of them near the worst value
    found = judge(run(np.linspace(0.0, 2.0 * math.pi, steps + 1)), kind=kind, signal=text, bound=bound)
    keeps = worst >= bound if kind == "above" else worst <= bound
    # 20,000 samples miss an extreme by some 1e-7 of the values
    near = abs(worst - bound) < 1e-6 * (scale + abs(worst))
    assert near or found.word == "undecided" or bool(found) == keeps


def test_a_difference_is_judged_between_the_samples_as_a_recorded_one() -> None:
    t = TIME[::20]
    signals = {
        "a.x": ("m", np.cos(t), {"rate": "v"}),
        "a.v": ("m/s", -np.sin(t)),
        "b.x": ("m", np.sin(t), {"rate": "v"}),
        "b.v": ("m/s", np.cos(t)),
        "c.x": ("m", np.cos(t) - 2.0 * np.sin(t), {"rate": "v"}),
        "c.v": ("m/s", -np.sin(t) - 2.0 * np.cos(t)),
    }
    trace = drawn(t, {**signals, **turning(t, 1.0, 0.0)})
    for kind, bound in (("above", -2.3), ("below", 2.3), ("above", -2.0)):
        one = judge(trace, kind=kind, signal="a.x - 2 * b.x", bound=bound)  # type: ignore[arg-type]
        other = judge(trace, kind=kind, signal="c.x", bound=bound)  # type: ignore[arg-type]
        assert (one.word, one.unit, one.display_unit) == (other.word, "m", "mm")
        assert math.isclose(one.worst, other.worst, rel_tol=1e-13)  # rounding
        # the extreme sqrt(5) lies between samples 18 deg apart, where the cubic is off by h^4 / 384
        assert math.isclose(abs(one.worst), math.sqrt(5.0), rel_tol=3e-5)
    assert not one.holds and one.decided


@pytest.mark.parametrize(
    ("kind", "signal", "bound", "word"),
    [
        ("below", "abs(a.x)", 1.0, "holds"),
        ("below", "abs(a.x)", 0.99, "FAILS"),
        ("below", "max(a.x, b.x - 1 m) * 2", "4.001 m", "holds"),
        ("above", "min(a.x, b.x)", "-1.001 m", "holds"),
        ("above", "-abs(a.x - b.x)", "-4 m", "holds"),
        ("above", "abs(b.x)", "0.5 m", "undecided"),  # samples do not tell of a corner between them
        ("below", "c.share * a.x", "2 m", "undecided"),  # nothing is known of the share's rate
    ],
)
def test_abs_min_and_max_are_judged_by_cases_where_they_can_be(
    kind: Any, signal: str, bound: Any, word: str
) -> None:
    found = judge(run(), kind=kind, signal=signal, bound=bound)
    assert (found.word, found.signal) == (word, signal)


@pytest.mark.parametrize("at_samples", [True, False])
def test_a_division_by_a_signal_that_passes_0_leaves_a_claim_undecided_and_says_when(
    at_samples: bool,
) -> None:
    found = judge(run(), kind="above", signal="2 + b.x / a.x", bound=0, at_samples=at_samples)
    # the sample 100 is at a quarter of a turn, to rounding
    where = f"{TIME[100]:.6g} s, 90.000 deg, rev. 1"
    assert (found.word, found.note) == ("undecided", f"it divides by a.x, which is or passes 0 at {where}")
    assert math.isnan(found.worst) and math.isnan(found.distance)


def test_the_worst_case_gives_the_value_and_any_open_one_leaves_it_undecided() -> None:
    found = judge(run(), kind="below", signal="max(b.x, c.share * (1 m))", bound="4 m")
    assert found.word == "undecided" and "(c.share * 1 m) is known only at the samples" in found.note
    assert found.worst == pytest.approx(3.0, rel=1e-9)  # of b.x: near its extreme the quintic is exact to h^6
    failing = judge(run(), kind="below", signal="max(b.x, c.share * (1 m))", bound="2 m")
    assert failing.word == "FAILS" and failing.worst == found.worst


def test_a_case_that_is_farther_from_the_bound_but_less_sure_leaves_it_undecided() -> None:
    unsure = {
        "a.x": ("m", np.cos(TIME), {"rate": "v", "beside": Beside(error="off")}),
        "a.off": ("m", 3.0 + 0.0 * TIME),
    }
    for trace, word in ((run(), "holds"), (run(**unsure), "undecided")):
        asked = claims.read({"kind": "below", "signal": "max(a.x, b.x)", "bound": "3.5 m"}, trace.unit)
        found = asked.settled(trace, asked.judge(trace), 0.0, 1e-12, 0.0, 0.0)
        # b.x comes to 3 m, 0.5 m from the bound; a.x to 1 m, but it may be off by 3 m
        assert (found.word, found.worst) == (word, pytest.approx(3.0, rel=1e-9))
    assert found.error == pytest.approx(3.0)


def test_samples_alone_are_judged_if_asked() -> None:
    found = judge(run(), kind="above", signal="abs(b.x)", bound="0.5 m", at_samples=True)
    assert (found.word, found.claim) == ("holds", "lowest value at the samples")


def test_a_quotient_whose_denominator_may_pass_0_between_two_samples_is_known_only_there() -> None:
    # b.x is 0.1 m at its samples, but by its rates it may dip far below 0 between them
    dips = {
        "b.x": ("m", 0.1 + 0.0 * TIME, {"rate": "v"}),
        "b.v": ("m/s", np.resize([-50.0, 50.0], len(TIME))),
    }
    found = judge(run(**dips), kind="below", signal="a.x / b.x", bound=100.0)
    assert (found.word, "is known only at the samples" in found.note) == ("undecided", True)


def test_it_is_known_where_its_signals_are_and_off_by_what_they_are() -> None:
    beside = Beside(valid_if="sure", error="off")
    unsure = {
        "a.x": ("m", np.cos(TIME), {"rate": "v", "beside": beside}),
        "a.sure": ("1", TIME < 3.0),
        "a.off": ("m", 0.01 + 0.0 * TIME),
    }
    trace = run(**unsure)
    found = judge(trace, kind="above", signal="3 * a.x - b.x", bound="-20 m")
    assert found.word == "undecided" and "as a.sure is false" in found.note
    expressed = Expressed(trace, read("3 * a.x - b.x"))
    assert np.allclose(expressed[expressed.error("3 * a.x - b.x") or ""], 0.03, rtol=1e-12)


def test_nobody_trusts_the_difference_of_two_large_numbers_beyond_their_own_errors() -> None:
    assert Expressed(run(), read("(a.x * b.x) / 1 m - (b.x * a.x) / 1 m")).noise(1e-8, 0.0) > 8e-8
    # a sum of shares: none of it is left
    assert Expressed(run(), read("a.x - a.x")).noise(1e-8, 0.0) < 1e-300
    assert Expressed(run(), read("a.x - b.x")).noise(0.0, 5e-3) > 5e-3  # each has moved by a metre at least


@pytest.mark.parametrize("numbers", ["* 1e-200 * 1e-200 * 1e200 * 1e200", "+ 1e14 m + 1 mm - 1e14 m - 1 mm"])
def test_numbers_do_not_round_before_they_meet_a_signal(numbers: str) -> None:
    expressed = Expressed(run(), read(f"a.x {numbers}"))
    assert np.allclose(expressed[f"a.x {numbers}"], run()["a.x"], rtol=4e-16, atol=0.0)
    assert expressed.noise(0.0, 0.0) < 1e-15


def test_a_product_of_signals_that_underflows_is_not_trusted() -> None:
    text = "a.x * c.share * 1e-200 * 1e-200 * 1e200 * 1e200"
    assert Expressed(run(), read(text)).noise(0.0, 0.0) > 1e50


def test_a_long_sum_has_no_cases_rather_than_two_to_its_length() -> None:
    expression = read(" + ".join(30 * ["abs(a.x)"]))
    assert expression.cases(-1) == [expression]


@pytest.mark.parametrize(
    "signal", [" + ".join(6 * ["abs(a.x)"]), f"max({', '.join(9 * ['abs(a.x) + abs(b.x)'])})"]
)
def test_a_claim_with_too_many_cases_says_so(signal: str) -> None:
    found = judge(run(), kind="below", signal=signal, bound="7 m")
    assert found.word == "undecided" and "make more than the 32 cases" in found.note
    assert (
        "cases" not in judge(run(), kind="below", signal=signal, bound="0.1 m").note
    )  # it fails in any case
    assert "cases" not in judge(run(), kind="below", signal=signal, bound="7 m", at_samples=True).note


def test_a_long_product_is_read_at_once() -> None:
    assert read("a.x" + 45 * " * 2").node.linear == ({"a.x": 2**45}, 0)  # with 2^45 looks at its start


# ---- in scenes


LOOM = loom('weave = "10/01"\n')


def test_a_scene_judges_an_expression_with_its_error() -> None:
    lifted = "abs(heald_1.lift + heald_2.lift)"
    (found,) = verdicts(LOOM, claim("below", signal=lifted, bound="98.1 mm"), revolutions=2)
    assert (found.word, found.signal) == ("holds", lifted)
    # in plain weave both frames are at the same place of their strokes, 98 and 0 mm, at 0 deg
    assert 0.0 < found.error < 1e-4 and found.worst > 0.0
    rates = "heald_1.velocity * (1 s) - heald_2.velocity * (2 s)"
    (found,) = verdicts(LOOM, claim("below", signal=rates, bound="1 mm"), revolutions=2)
    assert found.word == "FAILS"


@pytest.mark.parametrize(
    "signal", ["heald_1.lift * 1e308 * heald_2.lift * 1e308 / (1 mm)", "-1e308 * heald_1.lift / 1e-308"]
)
def test_numbers_beyond_those_of_a_float_are_told_in_the_note_alone(signal: str) -> None:
    """Turning such a factor into a float was an error, and numpy's warnings were printed."""
    (found,) = verdicts(LOOM, claim("below", signal=signal, bound="2 m"), revolutions=2)
    assert not found and "is not finite everywhere" in found.note


@pytest.mark.parametrize(
    ("signal", "why"),
    [
        ("heald_1.lift - heald_9.lift", "there is no instance 'heald_9'; did you mean"),
        ("heald_1.lift - heald_2.lif", "heald_2 has no output 'lif'; did you mean 'lift'"),
        ("heald_1.lift - heald_2.velocity", "has heald_1.lift in m beside heald_2.velocity in m/s"),
    ],
)
def test_a_scene_refuses_a_wrong_expression_before_it_runs(signal: str, why: str) -> None:
    with pytest.raises(LoomfmuError) as error:
        Requested(parsed(LOOM + claim("below", signal=signal, bound="1 mm")))
    assert why in str(error.value) and str(error.value).startswith("claim 'below'")


def test_a_bound_in_another_unit_is_refused_and_one_without_is_doubted() -> None:
    with pytest.raises(LoomfmuError, match="'3 s' is in s, which does not fit m"):
        Requested(parsed(LOOM + claim("below", signal="heald_1.lift - heald_2.lift", bound="3 s")))
    text = LOOM + claim("below", signal="heald_1.lift - heald_2.lift", bound=40)
    assert any("is read as 40 m" in note for note in checked_claims(parsed(text)).scene.notes)
    speed = claim("above", signal="belt.lowest_speed_limit - 10 mm", bound="shaft.speed")
    with pytest.raises(LoomfmuError, match="beside 10 mm in m"):
        Requested(parsed(LOOM + speed))
    with pytest.raises(LoomfmuError, match=r"bound shaft.speed is in rad/s, but .* is in m"):
        checked_claims(parsed(LOOM + claim("above", signal="2 * heald_1.lift", bound="shaft.speed")))
