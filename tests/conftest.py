"""What all tests share."""

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


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """What takes minutes runs on demand."""
    if "slow" not in config.option.markexpr:
        for item in items:
            if item.get_closest_marker("slow"):
                item.add_marker(pytest.mark.skip(reason="takes minutes: run it with -m slow"))
