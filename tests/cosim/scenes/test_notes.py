"""What the user of a scene is warned of, and works that a shaft counts without a source."""

from pathlib import Path

import pytest

from loomfmu import LoomfmuError
from loomfmu.cosim.scenes import scene as scenes

LOOM = """
[loom]
machine = "WL680-3600"
weave = "10/01"
[shaft]
component = "DrivenShaft"
"""


@pytest.mark.parametrize(
    ("text", "switch", "sink"),
    [
        (LOOM + 'use_work_2 = true\n[wires]\n"shaft.work_2" = false\n', "shaft.use_work_2", "shaft.work_2"),
        (LOOM + "use_work_32 = true\n", "shaft.use_work_32", "shaft.work_32"),
        (LOOM + "[heald_1]\nuse_load_work = true\n", "heald_1.use_load_work", "heald_1.load_work"),
    ],
)
def test_a_work_that_counts_needs_a_source(text, switch, sink):
    expected = f"{switch} = true, but {sink} is not wired: wire it, or set {switch} = false"
    with pytest.raises(LoomfmuError, match=expected):
        scenes.parse(text)


def test_a_work_may_come_from_a_table():
    text = LOOM + 'use_work_32 = true\n[inputs]\n"shaft.work_32" = [[0, 0.0], [1, 5.0]]\n'
    assert scenes.parse(text).notes == ()


@pytest.mark.parametrize(
    ("wires", "note"),
    [
        (
            '"shaft.torque_2" = "heald_1.shaft_torque"\n"shaft.torque_7" = "heald_1.shaft_torque"',
            "heald_1.shaft_torque loads shaft 2 times: shaft.torque_2 and shaft.torque_7; keep one wire",
        ),
        ('"shaft.torque_1" = false', "weft does not load shaft: weft.shaft_torque is not wired"),
    ],
)
def test_mechanisms_that_load_the_shaft_twice_or_not_at_all_are_named(wires, note):
    assert scenes.parse(LOOM).notes == ()
    assert scenes.parse(f"{LOOM}[wires]\n{wires}\n").notes == (note,)


@pytest.mark.parametrize(
    ("table", "note"),
    [
        (
            '[heald_9]\npattern = "1100"\n',
            "[heald_9] adds a heald to the loom, beside heald_1 and heald_2;"
            ' write component = "HealdFrame" if it is meant',
        ),
        (
            '[damper_3]\ncarrier_mass = "30 kg"\n',
            "[damper_3] adds a damper to the loom, which has no heald_3;"
            ' write component = "HealdDamper" if it is meant',
        ),
        (
            '[shaft_2]\nspeed = "600 rpm"\n',
            '[shaft_2] adds a shaft to the loom, beside shaft; write component = "MainShaft" if it is meant',
        ),
        (
            "[weft_2]\n",
            "[weft_2] adds a weft to the loom, beside weft; set loom.both_rapiers = true for the taker's, or"
            ' write component = "WeftInsertion" if it is meant',
        ),
        ('[heald_3]\ncomponent = "HealdFrame"\n', ""),
        ('[heald_2]\nstroke = "60 mm"\n[damper_1]\n[warp_1]\n', ""),
        (
            "[belt_2]\n",
            "[belt_2] adds a belt to the loom, beside belt; set loom.both_rapiers = true for the taker's, or"
            ' write component = "BeltMonitor" if it is meant',
        ),
        ("[weft_2]\n[belt_2]\n", ""),
    ],
)
def test_a_numbered_table_that_fits_nothing_of_the_loom_is_named(table: str, note: str) -> None:
    loom = '[loom]\nmachine = "WL680-3600"\nweave = "10/01"\n'
    assert scenes.parse(loom + table).notes == ((note,) if note else ())


@pytest.mark.parametrize(
    ("more", "notes"),
    [
        ("", ("belt does not move: travel, velocity and acceleration are cut and have no value",)),
        ('[belt]\ntravel = "0.5 m"\n', ()),
        ('[inputs]\n"belt.travel" = [[0, 0.0], [1, 0.5]]\n', ()),
    ],
)
def test_a_mechanism_whose_motion_is_cut_is_named(more: str, notes: tuple[str, ...]) -> None:
    wires = "".join(f'"belt.{each}" = false\n' for each in ("travel", "velocity", "acceleration"))
    loom = '[loom]\nmachine = "WL680-3600"\n'
    assert scenes.parse(f"{loom}[wires]\n{wires}{more}").notes == notes


def test_a_tolerance_from_high_to_low_is_refused() -> None:
    loom = '[loom]\nmachine = "WL680-3600"\n[tolerances]\n'
    assert scenes.parse(loom + '"belt.guide_clearance" = ["0.2 mm", "0.5 mm"]\n').tolerances
    said = "tolerances: belt.guide_clearance: the range from 0.5 mm to 0.2 mm is empty"
    with pytest.raises(LoomfmuError, match=said):
        scenes.parse(loom + '"belt.guide_clearance" = ["0.5 mm", "0.2 mm"]\n')


@pytest.mark.parametrize(
    ("values", "its_own"),
    [
        ("", ""),
        ('[weft_2]\nmoving_mass = "0.2 kg"\n', ""),
        ('[weft_2]\nlead = "-30 deg"\n', "lead"),
        ('[weft]\nlead = "5 deg"\n[weft_2]\nlead = "5 deg"\n', ""),
        ('[weft_2]\ngear_ratio = 9.5\nlead = "-30 deg"\n', "lead and gear_ratio"),
    ],
)
def test_a_weft_whose_taker_does_not_mirror_the_giver_is_warned_of(values, its_own):
    loom = '[loom]\nmachine = "WL680-3600"\nboth_rapiers = true\n'
    note = (
        f"yarn follows weft on both ways, but weft_2 moves differently: it has its own {its_own}; after the"
        " hand-over the tension is that of a taker like weft"
    )
    assert scenes.parse(loom + values).notes == ()
    assert scenes.parse(loom + "yarn = true\n" + values).notes == ((note,) if its_own else ())


@pytest.mark.parametrize(
    ("text", "note"),
    [
        (
            "[belt]\nprescribed_length_factor = 0.8\n",
            "belt.prescribed_length_factor has no effect: set belt.prescribe_length_factor = true",
        ),
        ("[belt]\nprescribe_length_factor = true\nprescribed_length_factor = 0.8\n", ""),
        (
            '[belt]\nprescribe_length_factor = true\nguide_clearance = "0.3 mm"\n',
            "belt.guide_clearance has no effect: set belt.prescribe_length_factor = false",
        ),
        (
            'belt_motion = true\n[belt_motion]\nguide_length = "20 mm"\n',
            'belt_motion.guide_length has no effect: set belt_motion.guide_end = "play"',
        ),
        ('belt_motion = true\n[belt_motion]\nguide_length = "20 mm"\nguide_end = "play"\n', ""),
    ],
)
def test_a_value_without_effect_is_named(text, note):
    loom = '[loom]\nmachine = "WL680-3600"\n' + text
    assert scenes.parse(loom).notes == (() if not note else (note,))


@pytest.mark.parametrize(
    "path", sorted((Path(__file__).parents[3] / "sims").glob("*.toml")), ids=lambda path: path.stem
)
def test_the_scenes_of_the_project_have_no_warnings(path):
    assert scenes.load(path).notes == ()
