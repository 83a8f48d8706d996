"""System packages: what is written, that others can read it, and that it comes back to the last bit."""

import itertools
import re
import zipfile
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from direct_loom import small
from fmpy.ssp.ssd import read_ssd, read_ssv, validate_tree
from lxml import etree

from loomfmu import LoomfmuError, Trace
from loomfmu.cli import main
from loomfmu.cosim.run import Result, run
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.cosim.ssp import export as ssp
from loomfmu.cosim.ssp import read as ssp_read
from loomfmu.cosim.ssp.xml import NAMESPACES
from loomfmu.fmi.fmu_files import zipped
from loomfmu.fmi.native.platforms import host

SIMS = Path(__file__).parents[3] / "sims"
DEMO = SIMS / "wl680_3600.toml"
SHORT = {"revolutions": 0.5, "steps_per_revolution": 90}
TIMED = """
duration = "0.0994 s"
step = "0.7 ms"
[weft]
machine = "WL680-3600"
speed = "430 rpm"
[belt]
speed = "430 rpm"
[inputs]
"belt.guide_clearance" = [[0, "0.3 mm"], [0.05, "1 mm"]]
"""
GRAM = '<ssc:Unit name="g"><ssc:BaseUnit kg="1" factor="1e-3"/></ssc:Unit>'
LOOP = '[wires]\n"belt.yarn_tension" = "belt.inertia_force"\n'


def packed(scene: Scene, directory: Path) -> Path:
    path = directory / f"{scene.name}.ssp"
    ssp.export(scene, path, "live")
    return path


def members(path: Path, suffix: str = "") -> dict[str, bytes]:
    """The files of a package by name, those of one kind."""
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist() if name.endswith(suffix)}


def structure(path: Path) -> ElementTree.Element:
    return ElementTree.fromstring(members(path)["SystemStructure.ssd"])


def names_of(parent: ElementTree.Element) -> list[str]:
    return [element.tag.rpartition("}")[2] for element in parent]


def alike(
    folder: Path, scene: Scene | Path, package: Path, changed: dict[str, Any] | None = None, **more: Any
) -> tuple[Result, Result]:
    """The runs of a scene and of a package, whose traces are equal to the bit; `more` is changed in both."""
    before = run(scene, set=(changed or {}) | more, output=folder / "before.h5")
    after = run(package, set=more, output=folder / "after.h5")
    assert set(before.trace) == set(after.trace)
    np.testing.assert_array_equal(before.trace.time, after.trace.time)
    np.testing.assert_array_equal(before.trace.shaft_angle, after.trace.shaft_angle)
    for signal in before.trace:
        np.testing.assert_array_equal(before.trace[signal], after.trace[signal], err_msg=signal)
    for mine, theirs in zip(before.claims, after.claims, strict=True):  # judged between the samples there
        assert (mine.claim, mine.word) == (theirs.claim, theirs.word)
        assert abs(mine.worst - theirs.worst) <= theirs.error or str(mine) == str(theirs)
    return before, after


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return packed(scenes.load(DEMO, SHORT), tmp_path_factory.mktemp("demo"))


# ---- what is written


def test_the_same_scene_gives_the_same_bytes(demo: Path, tmp_path: Path) -> None:
    assert packed(scenes.load(DEMO, SHORT), tmp_path).read_bytes() == demo.read_bytes()
    other = packed(scenes.load(DEMO, SHORT | {"shaft.speed": "601 rpm"}), tmp_path)
    assert other.read_bytes() != demo.read_bytes()


@pytest.mark.parametrize("name", ["wl680_3600", "full_loom", "worn_belt", "start_up"])
def test_structure_and_parameters_are_valid(tmp_path: Path, name: str) -> None:
    path = packed(scenes.load(SIMS / f"{name}.toml", SHORT), tmp_path)
    for suffix, schema in ((".ssd", "Description"), (".ssv", "ParameterValues")):
        for content in members(path, suffix).values():
            validate_tree(etree.fromstring(content), f"SystemStructure{schema}.xsd")


def test_fmpy_reads_it(demo: Path) -> None:
    scene, found = scenes.load(DEMO, SHORT), read_ssd(str(demo))
    elements = {element.name: element for element in found.system.elements}
    assert list(elements) == list(scene.instances)
    assert len(found.system.connections) == len(scene.wires)
    assert elements["heald_3"].source == "resources/HealdFrame.fmu"
    for name, element in elements.items():
        inputs = {connector.name for connector in element.connectors if connector.kind == "input"}
        assert inputs == {wire.sink[1] for wire in scene.wires if wire.sink[0] == name}
    known = {unit.name: unit for unit in found.units}
    assert (known["N.m"].kg, known["N.m"].m, known["N.m"].s, known["N.m"].factor) == (1, 2, -2, 1.0)
    given = {p.name: p for p in read_ssv(str(demo), "resources/belt.ssv").parameters}
    assert (given["head_mass"].value, given["head_mass"].unit) == ("0.1105", "kg")
    assert (given["follow_shaft"].type, given["follow_shaft"].value) == ("Boolean", "true")


