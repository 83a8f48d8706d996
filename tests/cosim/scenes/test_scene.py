"""What a scene says, and what becomes of it."""

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import scene_texts as texts
from direct_loom import small, traced
from scene_texts import HEAD, MOTION, parsed, table, wires

from loomfmu import LoomfmuError, units
from loomfmu.cosim.reading import checked_claims
from loomfmu.cosim.run import run
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.graph import Wire
from loomfmu.machines import parameters

LOOM = texts.loom('weave = "10/01/10/01"\ndampers = true\n')
RPM = 2 * math.pi / 60


LENGTH_OF_450 = parameters("BeltMonitor", machine="WL450-3600")["head_length"]


def wired(*parts: str) -> set[str]:
    return {str(wire) for wire in parsed(*parts).wires}


def values_of(name: str, *parts: str, **overrides: Any) -> dict[str, Any]:
    """The values of one instance."""
    return parsed(*parts, **overrides).instances[name].values


def refusal(*parts: str, **overrides: Any) -> str:
    with pytest.raises(LoomfmuError) as raised:
        parsed(*parts, **overrides)
    return str(raised.value)


def test_a_standard_loom_is_spelt_out_by_nobody() -> None:
    scene = parsed(LOOM)
    frames = [f"{kind}_{number}" for kind in ("heald", "damper") for number in range(1, 5)]
    assert list(scene.instances) == ["shaft", "weft", "belt", "dobby", *frames]
    kinds = {name: instance.fmu.name for name, instance in scene.instances.items()}
    assert kinds["heald_3"] == "HealdFrame"
    assert kinds["damper_4"] == "HealdDamper"
    wires = {str(wire) for wire in scene.wires}
    for name in ("weft", "belt", "dobby"):
        for signal in ("angle", "velocity", "acceleration"):
            assert f"shaft.{signal} -> {name}.shaft_{signal}" in wires
    assert "weft.travel -> belt.travel" in wires
    assert "dobby.rotor_angle -> heald_2.rotor_angle" in wires
    assert "heald_3.lift -> damper_3.lift" in wires
    assert not any("heald_3" in wire and "damper_4" in wire for wire in wires)


def test_mechanisms_on_the_shaft_follow_it_of_themselves() -> None:
    scene = parsed(LOOM)
    for name, instance in scene.instances.items():
        follows = name in ("weft", "belt", "dobby")
        assert instance.values.get("follow_shaft", False) is follows
        assert instance.values.get("inputs_at_step_end", False) is (name != "shaft")
    alone = parsed(LOOM + "[weft]\nfollow_shaft = false\n")
    assert alone.instances["weft"].values["follow_shaft"] is False


GROUP, OWN = table("heald", stroke="60 mm", frame_mass=10.0), table("heald_2", stroke="70 mm")
MEMBERS = table("heald_1", pattern="10") + table("heald_2", pattern="01")
STROKES = {f"heald_{n}.stroke": 0.07 if n == 2 else 0.06 for n in (1, 2, 3, 4)}
OTHER_HEAD = {"weft.moving_mass": 0.1222, "belt.head_mass": 0.1222}
TRAVEL = table("belt", idle_travel="200 mm")


