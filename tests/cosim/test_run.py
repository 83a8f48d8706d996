"""A run as a whole: its trace is safe from what FMUs do, and its result says what happened."""

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from foreign_motors import FMI3, description2, library, motor2, motor3, packed
from motor_scenes import LENGTH, MOTOR, ran

from loomfmu import Trace, run
from loomfmu.cosim.recorded import usual_path
from loomfmu.cosim.scenes import scene as scenes

CLAIM = '[[claims]]\nkind = "below"\nsignal = "motor.flange_w"\nbound = 100.0\n'


def test_an_fmu_that_crashes_at_its_end_takes_no_trace_with_it(tmp_path: Path) -> None:
    motor2(tmp_path, defines=("CRASHES=1",))
    (tmp_path / "motor.toml").write_text("isolated = false\n" + MOTOR + CLAIM)
    command = [sys.executable, "-m", "loomfmu.cli", "run", "motor.toml", "--output", "out/motor.h5"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode not in (0, 1)  # the process is gone
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["motor.h5"]
    with Trace(tmp_path / "out" / "motor.h5") as trace:
        assert (trace.status, trace.rows) == ("complete", 201)
        assert [each.word for each in trace.verdicts] == ["undecided"]


def test_an_fmu_none_of_whose_outputs_can_be_recorded_is_named(tmp_path: Path) -> None:
    lines = [line for line in FMI3.splitlines() if 'causality="output"' not in line]
    arrays = "".join(
        f'<Float64 name="phase {number}" valueReference="{90 + number}" causality="output">'
        '<Dimension start="2000"/></Float64>'
        for number in range(6)
    )
    motor3(tmp_path, description="\n".join(lines).replace("</ModelVariables>", f"{arrays}</ModelVariables>"))
    text = LENGTH + '[motor]\nfmu = "Motor3.fmu"\n'
    result = ran(tmp_path, text, tmp_path)
    assert list(result.trace) == []
    assert result.warnings == (
        "motor: nothing recorded; none of its outputs is a scalar number or a Boolean:"
        " phase 0, phase 1, phase 2, phase 3, phase 4, ...",
    )
    # one that has no outputs at all, or others as well, is as usual
    sink = description2().replace('causality="output"', 'causality="local"')
    packed(tmp_path / "Motor.fmu", sink, library("fmi2.c"), "Motor")
    assert ran(tmp_path, MOTOR, tmp_path).warnings == ()


def test_the_steps_of_a_result_are_those_of_its_trace(tmp_path: Path) -> None:
    """Where only claims are recorded, one master steps the coarser runs, too: a quarter was said."""
    (tmp_path / "scene.toml").write_text(
        "revolutions = 1\nsteps_per_revolution = 60\nrecord = []\n"
        '[loom]\nmachine = "WL680-3600"\nhead = "G6300 left"\n[shaft]\nspeed = "600 rev/min"\n'
        '[[claims]]\nkind = "lowest_margin"\nbound = 0.1\n'
    )
    result = run(tmp_path / "scene.toml", output=tmp_path / "trace.h5")
    assert result.steps == 60 == len(result.trace.time) - 1


SHAFT = "revolutions = 1\n[shaft]\n"


@pytest.mark.parametrize(
    ("given", "name"),
    [
        ({}, "a.h5"),
        ({"shaft.speed": "685 rpm", "revolutions": 2}, "a_revolutions=2,shaft.speed=685rpm.h5"),
        ({"shaft.speed": 60.5}, "a_shaft.speed=60.5.h5"),
        ({"shaft.speed": "600 rev/min"}, "a_shaft.speed=600rev-min-c3617018.h5"),
    ],
)
def test_each_set_of_values_has_a_trace_of_its_own(given: dict[str, Any], name: str) -> None:
    shuffled = dict(reversed(given.items()))
    for values in (given, shuffled):
        assert usual_path(scenes.parse(SHAFT, "a", values)) == Path("results") / name


def test_a_scene_whose_name_is_too_long_for_that_of_a_file_is_told_from_others() -> None:
    scene = scenes.parse(SHAFT, "loom " + 245 * "\u00e4", {"shaft.speed": "685 rpm"})
    paths = [usual_path(replace(scene, name=name), "_page.html") for name in (scene.name, scene.name[:-1])]
    assert paths[0] != paths[1] and max(len(path.name.encode()) for path in paths) <= 200
    assert all(path.name.endswith("_shaft.speed=685rpm_page.html") for path in paths)
    assert usual_path(replace(scene, name="a" * 200, overrides={})).name.startswith("a" * 150)


def test_values_too_long_for_the_name_of_a_file_are_told_apart() -> None:
    knots = [
        [[0.0, "60 rpm"], *([0.1 * n, 50.0] for n in range(1, 40)), [9.0, last]] for last in (50.0, 51.0)
    ]
    names = [
        usual_path(replace(scenes.parse(SHAFT, "a"), overrides={"shaft.speed": each})).name for each in knots
    ]
    assert names[0] != names[1] and max(map(len, names)) < 110
    assert all(re.fullmatch(r"[\w.,=+-]+", each) for each in names)
