"""Tests here run native FMUs of the machine's own platform: built once, in a cache of their own."""

import sys
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec

import foreign_motors
import pytest
from natives import STEPPED, Instance, Native, Native3
from sharing import OF_FMI_3, native_fmu_of_fmi_3, native_fmus

from loomfmu.cosim.importing import fmus


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Leave most FMUs of FMI 3 to the slow tests: compiling all takes longer than what is tested of them."""
    for item in items:
        given = item.callspec.params if hasattr(item, "callspec") else {}
        left = given.get("fmi") == 3 and given.get("name", OF_FMI_3[0]) not in OF_FMI_3
        if left and "package" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.slow)


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
def package(built: dict[str, fmus.Fmu]) -> Callable[[str, int], fmus.Fmu]:
    """The native FMU of a component in either FMI."""
    of_fmi_3 = cache(native_fmu_of_fmi_3)
    return lambda name, fmi: built[name] if fmi == 2 else of_fmi_3(name)


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