def test_pyssp_reads_it_and_finds_it_in_order(demo: Path) -> None:
    package = pytest.importorskip("pyssp_standard.ssp", reason="pyssp_standard is not installed")
    with package.SSP(demo, mode="r") as opened, opened.system_structure as found:
        found.check_compliance(found.schemas["ssd11"], found.namespaces)  # the schema in its XSD 1.1 form
        assert len(found.connections()) == len(scenes.load(DEMO, SHORT).wires)
        assert [element.name for element in found.system.elements][:3] == ["shaft", "weft", "belt"]


def test_each_fmu_is_in_it_once(demo: Path) -> None:
    assert sorted(members(demo, ".fmu")) == [
        f"resources/{name}.fmu"
        for name in ("BeltMonitor", "DobbyDrive", "HealdDamper", "HealdFrame", "MainShaft", "WeftInsertion")
    ]


def test_the_step_is_what_libcosim_looks_for(demo: Path) -> None:
    experiment = structure(demo).find("ssd:DefaultExperiment", NAMESPACES)
    fixed = experiment.find("ssd:Annotations/ssc:Annotation/osp:Algorithm/osp:FixedStepAlgorithm", NAMESPACES)
    # 600 rev/min in 90 steps: 1.111 ms, to the nanosecond, which is all that libcosim counts
    assert int(float(fixed.get("baseStepSize")) * 1e9) == 1111111
    assert experiment.get("stopTime") == "0.05"


def test_it_has_what_omsimulator_asks_for_and_nothing_that_it_refuses(demo: Path) -> None:
    found = structure(demo)
    place = "ssd:System/ssd:Annotations/ssc:Annotation"
    assert found.find(place, NAMESPACES).get("type") == "org.openmodelica"
    master = found.find(f"{place}/oms:Annotations/oms:SimulationInformation/oms:FixedStepMaster", NAMESPACES)
    assert master.get("description") == "oms-ma"
    assert float(master.get("stepSize")) == pytest.approx(scenes.load(DEMO, SHORT).step_size, rel=1e-15)
    # oms::Model::importFromSnapshot and oms::System::importFromSnapshot end at any other element
    assert names_of(found) == ["System", "Units", "DefaultExperiment"]
    assert names_of(found.find("ssd:System", NAMESPACES)) == ["Elements", "Connections", "Annotations"]
    # it looks for the prefix as it stands
    assert b"<oms:FixedStepMaster " in members(demo)["SystemStructure.ssd"]


def test_a_choice_is_written_by_its_name_and_only_where_it_is_not_the_default(
    demo: Path, tmp_path: Path
) -> None:
    def choices(path: Path) -> list[str | None]:
        sets = map(ElementTree.fromstring, members(path, ".ssv").values())
        return [each.get("value") for one in sets for each in one.iter(f"{{{NAMESPACES['ssv']}}}Enumeration")]

    assert choices(demo) == []  # libcosim and ecos take no package with one
    scene = scenes.load(DEMO, SHORT | {"dobby.law": "harmonic_ends"})
    path = packed(scene, tmp_path)
    assert choices(path) == ["harmonic_ends"]
    written = etree.fromstring(members(path)["resources/dobby.ssv"])
    validate_tree(written, "SystemStructureParameterValues.xsd")
    alike(tmp_path, scene, path)


def test_what_tells_of_our_master_is_left_to_others(tmp_path: Path) -> None:
    # they hand over values of the start of a step, which is what inputs_at_step_end says by default
    written = members(packed(small(90), tmp_path), ".ssv").values()
    assert not any(b"inputs_at_step_end" in content for content in written)
    said = packed(small(90, rest="[belt]\ninputs_at_step_end = false\n"), tmp_path)
    assert b"inputs_at_step_end" in members(said)["resources/belt.ssv"]
    result = run(tmp_path / "small.ssp", output=tmp_path / "back.h5")
    assert result.scene.instances["belt"].values["inputs_at_step_end"] is False
    assert result.scene.instances["weft"].values["inputs_at_step_end"] is True


