"""A mechanism from outside the package: written by `loomfmu new`, changed by hand, run, built and judged."""

import json
import math
import os
import shutil
import subprocess
import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import fmpy
import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import loomfmu
from loomfmu import LoomfmuError
from loomfmu.cli import main
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.settings import KEYS
from loomfmu.loom.standard_loom import COMPONENT_OF
from loomfmu.mechanism import ShaftDriven, highest_so_far, output, state
from loomfmu.own import checks, load
from loomfmu.own.new import new

TRIAL = Path(__file__).with_name("picking_cam")  # what was written by hand
SCENE = """
revolutions = 3
steps_per_revolution = {steps}
[shaft]
speed = "400 rev/min"
[cam]
component = "picking_cam.py:PickingCam"
[[claims]]
kind = "above"
signal = "cam.lowest_contact_force"
bound = "10 N"
"""


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that the command writes."""
    return new("PickingCam", (), tmp_path_factory.mktemp("new"))[0].parent


@pytest.fixture
def cam(written: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The trial: that folder, three of its files rewritten by hand."""
    monkeypatch.chdir(tmp_path)
    folder = shutil.copytree(written, tmp_path / "picking_cam")
    for file in TRIAL.iterdir():
        if file.is_file():
            shutil.copy(file, folder)
    (folder / "cam.toml").write_text(SCENE.format(steps=360))
    return folder


def lowest_force(speed: float = 400.0 * math.pi / 30.0) -> float:
    """Of the picking cam with its defaults, from equations (1) to (3) alone."""
    law = np.polynomial.Polynomial([0, 0, 0, 0, 35, -84, 70, -20])
    scale = 0.03 * (speed / (math.pi / 3.0)) ** 2

    def force(u: float) -> float:
        return float(500.0 + 5000.0 * 0.03 * law(u) + scale * law.deriv(2)(u))

    near = min(np.linspace(0.0, 1.0, 1001), key=force)
    return float(
        minimize_scalar(
            force, bounds=(near - 1e-3, near + 1e-3), method="bounded", options={"xatol": 1e-10}
        ).fun
    )


def changed(folder: Path, *texts: tuple[str, str]) -> None:
    """The cam's source with some of its lines written in another way."""
    path = folder / "picking_cam.py"
    text = path.read_text()
    for old, other in texts:
        assert old in text
        text = text.replace(old, other)
    path.write_text(text)


# ---- the folder


def in_a_process(*arguments: str, cwd: Path) -> str:
    found = subprocess.run(
        [sys.executable, *arguments],
        cwd=cwd,
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"},
    )
    assert found.returncode == 0, found.stdout + found.stderr
    return found.stdout


@pytest.mark.few(1)
@pytest.mark.parametrize(("name", "own"), [("PickingCam", "picking_cam"), ("LiftABC2", "lift_abc2")])
def test_the_folder_runs_and_its_tests_pass_as_it_is_written(
    tmp_path: Path,
    name: str,
    own: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["new", name, "--output", str(tmp_path / "made here")]) == 0
    folder = tmp_path / "made here" / own
    files = ["README.md", f"{own}.py", f"{own}.toml", f"test_{own}.py"]
    assert sorted(file.name for file in folder.iterdir()) == files
    assert not any("ccentric" in file.read_text() for file in folder.iterdir())
    monkeypatch.chdir(folder)
    for options in ((), ("--native",)):
        assert main(["run", f"{own}.toml", *options]) == 0
        assert "holds" in capsys.readouterr().out
    in_a_process("-m", "pytest", "-q", "-p", "no:cacheprovider", cwd=folder)


@pytest.mark.slow
def test_nothing_is_overwritten(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "picking_cam").mkdir()
    assert main(["new", "PickingCam", "--output", str(tmp_path)]) == 2
    assert "picking_cam already exists; nothing was written\n" in capsys.readouterr().err
    assert list((tmp_path / "picking_cam").iterdir()) == []
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    (tmp_path / "file").write_text("mine")
    for name in ("Link", "File"):
        assert main(["new", name, "--output", str(tmp_path)]) == 2
    assert main(["new", "PickingCam", "--output", str(tmp_path / "file")]) == 2
    assert sorted(file.name for file in tmp_path.iterdir()) == ["file", "link", "picking_cam"]


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("picking_cam", "not a class name such as PickingCam"),
        ("../Cam", "not a class name"),
        ("True", "not a class name"),
        ("BeltMonitor", "^BeltMonitor: it is one of loomfmu's components; choose another name$"),
        ("Belt", "scenes use the name belt themselves"),
        ("Wires", "scenes use the name wires"),
        ("Random", "random is already a Python module"),
        ("Numpy", "numpy is already a Python module"),
        ("Loomfmu", "loomfmu is already a Python module"),
        ("Conftest", "conftest is already a Python module"),
        ("ShaftDriven", "loomfmu.mechanism has this name"),
        ("Class", "class is a Python keyword"),
        ("TestCam", "pytest would take test_cam.py for tests"),
        *((name, f"Windows cannot have a file {name.lower()}.py") for name in ("Con", "Nul", "Aux", "Lpt1")),
    ],
)
def test_names_that_cannot_be_used_are_refused(tmp_path: Path, name: str, said: str) -> None:
    with pytest.raises(LoomfmuError, match=said):
        new(name, (*KEYS, *COMPONENT_OF), tmp_path)
    assert list(tmp_path.iterdir()) == []