@pytest.mark.parametrize(
    ("text", "given", "values"),
    [
        # published machines and heads set what they know
        (LOOM, {}, {"weft.output_length": 0.121, "weft.moving_mass": 0.1105}),
        (LOOM, {}, {"belt.head_mass": 0.1105, "belt.head_length": 0.55}),
        (
            LOOM + table("belt", head="GS900 left", head_length="540 mm"),
            *({}, {"belt.head_mass": 0.1222, "belt.head_length": 0.54, "weft.moving_mass": 0.1105}),
        ),
        (LOOM, {"head": "GS900 left"}, OTHER_HEAD),
        (LOOM, {"loom.head": "GS900 left"}, OTHER_HEAD),
        # a value of the scene prevails over the machine, and one that is set over both
        (
            LOOM + TRAVEL,
            {"machine": "WL450-3600"},
            {"belt.idle_travel": 0.2, "belt.head_length": LENGTH_OF_450},
        ),
        (LOOM + TRAVEL, {"machine": "WL450-3600", "belt.idle_travel": 0.3}, {"belt.idle_travel": 0.3}),
        (LOOM + TRAVEL, {"belt.idle_travel": 0.3, "machine": "WL450-3600"}, {"belt.idle_travel": 0.3}),
        # every frame has its string of pegs
        (LOOM, {}, {"heald_1.pattern_length": 2, "heald_1.pattern_1": 1}),
        (LOOM + table("heald_2", pattern="0010"), {}, {"heald_2.pattern_length": 4, "heald_2.pattern_1": 4}),
        (
            LOOM + table("heald_1", pattern="1" * 17 + "0" * 3),
            *({}, {"heald_1.pattern_length": 20, "heald_1.pattern_1": 65535, "heald_1.pattern_2": 1}),
        ),
        # a table without a number is for all members, wherever it stands, and a member's own says more
        (LOOM + GROUP + OWN, {}, STROKES | {"heald_2.frame_mass": 10.0}),
        (LOOM + OWN + GROUP, {}, STROKES | {"heald_2.frame_mass": 10.0}),
        (GROUP + MEMBERS, {}, {"heald_1.stroke": 0.06, "heald_2.stroke": 0.06}),
        (MEMBERS + GROUP, {}, {"heald_1.stroke": 0.06, "heald_2.stroke": 0.06}),
        # so it is with what is set, in any order
        (
            LOOM + table("heald_1", stroke="80 mm"),
            *({"heald.stroke": "60mm", "heald_2.stroke": "70 mm"}, STROKES),
        ),
        (LOOM, {"heald_2.stroke": "70 mm", "heald.stroke": "60mm"}, STROKES),
        # numbers are SI, and texts have units
        (LOOM, {"belt.guide_clearance": "0.5mm"}, {"belt.guide_clearance": 0.5e-3}),
        *(
            ("[shaft]", {"shaft.speed": speed}, {"shaft.speed": 71.733})
            for speed in (71.733, "71.733", "71.733 rad/s")
        ),
        ("[shaft]", {"shaft.speed": "685 rpm"}, {"shaft.speed": 685 * RPM}),
        ("[shaft]", {"shaft.ripple_order": "3"}, {"shaft.ripple_order": 3}),
        # a law has a name or a number
        *(
            (f"[dobby]\nlaw = {law}\n", {}, {"dobby.law": 3})
            for law in ("'sloped_line'", "'sloped-line'", "'sloped line'", "3", "'3'")
        ),
        ("[dobby]\nlaw = 'uniform'\n", {}, {"dobby.law": 1}),
        *(
            (f"[belt]\nprescribe_length_factor = {given}\n", {}, {"belt.prescribe_length_factor": value})
            for given, value in (("true", True), ("false", False), ("'true'", True), ("'False'", False))
        ),
    ],
)
def test_values_that_a_scene_and_set_give(text: str, given: dict[str, Any], values: dict[str, Any]) -> None:
    instances = parsed(text, **given).instances
    for name, value in values.items():
        owner, _, variable = name.partition(".")
        found = instances[owner].values[variable]
        assert type(found) is type(value) and found == pytest.approx(value, rel=1e-15)  # one product


# ---- wires


@pytest.mark.parametrize(
    ("lines", "less", "more"),
    [
        (wires(belt__yarn_tension="damper_1.transmitted_force"), (),
         "damper_1.transmitted_force -> belt.yarn_tension"),
        (wires(damper_2__lift="heald_1.lift"), "heald_2.lift -> damper_2.lift",
         "heald_1.lift -> damper_2.lift"),
        ('damper_2 = {lift = "heald_1.lift"}', "heald_2.lift -> damper_2.lift",
         "heald_1.lift -> damper_2.lift"),
        *(
            (cut, "weft.travel -> belt.travel", ())
            for cut in ('"belt.travel" = false', "belt.travel = false", "belt = {travel = false}")
        ),
    ],
)  # fmt: skip
def test_a_wire_can_be_added_replaced_and_cut(lines: str, less: Any, more: Any) -> None:
    less, more = ({each} if each else set() for each in (less, more))
    assert wired(LOOM, "[wires]\n", lines) == wired(LOOM) - less | more


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            LOOM + "[wires]\n" + wires(belt__travl=False),
            "wires: 'belt.travl' is not wired; did you mean",
        ),
        ('coupling = "iterate"', "coupling = 'iterate' is unknown; did you mean 'iterated'"),
    ],
)
def test_a_name_with_a_slip_is_refused(text: str, said: str) -> None:
    assert refusal(text).startswith(said)


