"""What the user of a scene is warned of, and works that a shaft counts without a source."""

from pathlib import Path

import pytest
from scene_texts import HEAD, parsed, table, wires

from loomfmu import LoomfmuError
from loomfmu.cosim.scenes import scene as scenes

RAPIER = '[loom]\nmachine = "WL680-3600"\n'
LOOM = RAPIER + 'weave = "10/01"\n'
DRIVEN = LOOM + '[shaft]\ncomponent = "DrivenShaft"\n'
CUT = "[wires]\n" + wires(**{f"belt__{each}": False for each in HEAD})
MIRRORED = (
    "yarn follows weft on both ways, but weft_2 moves differently: it has its own {}; after the"
    " hand-over the tension is that of a taker like weft"
)
TWICE = "heald_1.shaft_torque loads shaft 2 times: shaft.torque_2 and shaft.torque_7; keep one wire"
RAPIERS = (
    'beside {0}; set loom.both_rapiers = true for the taker\'s, or write component = "{1}" if it is meant'
)


@pytest.mark.parametrize(
    ("text", "switch", "sink"),
    [
        ('use_work_2 = true\n[wires]\n"shaft.work_2" = false\n', "shaft.use_work_2", "shaft.work_2"),
        ("use_work_32 = true\n", "shaft.use_work_32", "shaft.work_32"),
        ("[heald_1]\nuse_load_work = true\n", "heald_1.use_load_work", "heald_1.load_work"),
    ],
)
def test_a_work_that_counts_needs_a_source(text, switch, sink):
    expected = f"{switch} = true, but {sink} is not wired: wire it, or set {switch} = false"
    with pytest.raises(LoomfmuError, match=expected):
        parsed(DRIVEN, text)


@pytest.mark.parametrize(
    ("loom", "cases"),
    [
        (
            DRIVEN,
            {
                "": "",
                # a work may come from a table
                'use_work_32 = true\n[inputs]\n"shaft.work_32" = [[0, 0.0], [1, 5.0]]\n': "",
                "[wires]\n" + wires(**{f"shaft__torque_{n}": "heald_1.shaft_torque" for n in (2, 7)}): TWICE,
                '[wires]\n"shaft.torque_1" = false': (
                    "weft does not load shaft: weft.shaft_torque is not wired"
                ),
            },
        ),
        (  # a numbered table that fits nothing of the loom
            LOOM,
            {
                '[heald_9]\npattern = "1100"\n': "[heald_9] adds a heald to the loom, beside heald_1 and"
                ' heald_2; write component = "HealdFrame" if it is meant',
                '[damper_3]\ncarrier_mass = "30 kg"\n': "[damper_3] adds a damper to the loom, which has no"
                ' heald_3; write component = "HealdDamper" if it is meant',
                '[shaft_2]\nspeed = "600 rpm"\n': "[shaft_2] adds a shaft to the loom, beside shaft;"
                ' write component = "MainShaft" if it is meant',
                "[weft_2]\n": "[weft_2] adds a weft to the loom, " + RAPIERS.format("weft", "WeftInsertion"),
                "[belt_2]\n": "[belt_2] adds a belt to the loom, " + RAPIERS.format("belt", "BeltMonitor"),
                "[weft_2]\n[belt_2]\n": "",
                '[heald_3]\ncomponent = "HealdFrame"\n': "",
                '[heald_2]\nstroke = "60 mm"\n[damper_1]\n[warp_1]\n': "",
            },
        ),
        (  # a mechanism whose motion is cut
            RAPIER + CUT,
            {
                "": "belt does not move: travel, velocity and acceleration are cut and have no value",
                '[belt]\ntravel = "0.5 m"\n': "",
                '[inputs]\n"belt.travel" = [[0, 0.0], [1, 0.5]]\n': "",
            },
        ),
        (  # a weft whose taker does not mirror the giver
            RAPIER + "both_rapiers = true\nyarn = true\n",
            {
                "": "",
                '[weft_2]\nmoving_mass = "0.2 kg"\n': "",
                '[weft_2]\nlead = "-30 deg"\n': MIRRORED.format("lead"),
                '[weft]\nlead = "5 deg"\n[weft_2]\nlead = "5 deg"\n': "",
                '[weft_2]\ngear_ratio = 9.5\nlead = "-30 deg"\n': MIRRORED.format("lead and gear_ratio"),
            },
        ),
        (RAPIER + "both_rapiers = true\n", {'[weft_2]\ngear_ratio = 9.5\nlead = "-30 deg"\n': ""}),
        (  # a value without effect
            RAPIER + "belt_motion = true\n",
            {
                "[belt]\nprescribed_length_factor = 0.8\n": (
                    "belt.prescribed_length_factor has no effect: set belt.prescribe_length_factor = true"
                ),
                "[belt]\nprescribe_length_factor = true\nprescribed_length_factor = 0.8\n": "",
                '[belt]\nprescribe_length_factor = true\nguide_clearance = "0.3 mm"\n': (
                    "belt.guide_clearance has no effect: set belt.prescribe_length_factor = false"
                ),
                table("belt_motion", guide_length="20 mm"): (
                    'belt_motion.guide_length has no effect: set belt_motion.guide_end = "play"'
                ),
                table("belt_motion", guide_length="20 mm", guide_end="play"): "",
            },
        ),
    ],
)
def test_what_the_user_probably_did_not_mean_is_named(loom, cases):
    for text, note in cases.items():
        assert parsed(loom, text).notes == ((note,) if note else ()), text


def test_a_tolerance_from_high_to_low_is_refused() -> None:
    loom = RAPIER + '[tolerances]\n"belt.guide_clearance" = '
    assert parsed(loom, '["0.2 mm", "0.5 mm"]\n').tolerances
    said = "tolerances: belt.guide_clearance: the range from 0.5 mm to 0.2 mm is empty"
    with pytest.raises(LoomfmuError, match=said):
        parsed(loom, '["0.5 mm", "0.2 mm"]\n')


@pytest.mark.parametrize(
    "path", sorted((Path(__file__).parents[3] / "sims").glob("*.toml")), ids=lambda path: path.stem
)
def test_the_scenes_of_the_project_have_no_warnings(path):
    assert scenes.load(path).notes == ()
