"""Tests here run native FMUs of the machine's own platform: built once, in a cache of their own."""

import sys
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec

import foreign_motors
import pytest
from natives import STEPPED, Instance, Native, Native3
from sharing import native_fmus

from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing import fmus
from loomfmu.cosim.importing.built import file_of


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
    return foreign_motors.gcc()


@pytest.fixture(scope="session")
def built(fmu_cache: None, tools: None) -> dict[str, fmus.Fmu]:
    """All native FMUs."""
    return native_fmus()


@pytest.fixture(scope="session")
def built3(built: dict[str, fmus.Fmu]) -> dict[str, fmus.Fmu]:
    """All native FMUs of FMI 3."""

    def build(name: str) -> fmus.Fmu:
        return fmus.load(file_of(COMPONENTS[name], "native", ("linux64",), 3))

    with ThreadPoolExecutor(max_workers=4) as pool:
        return dict(zip(COMPONENTS, pool.map(build, COMPONENTS), strict=True))


@pytest.fixture
def package(request: pytest.FixtureRequest):
    """The native FMU of a component in either FMI."""
    return lambda name, fmi: request.getfixturevalue("built" if fmi == 2 else "built3")[name]


@pytest.fixture
def native(package):
    """Opens instances and frees them after the test."""
    opened: list[Instance] = []

    def open_(component: str, kind: str = STEPPED, fmi: int = 2, **options: object) -> Instance:
        made = Native if fmi == 2 else Native3
        opened.append(made(package(component, fmi), kind, **options))
        return opened[-1]

    yield open_
    for instance in opened:
        instance.free()
