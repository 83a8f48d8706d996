"""What all processes have in common that share the tests of one session."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from filelock import FileLock

from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing import fmus
from loomfmu.fmi.cache import cache_directory
from loomfmu.fmi.native.platforms import host


def shared_directory(request: pytest.FixtureRequest, factory: pytest.TempPathFactory) -> Path:
    """The session's temporary directory: each worker of pytest-xdist has its own below it."""
    own = factory.getbasetemp()
    return own.parent if hasattr(request.config, "workerinput") else own


@pytest.fixture(scope="session", autouse=True)
def fmu_cache(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """One cache of built FMUs for all tests, also for the processes they start; not the user's own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LOOMFMU_CACHE", str(shared_directory(request, tmp_path_factory) / "fmu_cache"))
        yield


def native_fmus() -> dict[str, fmus.Fmu]:
    """All native FMUs, for the machine's own platform, in the session's cache.

    One process builds them, on all cores, while the others wait.
    """
    cache = cache_directory()
    cache.mkdir(parents=True, exist_ok=True)
    with FileLock(cache / "native.lock"), ThreadPoolExecutor(max_workers=4) as pool:
        list(pool.map(lambda each: fmus.file_of(each, "native", (host(),)), COMPONENTS.values()))
    return {name: fmus.of_component(name, "native") for name in COMPONENTS}