def test_the_diagram_goes_from_left_to_right(demo: Path) -> None:
    boxes = {}
    for component in structure(demo).iterfind("ssd:System/ssd:Elements/ssd:Component", NAMESPACES):
        shape = component.find("ssd:ElementGeometry", NAMESPACES)
        boxes[component.get("name")] = [float(shape.get(key)) for key in ("x1", "y1", "x2", "y2")]
    for wire in scenes.load(DEMO, SHORT).wires:
        assert boxes[wire.source[0]][2] < boxes[wire.sink[0]][0], str(wire)
    for one, other in itertools.combinations(boxes.values(), 2):
        apart = one[2] < other[0] or other[2] < one[0] or one[3] < other[1] or other[3] < one[1]
        assert apart, (one, other)
    for connector in structure(demo).iter(f"{{{NAMESPACES['ssd']}}}ConnectorGeometry"):
        assert 0.0 < float(connector.get("y")) < 1.0


# ---- and read again


@pytest.mark.few(2)
@pytest.mark.parametrize("name", ["wl680_3600", "full_loom", "worn_belt", "start_up", "satin"])
def test_a_package_runs_as_its_scene_to_the_last_bit(tmp_path: Path, name: str) -> None:
    changed = SHORT | {"shaft.speed": "487.3 rpm"}
    scene = scenes.load(SIMS / f"{name}.toml", changed)
    before, after = alike(tmp_path, scene, packed(scene, tmp_path))
    assert after.scene.title == scene.title and after.scene.description == scene.description
    assert after.trace.attributes["scene"] == scene.text
    signals = [signal for signal in before.trace if signal in scene.record]
    assert signals == [signal for signal in after.trace if signal in after.scene.record]


def test_the_system_has_connectors_where_they_are_asked_for(tmp_path: Path) -> None:
    scene = scenes.load(SIMS / "worn_belt.toml", SHORT)
    path = tmp_path / "outside.ssp"
    assert ssp.export(scene, path, "live", connectors=True) == ssp.export(scene, tmp_path / "o.ssp", "live")
    validate_tree(etree.fromstring(members(path)["SystemStructure.ssd"]), "SystemStructureDescription.xsd")
    outer = {each.name: each for each in read_ssd(str(path)).system.connectors}
    assert (outer["shaft_speed"].kind, outer["belt_margin"].kind) == ("parameter", "output")
    assert {"weft_travel", "weft_velocity", "weft_acceleration"} <= set(outer)  # a terminal
    alike(tmp_path, scene, path)
    alike(tmp_path, scene, path, SHORT, **{"shaft.speed": "601 rpm"})


@pytest.mark.skipif(find_spec("ziglang") is None, reason="ziglang is not installed: no native FMU")
def test_a_package_may_hold_fmus_of_fmi_3(tmp_path: Path) -> None:
    scene = scenes.load(SIMS / "worn_belt.toml", SHORT)
    path = tmp_path / "three.ssp"
    ssp.export(scene, path, "native", (host(),), fmi=3)
    assert {each.fmu.fmi for each in ssp_read.load(path).instances.values()} == {3}
    alike(tmp_path, scene, path)
    assert structure(path).get("version") == "2.0"
    pyssp = pytest.importorskip("pyssp_standard", reason="pyssp_standard is not installed")
    schemas = Path(pyssp.__file__).with_name("resources") / "ssp2"
    for suffix, schema in ((".ssd", "Description"), (".ssv", "ParameterValues")):
        valid = etree.XMLSchema(etree.parse(schemas / f"SystemStructure{schema}.xsd"))
        for content in members(path, suffix).values():
            valid.assertValid(etree.fromstring(content))
    with pytest.raises(LoomfmuError, match=r"live FMUs are of FMI 2\.0"):
        ssp.export(scene, tmp_path / "live.ssp", "live", fmi=3)


@pytest.mark.parametrize("text", [TIMED, "revolutions = 0.5\n[weft]\n[belt]\n" + LOOP])
def test_so_do_a_scene_without_shaft_and_one_with_a_loop(tmp_path: Path, text: str) -> None:
    scene = scenes.parse(text, "odd")
    before, after = alike(tmp_path, scene, packed(scene, tmp_path))
    assert after.warnings == before.warnings


def test_values_of_a_package_can_be_changed(demo: Path, tmp_path: Path) -> None:
    changed = {"shaft.speed": "650 rpm", "heald.stroke": "90 mm", "steps_per_revolution": "44"}
    _before, after = alike(tmp_path, DEMO, demo, {"revolutions": 0.5}, **changed)
    again = run(after.scene, set={"steps_per_revolution": 30}, output=tmp_path / "again.h5")
    assert (again.trace.rows, again.scene.speed) == (16, scenes.load(DEMO).speed)


