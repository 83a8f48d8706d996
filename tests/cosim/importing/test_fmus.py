"""FMUs of our own: known from their declarations, built when they are needed, native where they can be."""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import fmpy
import pytest

import loomfmu
from loomfmu import LoomfmuError
from loomfmu.cache.directory import cache_directory
from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing import fmus
from loomfmu.cosim.importing.built import file_of, run_files
from loomfmu.cosim.importing.descriptions import declared_ports, ports_of
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.declaring.arrays import array
from loomfmu.declaring.declarations import output
from loomfmu.declaring.variables import Component
from loomfmu.fmi.description.model_description import model_description
from loomfmu.fmi.fmu_files import zipped
from loomfmu.fmi.native import platforms
from loomfmu.sweeps.plan import load

SCENE = "revolutions = 0.1\nsteps_per_revolution = 90\n[weft]\n[belt]\n"


@pytest.mark.parametrize("name", COMPONENTS)
def test_declared_variables_are_those_that_the_description_has(name: str) -> None:
    description = model_description(COMPONENTS[name], guid="", version="")
    packed = io.BytesIO(zipped({"modelDescription.xml": description}))
    read = ports_of(fmpy.read_model_description(packed, validate=False), COMPONENTS[name])
    declared = declared_ports(COMPONENTS[name])
    assert declared == read
    assert repr(declared) == repr(read)  # types as well: 1 is not 1.0


@dataclass(slots=True)
class Row(Component):
    """Places in a row, with their rates."""

    place: Sequence[float] = array(output("m", f"Place {n}", rate=f"rate_{n}") for n in (1, 2))
    rate: Sequence[float] = array(output("m/s", f"Rate {n}") for n in (1, 2))


def test_the_rates_of_an_array_of_outputs_are_found_in_the_description() -> None:
    packed = io.BytesIO(zipped({"modelDescription.xml": model_description(Row, guid="", version="")}))
    read = ports_of(fmpy.read_model_description(packed, validate=False), Row)
    assert (read["place_1"].rate, read["place_2"].rate) == ("rate_1", "rate_2")
    assert read == declared_ports(Row)


@pytest.mark.parametrize("flavour", fmus.FLAVOURS)
@pytest.mark.parametrize("name", COMPONENTS)
def test_a_built_fmu_is_what_its_file_says(name: str, flavour: str) -> None:
    fmu = fmus.of_component(name, flavour)
    read = fmus.load(fmu.path)
    assert fmu.file == read.file
    assert (fmu.name, fmu.ports, fmu.fmi) == (read.name, read.ports, read.fmi)
    assert read.component is fmu.component
    for trait in ("trusted", "single", "fixed_step", "needs_tool"):
        assert getattr(fmu, trait) == getattr(read, trait)


@pytest.mark.parametrize(("flavour", "fmi"), [("live", 2), ("native", 2), ("native", 3)])
def test_one_byte_beside_our_own_makes_an_fmu_a_foreign_one(flavour: str, fmi: int, tmp_path: Path) -> None:
    """Whatever it says of its maker, its name and its GUID."""
    files = run_files(file_of(COMPONENTS["MainShaft"], flavour, (platforms.host(),), fmi))
    last = max(files)

    def read(**changed: bytes) -> fmus.Fmu:
        (tmp_path / "MainShaft.fmu").write_bytes(zipped(files | {"documentation/x": b"x"} | changed))
        return fmus.load(tmp_path / "MainShaft.fmu")

    same = read()
    assert same.ours and same.trusted and same.component is COMPONENTS["MainShaft"]
    for changed in ({last: files[last] + b"\n"}, {"resources/more.py": b""}):
        other = read(**changed)
        assert other.ours and not other.trusted and other.component is None
        assert other.guid == same.guid
    text = f"revolutions = 1\n[shaft]\n[other]\nfmu = '{tmp_path / 'MainShaft.fmu'}'\nspeed = '600 rpm'\n"
    assert scenes.parse(text).isolates("other")


def test_runs_are_native_by_default(tmp_path: Path) -> None:
    result = loomfmu.run(scenes.parse(SCENE), output=tmp_path / "run.h5")
    assert result.trace.attributes["flavour"] == "native"
    assert result.warnings == ()
    assert {each.fmu.flavour for each in loomfmu.evaluate(scenes.parse(SCENE)).scene.instances.values()} == {
        "native"
    }
    (tmp_path / "scene.toml").write_text(SCENE)
    (tmp_path / "sweep.toml").write_text('scene = "scene.toml"\n[grid]\n"shaft.speed" = [60, 70]\n')
    assert load(tmp_path / "sweep.toml").flavour == "native"


NO_COMPILER = 'the compiler that builds it is not installed: pip install "loomfmu[native]"'
MISSING = {
    "no compiler": ("compiler", None, NO_COMPILER),
    "another machine": ("host", "", f"none are built for {platforms.MACHINE}"),
}


@pytest.mark.parametrize(("name", "value", "reason"), MISSING.values(), ids=MISSING)
def test_without_a_native_fmu_a_run_is_live_and_warns(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str, value: str | None, reason: str
) -> None:
    monkeypatch.setattr(platforms, name, lambda: value)
    scene = scenes.parse(SCENE)
    result = loomfmu.run(scene, output=tmp_path / "run.h5")
    warning = f"running live FMUs of MainShaft, WeftInsertion and BeltMonitor, not native ones: {reason}"
    assert result.warnings == (warning,)
    assert result.trace.attributes["flavour"] == "live"
    assert result.trace.attributes["notes"] == warning
    assert loomfmu.evaluate(scene).warnings == (warning,)
    assert loomfmu.evaluate(scene, flavour="live").warnings == ()


def test_what_is_needed_is_built_at_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("LOOMFMU_CACHE", str(tmp_path))
    names = ("MainShaft", "HealdFrame")
    wanted = [fmus.Fmu(name, {}, flavour="live", component=COMPONENTS[name]) for name in (*names, *names)]
    missing = fmus.unbuilt(wanted)
    assert [each.name for each in missing] == list(names)
    fmus.build(missing)
    assert fmus.unbuilt(wanted) == []
    assert {path.name for path in tmp_path.glob("fmus/*/*.fmu")} == {f"{name}.fmu" for name in names}


def test_files_that_are_no_fmus_are_told_in_one_line(tmp_path: Path) -> None:
    path, whole = tmp_path / "wrong.fmu", fmus.of_component("MainShaft").path.read_bytes()
    cases = {
        "not a readable FMU (File is not a zip file)": [
            b"",
            b"no zip",
            whole[: len(whole) // 2],
            whole[:-30],
        ],
        "not a readable FMU (it has no modelDescription.xml)": [zipped({}), zipped({"x.xml": b"<a/>"})],
        "its modelDescription.xml cannot be read (": [
            zipped({"modelDescription.xml": text}) for text in (b"<a", b"<a/>")
        ],
    }
    for said, contents in cases.items():
        for content in contents:
            path.write_bytes(content)
            with pytest.raises(LoomfmuError) as raised:
                fmus.load(path)
            assert str(raised.value).startswith(f"{path}: {said}") and "\n" not in str(raised.value)
    unpacked = cache_directory() / "unpacked"
    assert all(len(entry.name) == 64 for entry in unpacked.iterdir())  # nothing half unpacked is left


def test_an_fmu_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(LoomfmuError, match=r"none\.fmu: there is no such FMU$"):
        fmus.load(tmp_path / "none.fmu")
    with pytest.raises(LoomfmuError, match=r": not a readable FMU \(Is a directory"):
        fmus.load(tmp_path)
