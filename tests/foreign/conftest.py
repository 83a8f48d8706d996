"""Tests here run our native FMUs in the tools of other makers; each is skipped where its tool is missing."""

import sys
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec

import pytest
from live_fmus import fmu_cache

from loomfmu.components import COMPONENTS
from loomfmu.cosim import fmus

__all__ = ["fmu_cache"]


@pytest.fixture(scope="session")
def natives(fmu_cache: None) -> dict[str, fmus.Fmu]:
    """All native FMUs, for the machine's own platform."""
    for module in ("pyccel", "ziglang"):
        if find_spec(module) is None:
            pytest.skip(f"{module} is not installed: no native FMU can be built")
    if not sys.platform.startswith("linux"):
        pytest.skip("the tools of other makers are tried on Linux alone")
    with ThreadPoolExecutor(max_workers=4) as pool:
        found = pool.map(lambda name: fmus.of_component(name, "native"), COMPONENTS)
        return dict(zip(COMPONENTS, found, strict=True))