CUT = "[wires]\n" + wires(**{f"belt__{each}": False for each in HEAD})


def test_an_input_whose_wire_is_cut_takes_a_value_or_its_start(tmp_path: Path) -> None:
    own = table("belt", travel="900 mm", velocity=0.0, acceleration=100.0)
    assert wired(LOOM, own, CUT) == wired(LOOM) - {f"weft.{each} -> belt.{each}" for each in HEAD}
    start = small().instances["belt"].fmu.ports["acceleration"].start
    for given, acceleration in ((own, 100.0), ("", start)):
        with traced(small(90, 0.1, rest=given + CUT), tmp_path) as trace:
            assert set(trace["belt.inertia_force"]) == {0.1105 * acceleration}


# ---- own names, and what a loom has one of


def test_one_frame_needs_no_number() -> None:
    scene = parsed('[dobby]\n[heald]\npattern = "10"\n[damper]\n')
    assert "heald.lift -> damper.lift" in {str(wire) for wire in scene.wires}
    assert "dobby.rotor_angle -> heald.rotor_angle" in {str(wire) for wire in scene.wires}


def test_set_reaches_the_runs_own_keys() -> None:
    scene = parsed("revolutions = 9\n", LOOM, revolutions="2.5", steps_per_revolution="360")
    assert (scene.periods, scene.steps_per_period, scene.steps) == (2.5, 360, 900)
    both = {"machine": "WL680-3800", "loom.machine": "WL680-3600"}
    assert re.match(r"machine and loom\.machine both set \w+\.machine; leave out", refusal(LOOM, **both))


def test_components_under_names_of_their_own() -> None:
    motion = {f"left_head__shaft_{each}": f"shaft.{each}" for each in ("angle", "velocity")}
    head = table("left_head", component="WeftInsertion", machine="WL800-3600")
    scene = parsed(head, "[wires]\n", wires(**motion))
    left = scene.instances["left_head"]
    assert left.fmu.name == "WeftInsertion"
    assert left.values["planar_linkage"] is False
    assert left.values["follow_shaft"] is True
    # the standard wires of a component hold under any name
    assert Wire(("shaft", "acceleration"), ("left_head", "shaft_acceleration")) in scene.wires


MIXED = (
    "the loom mixes machines: weft has WL450-3600 and belt has WL680-3600; machine = NAME sets all of them"
)


@pytest.mark.parametrize("key", ["machine", "loom.machine"])
def test_a_machine_is_set_for_all_that_have_one(key: str) -> None:
    changed = parsed(LOOM, **{key: "WL450-3600"})
    written = parsed(LOOM.replace("WL680-3600", "WL450-3600"))
    for name in ("weft", "belt"):
        assert changed.instances[name].values == written.instances[name].values
        assert changed.instances[name].published["machine"] == "WL450-3600"
    assert changed.notes == written.notes == ()


def test_a_loom_of_two_machines_is_named(tmp_path: Path) -> None:
    half = {"weft.machine": "WL450-3600", "revolutions": 0.1}
    assert parsed(LOOM, **half).notes == (MIXED,)
    assert parsed(LOOM + '[weft]\nmachine = "WL450-3600"\n').notes == (MIXED,)
    result = run(parsed(LOOM, **half), output=tmp_path / "mixed.h5")
    assert result.warnings == (MIXED,)
    assert result.trace.attributes["notes"] == MIXED
    whole = half | {"belt.machine": "WL450-3600"}
    assert parsed(LOOM, **whole).notes == ()


def test_an_instance_that_names_no_machine_counts_by_its_values() -> None:
    of_680 = '[weft]\nmachine = "WL680-3600"\n[belt]\n'  # what the defaults are of
    assert parsed(of_680).notes == ()
    assert parsed(of_680.replace("680", "450")).notes == (MIXED.replace("WL680-3600", "its own values"),)