# ---- the trial


@pytest.mark.parametrize("flavour", ["live", "native"])
def test_the_lowest_force_is_that_of_the_equations(cam: Path, flavour: str) -> None:
    known = lowest_force()
    for steps in (1440, 360):
        (cam / "cam.toml").write_text(SCENE.format(steps=steps))
        found = loomfmu.evaluate(cam / "cam.toml", flavour=flavour)
        # the cubic is off by h^4 F''''/384: the force has some 1e3 N and its fourth derivative by angle is
        # 1e3 * (2 pi / 60 deg)^4 = 1.3e6; with 1 deg that is 3e-4 N, with 0.25 deg 1e-6 N
        assert found.claims[0].worst == pytest.approx(known, abs=3e-4 if steps == 360 else 1.3e-6)
        assert found.holds


def test_live_and_native_give_the_same_bits(cam: Path) -> None:
    ramp = {"shaft.ramp_duration": "0.1 s"}
    live, native = (
        loomfmu.run(cam / "cam.toml", set=ramp, flavour=flavour, output=cam / f"{flavour}.h5")
        for flavour in ("live", "native")
    )
    lift, steady = live.trace["cam.lift"], loomfmu.evaluate(cam / "cam.toml", values=["cam.lift"]).trace
    assert np.abs(lift - steady["cam.lift"]).max() > 0.02  # it follows the start-up
    for signal in live.trace:
        np.testing.assert_array_equal(live.trace[signal], native.trace[signal])


TURN = "    longest_turn: ClassVar[float] = pi / 72.0  # an eighth of the shortest rise\n"
KEEPS = "    keeps: ClassVar[str] = EXTREMES\n"


def test_what_is_not_declared_leaves_it_undecided_and_not_wrong(cam: Path) -> None:
    known = lowest_force()
    before = (cam / "picking_cam.py").read_text()
    for line in (TURN, KEEPS):
        (cam / "picking_cam.py").write_text(before)
        changed(cam, (line, ""))
        found = loomfmu.evaluate(cam / "cam.toml")
        assert found.claims[0].worst == pytest.approx(known, abs=3e-4)
        # with a `keeps` nothing says that these steps show its outputs
        assert found.claims[0].decided is (line == KEEPS)


def test_steps_longer_than_it_allows_leave_its_claims_undecided_whatever_it_keeps(cam: Path) -> None:
    changed(cam, (KEEPS, ""))
    for steps, word in ((60, "undecided"), (360, "holds")):
        (found,) = loomfmu.evaluate(cam / "cam.toml", set={"steps_per_revolution": steps}).claims
        assert found.word == word
        assert ("allows steps of at most 2.5 deg" in found.note) == (word == "undecided")


def test_one_that_is_cut_off_from_the_shaft_is_named(cam: Path) -> None:
    path = cam / "cam.toml"
    cut = "".join(f'"cam.shaft_{n}" = false\n' for n in ("angle", "velocity", "acceleration"))
    path.write_text(f"{path.read_text()}[wires]\n{cut}")
    (note,) = scenes.load(path).notes
    assert note == "cam runs at its own constant speed: its shaft inputs are not wired to the shaft"


ALONE = '''"""A wheel that knows no shaft."""

from dataclasses import dataclass

from loomfmu.mechanism import Component, output, parameter


@dataclass(slots=True)
class Wheel(Component):
    """A wheel."""

    speed: float = parameter("rad/s", 40.0, "Speed", display="rev/min")
    angle: float = output("rad", "Angle", unbounded=True)

    def initialize(self, time: float) -> int:
        """Start."""
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Turn."""
        self.angle = self.speed * (time + step_size)
        return 0
'''


def test_one_that_cannot_follow_the_shaft_is_named(tmp_path: Path) -> None:
    (tmp_path / "wheel.py").write_text(ALONE)
    scene = scenes.parse('[shaft]\n[wheel]\ncomponent = "wheel.py"\n', directory=tmp_path)
    assert scene.notes == ("wheel runs at its own constant speed: Wheel has no terminal SHAFT",)


