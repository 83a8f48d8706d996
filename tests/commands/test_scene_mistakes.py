"""Mistakes in a scene and in `--set`: one line that names what, where and what would be right."""

from pathlib import Path

import pytest
from scene_texts import claim, table
from small_scenes import CLAIM, HEAD, HUGE, LOOM, one_line, scene

from loomfmu.cli import main

MARGIN = {"signal": "belt.margin", "bound": 1}
ANGLES = '["330 deg", "30 deg"]'
BELT = {  # what is written of the belt, and what is said after its name
    'pattern = "10"': ": a BeltMonitor has no pattern",
    "guide_clearence = 1": " is unknown; did you mean 'guide_clearance'?",
    "margin = 1": " is an output of BeltMonitor and cannot be set",
    "sampled_travel = 1": " is a state of BeltMonitor and cannot be set",
    'guide_clearance = "90 mm"': " = 90 mm is outside [0, 50] mm",
    "guide_clearance = nan": " = nan is not a finite number",
    "yarn_tension = inf": " = inf is not a finite number",
    "bending_stiffness = -0.25": " = -0.25 N.m2 is outside [1e-09, 1000000] N.m2",
    "guide_clearance = [1]": ': [1] is not a quantity such as "685 rpm"',
    "guide_clearance = 2026-01-02": ': 2026-01-02 is not a quantity such as "685 rpm"',
    'guide_clearance = "0,5mm"': ": '0,5mm' has a decimal comma: write \"0.5mm\"",
    "prescribe_length_factor = 1": " = 1 must be true or false",
}
WIRES = {
    ("belt.yarn", "weft.travel"): "belt has no input 'yarn'; did you mean 'yarn_tension'?",
    ("belt.yarn_tension", "weft.travl"): "weft has no output 'travl'; did you mean 'travel'?",
    ("belt.yarn_tension", "wft.travel"): "there is no instance 'wft'; did you mean 'weft'?",
    ("belt.yarn_tension", "weft.travel"): "weft.travel is in m, belt.yarn_tension in N",
}
CLAIMS = [  # kind, arguments, and what is said after the kind
    ("above", {"signal": "belt.margin", "bond": 1}, " has no 'bond'; did you mean 'bound'?"),
    ("above", {"signal": "belt.margin"}, " needs 'bound'"),
    ("above", {"bound": 1}, " needs 'signal'"),
    ("above", {"signal": "belt.margn", "bound": 1}, ": belt has no output 'margn'; did you mean 'margin'?"),
    ("dwell", {"heald": "heald_7", "at_least": 1},
     ": there is no instance 'heald_7'; did you mean 'heald_2'?"),
    ("above", MARGIN | {"bound": "1 mm"},
     ": bound: '1 mm' is in mm, which does not fit a number without a unit"),
    ("above", MARGIN | {"window": "10..20"},
     f": window = '10..20' must be two shaft angles, such as {ANGLES}"),
    ("above", MARGIN | {"window": ["1 mm", 2]}, ": window: '1 mm' is in mm, which does not fit rad"),
    ("lowest_margin", {"bound": "shaft.speed"},
     ": bound: 'shaft.speed' is not a quantity such as \"685 rpm\""),
    ("dwell_contains", {"heald": "heald_1", "angles": [91]},
     ": angles: 91 is 5213.916 deg, outside [-360, 360] deg"),
    ("rapier_in_open_shed", {"head_height": "-5 mm"}, ": head_height = '-5 mm' must not be negative"),
    ("dwell", {"heald": "heald_1", "at_least": 1, "tolerance": 0.9},
     ": tolerance = 0.9 is outside (0, 0.5) of the stroke"),
    ("stop_contacts", {"damper": "damper_1", "at_most": -1}, ": at_most = -1 must not be negative"),
]  # fmt: skip
IN_LOOM = [
    *((table("belt") + f"{line}\n", f"belt.{line.split()[0]}{said}") for line, said in BELT.items()),
    *(
        (f'[wires]\n"{sink}" = "{source}"\n', f"wire {source} -> {sink}: {said}")
        for (sink, source), said in WIRES.items()
    ),
    *(
        (table("damper_1") + claim(kind, **arguments), f"claim {kind!r}{said}")
        for kind, arguments, said in CLAIMS
    ),
    (table("damper_1") + claim("above", signal="belt.margin") + "bound = nan\n",
     "claim 'above': bound = nan is not finite"),
    ('dampers = "no"\n', "loom.dampers = 'no' must be true or false"),
    (table("heald_1", pattern="12"), "heald_1.pattern = '12' is not a string of pegs such as \"1010\""),
    (table("dobby", law="sloped-sin"),
     "dobby.law = 'sloped-sin' must be 'uniform', 'harmonic_ends', 'sloped_line', 'sloped_sine',"
     " 'slotted_levers', 'noncircular_gears', 'spline_cam', 'table' or 'plateau';"
     " did you mean 'sloped_sine'?"),
    ('[wires]\n"belt.travl" = false\n', "wires: 'belt.travl' is not wired; did you mean 'belt.travel'?"),
    ('[wires]\n"belt.travel" = true\n',
     'wires: "belt.travel" = true must be an output, or false to cut the wire'),
    (table("shaft", record=[]),
     "shaft.record is unknown: record belongs to the scene, write it above the first [table]"),
]  # fmt: skip
IN_MOTION = "[loom]\nbelt_motion = true\n[belt_motion]\n"
IN_HEAD = [
    ("revolution = 3\n", "revolution is unknown; did you mean 'revolutions'?"),
    (table("belts_x", a=1),
     "[belts_x] is unknown and has no component = \"...\" of its own; did you mean 'belt'?"),
    (table('"my shaft"', component="MainShaft"),
     "instance name 'my shaft' must be letters, digits and _, with a letter first"),
    (table("time", component="MainShaft"),
     "instance name 'time' is taken: every trace has a time of its own"),
    (table("mine", component="BeltMonito"),
     "there is no component 'BeltMonito'; did you mean 'BeltMonitor'?"),
    (table("mine", component=5), "mine.component = 5 is not a name in quotes"),
    (table("shaft", component="HealdFrame"),
     "shaft.component = 'HealdFrame': the shaft of a scene must be a MainShaft or a DrivenShaft"),
    (IN_MOTION + "guide_end = 3\n", "belt_motion.guide_end = 3 must be 1 (calibrated) or 2 (play)"),
    (IN_MOTION + "guide_end = 'plya'\n",
     "belt_motion.guide_end = 'plya' must be 'calibrated' or 'play'; did you mean 'play'?"),
    (table("shaft", speed=0),
     "shaft.speed = 0 rev/min: the shaft's speed sets the step, so it must not be 0"),
    (table("loom", machin="x"), "loom.machin is unknown; did you mean 'machine'?"),
    (table("loom", machine="WL680-36"), "there is no machine 'WL680-36'; did you mean 'WL680-3600'?"),
    (table("loom", machine=5), "weft.machine = 5 is not a name in quotes"),
    (LOOM.replace(" left", ""), "there is no head 'G6300'; did you mean 'G6300 left'?"),
    (table("shaft", speed="600 rpmm"), "shaft.speed: unknown unit 'rpmm'; did you mean 'rpm'?"),
    (table("shaft", speed="600 mm"), "shaft.speed: '600 mm' is in mm, which does not fit rad/s"),
    (table("shaft", ripple_order=1.5), "shaft.ripple_order = 1.5 is not a whole number"),
    (claim("abov"), "claim kind = 'abov' is unknown; did you mean 'above'?"),
]  # fmt: skip
TURNS = "revolutions = 1"
WHOLE = [
    (
        '[claims]\nkind = "above"\n\n[[claims]]\nkind = "below"\n',
        "claims are written as [[claims]] tables, with two brackets; line 1 has [claims]",
    ),
    ("a = = 5", "not valid TOML: Invalid value (at line 1, column 5)"),
    (HEAD.replace("90", "0"), "steps_per_revolution = 0 is outside [1, 1e+09]"),
    (HEAD.replace("90", "90.5"), "steps_per_revolution = 90.5 is not a whole number"),
    (HEAD.replace("90", "'many'"), "steps_per_revolution = 'many' is not a number"),
    (HEAD.replace(TURNS, "revolutions = -1"), "revolutions = -1 is outside [1e-09, 1e+09]"),
    (HEAD.replace(TURNS, "revolutions = 1e-6"), "revolutions = 1e-06 at 90 steps each is less than one step"),
    (HEAD.replace(TURNS, "revolutions = nan"), "revolutions = nan is outside [1e-09, 1e+09]"),
    (f"record = 'belt.margin'\n{HEAD}{LOOM}",
     'record = \'belt.margin\' is not a list such as ["belt.*", "weft.travel"]'),
    (f"record = ['belt.margn']\n{HEAD}{LOOM}",
     "record: no output is called 'belt.margn'; did you mean 'belt.margin'?"),
    (HEAD + LOOM + table("heald_1", pattern="10" * 65), "heald_1.pattern has 130 picks; the dobby holds 128"),
    (f"wires = 5\n{HEAD}", 'wires must be a table of "instance.input" = "instance.output"'),
    (f"claims = 5\n{HEAD}", "claims are written as [[claims]] tables, with two brackets"),
    (f"{HEAD}[shaft]\nspeed = {HUGE}\n", f"shaft.speed: {HUGE[:60]}... is too large"),
    (HEAD.replace(TURNS, f"revolutions = {HUGE}"), f"revolutions = {HUGE[:60]}... is outside [1e-09, 1e+09]"),
    (HEAD + LOOM + CLAIM.format(bound=HUGE), f"claim 'lowest_margin': bound: {HUGE[:60]}... is too large"),
    (f"{HEAD}{LOOM}[heald]\npattern_length = {HUGE}\n",
     f"heald_1.pattern_length = {HUGE[:60]}... is outside [1, 128]"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "said"),
    [
        *((HEAD + LOOM + text, said) for text, said in IN_LOOM),
        *((HEAD + text, said) for text, said in IN_HEAD),
        *WHOLE,
    ],
)
def test_a_mistake_in_a_scene_is_told_in_one_line(
    capsys: pytest.CaptureFixture[str], text: str, said: str
) -> None:
    assert main(["run", scene(text)]) == 2
    assert one_line(capsys) == f"scene.toml: {said}"
    assert not Path("results").exists()  # nothing was run, nothing written


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("bel.travel=1", "bel.travel: the scene has no instance 'bel'; did you mean 'belt'?"),
        ("belt.margin=1", "belt.margin is an output of BeltMonitor and cannot be set"),
        ("revolution=2", "'revolution' cannot be set; did you mean 'revolutions'?"),
        ("shaft.speed=", "shaft.speed: '' is not a quantity such as \"685 rpm\""),
        ("shaft.speed=nan", "shaft.speed: 'nan' is not a quantity such as \"685 rpm\""),
        ("shaft.speed=1e999", "shaft.speed = inf is not a finite number"),
        ("heald.strok=1", "heald_1.strok is unknown; did you mean 'stroke'?"),
        ("heald.inputs_at_step_end=maybe", "heald_1.inputs_at_step_end = 'maybe' must be true or false"),
    ],
)
def test_a_mistake_in_set_is_told_in_one_line(
    capsys: pytest.CaptureFixture[str], given: str, said: str
) -> None:
    assert main(["run", scene(HEAD + LOOM), "--set", given]) == 2
    assert one_line(capsys) == f"scene.toml: {said}"