def test_what_instances_take_from_one_another_they_take_in_a_package_too(tmp_path: Path) -> None:
    text = (
        '[loom]\nmachine = "WL680-3600"\nweave = "10/01"\nwarps = true\ndampers = true\nbelt_motion = true\n'
    )
    (tmp_path / "whole.toml").write_text(text)
    package = tmp_path / "whole.ssp"
    ssp.export(scenes.load(tmp_path / "whole.toml"), package, "live")
    for changed in ({"warp.thread_count": 600}, {"heald.stroke": "90 mm"}, {"machine": "WL450-3600"}):
        before = scenes.load(tmp_path / "whole.toml", changed).instances
        after = ssp_read.load(package, changed).instances
        assert all(after[name].effective() == each.effective() for name, each in before.items())


def test_the_machine_of_a_package_can_be_changed_and_a_mixed_one_is_named(demo: Path) -> None:
    changed = ssp_read.load(demo, {"belt.idle_travel": "0.2 m", "machine": "WL450-3600"})
    wanted = scenes.load(DEMO, {"belt.idle_travel": "0.2 m", "machine": "WL450-3600"})
    for name in ("weft", "belt"):
        assert changed.instances[name].values == wanted.instances[name].values
    assert changed.notes == ()
    (note,) = ssp_read.load(demo, {"weft.machine": "WL450-3600"}).notes
    assert note.startswith("the loom mixes machines: weft has WL450-3600 and belt has its own values;")


def test_a_connected_input_of_a_package_takes_no_value(demo: Path) -> None:
    with pytest.raises(LoomfmuError) as raised:
        ssp_read.load(demo, {"belt.travel": 3})
    assert str(raised.value).endswith("belt.travel cannot be set, it is wired to weft.travel in the package")


def edited(path: Path, target: Path, *changes: tuple[str, str, str]) -> Path:
    """A copy of a package with texts of its files replaced: each the file, the text and the new one."""
    files = members(path)
    for name, before, after in changes:
        assert before.encode() in files[name], before
        files[name] = files[name].replace(before.encode(), after.encode())
    target.write_bytes(zipped(files))
    return target


def test_what_another_tool_has_changed_in_it_holds(demo: Path, tmp_path: Path) -> None:
    wire = '{0}Element="weft" {0}Connector="acceleration" {1}Element="belt" {1}Connector="acceleration"'
    path = edited(
        demo,
        tmp_path / "edited.ssp",
        ("resources/belt.ssv", '"0.1105" unit="kg"', '"221" unit="g"'),
        ("resources/belt.ssv", '<ssc:Unit name="kg">', f'{GRAM}<ssc:Unit name="kg">'),
        ("SystemStructure.ssd", wire.format("start", "end"), wire.format("end", "start")),
    )
    trace = run(path, output=tmp_path / "edited.h5").trace
    expected = run(DEMO, set=SHORT | {"belt.head_mass": 0.221}, output=tmp_path / "expected.h5").trace
    # 221 g is 0.221 kg to the rounding of one product; start and end of a connection tell no direction
    for signal in expected:
        scale = np.max(np.abs(expected[signal]))
        np.testing.assert_allclose(
            trace[signal], expected[signal], rtol=0, atol=1e-14 * scale, err_msg=signal
        )


def test_a_package_of_the_form_before_is_still_read(demo: Path, tmp_path: Path) -> None:
    # our annotation at the end of the root, a choice by its number
    text = members(demo)["SystemStructure.ssd"].decode()
    (ours,) = re.findall(
        r'<ssc:Annotation type="org\.pypi\.loomfmu">.*</loomfmu:Scene>\s*</ssc:Annotation>', text, re.DOTALL
    )
    last, law = (
        "</ssd:DefaultExperiment>",
        '<ssv:Parameter name="law"><ssv:Integer value="2"/></ssv:Parameter>',
    )
    path = edited(
        demo,
        tmp_path / "old.ssp",
        ("SystemStructure.ssd", ours, ""),
        ("SystemStructure.ssd", last, f"{last}<ssd:Annotations>{ours}</ssd:Annotations>"),
        ("resources/dobby.ssv", "</ssv:Parameters>", f"{law}</ssv:Parameters>"),
    )
    assert names_of(structure(path))[-1] == "Annotations"
    alike(tmp_path, DEMO, path, SHORT | {"dobby.law": "harmonic_ends"})


# ---- the command


