import math
from pathlib import Path

import numpy as np
import pytest
from scene_texts import claim

import loomfmu
from loomfmu.cli import main
from loomfmu.cosim.claims.arguments import Window
from loomfmu.cosim.claims.conditions import FALLS, IN, OUT, RISES, UNKNOWN, Always, Sometime, Spans, Sum
from loomfmu.cosim.reading import requested
from loomfmu.cosim.scenes.scene import Scene, parse
from loomfmu.errors import LoomfmuError
from loomfmu.studies.proving.chain import Chain
from loomfmu.studies.proving.proofs import Proofs
from loomfmu.studies.proving.proofs_shown import draw
from loomfmu.studies.proving.prove import prove

RAPIERS = Path(__file__).parents[3] / "sims" / "both_rapiers.toml"


def _status(found: Proofs) -> dict[str, str]:
    return {proof.claim: proof.status for proof in found.claims}


def test_claims_without_a_memory_are_proven_and_the_others_refused(proofs: Proofs) -> None:
    proven = dict.fromkeys(("margin", "safe speed", "dwell", "transfer"), "proven")
    assert _status(proofs) == proven | {"count": "cannot be proven"}
    assert not proofs
    assert "belt.buckled depends on the run so far" in proofs.claims[-1].why


def test_a_claim_is_proven_up_to_its_limit_and_refuted_beyond(loom: Scene) -> None:
    # the margin is 0.1 at 646.8164 rev/min, to which the search of `limit` and a closed form agree
    assert prove(loom, over=["shaft.speed=300rpm..646.816rpm"], claims=["margin"])
    (beyond,) = prove(loom, over=["shaft.speed=300rpm..646.817rpm"], claims=["margin"]).claims
    assert beyond.status == "refuted"
    run = loomfmu.evaluate(loom, set=dict(beyond.witness))
    assert run.claims[0].holds is False


def test_several_values_vary_together(loom: Scene) -> None:
    over = ["shaft.speed=500rpm..600rpm", "belt.guide_clearance=0mm..0.3mm", "belt.head_mass=105g..113g"]
    assert prove(loom, over=over, claims=["margin"])


@pytest.mark.parametrize(
    ("at", "status"),
    [("135 deg", "refuted"), ("140 deg", "proven")],
)
def test_a_dwell_at_an_angle_for_all_reductions(loom: Scene, at: str, status: str) -> None:
    # (1 - cos(S/2))/2 is 0.0150 of the stroke at 138.0 deg for a reduction of 0.5
    text = loom.text.replace("140 deg", at)
    scene = parse(text.replace("[[claims]]", "[dobby]\nlaw = 'sloped-sine'\n[[claims]]", 1), "loom")
    found = prove(scene, over=["dobby.speed_reduction=0.5..0.7"], claims=["transfer"])
    assert _status(found) == {"transfer": status}


@pytest.mark.parametrize(
    ("overlap", "meet", "speed"),
    [("0.1 m", "proven", "proven"), ("0.9 m", "refuted", "cannot be proven")],
)
def test_nothing_is_proven_of_heads_that_never_meet(overlap: str, meet: str, speed: str) -> None:
    claims = ["the heads meet in time", "the hooks pass each other slowly"]
    found = prove(RAPIERS, set={"transfer.needed_overlap": overlap}, claims=claims)
    assert list(_status(found).values()) == [meet, speed]


def test_a_span_that_never_begins_does_not_last() -> None:
    """Nothing is said of spans where there are none: cells are outside, or inside for long enough."""
    spans, sides = Spans((Sum(()), Sum(((1.0, "other"),))), 1.5), {Sum(()): OUT}
    assert not spans.hold(0.0, 6.0, lambda _form, edges: np.full(len(edges) - 1, OUT))
    assert spans.hold(0.0, 6.0, lambda form, edges: np.full(len(edges) - 1, sides.get(form, IN)))


def test_what_few_boxes_cannot_decide_is_left_open_with_its_share(loom: Scene) -> None:
    (found,) = prove(loom, over=["shaft.speed=300rpm..640rpm"], claims=["margin"], boxes=100).claims
    assert found.status == "open"
    assert 0.0 < found.share < 1.0


