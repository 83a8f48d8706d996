"""The Windows binaries under Wine: the same host, the same values."""

import math
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from loomfmu.components import COMPONENTS
from loomfmu.declaring.variables import variables_of
from loomfmu.fmi import live_fmu
from loomfmu.fmi.native import native_fmu

WINE = shutil.which("wine64") or shutil.which("wine") or shutil.which("/usr/lib/wine/wine64")
HERE = Path(__file__).parent
STEPS, SIZE = 1000, 1e-3  # one second

pytestmark = pytest.mark.skipif(WINE is None, reason="no wine: the Windows binaries are not run")


@pytest.fixture(scope="module")
def host(tools, tmp_path_factory) -> Path:
    """The C host of the other tests, built for Windows."""
    path = tmp_path_factory.mktemp("windows") / "host.exe"
    command = [
        sys.executable,
        "-m",
        "ziglang",
        "cc",
        "-target",
        "x86_64-windows-gnu",
        "-std=c99",
        "-O1",
        f"-I{native_fmu.HEADERS}",
        "-o",
        path,
        HERE / "host.c",
    ]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return path


@pytest.mark.parametrize("name", COMPONENTS)
def test_the_windows_binary_gives_the_components_results(fmu_cache, host, tmp_path, name):
    component = COMPONENTS[name]
    fmu = native_fmu.build_native(name, tmp_path, ("win64",))
    with zipfile.ZipFile(fmu) as zipped:
        library = Path(zipped.extract(f"binaries/win64/{name}.dll", tmp_path))
    letters = "".join({float: "r", int: "i", bool: "b"}[v.type] for v in variables_of(component))
    run = subprocess.run(
        [WINE, host, f"Z:{library}", live_fmu.guid(component), str(STEPS), repr(SIZE), letters],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
        env=os.environ | {"WINEPREFIX": str(host.parent / "prefix"), "WINEDEBUG": "-all", "DISPLAY": ""},
    )
    assert run.returncode == 0, run.stderr
    python = component()
    assert python.initialize(0.0) == 0
    for step in range(STEPS):
        assert python.step(step * SIZE, SIZE) == 0
    for variable, line in zip(variables_of(component), run.stdout.split(), strict=True):
        # Windows' libm is another: 1e-9 of the value, or of 1 where values cancel to noise
        wanted = float(getattr(python, variable.name))
        assert math.isclose(float(line), wanted, rel_tol=1e-9, abs_tol=1e-9), variable.name
