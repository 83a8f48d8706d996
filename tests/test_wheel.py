"""The wheel: whoever installs it needs no compiler and no checkout."""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from importlib.util import find_spec
from pathlib import Path

import pytest

from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing.built import file_of
from loomfmu.fmi.native.platforms import host
from loomfmu.traces import Trace

ROOT = Path(__file__).parents[1]
PARTS = ("src", "fmus", "sims", "pyproject.toml", "README.md", "LICENSE", "THIRD_PARTY.md")
SCENE = """
revolutions = 1
steps_per_revolution = 90
[shaft]
speed = "450 rev/min"
[weft]
[belt]
[[claims]]
kind = "lowest_margin"
bound = 0.05
"""
NEEDED = ("BeltMonitor", "MainShaft", "WeftInsertion")  # by the scenes below
# for this platform alone, of FMUs that the tests have built of the same sources
BUILD = """
import json, shutil, sys
from loomfmu.fmi import shipping
made = json.loads(sys.argv[1])
def build(name, directory, platforms, fmi):
    directory.mkdir(parents=True, exist_ok=True)
    shutil.copy(made[f"{name} {fmi}"], directory)
shipping.build_native = build
shipping.COMPONENTS = {name: shipping.COMPONENTS[name] for name in sys.argv[3:]}
shipping.build_all((sys.argv[2],))
"""
COMMAND = "import sys; from loomfmu.cli import main; sys.exit(main())"

pytestmark = pytest.mark.skipif(
    find_spec("ziglang") is None or not host(), reason="no native FMU can be built"
)


def called(
    *words: str | Path, cwd: Path, status: int = 0, **environment: str
) -> subprocess.CompletedProcess[str]:
    command, given = list(map(str, words)), os.environ | environment
    done = subprocess.run(command, cwd=cwd, env=given, capture_output=True, text=True, check=False)
    assert done.returncode == status, done.stderr
    return done


def command(python: Path, folder: Path, *words: str, status: int = 0) -> subprocess.CompletedProcess[str]:
    """A command of the wheel in a folder that has a cache of its own."""
    own = {"LOOMFMU_CACHE": str(folder / "cache"), "PYTHONPATH": ""}
    return called(python, "-c", COMMAND, *words, cwd=folder, status=status, **own)


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel, built as `make wheel` builds it, from a copy of the checkout."""
    copy = tmp_path_factory.mktemp("checkout")
    for part in PARTS:
        if (ROOT / part).is_dir():
            shutil.copytree(ROOT / part, copy / part, ignore=shutil.ignore_patterns("__pycache__", "shipped"))
        else:
            shutil.copy(ROOT / part, copy)
    made = {
        f"{name} {fmi}": str(file_of(COMPONENTS[name], "native", (host(),), fmi))
        for name in NEEDED
        for fmi in (2, 3)
    }
    arguments = (json.dumps(made), host(), *NEEDED)
    called(sys.executable, "-c", BUILD, *arguments, cwd=copy, PYTHONPATH=str(copy / "src"))
    flags = ("--quiet", "--no-deps", "--no-build-isolation", "--no-index", "--wheel-dir", "dist", ".")
    called(sys.executable, "-m", "pip", "wheel", *flags, cwd=copy)
    (built,) = (copy / "dist").glob("*.whl")
    return built


@pytest.fixture(scope="module")
def python(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A new environment with the wheel, the packages that it needs, and no compiler."""
    home = tmp_path_factory.mktemp("elsewhere")
    called(sys.executable, "-m", "venv", "--without-pip", home, cwd=home)
    python = home / Path(sys.executable).relative_to(sys.prefix)
    flags = ("--quiet", "--no-compile", "--no-deps")
    called(sys.executable, "-m", "pip", "--python", python, "install", *flags, wheel, cwd=home)
    own = home / Path(sysconfig.get_path("purelib")).relative_to(sys.prefix)
    (own / "others.pth").write_text(sysconfig.get_path("purelib"))
    (own / "sitecustomize.py").write_text("import sys\nsys.modules['ziglang'] = None\n")
    return python


@pytest.mark.slow
def test_the_first_run_of_a_scene_is_native(python: Path, tmp_path: Path) -> None:
    (tmp_path / "my_loom.toml").write_text(SCENE)
    found = called(python, "-c", "import loomfmu; print(loomfmu.__file__)", cwd=tmp_path, PYTHONPATH="")
    assert found.stdout.startswith(str(python.parents[1]))
    assert "90 steps with native FMUs, " in command(python, tmp_path, "run", "my_loom.toml").stdout
    assert not (tmp_path / "cache/fmus").exists()  # nothing was built
    assert not (tmp_path / "cache/stepper").exists()  # nor the stepper, which it brings
    (stepper,) = python.parents[1].rglob("shipped/*/stepper.*[!6]")
    assert stepper.parent.name == host()
    with Trace(tmp_path / "results/my_loom.h5") as trace:
        assert trace.attributes["flavour"] == "native"
        assert "notes" not in trace.attributes


def test_a_scene_runs_with_the_installed_command(python: Path, tmp_path: Path) -> None:
    installed, environment = python.with_name("loomfmu"), {"LOOMFMU_CACHE": str(tmp_path / "cache")}
    called(installed, "init", cwd=tmp_path, **environment)
    assert (tmp_path / "wl680_3600.toml").exists()
    (tmp_path / "my_loom.toml").write_text(SCENE)
    done = called(installed, "run", "my_loom.toml", cwd=tmp_path, **environment)
    assert "90 steps with native FMUs, " in done.stdout


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("page", 'a page that runs its scene needs the extra "native"'),
        ("export --fmu loom.fmu", "this needs a compiler, which is not installed"),
    ],
)
def test_what_needs_a_compiler_says_so_in_one_line(
    python: Path, tmp_path: Path, words: str, said: str
) -> None:
    (tmp_path / "my_loom.toml").write_text(SCENE)
    done = command(python, tmp_path, *words.split(), "my_loom.toml", status=2)
    assert done.stdout == ""
    assert done.stderr == f'loomfmu: {said}: pip install "loomfmu[native]"\n'
    assert not list(tmp_path.glob("**/loom.fmu*")) and not list(tmp_path.glob("**/*.html*"))


@pytest.mark.few(1)
@pytest.mark.parametrize("fmi", ["2", "3"])
def test_native_fmus_are_written_without_a_compiler(
    python: Path, wheel: Path, tmp_path: Path, fmi: str
) -> None:
    words = f"build --native --fmi {fmi} --platform {host()} --output here MainShaft"
    command(python, tmp_path, *words.split())
    with zipfile.ZipFile(wheel) as archive:
        brought = archive.read(f"loomfmu/fmi/native/shipped/fmi{fmi}/MainShaft.fmu")
    assert (tmp_path / "here/MainShaft.fmu").read_bytes() == brought


def test_a_mechanism_of_ones_own_runs_live_and_the_command_says_so(python: Path, tmp_path: Path) -> None:
    command(python, tmp_path, "new", "PickingCam")
    assert command(python, tmp_path, "run", "picking_cam/picking_cam.toml").stderr == (
        "warning: running live FMUs of PickingCam, not native ones: the compiler that builds it is not"
        ' installed: pip install "loomfmu[native]"\n'
    )
