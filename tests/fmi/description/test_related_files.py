"""Reference results and parameter sets as FMI-LS-REF lists them: a host gets these results."""

from pathlib import Path
from xml.etree.ElementTree import Element, parse

import fmpy
import numpy as np
import pytest
from live_fmus import COMPONENTS, NAMES
from sharing import native_fmus
from whole_fmus import exported

from loomfmu.cosim.importing import fmus
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.declaring.variables import variables_of
from loomfmu.fmi.description.parameter_sets import parameter_sets
from loomfmu.fmi.description.related_files import related_files

PLACE = "extra/org.fmi-standard.fmi-ls-ref"
SPACE = "{http://fmi-standard.org/fmi-ls-manifest}"
every_fmu = pytest.mark.parametrize("name", NAMES)


def listed(path: Path, directory: Path) -> tuple[Element, Path]:
    """The manifest of an FMU, and the folder that it is in."""
    folder = Path(fmpy.extract(str(path), str(directory))) / PLACE
    return parse(folder / "fmi-ls-manifest.xml").getroot(), folder


@every_fmu
def test_the_manifest_lists_what_is_there(name: str, tmp_path: Path) -> None:
    root, folder = listed(fmus.of_component(name).path, tmp_path)
    # the layered standard fixes the first and the last
    assert root.tag == "fmiReferences" and root.attrib == {
        f"{SPACE}fmi-ls-name": "org.fmi-standard.fmi-ls-ref",
        f"{SPACE}fmi-ls-version": "1.0.0-alpha.1",
        f"{SPACE}fmi-ls-description": (
            "Layered Standard providing information on related files included in an FMU."
        ),
    }
    roles = [each.get("role") for each in root]
    assert roles == ["result", *["parameter"] * len(parameter_sets(COMPONENTS[name]))]
    for each in root:
        assert each.tag == "Related" and (folder / each.get("source", "")).resolve().is_file()


def gives_its_results(path: Path, directory: Path, lines: int = 145) -> None:
    root, folder = listed(path, directory)
    (source,) = (each.get("source", "") for each in root if each.get("role") == "result")
    expected = np.genfromtxt(folder / source, delimiter=",", names=True, deletechars="")
    times = expected["time"]
    found = fmpy.simulate_fmu(
        str(path), stop_time=times[-1], output_interval=times[1], fmi_type="CoSimulation"
    )
    assert len(found) == len(times) == lines
    for output in expected.dtype.names:
        # the same operations in the same order: only another libm may differ, by some last bits
        scale = np.max(np.abs(expected[output]))
        np.testing.assert_allclose(found[output], expected[output], rtol=0, atol=1e-12 * scale)


@every_fmu
def test_a_live_fmu_gives_the_results_that_it_carries(name: str, tmp_path: Path) -> None:
    gives_its_results(fmus.of_component(name).path, tmp_path)


@pytest.mark.few(3)
@every_fmu
def test_a_native_fmu_gives_the_results_that_it_carries(name: str, tmp_path: Path) -> None:
    gives_its_results(native_fmus()[name].path, tmp_path)


def test_results_of_something_else_are_left_out() -> None:
    component = COMPONENTS["MainShaft"]
    outputs = [each.structured for each in variables_of(component) if each.causality == "output"]
    right = ",".join(["time", *outputs]) + "\n0.0,0.0,0.0,0.0\n"
    assert len(related_files(component, right.encode())) == 2
    assert related_files(component, right.replace("time", "angle", 1).encode()) == {}
    assert related_files(component, b"") == related_files(component, None) == {}


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("steps", [30, 700])  # a line for each step, and for each four of them
def test_a_whole_loom_gives_the_results_that_it_carries(tmp_path: Path, fmi: int, steps: int) -> None:
    text = f"revolutions = 1.5\nsteps_per_revolution = {steps}\n[shaft]\n[weft]\n[dobby]\n[heald_1]\n"
    path = exported(scenes.parse(text, "loom"), tmp_path, fmi)
    gives_its_results(path, tmp_path / "unpacked", lines=1 + (30 if steps == 30 else 175))
