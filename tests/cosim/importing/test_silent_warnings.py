"""Warnings that come without a message are reported once, whoever makes the calls."""

from pathlib import Path

import pytest
from foreign_motors import misbehaving
from motor_scenes import MOTOR

from loomfmu.cosim.importing.calls import OK, WARNING, Call
from loomfmu.cosim.importing.logged import MOST_MESSAGES, Logged
from loomfmu.cosim.master.master import Master
from loomfmu.cosim.master.steppers import Action, CompiledStepper, PythonStepper, perform, take
from loomfmu.cosim.run import run
from loomfmu.cosim.scenes import scene as scenes

LINE = "motor returned a warning without a message in fmi2DoStep at 0.05 s, the first of 150"


@pytest.mark.parametrize("compiled", [True, False])
def test_both_steppers_report_it(tmp_path: Path, compiled: bool) -> None:
    misbehaving(tmp_path, "STATUS", returned=WARNING)
    scene = scenes.parse("isolated = false\n" + MOTOR, "motor", directory=tmp_path)
    with Master(scene, compiled=compiled) as master:
        master.initialize()
        assert type(master._stepper) is (CompiledStepper if compiled else PythonStepper)
        master.run(1000, lambda *_: None, lambda _: None)
        assert master.warnings() == [LINE]


def test_the_process_of_an_isolated_fmu_reports_it_in_every_run(tmp_path: Path) -> None:
    misbehaving(tmp_path, "STATUS", returned=WARNING)
    scene = scenes.parse("isolated = true\n" + MOTOR, "motor", directory=tmp_path)
    for _ in range(2):
        assert run(scene, output=tmp_path / "motor.h5").warnings == (LINE,)


def warning() -> int:
    return WARNING


@pytest.mark.parametrize("made", [lambda a: perform(a, 0.12), lambda a: take(a, 0.12, 0.13)])
def test_calls_of_the_start_and_of_iterated_steps_report_it(made) -> None:
    motor = Logged("motor")
    calls = [Call(warning, (), "fmi3SetFloat64"), Call(lambda: OK, (), "fmi3DoStep")]
    made([Action(motor, call) for call in calls])
    assert motor.warnings() == ["motor returned a warning without a message in fmi3SetFloat64 at 0.12 s"]
    motor.forget_messages()
    assert motor.warnings() == []


def test_a_warning_with_a_message_is_its_message() -> None:
    motor = Logged("motor")

    def warns() -> int:
        motor._keep(WARNING, b"hot")
        return WARNING

    def informs() -> int:
        motor._keep(OK, b"this level is not kept")
        return WARNING

    for _ in range(2 * MOST_MESSAGES):  # those that are left out were messages, too
        assert motor.noted("fmi2DoStep", 1.0, warns) == WARNING
    assert motor.silent == {}
    motor.noted("fmi2DoStep", 2.0, informs)
    assert motor.warnings()[-1] == "motor returned a warning without a message in fmi2DoStep at 2 s"
