"""Tests here run native FMUs of the machine's own platform: built once, in a cache of their own."""

import shutil
import sys
from importlib.util import find_spec
from pathlib import Path

import fmpy
import pytest
from natives import Native
from sharing import native_fmus

from loomfmu.cosim.importing import fmus


@pytest.fixture(scope="session")
def tools() -> None:
    """What builds native FMUs."""
    if find_spec("ziglang") is None:
        pytest.skip("ziglang is not installed: no native FMU can be built")
    if not sys.platform.startswith("linux"):
        pytest.skip("the tests of native FMUs know Linux alone")


@pytest.fixture(scope="session")
def gcc(tools: None) -> str:
    """A compiler that is not the one the FMUs were built with."""
    found = shutil.which("gcc")
    if found is None:
        pytest.skip("gcc is not installed")
    return found


@pytest.fixture(scope="session")
def built(fmu_cache: None, tools: None) -> dict[str, fmus.Fmu]:
    """All native FMUs."""
    return native_fmus()


@pytest.fixture(scope="session")
def sources(built: dict[str, fmus.Fmu], tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The folder of C sources of each FMU, as a user finds it."""
    unpacked = tmp_path_factory.mktemp("sources")
    for name, fmu in built.items():
        fmpy.extract(fmu.path, unpacked / name)
    return {name: unpacked / name / "sources" for name in built}


@pytest.fixture
def native(built: dict[str, fmus.Fmu]):
    """Opens instances and frees them after the test."""
    opened: list[Native] = []

    def open_(component: str, **options: object) -> Native:
        opened.append(Native(built[component], **options))
        return opened[-1]

    yield open_
    for instance in opened:
        instance.free()
