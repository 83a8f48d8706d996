"""What all tests share."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import pytest
from browser import chromium, opened
from compiled import belt_in_c
from hypothesis import settings
from sharing import fmu_cache

# fixtures are named here alone: one that is imported into two files would be made twice in a process
__all__ = ["belt_in_c", "chromium", "fmu_cache", "opened"]

collect_ignore_glob = ["*conftest.py"]  # they hold no doctests, and pytest takes them for one module

# the same examples every time, no database in the working directory, no hurry on a busy machine
settings.register_profile("loomfmu", derandomize=True, database=None, deadline=None, max_examples=100)
settings.load_profile("loomfmu")


# beside the tests that mirror the source: these cover what they run through, and tracing costs most of it
UNTRACED = [
    Path(__file__).parent / folder for folder in ("attack", "benchmarks", "foreign", "stress", "verdicts")
]


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """What takes minutes runs on demand; what others cover, without the tracing of coverage."""
    for item in items:
        if item.get_closest_marker("slow") and "slow" not in config.option.markexpr:
            item.add_marker(pytest.mark.skip(reason="takes minutes: run it with -m slow"))
        if any(item.path.is_relative_to(folder) for folder in UNTRACED):
            item.add_marker(pytest.mark.no_cover)


@pytest.fixture(scope="session")
def untraced(request: pytest.FixtureRequest) -> Callable[[], AbstractContextManager[None]]:
    """Stops the tracing of coverage for what a fixture makes, as `no_cover` does for a test."""

    @contextmanager
    def stopped() -> Iterator[None]:
        plugin = request.config.pluginmanager.get_plugin("_cov")
        tracing = plugin and plugin.cov_controller
        if tracing:
            tracing.pause()
        yield
        if tracing:
            tracing.resume()

    return stopped
