"""Tests here run our native FMUs in third-party tools; each is skipped where its tool is missing."""

import sys
from importlib.util import find_spec

import pytest
from sharing import native_fmus

from loomfmu.cosim.importing import fmus


@pytest.fixture(scope="session")
def natives(fmu_cache: None) -> dict[str, fmus.Fmu]:
    """All native FMUs, for the machine's own platform."""
    if find_spec("ziglang") is None:
        pytest.skip("ziglang is not installed: no native FMU can be built")
    if not sys.platform.startswith("linux"):
        pytest.skip("third-party tools are tried on Linux alone")
    return native_fmus()