@pytest.mark.parametrize(
    ("text", "given", "said"),
    [
        (LOOM, {"machine": "WL45-3600"}, "there is no machine 'WL45-3600'; did you mean 'WL450-3600'?"),
        (LOOM, {"machine": 5}, "weft.machine = 5 is not a name in quotes"),
        (LOOM, {"loom.speed": "10"}, "loom.speed cannot be set; known: machine, head, weave"),
        ("[shaft]", {"loom.weave": "10"}, "loom.weave: the scene has no [loom]; set the pattern of"),
        (LOOM, {"weave": "10"}, "'weave' cannot be set; did you mean 'loom.weave'?"),
        (LOOM, {"speed": "1"}, "'speed' cannot be set; did you mean 'shaft.speed'?"),
        (LOOM, {"guide_clearance": "1"}, "'guide_clearance' cannot be set; did you mean 'belt.guide_cl"),
        (LOOM, {"shaft": "1"}, "'shaft' cannot be set: it is an instance; set one of its variables, such"),
        (LOOM, {"shaft.machine": "WL450-3600"}, "shaft.machine: a MainShaft has no machine"),
        ("[shaft]", {"machine": "WL450-3600"}, "machine: the scene has no WeftInsertion, BeltMonitor or"),
    ],
)
def test_a_machine_that_cannot_be_set_is_refused(text: str, given: dict[str, object], said: str) -> None:
    assert refusal(text, **given).startswith(said)


def test_the_weave_can_be_set(tmp_path: Path) -> None:
    (tmp_path / "twill.wif").write_text(
        "[WIF]\nVersion=1.1\n[WEAVING]\nShafts=3\n[WEFT]\nThreads=2\n[LIFTPLAN]\n1=1,2\n2=3\n[THREADING]\n1=1\n"
    )
    for weave, frames in (("10/01/11", 3), ("twill.wif", 3), (["10"], 1)):
        scene = parsed(LOOM, loom__weave=weave, directory=tmp_path)
        assert sum(name.startswith("heald_") for name in scene.instances) == frames
        assert list(scene.texts) == ["twill.wif"] * (weave == "twill.wif")


# ---- an input has one source

WIRED = "belt.travel cannot be set, it is wired to weft.travel; to set it, cut the wire: [wires]"
WIRED += ' "belt.travel" = false'
DRIVEN = "belt.guide_clearance cannot be set, it is driven along a table"
TABLE = '[inputs]\n"belt.guide_clearance" = [[0, "0.3 mm"], [1, "1 mm"]]\n'


@pytest.mark.parametrize(
    ("more", "given", "said"),
    [
        ("", {"belt__travel": 3}, WIRED),
        (table("belt", travel="3 m"), {}, WIRED),
        ('[inputs]\n"belt.travel" = [[0, 1.0]]\n', {}, "inputs.belt.travel is wired already"),
        (TABLE, {"belt__guide_clearance": "1 mm"}, DRIVEN),
        (table("belt", guide_clearance="1 mm") + TABLE, {}, DRIVEN),
    ],
)
def test_a_value_for_an_input_that_has_a_source_is_refused_whoever_gives_it(
    more: str, given: dict[str, Any], said: str
) -> None:
    assert refusal(LOOM, more, **given).startswith(said)
    assert values_of("belt", LOOM, "[wires]\n", wires(belt__travel=False), belt__travel=3)["travel"] == 3.0


# ---- numbers without unit

DOUBT = 'is read as 480 rad/s = 4583.662 rev/min; write "480 rev/min" if that is meant'


@pytest.mark.parametrize(
    ("more", "given", "note"),
    [
        ("[shaft]\nspeed = 480\n", {}, f"shaft.speed = 480 {DOUBT}"),
        ("", {"shaft__speed": "480"}, f"shaft.speed = 480 {DOUBT}"),
        ("", {"belt__head_mass": 95},
         'belt.head_mass = 95 is read as 95 kg = 95000 g; write "95 g" if that is meant'),
        ('[inputs]\n"weft.shaft_velocity" = [[0, 480]]\n[wires]\n"weft.shaft_velocity" = false\n', {},
         f"inputs.weft.shaft_velocity = 480 {DOUBT}"),
        ("[shaft]\nspeed = 480\n", {"shaft__speed": "480 rpm"}, ""),  # what is set anew is doubted anew
        # ordinary numbers are not doubted
        *(
            ("", {f"{name}": value}, "")
            for name, values in {
                "shaft__speed": ("4583 rpm", "480 rad/s", 30.0, 120, -70.0),
                "belt__guide_clearance": (1e-3,),
                "belt__head_mass": (0.2,),
                "dobby__slow_point": (1.5,),
                "damper__spring_stiffness": (1000.0, 0.0),
                "heald__stroke": (0.3,),
            }.items()
            for value in values
        ),
    ],
)  # fmt: skip
def test_a_number_that_was_meant_in_another_unit_is_doubted(
    more: str, given: dict[str, Any], note: str
) -> None:
    assert parsed(LOOM, more, **given).notes == ((note,) if note else ())


