"""Published machines and heads as parameter sets inside the FMUs: third-party tools read and apply them."""

import zipfile
from pathlib import Path

import fmpy
import fmpy.ssp.ssd
import pytest
from live_fmus import COMPONENTS, NAMES

from loomfmu.cosim.importing import fmus
from loomfmu.fmi.description.parameter_sets import parameter_sets
from loomfmu.machines import HEADS, MACHINES, parameters

every_fmu = pytest.mark.parametrize("name", NAMES)
TYPES = {"Real": float, "Integer": int, "Boolean": lambda text: text == "true"}


def unpacked(name: str, folder: Path) -> dict[str, Path]:
    """The sets of an FMU by their names, as a host finds them."""
    with zipfile.ZipFile(fmus.of_component(name).path) as zipped:
        zipped.extractall(folder, [file for file in zipped.namelist() if file.endswith(".ssv")])
    return {fmpy.ssp.ssd.read_ssv(str(file)).name: file for file in sorted(folder.rglob("*.ssv"))}


def read(file: Path) -> dict[str, tuple[str, str, str | None]]:
    """Type, value and unit of each parameter; fmpy holds the file to the schema of SSP 1.0."""
    found = fmpy.ssp.ssd.read_ssv(str(file), validate=True).parameters
    return {each.name: (each.type, each.value, each.unit) for each in found}


@every_fmu
def test_documentation_lists_them(name: str) -> None:
    with zipfile.ZipFile(fmus.of_component(name).path) as zipped:
        page = zipped.read("documentation/index.html").decode()
        there = {file for file in zipped.namelist() if file.endswith(".ssv")}
    assert there == {each.file for each in parameter_sets(COMPONENTS[name])}
    assert all(f"<code>{file}</code>" in page for file in there)
    assert ("<h2>Parameter sets</h2>" in page) == bool(there)


@pytest.mark.parametrize("name", ["WeftInsertion", "BeltMonitor"])
def test_every_machine_and_head_is_there_with_its_values_and_units(name: str, tmp_path: Path) -> None:
    found = unpacked(name, tmp_path)
    assert set(found) == {*MACHINES, *HEADS}
    ports = fmus.of_component(name).ports
    for which, file in found.items():
        assert file.parent.name == ("machines" if which in MACHINES else "heads")
        kind = "machine" if which in MACHINES else "head"
        given = read(file)
        assert {key: TYPES[value[0]](value[1]) for key, value in given.items()} == parameters(
            name, **{kind: which}
        )
        for key, (type_, _value, unit) in given.items():
            assert type_ == ports[key].kind
            assert unit == (ports[key].unit if type_ == "Real" else None)


@pytest.mark.parametrize("machine", MACHINES)
def test_a_host_applies_one(machine: str, tmp_path: Path) -> None:
    given = read(unpacked("WeftInsertion", tmp_path)[machine])
    found = fmpy.simulate_fmu(
        str(fmus.of_component("WeftInsertion").path),
        stop_time=1e-3,
        output_interval=1e-3,
        start_values={key: value[1] for key, value in given.items()},
        output=["stroke"],
    )
    there = COMPONENTS["WeftInsertion"](**parameters("WeftInsertion", machine=machine))
    assert there.initialize(0.0) == 0
    assert found["stroke"][-1] == there.stroke


def test_pyssp_reads_them(tmp_path: Path) -> None:
    ssv = pytest.importorskip("pyssp_standard.ssv", reason="pyssp_standard is not installed")
    with ssv.SSV(unpacked("BeltMonitor", tmp_path)["G6300 left"]) as found:
        (mass,) = found.parameters
        assert (mass["name"], mass["type_value"].parameter) == (
            "head_mass",
            {"value": "0.1105", "unit": "kg"},
        )
        found.__check_compliance__()
