"""What there is to run: described from the declarations, written from the examples."""

from pathlib import Path

import pytest
from foreign_motors import FIXED, FMI3, description2, packed
from live_fmus import NAMES

from loomfmu import LoomfmuError, catalogue
from loomfmu.cli import main
from loomfmu.components import COMPONENTS
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.declaring.variables import variables_of
from loomfmu.fmi import live_fmu
from loomfmu.machines import HEADS, MACHINES


@pytest.mark.parametrize("name", NAMES)
def test_an_fmu_is_described_with_every_variable_that_a_user_sees(name: str) -> None:
    text = "\n".join(catalogue.details(name))
    for variable in variables_of(COMPONENTS[name]):
        numbered = variable.name.rstrip("0123456789") in text
        assert variable.name in text or numbered or variable.causality == "local"
    assert max(map(len, text.splitlines()[1:])) <= 80


def test_a_variable_is_shown_in_the_unit_that_people_read_it_in() -> None:
    lines = list(catalogue.details("BeltMonitor"))
    assert "  head_length = 550 mm  [0 .. 10000]" in lines
    assert "  speed_limit in rev/min" in lines
    assert "  cam_angle_1 .. cam_angle_6 = 0, 80, 295, 450, 657, 720 deg  [0 .. 720]" in list(
        catalogue.details("DobbyDrive")
    )


def test_numbered_variables_are_listed_by_the_first_and_the_last() -> None:
    assert (
        "    inputs: torque_1 .. torque_32, work_1 .. work_32, passed_torque_1 .. passed_torque_32"
        in list(catalogue.overview())
    )


def test_a_machine_and_a_head_are_described_by_what_they_set() -> None:
    for name in (*MACHINES, *HEADS):
        assert len(list(catalogue.details(name))) > 1
    assert "  WeftInsertion.wheel_diameter = 397 mm" in list(catalogue.details("WL680-3600"))
    assert "  BeltMonitor.head_mass = 110.5 g" in list(catalogue.details("G6300 left"))


def test_an_unknown_name_is_answered_with_the_nearest() -> None:
    with pytest.raises(LoomfmuError, match="did you mean 'BeltWrap'"):
        catalogue.details("BeltWarp")


def test_init_writes_a_scene_and_a_sweep_that_can_be_read(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["init", str(tmp_path / "loom")]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert printed[-1] == f"next: loomfmu run {tmp_path / 'loom' / 'wl680_3600.toml'}"
    scene = scenes.load(tmp_path / "loom" / "wl680_3600.toml")
    assert scene.claims
    assert (tmp_path / "loom" / "sweeps" / "safe_speed.toml").is_file()


def test_init_takes_a_folder_not_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("")
    for name in ("file", "new.toml"):
        assert main(["init", str(tmp_path / name)]) == 2
        assert f"{name} is not a folder; init takes one and writes wl680_3600.toml" in capsys.readouterr().err
    assert [each.name for each in tmp_path.iterdir()] == ["file"]


def test_init_writes_all_examples_and_overwrites_none(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "twill.toml").write_text("mine")
    assert main(["init", str(tmp_path), "--all"]) == 2
    error = capsys.readouterr().err
    reason = "already exists and differs; nothing was written: name another folder"
    assert error == f"loomfmu: {tmp_path / 'twill.toml'} {reason}\n"
    assert [path.name for path in tmp_path.iterdir()] == ["twill.toml"]
    (tmp_path / "twill.toml").unlink()
    assert main(["init", str(tmp_path), "--all"]) == 0
    assert scenes.load(tmp_path / "twill.toml").instances


def test_the_version_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert capsys.readouterr().out.startswith("loomfmu ")


def test_a_symbol_of_the_sources_finds_its_parameter() -> None:
    text = '[loom]\nweave = "10/01"\n[dobby]\nzeta = 0.5\n'
    with pytest.raises(LoomfmuError, match=r"dobby\.zeta is unknown; did you mean 'speed_reduction'\?"):
        scenes.parse(text)


def test_the_file_of_an_fmu_is_described_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    packed(tmp_path / "Motor.fmu", description2(), None, "Motor")
    packed(tmp_path / "Motor3.fmu", FMI3.format(fixed=FIXED), None, "Motor3")
    for name in ("Motor", "Motor3"):
        assert main(["list", str(tmp_path / f"{name}.fmu")]) == 0
        lines = capsys.readouterr().out.splitlines()
        assert lines[0].startswith(f"{name}: FMI {3 if name == 'Motor3' else 2}.0, ")
        assert "  mode = both_ways" in lines and "  w_free = 60 rad/s" in lines
    shaft = live_fmu.build(COMPONENTS["MainShaft"], tmp_path)
    assert main(["list", str(shaft)]) == 0
    assert "  speed = 400 rev/min  [from -9549.3 to 9549.3]" in capsys.readouterr().out.splitlines()
    assert main(["list", str(tmp_path / "none.fmu")]) == 2
    assert capsys.readouterr().err == f"loomfmu: {tmp_path / 'none.fmu'}: there is no such FMU\n"
