"""Scenes with a third-party motor, as several tests run them."""

from pathlib import Path

import numpy as np
import pytest

from loomfmu import LoomfmuError
from loomfmu.cosim.run import Result, run
from loomfmu.cosim.scenes import scene as scenes

LENGTH = 'duration = "0.2 s"\nstep = "1 ms"\n'
MOTOR = LENGTH + '[motor]\nfmu = "Motor.fmu"\n'
WEFT = """
[weft]
machine = "WL680-3600"
[wires]
"weft.shaft_angle" = "motor.flange.phi"
"weft.shaft_velocity" = "motor.flange_w"
"weft.shaft_acceleration" = "motor.flange.a"
"""
SHAFT3 = '[shaft]\nfmu = "Motor3.fmu"\n'


def ran(place: Path, text: str, tmp_path: Path, **changed: object) -> Result:
    """The run of a scene whose FMUs lie in a place; in this process, where nothing else is said."""
    overrides = {"isolated": False} | {key.replace("__", "."): value for key, value in changed.items()}
    scene = scenes.parse(text, "motor", overrides, place)
    return run(scene, output=tmp_path / "motor.h5")


def refused(place: Path, text: str) -> str:
    """What is said of a scene that cannot be read."""
    with pytest.raises(LoomfmuError) as raised:
        scenes.parse(text, directory=place)
    return str(raised.value)


def exact(time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angle, velocity and acceleration of the unloaded motor: J dw/dt = tau (1 - w / w_free)."""
    constant, free = 0.5 * 60.0 / 100.0, 60.0
    decay = np.exp(-time / constant)
    return free * (time - constant * (1.0 - decay)), free * (1.0 - decay), free / constant * decay
