"""Our native FMI 3.0 FMUs inside a container of fmpy, which has value reference 0 for a time of its own."""

from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.container_fmu.cli import create_container_fmu
from fmpy.container_fmu.config import Component, Configuration, Connection
from fmpy.model_description import CoSimulation, DefaultExperiment, ModelDescription, ModelVariable

from loomfmu.components import COMPONENTS, WeftInsertion
from loomfmu.cosim.importing.built import file_of
from loomfmu.fmi.native.platforms import host

SHAFT = ("angle", "velocity", "acceleration")


def part(name: str) -> Component:
    path = file_of(COMPONENTS[name], "native", (host(),), 3)
    return Component(name, path, fmpy.read_model_description(path))


def variable(part: Component, name: str) -> ModelVariable:
    return next(each for each in part.modelDescription.modelVariables if each.name == name)


@pytest.mark.usefixtures("natives")
def test_a_shaft_drives_the_weft_in_it(tmp_path: Path) -> None:
    shaft, weft = part("MainShaft"), part("WeftInsertion")
    time = ModelVariable(type="Float64", name="time", causality="independent", variability="continuous")
    follow = ModelVariable(
        type="Boolean", name="follow_shaft", causality="parameter", variability="fixed", start="true"
    )
    travel = ModelVariable(
        type="Float64", name="travel", causality="output", variability="continuous", initial="calculated"
    )
    description = ModelDescription(
        fmiVersion="3.0",
        modelName="Loom",
        instantiationToken="{loom}",
        unitDefinitions=[],
        typeDefinitions=[],
        defaultExperiment=DefaultExperiment(stopTime="0.15"),
        coSimulation=CoSimulation(fixedInternalStepSize=1e-3),
        modelVariables=[time, follow, travel],
    )
    wires = Connection(
        shaft,
        [variable(shaft, name) for name in SHAFT],
        weft,
        [variable(weft, f"shaft_{name}") for name in SHAFT],
    )
    mappings = {follow: [(weft, variable(weft, "follow_shaft"))], travel: [(weft, variable(weft, "travel"))]}
    (tmp_path / "unzipped").mkdir()
    container = tmp_path / "Loom.fmu"
    configuration = Configuration(False, description, [shaft, weft], [wires], mappings)
    create_container_fmu(configuration, tmp_path / "unzipped", container)
    rows = fmpy.simulate_fmu(container, stop_time=0.15, output_interval=1e-3)
    assert len(rows) == 151
    alone = WeftInsertion()
    for instant, found in zip(rows["time"], rows["travel"], strict=True):
        assert alone.initialize(float(instant)) == 0
        # at constant speed a shaft that is a step old is carried on exactly, but for rounding
        assert found == pytest.approx(alone.travel, rel=1e-12, abs=1e-12)
    assert np.ptp(rows["travel"]) > 2.0
