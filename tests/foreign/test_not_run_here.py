"""PyFMI was not run when this was written: it has wheels for few versions of Python, conda for all."""

from pathlib import Path

import numpy as np
import pytest

from loomfmu.components import WeftInsertion
from loomfmu.cosim.importing.fmus import Fmu

SPEED = 20.0 * np.pi  # 600 rev/min


def test_pyfmi_runs_the_weft_at_its_own_speed(
    natives: dict[str, Fmu], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pyfmi = pytest.importorskip("pyfmi", reason="pyfmi is not installed: it has no wheel for this Python")
    monkeypatch.chdir(tmp_path)  # it writes its log and its result where it stands
    model = pyfmi.load_fmu(str(natives["WeftInsertion"].path), kind="CS")
    model.set("speed", SPEED)
    options = model.simulate_options()
    options["ncp"] = 1000
    found = model.simulate(start_time=0.0, final_time=0.1, options=options)
    weft = WeftInsertion(speed=SPEED)
    for time, travel in zip(found["time"], found["travel"], strict=True):
        assert weft.initialize(float(time)) == 0
        assert travel == pytest.approx(weft.travel, rel=1e-12, abs=1e-12)