@pytest.mark.parametrize(
    "text",
    [
        "[shaft]\nramp_duration = 0.1\nspeed = '600 rev/min'\n",
        '[inputs]\n"belt.guide_clearance" = [[0, 1e-4], [1, 3e-4]]\n',
    ],
)
def test_a_start_up_and_a_table_of_inputs_are_proven_over_time(loom: Scene, text: str) -> None:
    base = loom.text.replace('[shaft]\nspeed = "600 rev/min"\n', "") if "[shaft]" in text else loom.text
    base = base.replace("bound = 0.1", "bound = -0.6")  # the shaft speeds up hard
    scene = parse(base.replace("[[claims]]", f"{text}[[claims]]", 1), "loom")
    margin, transfer = prove(scene, claims=["margin", "transfer"]).claims
    assert margin
    assert transfer or "the claim names angles" in transfer.why  # the table does not reach the frames
    lowest = loomfmu.evaluate(scene).claims[0].worst
    above = parse(scene.text.replace("bound = -0.6", f"bound = {lowest + 1e-4}", 1), "loom")
    assert prove(above, claims=["margin"]).claims[0].status == "refuted"


@pytest.mark.parametrize("revolutions", [20, 100, 1000])
def test_no_pass_through_a_window_is_lost_to_rounding(revolutions: int) -> None:
    for start in range(360):
        window = Window(math.radians(start), math.radians(start + 1))
        passes = Sometime(Sum((), 1.0), window).ranges(0.0, 2.0 * math.pi * revolutions)
        assert len(passes) == revolutions, start


def test_a_proof_goes_as_far_as_the_steps_of_the_run(loom: Scene) -> None:
    text = loom.text.split("[[claims]]")[0].replace("revolutions = 2", "revolutions = 8.9999999919")
    signal = "shaft.angle / 1 rad + weft.travel / 1 m"  # 56.5 at the end, and up to 1.8 of travel
    ends = claim("below", signal=signal, bound=57.0, window=["0 deg", "1 deg"])
    (found,) = prove(parse(text + ends, "loom"), over=["weft.lead=-360deg..360deg"]).claims
    assert found.status == "refuted"


@pytest.mark.parametrize(
    ("signal", "status"),
    [
        ("heald_1.lift + 1e14 m + 1 mm - 1e14 m", "refuted"),  # 99 mm
        ("heald_1.lift + max(0 m, 1e14 m + 1 mm - 1e14 m)", "refuted"),
        ("(1e14 m + 1 mm - 1e14 m) + heald_1.lift", "refuted"),
        ("heald_1.lift - 1e-3 m * 1e17 + 1e17 mm + 1 mm", "refuted"),
        ("heald_1.lift + 1 mm", "refuted"),
        ("heald_1.lift + min(1 m, abs(-0.25 mm))", "proven"),
        ("heald_1.lift * 1e-200 * 1e-200 * 1e200 * 1e200", "proven"),
        ("heald_1.lift * 1e-200 * 1e-200", "cannot be proven"),
    ],
)
def test_the_numbers_of_an_expression_are_exact(loom: Scene, signal: str, status: str) -> None:
    text = loom.text.split("[[claims]]")[0] + claim("below", signal=signal, bound="98.5 mm")
    (found,) = prove(parse(text, "loom")).claims
    assert found.status == status


def test_the_end_of_a_run_belongs_to_the_window_that_begins_there() -> None:
    """Rounding left it out: 260 deg before the start of a revolution is 100 deg after it."""
    start, edge = math.radians(-260.0), math.radians(100.0)
    always = Always((Sum(()),), Window(edge, math.radians(101.0)))
    assert always.ranges(start, start + 2.0 * math.pi)[-1] == pytest.approx((edge, edge))


def test_nothing_is_proven_of_an_input_that_follows_a_table(loom: Scene) -> None:
    table = '[inputs]\n"heald_1.load" = [[0, 10], [1, 20]]\n'
    text = loom.text.split("[[claims]]")[0] + table + claim("below", signal="heald_1.load", bound=15)
    (found,) = prove(parse(text, "loom")).claims
    assert (found.status, found.why) == (
        "cannot be proven",
        "heald_1.load is an input that follows a table or a wire",
    )


def test_the_sense_of_a_turn_is_that_of_the_range_not_of_the_scene(loom: Scene) -> None:
    table = '[inputs]\n"belt.yarn_tension" = [[0, 0], [0.25, 0], [0.3, 9]]\n[[claims]]'
    text = loom.text.replace("[[claims]]", table, 1).replace('bound = "shaft.speed"', "bound = 1")
    boxes = np.repeat(np.array([[0.02, -60.0], [0.04, -60.0]])[..., None], 2, axis=-1)
    margins = []
    for speed in ("600 rev/min", "-600 rev/min"):
        scene = requested(parse(text.replace("600 rev/min", speed), "loom"), None, "native").scene
        chain = Chain(scene, ["belt.margin"], {("shaft", "speed"): 1})
        margins.append(chain.numbers(boxes)["belt.margin"].values)
        assert chain.number("shaft.start_angle", {}, boxes).values.tolist() == 2 * [[0.0, 0.0]]
    assert np.array_equal(*margins)