SAMPLED = """
def sampled(lowest: float, h: float, a: float, b: float, end: float, c: float) -> float:
    return end if end < lowest else lowest


@dataclass(slots=True)
"""
BEYOND = r"lowest_contact_force = .* contact_force has been"


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            [("lowest_so_far(\n", "sampled(\n"), ("@dataclass(slots=True)\n", SAMPLED)],
            "lowest_contact_force depends on where the samples lie",
        ),
        ([("self.lowest_contact_force = lowest_so_far(\n", "_unused = lowest_so_far(\n")], BEYOND),
        ([("lowest_so_far", "highest_so_far")], BEYOND),
    ],
    ids=["sampled", "never updated", "the other side"],
)
def test_an_extreme_that_misses_the_curve_does_not_pass_the_check(
    cam: Path, changes: list[tuple[str, str]], said: str
) -> None:
    changed(cam, *changes)
    with pytest.raises(AssertionError, match=said):
        checks.check_extremes(load.component("picking_cam.py", cam))


@dataclass(slots=True)
class Swing(ShaftDriven):
    """A swing that a crank lets go at the start: what it does later depends on where the crank was."""

    longest_turn: ClassVar[float] = math.pi / 12.0
    phase: float = state("rad", "Phase")
    swing: float = state("m", "Amplitude")
    height: float = output("m", "Height", rate="velocity")
    velocity: float = output("m/s", "Velocity")
    highest: float = output("m", "Highest height", highest_of="height")

    def initialize(self, time: float) -> int:
        self.phase = 0.0
        self.swing = 2.0 + math.cos(self.shaft(time, 0.0)[0])
        self.highest = 0.0
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        height, velocity = self.height, self.velocity
        self.phase += 40.0 * step_size
        self.height = self.swing * math.sin(self.phase)
        self.velocity = 40.0 * self.swing * math.cos(self.phase)
        self.highest = self.kept(step_size, height, velocity)
        return 0

    def kept(self, step_size: float, height: float, velocity: float) -> float:
        return highest_so_far(self.highest, step_size, height, velocity, self.height, self.velocity)


class SampledSwing(Swing):
    """The same with an extreme that compares samples."""

    def kept(self, step_size: float, height: float, velocity: float) -> float:
        return max(self.highest, self.height)


def test_the_checks_tell_an_extreme_that_is_sampled_from_a_motion_that_its_start_changes() -> None:
    checks.check_rates(Swing)
    checks.check_extremes(Swing)
    with pytest.raises(AssertionError, match="highest depends on where the samples lie"):
        checks.check_extremes(SampledSwing)


def test_the_checks_are_for_classes_on_shaft_driven(tmp_path: Path) -> None:
    (tmp_path / "wheel.py").write_text(ALONE)
    with pytest.raises(AssertionError, match=r"Wheel has no speed and start_angle .* on ShaftDriven"):
        checks.check_rates(load.component("wheel.py", tmp_path))


# ---- FMUs of it


SLOW = pytest.mark.slow  # the first build for all platforms takes a minute


