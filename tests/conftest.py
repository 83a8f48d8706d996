"""What all tests share."""

import os
import random
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import pytest
from browser import chromium, opened, tabs
from claimed import looms
from compiled import belt_in_c
from hypothesis import settings
from sharing import KEPT, compiled_once, fmu_cache, native_fmus, traces_checked_here

from loomfmu.fmi.native.platforms import compiler

# fixtures are named here alone: one that is imported into two files would be made twice in a process
__all__ = ["belt_in_c", "chromium", "compiled_once", "fmu_cache", "looms", "opened", "tabs"]
__all__ += ["traces_checked_here"]

collect_ignore_glob = ["*conftest.py"]  # they hold no doctests, and pytest takes them for one module

# the same examples every time, no database in the working directory, no hurry on a busy machine
SAME = {"derandomize": True, "database": None, "deadline": None}
settings.register_profile("quick", max_examples=25, **SAME)
settings.register_profile("all", max_examples=100, **SAME)
LEFT_OUT = pytest.StashKey[dict[str, Any]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--all", action="store_true", help="run the slow tests too, with all examples")


def pytest_configure(config: pytest.Config) -> None:
    settings.load_profile("all" if config.option.all else "quick")


def pytest_xdist_auto_num_workers() -> int:
    """Return one process more than cores, at most five: tests wait for programs, pages and time limits."""
    return min(os.cpu_count() or 1, 4) + 1


def pytest_sessionstart(session: pytest.Session) -> None:
    """Build each FMU once, on all cores, before several processes share the tests."""
    if getattr(session.config.option, "numprocesses", None) and compiler():
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("LOOMFMU_CACHE", str(KEPT))
            native_fmus()


# beside the tests that mirror the source: these cover what they run through, and tracing costs most of it
UNTRACED = tuple(f"tests/{each}/" for each in ("attack", "benchmarks", "foreign", "stress", "verdicts"))


def leave_cases_to_the_slow(items: list[pytest.Item]) -> None:
    """Of the cases of a test marked `few` mark all but a number, drawn by its name, as slow.

    They are drawn from those that are not slow.
    """
    cases: dict[tuple[str, object], list[pytest.Item]] = {}
    for item in items:
        if item.get_closest_marker("slow"):
            continue
        if (few := item.get_closest_marker("few")) and (case := getattr(item, "callspec", None)):
            given = case.params.get(few.kwargs.get("each"))
            cases.setdefault((item.nodeid.split("[")[0], given), []).append(item)
    for (name, _given), drawn in cases.items():
        count = min(drawn[0].get_closest_marker("few").args[0], len(drawn))
        kept = random.Random(name).sample(range(len(drawn)), count)
        for number, item in enumerate(drawn):
            if number not in kept:
                item.add_marker(pytest.mark.slow)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out slow tests unless they are asked for, and trace no coverage in what other tests cover."""
    leave_cases_to_the_slow(items)
    for item in items:
        if item.nodeid.startswith(UNTRACED):
            item.add_marker(pytest.mark.no_cover)
    slow = [item for item in items if item.get_closest_marker("slow")]
    if config.option.all or "slow" in config.option.markexpr or not slow:
        return
    # a report of each that is skipped would take as long as many tests
    items[:] = [item for item in items if not item.get_closest_marker("slow")]
    parents = (Path(item.nodeid.split("::")[0]).parent.parts for item in slow)
    folders = Counter(parts[1] if len(parts) > 1 else "others" for parts in parents)
    getattr(config, "workeroutput", config.stash.setdefault(LEFT_OUT, {})).update(left_out=dict(folders))


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    """Take over how many slow tests a process left out: all leave out the same."""
    node.config.stash.setdefault(LEFT_OUT, {}).update(getattr(node, "workeroutput", {}))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say how many slow tests were left out, by folder."""
    if folders := Counter(terminalreporter.config.stash.get(LEFT_OUT, {}).get("left_out", {})):
        counts = ", ".join(f"{folder} {count}" for folder, count in folders.most_common())
        terminalreporter.write_line(
            f"left out: {folders.total()} slow tests ({counts}); make test-all runs them"
        )


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