def test_a_loom_that_turns_backwards_is_proven_at_its_own_angles(loom: Scene) -> None:
    scene = parse(
        loom.text.replace("600 rev/min", "-600 rev/min").replace('bound = "shaft.speed"', "bound = 1"), "loom"
    )
    (found,) = prove(scene, claims=["margin"]).claims
    assert found
    (cover,) = found.covers[0][1]
    assert cover.whole[0].tolist() == pytest.approx([-4 * 3.141592653589793, 0.0])


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"over": ["shaft.speed=640rpm..300rpm"]},
         "shaft.speed: the range from 640 rev/min to 300 rev/min is empty"),
        ({"over": ["heald_1.pattern_length=2..4"]}, "is not a real number"),
        ({"claims": ["margins"]}, "the scene has no claim"),
        ({"over": ["shaft.speed"]}, "a proof over shaft.speed needs a range"),
        ({"over": ["shaft.speed=300rpm..640"]}, "a proof over shaft.speed: .* has no unit"),
        ({"over": "shaft.speed=640rpm..300rpm"}, "is empty"),
        ({"boxes": 0}, "boxes = 0 is not a number of boxes"),
        ({"over": ["shaft.start_angle=0deg..10deg"]}, "all shaft angles are proven"),
        ({"over": ["heald.stroke=97mm..99mm"], "set": {"heald_2.stroke": "105 mm"}},
         "heald_2.stroke keeps a value of its own"),
        ({"over": ["belt.head_mass=1g..2g", "belt.head_mass=2g..3g"]}, "both set"),
    ],
)  # fmt: skip
def test_bad_input_is_refused_in_a_line(loom: Scene, asked: dict[str, list[str]], message: str) -> None:
    with pytest.raises(LoomfmuError, match=message) as caught:
        prove(loom, **asked)  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)


KINDS = {"r": RISES, "i": IN, "f": FALLS, "o": OUT, "u": UNKNOWN}


@pytest.mark.parametrize(
    ("kinds", "proven"),
    [
        ("oriifo", True),
        ("orifo", False),  # too short
        ("orfo", False),  # it may be inside for a moment
        ("orofo", True),  # it never gets there
        ("ifori", False),  # both ends of the run cut one off
        ("iiforii", True),
        ("for", False),
        ("ifrifo", False),  # a short one may follow the one that is cut off
        ("rifo", False),  # it begins within the run
        ("riifo", True),
        ("oriuifo", False),
        ("uo", False),
        ("iii", True),
    ],
)
def test_spans_are_proven_only_where_they_are_known(kinds: str, proven: bool) -> None:
    edges = np.arange(len(kinds) + 1.0)
    cells = np.array([KINDS[each] for each in kinds])
    assert bool(Spans((Sum(()),), 1.5).doubtful(cells, edges).any()) != proven


def test_a_start_up_that_varies_is_proven_over_time(loom: Scene) -> None:
    # the corner of the third side is in no run that is tried: only the cover can see it
    text = loom.text.replace("revolutions = 2", "revolutions = 30").replace("bound = 0.1", "bound = 0.3")
    over = ["belt.bending_stiffness=0.25..0.4", "shaft.ramp_duration=1s..2s", "shaft.speed=300rpm..640rpm"]
    scene = parse(text.replace("600 rev/min", "300 rev/min"), "loom")
    (found,) = prove(scene, over=over, claims=["margin"], boxes=2000).claims
    assert found.status != "proven"
    corner = {"belt.bending_stiffness": 0.25, "shaft.ramp_duration": "1 s", "shaft.speed": "640 rpm"}
    assert loomfmu.evaluate(scene, set=corner).claims[0].holds is False


def test_an_extreme_that_is_held_in_a_window_is_not_proven(loom: Scene) -> None:
    held = 'kind = "above"\nsignal = "belt.lowest_margin"\nwindow = ["300 deg", "30 deg"]'
    scene = parse(loom.text.replace('kind = "lowest_margin"', held), "loom")
    (found,) = prove(scene, claims=["margin"]).claims
    assert "holds what was before the window" in found.why


def test_an_undecided_run_refutes_nothing(loom: Scene) -> None:
    scene = parse(loom.text.replace("revolutions = 2", "revolutions = 0.2"), "loom")
    (found,) = prove(scene, claims=["margin"]).claims
    assert found.status != "refuted"