DEFLECTION = {"kind": "below", "signal": "belt.deflection"}
MARGIN = {"kind": "above", "signal": "belt.margin", "bound": 0}
ROOM = {"kind": "rapier_in_open_shed", "head_height": 18}
TOO_HIGH = 'head_height = 18 is read as 18 m = 18000 mm; write "18 mm" if that is meant'


@pytest.mark.parametrize(
    ("claim", "note"),
    [
        (DEFLECTION | {"bound": 2}, "claim 'below' of belt.deflection: bound = 2 is read as 2 m = 2000 mm;"
         ' write "2 mm" if that is meant'),
        ({"kind": "dwell", "heald": "heald_1", "at_least": 85},
         "claim 'dwell': at_least = 85 is read as 85 rad = 4870.141 deg;"
         ' write "85 deg" if that is meant'),
        (ROOM, f"claim 'rapier_in_open_shed': {TOO_HIGH}"),
        (ROOM | {"name": "the head fits"}, f"claim 'the head fits': {TOO_HIGH}"),
        (DEFLECTION | {"bound": "2 mm", "window": ["210 deg", "150 deg"]},
         "claim 'below': window = [210 deg, 150 deg] covers 300 deg, through 360 deg;"
         ' write ["150 deg", "210 deg"] for the other part of the revolution, or ["-150 deg", "150 deg"]'
         " if this one is meant"),
        # ordinary ones are not doubted
        (DEFLECTION | {"bound": 0.002}, ""),
        (DEFLECTION | {"bound": "2 m"}, ""),
        ({"kind": "dwell", "heald": "heald_1", "at_least": 1.5}, ""),
        (MARGIN | {"window": [0, 6.283185307179586]}, ""),
        (MARGIN | {"window": ["330 deg", "30 deg"]}, ""),
        (MARGIN | {"window": ["-150 deg", "150 deg"]}, ""),
        ({"kind": "above", "signal": "belt.lowest_speed_limit", "bound": "shaft.speed"}, ""),
    ],
)  # fmt: skip
def test_claims_that_were_probably_meant_otherwise_are_doubted(claim: dict[str, Any], note: str) -> None:
    scene = replace(parsed(LOOM, revolutions=2), claims=[claim])
    notes = (note,) if note else ()
    assert checked_claims(scene).scene.notes == notes
    assert checked_claims(checked_claims(scene).scene).scene.notes == notes  # told once


# ---- duration


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            'duration = "10 s"\nstep = "0.15 s"\n[weft]\n',
            "duration = 10 s is 66.66667 steps of 0.15 s, not a whole number of steps;"
            " these would fit: 9.9 s or 10.05 s",
        ),
        (
            "revolutions = 2.51\nsteps_per_revolution = 90\n[weft]\n",
            "revolutions = 2.51 is 225.9 steps of 1/90 revolution, not a whole number of steps;"
            " these would fit: 2.5 or 2.511111111",
        ),
    ],
)
def test_a_duration_that_is_not_whole_steps_is_refused(text: str, said: str) -> None:
    assert refusal(text) == said
    key, fitting = text.split(" ")[0], said.split(": ")[1].split(" or ")
    for value in fitting:
        assert parsed(text, **{key: value}).steps in (66, 67, 225, 226)


def test_decimal_steps_that_binary_rounds_are_whole() -> None:
    for step in ("1 ms", "0.1 ms", 0.0007, 1 / 3):
        given = {"duration": 2100 * units.parse(step, "s"), "step": step}
        assert parsed("[shaft]", **given).steps == 2100