@pytest.mark.parametrize(
    "options",
    [[], pytest.param(["--native"], marks=SLOW), pytest.param(["--native", "--fmi", "3"], marks=SLOW)],
)
def test_its_fmus_stand_alone(cam: Path, options: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(cam)
    (cam / "icon.png").write_bytes(b"a picture")
    assert main(["build", "picking_cam.py", *options, "--output", "made"]) == 0
    path = cam / "made" / "PickingCam.fmu"
    with zipfile.ZipFile(path) as archive:
        page = archive.read("documentation/index.html").decode()
        icon = "terminalsAndIcons/icon.png" if "3" in options else "model.png"
        assert archive.read(icon) == b"a picture"
        binaries = {name.split("/")[1] for name in archive.namelist() if name.startswith("binaries/")}
    assert "A cam that throws the shuttle" in page
    assert "<code>preload</code>" in page
    assert len(binaries) == (2 if not options else 4 if "3" in options else 3)
    if options:
        assert fmpy.validation.validate_fmu(str(path)) == []
    found = fmpy.simulate_fmu(
        str(path),
        stop_time=0.3,
        output_interval=1e-3,
        output=["lowest_contact_force"],
        fmi_type="CoSimulation",
    )
    assert found["lowest_contact_force"][-1] == pytest.approx(lowest_force(), abs=0.1)  # 1 ms is 2.4 deg


def test_without_a_readme_its_docstring_is_the_documentation(cam: Path) -> None:
    (cam / "README.md").unlink()
    assert main(["build", str(cam / "picking_cam.py"), "--output", str(cam)]) == 0
    with zipfile.ZipFile(cam / "PickingCam.fmu") as archive:
        assert "the follower on a spring" in archive.read("documentation/index.html").decode()
        assert "model.png" not in archive.namelist()


def test_the_fmu_runs_in_a_scene_as_a_file(cam: Path) -> None:
    assert main(["build", str(cam / "picking_cam.py"), "--output", str(cam)]) == 0
    text = SCENE.format(steps=360).replace(
        'component = "picking_cam.py:PickingCam"', 'fmu = "PickingCam.fmu"'
    )
    (cam / "file.toml").write_text(text)
    (note,) = scenes.load(cam / "file.toml").notes
    assert note.startswith("cam runs at its own constant speed")


@pytest.mark.few(1)
@pytest.mark.parametrize(("flavour", "options"), [("live", []), ("native", ["--platform", "linux64"])])
def test_it_runs_in_a_package(cam: Path, flavour: str, options: list[str]) -> None:
    even, package = loomfmu.evaluate(cam / "cam.toml"), cam / "cam.ssp"
    arguments = ["export", str(cam / "cam.toml"), "--ssp", str(package), "--flavour", flavour]
    assert main([*arguments, *options]) == 0
    # the package follows the shaft's FMU, whose angle is rounded otherwise: by 1e-16 of some turns
    worst = loomfmu.evaluate(package).claims[0].worst
    assert worst == pytest.approx(even.claims[0].worst, rel=1e-12)


# ---- where it came from


def test_a_trace_keeps_its_source_and_runs_again_from_it(cam: Path) -> None:
    source = (cam / "picking_cam.py").read_text()
    law = source[source.index("def rise") : source.index("def pick")]
    (cam / "cam_law.py").write_text(f'"""The law."""\n\n\n{law}')
    changed(cam, (law, ""), ("from loomfmu.mechanism", "from cam_law import rise\nfrom loomfmu.mechanism"))
    (cam.parent / "scene.toml").write_text(
        SCENE.format(steps=90).replace("picking_cam.py", "picking_cam/picking_cam.py")
    )
    first = loomfmu.run(cam.parent / "scene.toml", output=cam / "first.h5").trace
    files = json.loads(first.attributes["files"])
    assert set(files) == {"picking_cam/picking_cam.py", "picking_cam/cam_law.py"}
    again = cam / "again"
    (again / "picking_cam").mkdir(parents=True)
    for name, text in files.items():
        (again / name).write_text(text)
    (again / "scene.toml").write_text(first.attributes["scene"])
    second = loomfmu.run(again / "scene.toml", output=cam / "second.h5").trace
    for signal in first:
        np.testing.assert_array_equal(first[signal], second[signal])
    with pytest.raises(LoomfmuError, match="it is an input of this command"):
        loomfmu.run(cam.parent / "scene.toml", output=cam / "cam_law.py", overwrite=True)


def test_a_sweep_of_it_runs_in_several_processes(cam: Path) -> None:
    (cam / "sweep.toml").write_text(
        'scene = "cam.toml"\nvalues = ["cam.lowest_contact_force"]\n'
        '[grid]\n"cam.preload" = ["200 N", "500 N", "800 N"]\n[traces]\nfailures = 0\nsample = 0\n'
    )
    (cam / "swept.py").write_text(
        "import loomfmu\nif __name__ == '__main__':\n"
        "    found = loomfmu.sweep('sweep.toml', processes=2, output='swept')\n"
        "    print(found.table['cam.lowest_contact_force'].to_pylist())\n"
    )
    forces = json.loads(in_a_process("swept.py", cwd=cam))
    assert np.diff(forces) == pytest.approx([300.0, 300.0], rel=1e-12)


# ---- its page in the documentation

PAGE = (Path(__file__).parents[2] / "docs" / "own_mechanism.md").read_text()


@pytest.mark.slow  # it builds for all platforms
def test_the_commands_of_its_page_work(tmp_path: Path) -> None:
    section = PAGE[PAGE.index("## Start") : PAGE.index("## In a scene")]
    commands = [line.strip() for line in section.splitlines() if line.startswith("    ")]
    assert len(commands) == 8
    here = tmp_path
    for command in commands:
        program, *arguments = command.split()
        if program == "cd":
            here = here / arguments[0]
            continue
        module = {"loomfmu": "loomfmu.cli", "pytest": "pytest"}[program]
        in_a_process("-m", module, *arguments, cwd=here)
    assert (here / "build" / "native_fmi3" / "PickingCam.fmu").exists()


def test_the_message_on_its_page_is_the_one_that_is_given(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (shown,) = [line.strip() for line in PAGE.splitlines() if line.startswith("    loomfmu: ")]
    monkeypatch.chdir(new("PickingCam", (), tmp_path)[0].parent)
    changed(Path(), ('rate="velocity"', 'rate="velocty"'))
    assert main(["build", "picking_cam.py"]) == 2
    assert capsys.readouterr().err == f"{shown}\n"