def test_a_value_that_is_set_is_one_of_a_variable(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", scene(HEAD + LOOM), "--set", "belt.guide_clearance"]) == 2
    assert one_line(capsys) == "--set belt.guide_clearance: not of the form INSTANCE.VARIABLE=VALUE"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('[weft]\ncrank_cone = "80 deg"\n',
         "weft: the spherical linkage does not close over a whole turn: |cos(rocker_angle = 60 deg)|"
         " reaches or exceeds |cos(crank_cone = 80 deg)|"),
        ('[weft]\ncoupler_length = "20 mm"\n',
         "weft: the planar four-bar does not close over the rocker's swing: crank_length = 150 mm,"
         " coupler_length = 20 mm, output_length = 121 mm, pivot at (243 mm, 258 mm)"),
        ("[weft]\nassembly = 0\n", "weft: assembly = 0 must be -1 or 1"),
        ('[damper_1]\nstart_displacement = "20 mm"\n',
         "damper_1: start_displacement = 20 mm must lie between the stops at free_travel = 15 mm"),
    ],
)  # fmt: skip
def test_values_that_do_not_go_together_are_told_in_one_line(
    capsys: pytest.CaptureFixture[str], text: str, said: str
) -> None:
    assert main(["run", scene(HEAD + LOOM + text)]) == 2
    assert one_line(capsys).startswith(said)
    assert not Path("results").exists()