def test_a_dwell_that_an_end_of_the_run_cuts_off_is_not_proven(loom: Scene) -> None:
    text = loom.text.split("[[claims]]")[0] + claim("dwell", heald="heald_1", at_least="20 deg")
    (found,) = prove(parse(text, "loom"), set={"shaft.start_angle": "150 deg"}).claims
    assert "one is cut off by an end of the run" in found.why


def test_a_dwell_is_not_proven_where_runs_end_at_different_angles(loom: Scene) -> None:
    text = loom.text.split("[[claims]]")[0].replace("revolutions = 2", 'duration = "0.4 s"\nstep = "0.1 ms"')
    text = "\n".join(line for line in text.splitlines() if not line.startswith("steps_per_revolution"))
    text += "\n" + claim("dwell", heald="heald_1", at_least="30 deg")
    (found,) = prove(parse(text, "loom"), over=["shaft.speed=450rpm..600rpm"]).claims
    assert "the run ends at another angle" in found.why


def test_values_that_are_set_stay_set_while_others_vary(loom: Scene) -> None:
    heavier = {"belt.head_mass": "130 g"}
    over = ["shaft.speed=500rpm..560rpm"]
    assert prove(loom, set=heavier, over=over, claims=["margin"]).claims[0].status == "proven"
    (found,) = prove(loom, set=heavier, over=["shaft.speed=500rpm..640rpm"], claims=["margin"]).claims
    assert found.status == "refuted"


HELD = """
revolutions = 2
steps_per_revolution = 360
[loom]
machine = "WL680-3600"
head = "G6300 left"
weave = "10"
[wires]
"heald_1.lift_slope" = "belt.lowest_margin"
[[claims]]
kind = "below"
signal = "heald_1.rotor_torque"
bound = 1e6
at_samples = true
"""


def test_an_extreme_that_another_mechanism_reads_is_no_present_value() -> None:
    (proof,) = prove(parse(HELD, "held")).claims
    assert proof.status == "cannot be proven" and "depends on the run so far" in proof.why


def test_what_is_left_open_is_drawn(loom: Scene, tmp_path: Path) -> None:
    found = prove(loom, over=["shaft.speed=300rpm..640rpm"], claims=["margin", "dwell"], boxes=100)
    axes, dwell = draw(found).axes
    assert (axes.get_title(), dwell.get_title()) == ("margin", "dwell")
    assert not dwell.collections[1].get_paths()
    _proven, left = axes.collections
    (cover,) = found.claims[0].covers[0][1]
    assert len(left.get_paths()) == len(cover.open)
    Path("loom.toml").write_text(loom.text)
    command = ["prove", "loom.toml", "--claim", "margin", "--picture", "open.png"]
    assert main([*command, "--boxes", "50"]) == 1 and Path("open.png").is_file()
    assert main([*command, "--claim", "count", "--force"]) == 1
    assert main(["prove", "loom.toml", "--claim", "count", "--picture", "none.png"]) == 2


def test_a_run_notes_what_is_proven(
    loom: Scene, tmp_path: Path, capsys: pytest.CaptureFixture[str], proofs: Proofs
) -> None:
    result = loomfmu.run(loom, output=tmp_path / "loom.h5", remarks=proofs.remarks)
    text = "proven for all shaft angles and shaft.speed from 300 to 640 rev/min"
    with result.trace as trace:
        notes = [verdict.note for verdict in trace.verdicts]
    assert [text in note for note in notes] == [bool(proof) for proof in proofs.claims]
    (tmp_path / "loom.toml").write_text(loom.text)
    assert main(["run", str(tmp_path / "loom.toml"), "--prove", "shaft.speed=300rpm..640rpm"]) == 0
    assert text in " ".join(capsys.readouterr().out.split())
    assert main(["run", str(tmp_path / "loom.toml"), "--prove", "shaft.speed=300..640"]) == 2
    said = capsys.readouterr().err
    assert "warning: shaft.speed = 300 is read as 300 rad/s" in said
    assert "the scene's shaft.speed = 600 rev/min is outside the range from 2864.789" in said
    Path("loom.toml").write_text(
        loom.text.replace("[[claims]]", '[heald_2]\nstroke = "120 mm"\n[[claims]]', 1)
    )
    assert main(["run", "loom.toml", "--prove", "heald.stroke=97mm..99mm"]) == 2
    assert "the scene's heald_2.stroke = 120 mm is outside" in capsys.readouterr().err
    assert main(["run", str(tmp_path / "loom.toml"), "--prove", "shaft.speed=500rpm..800rpm"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "not proven for shaft.speed from 500 to 800 rev/min:" in said
    assert "refuted: margin (shaft.speed = " in said
