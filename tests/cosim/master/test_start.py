"""The sample at 0 s and the first values on wires: those that FMUs have once they left initialization."""

from pathlib import Path

import numpy as np
import pytest
from foreign_motors import motor2, motor3
from motor_scenes import LENGTH, MOTOR, SHAFT3, exact, ran

from loomfmu.components import WeftInsertion
from loomfmu.machines import parameters

HELD = "follow_shaft = true\nshaft_angle = 1.0\nshaft_velocity = 0.0\n"  # rad: where the head feels it
WEFT = f'[weft]\nmachine = "WL680-3600"\n{HELD}'
WIRED = '[wires]\n"weft.shaft_acceleration" = "{}"\n'
CUT = '"weft.shaft_angle" = false\n"weft.shaft_velocity" = false\n'
TORQUE = '"motor.load.tau" = "weft.shaft_torque"\n'


@pytest.fixture(scope="module")
def late(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory with motors that compute their outputs on leaving initialization."""
    directory = tmp_path_factory.mktemp("late")
    motor2(directory, defines=("LATE=1",))
    motor3(directory, defines=("LATE=1",))
    return directory


def acceleration(shaft_acceleration: float) -> float:
    """What the weft's acceleration is at the first sample, if the shaft's is this."""
    weft = WeftInsertion(**parameters("WeftInsertion", machine="WL680-3600"))
    weft.follow_shaft = weft.inputs_at_step_end = True
    weft.shaft_angle, weft.shaft_velocity, weft.shaft_acceleration = 1.0, 0.0, shaft_acceleration
    assert weft.initialize(0.0) == 0
    return weft.acceleration


@pytest.mark.parametrize(
    ("text", "signal", "cut"), [(MOTOR, "motor.flange_a", ""), (LENGTH + SHAFT3, "shaft.acceleration", CUT)]
)
def test_what_is_computed_on_leaving_initialization_is_recorded_and_handed_on(
    late: Path, tmp_path: Path, text: str, signal: str, cut: str
) -> None:
    result = ran(late, text + WEFT + WIRED.format(signal) + cut, tmp_path)
    assert result.trace[signal][0] == exact(np.zeros(1))[2][0] == 200.0
    assert result.trace["weft.acceleration"][0] == acceleration(200.0)
    assert acceleration(200.0) > acceleration(0.0) + 100.0
    assert result.warnings == ()


@pytest.mark.parametrize("weft_first", [True, False])
def test_in_a_loop_ours_take_what_theirs_became(late: Path, tmp_path: Path, weft_first: bool) -> None:
    tables = [WEFT, MOTOR.removeprefix(LENGTH)]
    text = LENGTH + "".join(tables if weft_first else reversed(tables))
    result = ran(late, text + WIRED.format("motor.flange_a") + TORQUE, tmp_path)
    first = result.trace["motor.flange_a"][0]
    assert first > 100.0
    assert result.trace["weft.acceleration"][0] == acceleration(first)
    assert (
        "loop: weft.shaft_torque -> motor.load_tau changed after motor had left initialization;"
        " its sample at 0 s is based on the old value"
    ) in result.warnings
