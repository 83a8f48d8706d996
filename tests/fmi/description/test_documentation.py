"""Documentation of FMUs as HTML."""

import time
from concurrent.futures import ThreadPoolExecutor

from markdown_it import MarkdownIt

from loomfmu.fmi.description.documentation import page


def test_pages_of_fmus_that_are_built_at_once_are_rendered_one_after_the_other(monkeypatch):
    """The table of characters that mdurl fills at its first link is read by other threads half filled."""
    inside, most = 0, 0

    def render(reader, markdown):
        nonlocal inside, most
        inside += 1
        most = max(most, inside)
        time.sleep(0.01)
        inside -= 1
        return markdown

    monkeypatch.setattr(MarkdownIt, "render", render)
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda _: page("title", "text"), range(4)))
    assert most == 1
