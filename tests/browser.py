"""Pages in a real Chromium, the one of the system: nothing is downloaded."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

WIDE, NARROW = (1200, 900), (400, 800)


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """The browser; no test where there is none."""
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        pytest.skip("chromium is not installed: no page can be opened")
    api = pytest.importorskip("playwright.sync_api")
    with api.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield browser
        browser.close()


class Tabs:
    """Pages of a browser, each loaded again with other content: opening one takes three times as long."""

    def __init__(self, browser: Any):
        self.noticed: list[str] = []
        self._browser, self._free = browser, {}

    def take(self, size: tuple[int, int], options: dict[str, Any]) -> Any:
        """A page of that size: one that was given back, or a new one."""
        free = self._free.setdefault((size, *options.items()), [])
        return free.pop() if free else self.made(size, options)

    def made(self, size: tuple[int, int], options: dict[str, Any]) -> Any:
        """A new page, whose words and requests are noticed."""
        page = self._browser.new_page(viewport={"width": size[0], "height": size[1]}, **options)
        noticed = self.noticed
        page.on("console", lambda message: noticed.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: noticed.append(f"error: {error}"))
        page.on("request", lambda request: noticed.append(request.url) if _remote(request.url) else None)
        return page

    def give_back(self, page: Any, size: tuple[int, int], options: dict[str, Any]) -> None:
        """Leave a page for other tests: empty, and as the system shows it."""
        page.goto("about:blank")
        page.emulate_media(media="null", **({} if options else {"color_scheme": "null"}))
        self._free[size, *options.items()].append(page)


@pytest.fixture(scope="session")
def tabs(chromium: Any) -> Tabs:
    """The pages that tests have in common."""
    return Tabs(chromium)


@pytest.fixture
def opened(tabs: Tabs) -> Iterator[Callable[..., Any]]:
    """Opens a page; in the end it must have asked no host for anything, and said nothing on its console.

    One that a test adds scripts to is `alone`: no other test has it.
    """
    tabs.noticed.clear()
    taken: list[tuple[Any, ...]] = []

    def open_(path: Path, size: tuple[int, int] = WIDE, alone: bool = False, **options: Any) -> Any:
        page = tabs.made(size, options) if alone else tabs.take(size, options)
        taken.append((page, size, options, alone))
        page.goto(path.absolute().as_uri())
        page.wait_for_load_state("load")
        return page

    yield open_
    for page, size, options, alone in taken:
        page.close() if alone else tabs.give_back(page, size, options)
    assert not tabs.noticed, tabs.noticed


def until(page: Any, true: Callable[[], bool]) -> None:
    """Wait until something is true of a page, for ten seconds; its policy forbids Playwright's own way."""
    for _ in range(200):
        if true():
            return
        page.wait_for_timeout(50)
    raise AssertionError("it did not come true in ten seconds")


def _remote(url: str) -> bool:
    return not url.startswith(("file:", "data:", "blob:", "about:"))
