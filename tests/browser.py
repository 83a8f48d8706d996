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


@pytest.fixture
def opened(chromium: Any) -> Iterator[Callable[..., Any]]:
    """Opens a page; in the end it must have asked no host for anything, and said nothing on its console."""
    noticed: list[str] = []
    pages: list[Any] = []

    def open_(path: Path, size: tuple[int, int] = WIDE, **options: Any) -> Any:
        page = chromium.new_page(viewport={"width": size[0], "height": size[1]}, **options)
        page.on("console", lambda message: noticed.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: noticed.append(f"error: {error}"))
        page.on("request", lambda request: noticed.append(request.url) if _remote(request.url) else None)
        page.goto(path.absolute().as_uri())
        page.wait_for_load_state("load")
        pages.append(page)
        return page

    yield open_
    for page in pages:
        page.close()
    assert not noticed, noticed


def until(page: Any, true: Callable[[], bool]) -> None:
    """Wait until something is true of a page, for ten seconds; its policy forbids Playwright's own way."""
    for _ in range(200):
        if true():
            return
        page.wait_for_timeout(50)
    raise AssertionError("it did not come true in ten seconds")


def _remote(url: str) -> bool:
    return not url.startswith(("file:", "data:", "blob:", "about:"))