@pytest.mark.parametrize(
    "text", ["", 'title = "x"\n', "revolutions = 3\n", 'duration = "1 s"\nstep = "1 ms"\n']
)
def test_an_empty_scene_is_refused(text: str) -> None:
    with pytest.raises(LoomfmuError, match=r"the scene is empty: add \[loom\]|there is no shaft"):
        parsed(text)


# ---- the rest


def test_records_by_pattern() -> None:
    scene = parsed('record = ["belt.*margin", "heald_?.lift", "weft.travel"]\n' + LOOM)
    assert scene.record == [
        "weft.travel",
        "belt.margin",
        "belt.lowest_margin",
        *(f"heald_{number}.lift" for number in range(1, 5)),
    ]
    everything = parsed(LOOM).record
    assert "dobby.pick" in everything and "belt.at_risk" in everything
    assert not any(signal.split(".")[1] == "shaft_angle" for signal in everything)  # inputs are not outputs


def test_what_is_recorded_has_its_rates_with_it(tmp_path: Path) -> None:
    text = 'revolutions = 0.1\nrecord = ["heald_1.lift"]\n' + LOOM
    with traced(parsed(text), tmp_path) as trace:
        assert set(trace) == {
            "shaft.angle",
            "shaft.velocity",
            "shaft.acceleration",
            "heald_1.lift",
            "heald_1.velocity",
            "heald_1.acceleration",
        }
    with traced(parsed("record = []\n" + LOOM), tmp_path) as trace:
        assert set(trace) == {"shaft.angle", "shaft.velocity", "shaft.acceleration"}


def test_defaults_of_a_scene_that_says_nothing() -> None:
    scene = scenes.parse("[shaft]", "nothing")
    assert (scene.title, scene.description, scene.name) == ("nothing", "", "nothing")
    assert (scene.periods, scene.steps_per_period, scene.steps) == (1, 1440, 1440)
    assert math.isclose(scene.speed, 400 * RPM, rel_tol=1e-15)
    assert scene.claims == []


def test_a_file_is_named_in_what_is_said_of_it(tmp_path: Path) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text("[belt]\nmargin = 3\n")
    with pytest.raises(LoomfmuError) as raised:
        scenes.load(path)
    assert str(raised.value) == f"{path}: belt.margin is an output of BeltMonitor and cannot be set"
    path.write_bytes(b"title = '\xff'\n")
    with pytest.raises(LoomfmuError, match=r"wrong\.toml: is not text in UTF-8"):
        scenes.load(path)


def test_a_mechanism_that_follows_no_shaft_beside_one_is_named() -> None:
    cut = wires(**{f"weft__shaft_{each}": False for each in MOTION})
    note = "weft runs at its own constant speed: its shaft inputs are not wired to the shaft"
    assert note in parsed(texts.LOOM, "[wires]\n", cut).notes
    assert parsed(texts.LOOM).notes == ()


@pytest.mark.parametrize(("first", "warned"), [(2.9, False), (3, True), (20, True)])
def test_a_table_that_begins_after_the_run_is_warned_of(first: float, warned: bool) -> None:
    rows = wires(belt__guide_clearance=[[first, "0.3 mm"], [30, "1 mm"]])
    said = f"inputs.belt.guide_clearance begins at {first:g}, after the end at 3: its first value holds"
    assert (
        any(note.startswith(said) for note in parsed(texts.LOOM, "[inputs]\n", rows, revolutions=3).notes)
        == warned
    )


def test_a_mark_of_the_encoding_is_read_over_and_what_is_no_text_is_told(tmp_path: Path) -> None:
    text = DEMO_TEXT
    marked = tmp_path / "marked.toml"
    marked.write_bytes(text.encode("utf-8-sig"))
    assert scenes.load(marked).text == text
    for name, content, said in (
        ("wide.toml", text.encode("utf-16"), "is not text in UTF-8"),
        ("run.h5", b"\x89HDF\r\n\x1a\n", "is not text in UTF-8; use loomfmu show .*run.h5 for a trace"),
        (
            "m.fmu",
            b"PK\x03\x04\xff",
            r"is not text in UTF-8; loomfmu list .*m\.fmu shows an FMU; .* fmu = .*",
        ),
    ):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(LoomfmuError, match=f"{name}: {said}$"):
            scenes.load(tmp_path / name)


DEMO_TEXT = 'title = "Fäden"\n[loom]\nmachine = "WL680-3600"\n'
