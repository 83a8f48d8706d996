"""Mistakes in a scene and in `--set`: one line that names what, where and what would be right."""

from pathlib import Path

import pytest
from small_scenes import HEAD, HUGE, LOOM, one_line, scene

from loomfmu.cli import main

OF_CLAIMS = [
    (
        'kind = "above"\nsignal = "belt.margin"\nbond = 1\n',
        "claim 'above' has no 'bond'; did you mean 'bound'?",
    ),
    ('kind = "above"\nsignal = "belt.margin"\n', "claim 'above' needs 'bound'"),
    (
        'kind = "above"\nsignal = "belt.margn"\nbound = 1\n',
        "claim 'above': belt has no output 'margn'; did you mean 'margin'?",
    ),
    (
        'kind = "dwell"\nheald = "heald_7"\nat_least = 1\n',
        "claim 'dwell': there is no instance 'heald_7'; did you mean 'heald_2'?",
    ),
    (
        'kind = "above"\nsignal = "belt.margin"\nbound = "1 mm"\n',
        "claim 'above': bound: '1 mm' is in mm, which does not fit a number without a unit",
    ),
    ('kind = "above"\nsignal = "belt.margin"\nbound = nan\n', "claim 'above': bound = nan is not finite"),
    (
        'kind = "above"\nsignal = "belt.margin"\nbound = 1\nwindow = "10..20"\n',
        "claim 'above': window = '10..20' must be two shaft angles, such as [\"330 deg\", \"30 deg\"]",
    ),
    (
        'kind = "above"\nsignal = "weft.travel"\nbound = 1\nwindow = ["1 mm", 2]\n',
        "claim 'above': window: '1 mm' is in mm, which does not fit rad",
    ),
    (
        'kind = "lowest_margin"\nbound = "shaft.speed"\n',
        "claim 'lowest_margin': bound: 'shaft.speed' is not a quantity such as \"685 rpm\"",
    ),
    (
        'kind = "dwell_contains"\nheald = "heald_1"\nangles = [91]\n',
        "claim 'dwell_contains': angles: 91 is 5213.916 deg, outside [-360, 360] deg",
    ),
    (
        'kind = "rapier_in_open_shed"\nhead_height = "-5 mm"\n',
        "claim 'rapier_in_open_shed': head_height = '-5 mm' must not be negative",
    ),
    (
        'kind = "dwell"\nheald = "heald_1"\nat_least = 1\ntolerance = 0.9\n',
        "claim 'dwell': tolerance = 0.9 is outside (0, 0.5) of the stroke",
    ),
]
IN_LOOM = [
    ('dampers = "no"\n', "loom.dampers = 'no' must be true or false"),
    ('[heald_1]\npattern = "12"\n', "heald_1.pattern = '12' is not a string of pegs such as \"1010\""),
    ('[belt]\npattern = "10"\n', "belt.pattern: a BeltMonitor has no pattern"),
    ("[belt]\nguide_clearence = 1\n", "belt.guide_clearence is unknown; did you mean 'guide_clearance'?"),
    ("[belt]\nmargin = 1\n", "belt.margin is an output of BeltMonitor and cannot be set"),
    ("[belt]\nsampled_travel = 1\n", "belt.sampled_travel is a state of BeltMonitor and cannot be set"),
    ('[belt]\nguide_clearance = "90 mm"\n', "belt.guide_clearance = 90 mm is outside [0, 50] mm"),
    ("[belt]\nguide_clearance = nan\n", "belt.guide_clearance = nan mm is outside [0, 50] mm"),
    ("[belt]\nyarn_tension = inf\n", "belt.yarn_tension = inf cN is outside [-1e+08, 1e+08] cN"),
    (
        "[belt]\nbending_stiffness = -0.25\n",
        "belt.bending_stiffness = -0.25 N.m2 is outside [1e-09, 1000000] N.m2",
    ),
    ("[belt]\nguide_clearance = [1]\n", 'belt.guide_clearance: [1] is not a quantity such as "685 rpm"'),
    (
        '[dobby]\nlaw = "sloped-sin"\n',
        "dobby.law = 'sloped-sin' must be 'uniform', 'harmonic_ends', 'sloped_line', 'sloped_sine',"
        " 'slotted_levers', 'noncircular_gears', 'spline_cam', 'table' or 'plateau';"
        " did you mean 'sloped_sine'?",
    ),
    ("[belt]\nprescribe_length_factor = 1\n", "belt.prescribe_length_factor = 1 must be true or false"),
    (
        '[wires]\n"belt.yarn" = "weft.travel"\n',
        "wire weft.travel -> belt.yarn: belt has no input 'yarn'; did you mean 'yarn_tension'?",
    ),
    (
        '[wires]\n"belt.yarn_tension" = "weft.travl"\n',
        "wire weft.travl -> belt.yarn_tension: weft has no output 'travl'; did you mean 'travel'?",
    ),
    (
        '[wires]\n"belt.yarn_tension" = "wft.travel"\n',
        "wire wft.travel -> belt.yarn_tension: there is no instance 'wft'; did you mean 'weft'?",
    ),
    (
        '[wires]\n"belt.yarn_tension" = "weft.travel"\n',
        "wire weft.travel -> belt.yarn_tension: weft.travel is in m, belt.yarn_tension in N",
    ),
    ('[wires]\n"belt.travl" = false\n', "wires: 'belt.travl' is not wired; did you mean 'belt.travel'?"),
    (
        '[wires]\n"belt.travel" = true\n',
        'wires: "belt.travel" = true must be an output, or false to cut the wire',
    ),
    (
        "[belt]\nguide_clearance = 2026-01-02\n",
        'belt.guide_clearance: 2026-01-02 is not a quantity such as "685 rpm"',
    ),
    (
        '[belt]\nguide_clearance = "0,5mm"\n',
        "belt.guide_clearance: '0,5mm' has a decimal comma: write \"0.5mm\"",
    ),
    (
        "[shaft]\nrecord = []\n",
        "shaft.record is unknown: record belongs to the scene, write it above the first [table]",
    ),
    (
        '[damper_1]\n[[claims]]\nkind = "stop_contacts"\ndamper = "damper_1"\nat_most = -1\n',
        "claim 'stop_contacts': at_most = -1 must not be negative",
    ),
]
IN_HEAD = [
    ("revolution = 3\n", "revolution is unknown; did you mean 'revolutions'?"),
    (
        "[belts_x]\na = 1\n",
        "[belts_x] is unknown and has no component = \"...\" of its own; did you mean 'belt'?",
    ),
    (
        '["my shaft"]\ncomponent = "MainShaft"\n',
        "instance name 'my shaft' must be letters, digits and _, with a letter first",
    ),
    ('[time]\ncomponent = "MainShaft"\n', "instance name 'time' is taken: every trace has a time of its own"),
    ('[mine]\ncomponent = "BeltMonito"\n', "there is no component 'BeltMonito'; did you mean 'BeltMonitor'?"),
    ("[mine]\ncomponent = 5\n", "mine.component = 5 is not a name in quotes"),
    (
        '[shaft]\ncomponent = "HealdFrame"\n',
        "shaft.component = 'HealdFrame': the shaft of a scene must be a MainShaft or a DrivenShaft",
    ),
    (
        "[loom]\nbelt_motion = true\n[belt_motion]\nguide_end = 3\n",
        "belt_motion.guide_end = 3 must be 1 (calibrated) or 2 (play)",
    ),
    (
        "[loom]\nbelt_motion = true\n[belt_motion]\nguide_end = 'plya'\n",
        "belt_motion.guide_end = 'plya' must be 'calibrated' or 'play'; did you mean 'play'?",
    ),
    (
        "[loom]\nbelt_motion = true\n[belt_motion]\nhead_end = 'fixed'\n",
        "belt_motion.head_end = 'fixed' must be 'pinned' or 'guided'",
    ),
    ("[shaft]\nspeed = 0\n", "shaft.speed = 0 rev/min: the shaft's speed sets the step, so it must not be 0"),
    ("[loom]\nmachin = 'x'\n", "loom.machin is unknown; did you mean 'machine'?"),
    (
        '[loom]\nmachine = "WL680-36"\nhead = "G6300 left"\nweave = "10/01"\n',
        "there is no machine 'WL680-36'; did you mean 'WL680-3600'?",
    ),
    ("[loom]\nmachine = 5\n", "weft.machine = 5 is not a name in quotes"),
    (
        '[loom]\nmachine = "WL680-3600"\nhead = "G6300"\nweave = "10/01"\n',
        "there is no head 'G6300'; did you mean 'G6300 left'?",
    ),
    ('[shaft]\nspeed = "600 rpmm"\n', "shaft.speed: unknown unit 'rpmm'; did you mean 'rpm'?"),
    ('[shaft]\nspeed = "600 mm"\n', "shaft.speed: '600 mm' is in mm, which does not fit rad/s"),
    ("[shaft]\nripple_order = 1.5\n", "shaft.ripple_order = 1.5 is not a whole number"),
    ('[[claims]]\nkind = "abov"\n', "claim kind = 'abov' is unknown; did you mean 'above'?"),
    ('[[claims]]\nkind = "above"\nbound = 1\n', "claim 'above' needs 'signal'"),
]
WHOLE = [
    (
        '[claims]\nkind = "above"\n\n[[claims]]\nkind = "below"\n',
        "claims are written as [[claims]] tables, with two brackets; line 1 has [claims]",
    ),
    ("a = = 5", "not valid TOML: Invalid value (at line 1, column 5)"),
    (HEAD.replace("90", "0"), "steps_per_revolution = 0 is outside [1, 1e+09]"),
    (HEAD.replace("90", "90.5"), "steps_per_revolution = 90.5 is not a whole number"),
    (HEAD.replace("90", "'many'"), "steps_per_revolution = 'many' is not a number"),
    (HEAD.replace("revolutions = 1", "revolutions = -1"), "revolutions = -1 is outside [1e-09, 1e+09]"),
    (
        HEAD.replace("revolutions = 1", "revolutions = 1e-6"),
        "revolutions = 1e-06 at 90 steps each is less than one step",
    ),
    (HEAD.replace("revolutions = 1", "revolutions = nan"), "revolutions = nan is outside [1e-09, 1e+09]"),
    (
        "record = 'belt.margin'\n" + HEAD + LOOM,
        'record = \'belt.margin\' is not a list such as ["belt.*", "weft.travel"]',
    ),
    (
        "record = ['belt.margn']\n" + HEAD + LOOM,
        "record: no output is called 'belt.margn'; did you mean 'belt.margin'?",
    ),
    (
        HEAD + LOOM + f'[heald_1]\npattern = "{"10" * 65}"\n',
        "heald_1.pattern has 130 picks; the dobby holds 128",
    ),
    ("wires = 5\n" + HEAD, 'wires must be a table of "instance.input" = "instance.output"'),
    ("claims = 5\n" + HEAD, "claims are written as [[claims]] tables, with two brackets"),
    (HEAD + f"[shaft]\nspeed = {HUGE}\n", f"shaft.speed: {HUGE[:60]}... is too large"),
    (
        HEAD.replace("revolutions = 1", f"revolutions = {HUGE}") + LOOM,
        f"revolutions = {HUGE[:60]}... is outside [1e-09, 1e+09]",
    ),
    (
        HEAD + LOOM + f'[[claims]]\nkind = "lowest_margin"\nbound = {HUGE}\n',
        f"claim 'lowest_margin': bound: {HUGE[:60]}... is too large",
    ),
    (
        HEAD + LOOM + f"[heald]\npattern_length = {HUGE}\n",
        f"heald_1.pattern_length = {HUGE[:60]}... is outside [1, 128]",
    ),
]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        *((HEAD + LOOM + "[[claims]]\n" + text, said) for text, said in OF_CLAIMS),
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
        ("belt.guide_clearance", "--set belt.guide_clearance: not of the form INSTANCE.VARIABLE=VALUE"),
        ("bel.travel=1", "scene.toml: bel.travel: the scene has no instance 'bel'; did you mean 'belt'?"),
        ("belt.travl=1", "scene.toml: belt.travl is unknown; did you mean 'travel'?"),
        ("belt.margin=1", "scene.toml: belt.margin is an output of BeltMonitor and cannot be set"),
        ("revolution=2", "scene.toml: 'revolution' cannot be set; did you mean 'revolutions'?"),
        ("shaft.speed=", "scene.toml: shaft.speed: '' is not a quantity such as \"685 rpm\""),
        ("shaft.speed=nan", "scene.toml: shaft.speed: 'nan' is not a quantity such as \"685 rpm\""),
        (
            "shaft.speed=1e999",
            "scene.toml: shaft.speed = inf rev/min is outside [-9549.297, 9549.297] rev/min",
        ),
        ("shaft.speed=685rpmm", "scene.toml: shaft.speed: unknown unit 'rpmm'; did you mean 'rpm'?"),
        ("heald.strok=1", "scene.toml: heald_1.strok is unknown; did you mean 'stroke'?"),
        (
            "heald.inputs_at_step_end=maybe",
            "scene.toml: heald_1.inputs_at_step_end = 'maybe' must be true or false",
        ),
    ],
)
def test_a_mistake_in_set_is_told_in_one_line(
    capsys: pytest.CaptureFixture[str], given: str, said: str
) -> None:
    assert main(["run", scene(HEAD + LOOM), "--set", given]) == 2
    assert one_line(capsys) == said


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            '[weft]\ncrank_cone = "80 deg"\n',
            "weft: the spherical linkage does not close over a whole turn: |cos(rocker_angle = 60 deg)|"
            " reaches or exceeds |cos(crank_cone = 80 deg)|",
        ),
        (
            '[weft]\ncoupler_length = "20 mm"\n',
            "weft: the planar four-bar does not close over the rocker's swing: crank_length = 150 mm,"
            " coupler_length = 20 mm, output_length = 121 mm, pivot at (243 mm, 258 mm)",
        ),
        ("[weft]\nassembly = 0\n", "weft: assembly = 0 must be -1 or 1"),
        (
            '[damper_1]\nstart_displacement = "20 mm"\n',
            "damper_1: start_displacement = 20 mm must lie between the stops at free_travel = 15 mm",
        ),
    ],
)
def test_values_that_do_not_go_together_are_told_in_one_line(
    capsys: pytest.CaptureFixture[str], text: str, said: str
) -> None:
    assert main(["run", scene(HEAD + LOOM + text)]) == 2
    assert one_line(capsys).startswith(said)
    assert not Path("results").exists()
