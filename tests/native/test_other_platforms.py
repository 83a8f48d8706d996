"""Binaries for other platforms under what runs them here: the same host, the same values."""

import math
import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from loomfmu.components import COMPONENTS
from loomfmu.declaring.variables import variables_of
from loomfmu.fmi import live_fmu
from loomfmu.fmi.native import native_fmu
from loomfmu.fmi.native.platforms import PLATFORMS

HERE = Path(__file__).parent
STEPS, SIZE = 1000, 1e-3  # one second
SYSTEM = Path("/usr/aarch64-linux-gnu")  # libc6-arm64-cross of Debian


class Emulator(NamedTuple):
    """How a platform's programs run here: nothing where they do not."""

    command: tuple[str, ...]
    missing: str
    called: str  # the path of a file as they call it


def windows() -> Emulator:
    found = shutil.which("wine64") or shutil.which("wine") or shutil.which("/usr/lib/wine/wine64")
    return Emulator((found,) if found else (), "no wine", "Z:{}")


def aarch64() -> Emulator:
    found = shutil.which("qemu-aarch64") if (SYSTEM / "lib/ld-linux-aarch64.so.1").exists() else None
    return Emulator((found, "-L", str(SYSTEM)) if found else (), "no qemu-user or libc6-arm64-cross", "{}")


EMULATORS = {"win64": windows, "aarch64-linux": aarch64}


@pytest.fixture(scope="module")
def host(tools, tmp_path_factory) -> Callable[[str], Path]:
    """The C host of the other tests, built for a platform."""

    def built(platform: str) -> Path:
        path = tmp_path_factory.getbasetemp() / f"host-{platform}.exe"
        if path.exists():
            return path
        (target,) = PLATFORMS[platform].targets
        command = [sys.executable, "-m", "ziglang", "cc", "-target", target, "-std=c99", "-O1"]
        command += [f"-I{native_fmu.HEADERS}", "-o", path, HERE / "host.c", "-lm"]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        assert run.returncode == 0, run.stderr
        return path

    return built


@pytest.mark.few(1, each="platform")
@pytest.mark.parametrize("name", COMPONENTS)
@pytest.mark.parametrize("platform", EMULATORS)
def test_the_binary_gives_the_components_results(fmu_cache, host, tmp_path, platform, name):
    emulator = EMULATORS[platform]()
    if not emulator.command:
        pytest.skip(f"{emulator.missing}: the binaries for {platform} are not run")
    component = COMPONENTS[name]
    fmu = native_fmu.build_native(name, tmp_path, (platform,))
    with zipfile.ZipFile(fmu) as zipped:
        library = zipped.extract(f"binaries/{platform}/{name}{PLATFORMS[platform].suffix}", tmp_path)
    letters = "".join({float: "r", int: "i", bool: "b"}[v.type] for v in variables_of(component))
    program, called = host(platform), emulator.called.format(library)
    run = subprocess.run(
        [*emulator.command, program, called, live_fmu.guid(component), str(STEPS), repr(SIZE), letters],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
        env=os.environ | {"WINEPREFIX": str(tmp_path / "prefix"), "WINEDEBUG": "-all", "DISPLAY": ""},
    )
    assert run.returncode == 0, run.stderr
    python = component()
    assert python.initialize(0.0) == 0
    for step in range(STEPS):
        assert python.step(step * SIZE, SIZE) == 0
    for variable, line in zip(variables_of(component), run.stdout.split(), strict=True):
        # libm is another there: 1e-9 of the value, or of 1 where values cancel to noise
        wanted = float(getattr(python, variable.name))
        assert math.isclose(float(line), wanted, rel_tol=1e-9, abs_tol=1e-9), variable.name
