"""What the tests of the benchmarks share."""

import sys
from importlib.util import find_spec

import neighbours  # noqa: F401  the modules of the other tests
import pytest
from sharing import native_fmus


@pytest.fixture(scope="session")
def natives() -> None:
    """All native FMUs in the session's cache: nothing is built while a benchmark runs."""
    if find_spec("ziglang") is None:
        pytest.skip("ziglang is not installed: no native FMU can be built")
    if not sys.platform.startswith("linux"):
        pytest.skip("the benchmarks are written for Linux")
    native_fmus()