def test_export_and_run_by_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    scene = str(SIMS / "worn_belt.toml")
    few = ["--set", "steps_per_revolution=90", "--set", "revolutions=2"]
    assert main(["export", scene, "--ssp", "deep/belt.ssp", "--flavour", "live", *few]) == 0
    printed = capfd.readouterr()
    assert printed.out == "written: deep/belt.ssp\n"
    assert printed.err == (
        "warning: belt.guide_clearance is driven along a table, which a system package cannot hold:"
        " other tools keep it at its first value\n"
    )
    # its FMUs are files: they run in a child process
    assert main(["run", "deep/belt.ssp", "--set", "shaft.speed=500rpm"]) == 0
    assert "500 rev/min: 2 revolutions, 180 steps" in capfd.readouterr().out
    with Trace("results/belt_shaft.speed=500rpm.h5") as trace:
        assert trace["belt.guide_clearance"][-1] > 0.3e-3


def test_loops_that_others_may_close_late_are_told(tmp_path: Path) -> None:
    scene = scenes.load(SIMS / "light_shaft.toml", {"steps_per_revolution": 90})
    (warning,) = ssp.export(scene, tmp_path / "loop.ssp", "live")
    assert (
        "algebraic loop, weft.shaft_torque to shaft.torque_1 and" in warning
        and "--fmu iterates it" in warning
    )


def test_what_others_cannot_set_is_told(demo: Path, tmp_path: Path) -> None:
    scene = scenes.load(DEMO, SHORT | {"dobby.law": "uniform"})
    assert ssp.export(scene, tmp_path / "law.ssp", "live") == [
        "dobby.law is an enumeration: libcosim and ecos reject the package, OMSimulator leaves it at its"
        " default"
    ]
    assert ssp.export(scenes.load(DEMO, SHORT), tmp_path / "law.ssp", "live") == []  # it is the default
    with pytest.raises(
        LoomfmuError, match=r"a system package brings its own FMUs, so no flavour can be chosen$"
    ):
        run(demo, flavour="live", output=tmp_path / "x.h5")


CASES = {
    "no zip": (["run", "text.ssp"], "text.ssp: cannot be read (File is not a zip file)"),
    "none": (["run", "none.ssp"], "none.ssp: cannot be read (No such file or directory)"),
    "no structure": (["run", "empty.ssp"], "empty.ssp: SystemStructure.ssd is not in the package"),
    "no XML": (["run", "broken.ssp"],
        "broken.ssp: SystemStructure.ssd: not valid XML (unclosed token: line 1, column 0)"),
    "set": (["run", "good.ssp", "--set", "belt.travl=1"],
        "good.ssp: belt.travl is unknown; did you mean 'travel'?"),
    "set nobody": (["run", "good.ssp", "--set", "bel.travel=1"],
        "good.ssp: bel.travel: the scene has no instance 'bel'; did you mean 'belt'?"),
    "platform": (["export", str(DEMO), "--ssp", "x.ssp", "--platform", "linx64"],
        "there is no platform 'linx64'; did you mean 'linux64'?"),
    "directory": (["export", str(DEMO), "--ssp", "text.ssp/x.ssp", "--flavour", "live"],
        "text.ssp/x.ssp: cannot be written (text.ssp is not a directory)"),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_a_mistake_is_told_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], demo: Path, case: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("text.ssp").write_text("no zip")
    Path("good.ssp").write_bytes(demo.read_bytes())
    for name, files in {"empty": {}, "broken": {"SystemStructure.ssd": b"<a"}}.items():
        Path(f"{name}.ssp").write_bytes(zipped(files))
    arguments, said = CASES[case]
    assert main(arguments) == 2
    assert capsys.readouterr().err == f"loomfmu: {said}\n"


def test_a_package_is_not_packed_again(demo: Path, tmp_path: Path) -> None:
    result = run(demo, output=tmp_path / "x.h5")
    with pytest.raises(LoomfmuError, match="is already a system package"):
        ssp.export(result.scene, tmp_path / "x.ssp", "live")


def test_what_xml_cannot_hold_is_refused_and_nothing_is_written(tmp_path: Path) -> None:
    scene = scenes.load(DEMO, SHORT)
    for changed, said in (
        (
            replace(scene, name="a\0b"),
            "SystemStructureDescription name contains the control character U+0000",
        ),
        (replace(scene, text="# \uffff"), "Scene text contains the control character U+FFFF"),
    ):
        with pytest.raises(LoomfmuError, match=said.replace("+", r"\+")):
            ssp.export(changed, tmp_path / "x.ssp", "live")
    assert list(tmp_path.iterdir()) == []
