"""The documentation site: every page is on it, it builds without a warning, and it needs no host."""

import re
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import build_site
import markdown
import pytest
from browser import NARROW, until
from markdown_it import MarkdownIt
from website import assembly, contents, reference

from loomfmu.cosim.claims.claim import Claim

CDN = re.compile(r"https?://(?:unpkg|cdn|fonts|ajax)[.\w]*/[@\w.-]+")
# by the theme's script, for pages with Mermaid diagrams and for browsers of before 2020
NEVER_FETCHED = {"https://unpkg.com/mermaid@11", "https://unpkg.com/resize-observer-polyfill"}
COUNTED = ("li", "ul", "ol", "tr", "td", "th", "h1", "h2", "h3", "pre", "img", "code", "strong", "em")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built as by `make site`: takes a quarter of a minute."""
    return build_site.build(tmp_path_factory.mktemp("site") / "source", run_notebooks=False)


def test_every_page_of_the_repository_is_on_the_site_once() -> None:
    placed = [page for pages in contents.sections([]).values() for page in pages]
    root = contents.ROOT
    there = [
        page for each in ("*", "docs/**/*", "fmus/**/*", "results/*") for page in root.glob(f"{each}.md")
    ]
    there += (root / "docs" / "notebooks").glob("*.py")
    assert sorted(placed) == sorted(page.relative_to(root).as_posix() for page in there)


def test_the_guides_that_are_ordered_exist() -> None:
    ordered = (contents.GUIDES, contents.REFERENCE, contents.PROJECT, contents.CONTRIBUTING)
    for page in (contents.TOUR, *(page for pages in ordered for page in pages)):
        assert (contents.ROOT / page).is_file(), page


def test_pages_read_alike_in_the_repository_and_on_the_site(tmp_path: Path) -> None:
    repository = MarkdownIt("commonmark").enable("table")
    placed = (page for pages in contents.sections([]).values() for page in pages)
    for page in (page for page in placed if page not in contents.NOTEBOOKS):
        text = assembly.MARKER.sub("", (contents.ROOT / page).read_text())
        converted = assembly.converted(page, text, tmp_path)
        # without colours: the repository's view wraps no line of code
        shown = markdown.markdown(
            converted,
            extensions=["tables", "sane_lists", "pymdownx.superfences", "pymdownx.highlight"],
            extension_configs={"pymdownx.highlight": {"use_pygments": False}},
        )
        expected = repository.render(converted)
        assert _counts(shown) == _counts(expected), page


def _counts(shown: str) -> dict[str, int]:
    return {tag: len(re.findall(f"<{tag}[ >]", shown)) for tag in COUNTED}


def test_the_reference_names_every_command_and_claim() -> None:
    pages = reference.pages()
    assert set(re.findall(r"^## (\w+)$", pages["reference/claims.md"], re.M)) == set(Claim.kinds)
    assert "## loomfmu run" in pages["reference/commands.md"]


class _Fetched(HTMLParser):
    """The addresses that a page has a browser fetch."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        wanted = ["src", "srcset", "data"] + (["href"] if tag == "link" else [])
        self.found += [values[name] or "" for name in wanted if name in values]


@pytest.mark.slow
def test_the_site_refers_to_no_host(site: Path) -> None:
    for page in site.rglob("*.html"):
        reader = _Fetched()
        reader.feed(page.read_text())
        assert not [each for each in reader.found if re.match("(https?:)?//", each)], page
    for style in site.rglob("*.css"):
        assert not re.search(r"url\([\"']?(https?:)?//", style.read_text()), style
    for script in site.rglob("*.js"):
        text = script.read_text() if script.name != "search_index.js" else ""
        assert {*CDN.findall(text)} <= NEVER_FETCHED, script


@pytest.mark.slow
def test_the_report_of_the_demo_is_on_the_tour(site: Path) -> None:
    assert '<iframe class="framed" src="wl680_3600.html"' in (site / "docs" / "tour.html").read_text()
    assert "6 claims hold" in (site / "docs" / "wl680_3600.html").read_text()


@pytest.mark.slow
def test_equations_are_typeset(site: Path) -> None:
    assert "<mfrac>" in (site / "fmus" / "weft_insertion" / "index.html").read_text()


@pytest.mark.slow
@pytest.mark.parametrize("page", ["index", "docs/tour", "fmus/weft_insertion/index", "reference/claims"])
def test_pages_open_wide_and_narrow_and_in_the_dark(
    site: Path, opened: Callable[..., Any], page: str
) -> None:
    file = site / f"{page}.html"
    opened(file, color_scheme="dark")
    narrow = opened(file, NARROW)
    assert narrow.evaluate("document.documentElement.scrollWidth") <= NARROW[0]


@pytest.mark.slow
def test_the_search_works_without_a_server(site: Path, opened: Callable[..., Any]) -> None:
    page = opened(site / "fmus" / "belt_monitor" / "index.html")
    page.click(".md-search__input")
    page.locator(".md-search__input").press_sequentially("safe speed")
    until(page, lambda: page.locator(".md-search-result__item").count() > 3)
