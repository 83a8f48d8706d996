"""Sweep files: which combinations they are, and one line for every mistake before anything runs."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import qmc
from sweep_files import HEAD, SCENE, sweep_file

from loomfmu import LoomfmuError
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.machines import parameters
from loomfmu.sweeps import plan as plans

RPM = math.pi / 30.0
WOVEN = SCENE.replace("[shaft]", 'weave = "10/01"\n[shaft]')


def plan(text: str, scene: str = SCENE) -> plans.SweepPlan:
    return plans.load(sweep_file(text, scene))


def column(found: plans.SweepPlan, key: str) -> list[object]:
    values: list[object] = found.columns(np.arange(found.rows))[key].tolist()
    return values


# ---- grids


def test_a_grid_is_every_combination_with_the_last_axis_fastest() -> None:
    found = plan(
        '[grid]\n"shaft.speed" = ["500 rpm", 60.0]\n"belt.guide_clearance" = ["0.2 mm", "1 mm", 4e-4]\n',
    )
    assert found.rows == 6
    assert column(found, "shaft.speed") == [500 * RPM] * 3 + [60.0] * 3
    # the factors of the units are not exact in binary
    assert column(found, "belt.guide_clearance") == pytest.approx([0.2e-3, 1e-3, 4e-4] * 2, rel=1e-15)
    assert found.settings(range(4, 5)) == [{"shaft.speed": 60.0, "belt.guide_clearance": 1e-3}]


def test_a_range_is_shared_equally_or_in_the_logarithm() -> None:
    found = plan(
        '[grid]\n"belt.guide_clearance" = { from = "0.2 mm", to = "1 mm", count = 5 }\n'
        '"belt.bending_stiffness" = { from = 0.1, to = 10.0, count = 3, logarithmic = true }\n',
    )
    # a few roundings of values of order 1
    assert column(found, "belt.guide_clearance")[::3] == pytest.approx(
        [0.2e-3, 0.4e-3, 0.6e-3, 0.8e-3, 1e-3], rel=1e-14
    )
    assert column(found, "belt.bending_stiffness")[:3] == pytest.approx([0.1, 1.0, 10.0], rel=1e-14)


def test_keys_may_be_quoted_or_not_and_stand_for_all_frames() -> None:
    found = plan('[grid]\nheald.stroke = ["90 mm", "100 mm"]\nrevolutions = [1, 2]\n', WOVEN)
    assert [axis.varied.targets for axis in found.axes] == [
        ("heald_1.stroke", "heald_2.stroke"),
        ("revolutions",),
    ]
    assert found.settings(range(1, 2)) == [
        {"heald_1.stroke": 0.09, "heald_2.stroke": 0.09, "revolutions": 2.0}
    ]


@pytest.mark.parametrize("key", ["machine", "loom.machine"])
def test_a_machine_goes_to_all_instances_that_take_one_and_a_head_too(key: str) -> None:
    found = plan(
        f'[grid]\n{key} = ["WL450-3600", "WL800-3600"]\nhead = ["GS900 right"]\n'
        '"shaft.speed" = ["400 rpm"]\n',
    )
    (settings,) = found.settings(range(1, 2))
    assert settings.pop("shaft.speed") == pytest.approx(400 * RPM, rel=1e-15)  # rounding
    assert settings == {
        "weft.machine": "WL800-3600",
        "belt.machine": "WL800-3600",
        "weft.head": "GS900 right",
        "belt.head": "GS900 right",
    }
    instances = scenes.load(Path("scene.toml"), settings).instances
    for name, component in (("weft", "WeftInsertion"), ("belt", "BeltMonitor")):
        wanted = parameters(component, machine="WL800-3600", head="GS900 right")
        assert wanted.items() <= instances[name].values.items()


def test_whole_numbers_switches_and_choices_keep_their_type() -> None:
    found = plan(
        "[grid]\nsteps_per_revolution = [90, 180]\n"
        '"belt.prescribe_length_factor" = [true, false]\n"dobby.law" = ["sloped-sine", "harmonic-ends"]\n',
        WOVEN,
    )
    assert found.settings(range(3, 4)) == [
        {"steps_per_revolution": 90, "belt.prescribe_length_factor": False, "dobby.law": "harmonic_ends"}
    ]
    assert [axis.values.dtype.kind for axis in found.axes] == ["i", "b", "O"]


# ---- samples

SAMPLE = (
    '[sample]\ncount = 40\nseed = 7\n"belt.guide_clearance" = ["0.2 mm", "1 mm"]\n'
    '"belt.bending_stiffness" = { from = 0.1, to = 10.0, logarithmic = true }\n'
    "steps_per_revolution = [90, 99]\n"
)


def test_a_sample_is_the_latin_hypercube_of_scipy() -> None:
    found = plan(SAMPLE)
    assert found.rows == 40
    points = qmc.LatinHypercube(3, rng=7).random(40)
    clearance = qmc.scale(points[:, :1], 0.2e-3, 1e-3)[:, 0]
    stiffness = np.exp(qmc.scale(points[:, 1:2], math.log(0.1), math.log(10.0))[:, 0])
    # the same numbers by another way of rounding
    np.testing.assert_allclose(column(found, "belt.guide_clearance"), clearance, rtol=1e-14)
    np.testing.assert_allclose(column(found, "belt.bending_stiffness"), stiffness, rtol=1e-13)
    assert column(found, "steps_per_revolution") == [90 + int(10 * share) for share in points[:, 2]]


def test_each_share_of_a_sampled_range_is_met_once() -> None:
    found = plan(SAMPLE)
    clearance = (np.array(column(found, "belt.guide_clearance")) - 0.2e-3) / 0.8e-3
    stiffness = (np.log10(np.array(column(found, "belt.bending_stiffness"))) + 1.0) / 2.0
    for shares in (clearance, stiffness):
        assert sorted(np.floor(shares * 40).astype(int)) == list(range(40))
    steps = np.array(column(found, "steps_per_revolution"))
    assert [int(np.sum(steps == value)) for value in range(90, 100)] == [4] * 10


def test_another_seed_is_another_sample() -> None:
    one = column(plan(SAMPLE), "belt.guide_clearance")
    assert one == column(plan(SAMPLE), "belt.guide_clearance")
    assert one != column(plan(SAMPLE.replace("= 7", "= 8")), "belt.guide_clearance")


def test_a_grid_meets_every_point_of_a_sample() -> None:
    found = plan('[grid]\n"shaft.speed" = [50.0, 60.0, 70.0]\n' + SAMPLE)
    assert found.rows == 120
    assert column(found, "shaft.speed") == [50.0] * 40 + [60.0] * 40 + [70.0] * 40
    clearance = column(found, "belt.guide_clearance")
    assert clearance[:40] == clearance[40:80] == clearance[80:]
    # any part of the rows is that part of all of them
    assert found.settings(range(0, 120))[33:90] == found.settings(range(33, 90))


# ---- mistakes

GRID = '[grid]\n"shaft.speed" = ["500 rpm", "600 rpm"]\n"belt.guide_clearance" = ["0.2 mm", "1 mm"]\n'


IN_GRID = [
    ('"belt.guide_clearence" = [1]',
     "grid: belt.guide_clearence is unknown; did you mean 'guide_clearance'?"),
    ('"bolt.guide_clearance" = [1]', "the scene has no instance 'bolt'; did you mean 'belt'?"),
    ('machin = ["WL680-3600"]', "'machin' cannot be set; did you mean 'machine'?"),
    ('machine = ["WL680-3700"]', "there is no machine 'WL680-3700'; did you mean 'WL680-3"),
    ('"belt.margin" = [1]', "belt.margin is an output of BeltMonitor and cannot be set"),
    ('"belt.travel" = [3.0]', "grid: belt.travel cannot be set, it is wired to weft.travel"),
    ('"shaft.speed" = ["5 mm"]', "shaft.speed: '5 mm' is in mm, which does not fit rad/s"),
    ('"shaft.speed" = ["500 rmp"]', "unknown unit 'rmp'; did you mean 'rpm'?"),
    ('"belt.guide_clearance" = ["0.2 mm", "60 mm"]', "= 60 mm is outside [0, 50] mm"),
    ('"shaft.speed" = {from = 50, to = 1' + 400 * "0" + ", count = 2}", ".. is too large"),
    ('"shaft.speed" = []', "grid.shaft.speed must name at least one value"),
    ('"shaft.speed" = ["500 rpm", "500 r/min"]', "grid.shaft.speed: 500 rev/min appears twice"),
    ('"shaft.speed" = [50.0]\nshaft.speed = [60.0]', "grid.shaft.speed appears twice"),
    ('"shaft.speed" = [50.0]\n[sample]\ncount = 2\nseed = 1\n"shaft.speed" = [1, 2]',
     "sample.shaft.speed sets shaft.speed, which grid.shaft.speed already sets"),
    ('"shaft.speed" = [50.0]\n[set]\n"shaft.speed" = 50.0\n',
     "grid.shaft.speed sets shaft.speed, which set already sets"),
    ('machine = ["WL680-3600"]\n"belt.machine" = ["WL680-3600"]',
     "grid.belt.machine sets belt.machine, which grid.machine already sets"),
    ('"shaft.speed" = { from = 50.0, to = 60.0 }', "grid.shaft.speed.count is missing"),
    ('"shaft.speed" = { from = 50.0, cuont = 3 }', "cuont is unknown; did you mean 'count'"),
    ('"shaft.speed" = { from = 50.0, count = 3 }', "grid.shaft.speed has no 'to'"),
    ('"shaft.speed" = { from = "600 rpm", to = "500 rpm", count = 3 }',
     "600 rev/min is not below 500 rev/min"),
    ('"shaft.speed" = { from = -1.0, to = 5.0, count = 3, logarithmic = true }',
     "above 0 can be logarithmic"),
    ('machine = { from = "a", to = "b", count = 3 }', "grid.machine is not a number: list"),
    ("steps_per_revolution = [90.5]", "steps_per_revolution = 90.5 is not a whole number"),
    (
        "belt = { bending_stiffness = MANY, head_mass = MANY, head_length = MANY }".replace(
            "MANY", "{ from = 0.1, to = 0.2, count = 1000 }"
        ),
        "1000000000 combinations; the limit is 10000000",
    ),
    ("revolutions = [1, 0]", "revolutions = 0 is outside [1e-09, 1e+09]"),
]  # fmt: skip
ELSEWHERE = [
    ("", "nothing varies"),
    ("gird = 1", "gird is unknown; did you mean 'grid'?"),
    ('[sample]\n"shaft.speed" = [50.0, 60.0]\nseed = 1', "sample.count is missing"),
    ('[sample]\n"shaft.speed" = [50.0, 60.0]\ncount = 4', "sample.seed is missing"),
    ('[sample]\n"shaft.speed" = [50.0]\ncount = 4\nseed = 1', "is not a range [low, high]"),
    ("[sample]\ncount = 4\nseed = 1\n" + GRID, "sample needs a range"),
    ('flavour = "nativ"\n' + GRID, "there is no flavour 'nativ'; did you mean 'native'?"),
    ('[set]\n"shaft.sped" = 1\n' + GRID, "shaft.sped is unknown; did you mean 'speed'?"),
    (GRID + "[traces]\nfailure = 2", "traces.failure is unknown; did you mean 'failures'?"),
    (GRID + "[traces]\nsample = -1", "traces.sample = -1 is outside [0, 10000000]"),
]
IN_MAP = [
    ('x = "shaft.sped"\nvalue = "claim_1.worst"', "map.x = 'shaft.sped' is not an axis; did you mean"),
    ('x = "shaft.speed"', "map has no 'value'"),
    ('x = "shaft.speed"\nvalue = "belt.lowest_sped_limit"',
     "is not a column of results; did you mean 'belt.low"),
    ('x = "shaft.speed"\ny = "shaft.speed"\nvalue = "claim_1.worst"', "map.x and map.y are both shaft.speed"),
    ('x = "shaft.speed"\ny = "belt.guide_clearance"\nvalue = "claim_1.worst"\n'
     "[grid.weft]\nwheel_diameter = [0.3, 0.4]",
     "map: weft.wheel_diameter varies too; pick one of its values in [map.at]"),
    ('x = "shaft.speed"\nvalue = "claim_1.worst"\nat = { "belt.guide_clearance" = "0.3 mm" }',
     "map.at.belt.guide_clearance = 0.3 mm is not on its axis: 0.2 mm, 1 mm"),
    ('x = "shaft.speed"\ny = "belt.guide_clearance"\nvalue = "claim_1.worst"\n'
     '[sample]\ncount = 2\nseed = 1\n"weft.wheel_diameter" = [0.3, 0.4]',
     "map: weft.wheel_diameter is sampled, so many rows share one point"),
]  # fmt: skip


IN_HEAD = [
    ({"lowest_speed_limit": "lowest_sped_limit"}, "values: belt has no output 'lowest_sped_limit'"),
    ({'["belt.lowest_speed_limit"]': '"belt.margin"'}, "values = 'belt.margin' is not a list"),
    ({"scene.toml": "scen.toml"}, "scen.toml: cannot be read (No such file"),
    ({"scene =": "sceen ="}, "sceen is unknown; did you mean 'scene'?"),
    ({'scene = "scene.toml"\n': ""}, 'a sweep must name its scene: scene = "loom.toml"'),
    ({'"Swept"': ""}, "not valid TOML"),
]
IN_SCENE = [
    ('[[claims]]\nkind = "above"\nsignal = "belt.margn"\nbound = 0\n',
     "belt has no output 'margn'; did you mean 'margin'"),
    ('\n[inputs]\n"belt.guide_clearance" = [[0, "0.3 mm"], [1, "1 mm"]]\n',
     "belt.guide_clearance cannot be set, it is driven along a table"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("files", "words"),
    [
        *(({"text": "[grid]\n" + text}, words) for text, words in IN_GRID),
        *(({"text": text}, words) for text, words in ELSEWHERE),
        *(({"text": f"{GRID}[map]\n{text}"}, words) for text, words in IN_MAP),
        *(({"head": HEAD.replace(*each.popitem())}, words) for each, words in IN_HEAD),
        *(({"scene": SCENE + more}, words) for more, words in IN_SCENE),
    ],
)
def test_a_mistake_is_one_line_that_says_what_would_be_right(files: dict[str, str], words: str) -> None:
    with pytest.raises(LoomfmuError) as caught:
        plans.load(sweep_file(**{"text": GRID} | files))
    assert str(caught.value).startswith("swept.toml: ")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_file_that_is_missing_is_named() -> None:
    with pytest.raises(LoomfmuError, match=r"missing\.toml: cannot be read"):
        plans.load("missing.toml")


def taken(read: Callable[[], object]) -> bool:
    try:
        read()
    except LoomfmuError:
        return False
    return True


KEYS = """machine loom.machine weft.machine head coupling steps_per_revolution belt.guide_clearance
    belt.prescribe_length_factor duration belt.margin title record revolutions loom.weave shaft.machine
    belt.travel belt.fmu belt.units"""


@pytest.mark.parametrize("key", KEYS.split())
def test_a_sweep_varies_what_set_takes_and_nothing_else(key: str) -> None:
    values = {
        "machine": "WL450-3600",
        "head": "GS900 left",
        "coupling": "iterated",
        "belt.prescribe_length_factor": True,
        "belt.guide_clearance": 1e-3,
        "loom.weave": "10",
        "belt.fmu": "x.fmu",
    }
    value = values.get(key, values.get(key.rpartition(".")[2], 10))
    shown = str(value).lower() if isinstance(value, bool) else repr(value)
    swept = taken(lambda: plan(f'[grid]\n"{key}" = [{shown}]\n'))
    # a weave changes which FMUs there are: --set takes it, a sweep does not
    assert swept is (key != "loom.weave" and taken(lambda: scenes.parse(SCENE, overrides={key: value})))


def test_values_without_effect_are_refused_unless_another_axis_switches_them_on() -> None:
    factor = '"belt.prescribed_length_factor" = [0.8, 0.9]\n'
    with pytest.raises(
        LoomfmuError, match=r"grid: belt\.prescribed_length_factor has no effect: set belt\.prescribe"
    ):
        plan(f"[grid]\n{factor}")
    switch = '"belt.prescribe_length_factor" = [true, false]\n'
    assert plan(f"[grid]\n{factor}{switch}").rows == 4
    assert plan(f"[set]\n{switch.replace('[true, false]', 'true')}[grid]\n{factor}").rows == 2


def test_numbers_without_unit_are_doubted_once_and_converted_ones_never() -> None:
    doubt = 'shaft.speed = 480 is read as 480 rad/s = 4583.662 rev/min; write "480 rev/min" if that is meant'
    assert plan('[grid]\n"shaft.speed" = [50.0, 480, "600 rpm"]\n').notes == (doubt,)
    assert plan('[sample]\ncount=2\nseed=1\n"shaft.speed" = [50.0, 480]\n').notes == (doubt,)
    found = plan('[grid]\n"shaft.speed" = ["4000 rpm", "4583 rpm"]\n')
    assert found.notes == ()
    assert scenes.parse(SCENE, overrides=found.settings(range(1))[0]).notes == ()
