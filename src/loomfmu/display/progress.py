"""Progress bars: on a terminal and in a notebook, where one is wanted and is seen."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Any

from .notebook import text
from .printed import safe

SECONDS = 0.5  # between two pictures of a bar
Advance = Callable[[int], None]


@contextmanager
def progress(title: str, total: int, done: int = 0, *, wanted: bool = True) -> Iterator[Advance]:
    """A progress bar that takes how much more is done, and goes away at the end."""
    display = _display() if wanted else None
    if display is not None:
        bar = _in_notebook(display, title, total, done)
    elif wanted and sys.stderr is not None and sys.stderr.isatty():
        bar = _on_terminal(title, total, done)
    else:
        yield lambda _more: None
        return
    with bar as advance:
        yield advance


@contextmanager
def _on_terminal(title: str, total: int, done: int) -> Iterator[Advance]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    words = TextColumn("{task.description}", markup=False)
    columns = (words, BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True, refresh_per_second=2) as bar:
        task = bar.add_task(safe(title), total=total, completed=done)
        yield lambda more: bar.advance(task, more)


@contextmanager
def _in_notebook(display: Callable[..., Any], title: str, total: int, done: int) -> Iterator[Advance]:
    """A bar that needs no widgets: rich's own needs ipywidgets in a notebook."""

    def bar() -> _Html:
        words = f"{title}: {done} of {total}"
        return _Html(f'<progress value="{done}" max="{total}"></progress> {text(words)}', words)

    handle = display(bar(), display_id=True)
    drawn = monotonic()

    def advance(more: int) -> None:
        nonlocal done, drawn
        done += more
        if monotonic() - drawn >= SECONDS:
            drawn = monotonic()
            handle.update(bar())

    try:
        yield advance
    finally:
        handle.update(_Html("", ""))


def _display() -> Callable[..., Any] | None:
    """Return IPython's `display` if this process belongs to a notebook, else None."""
    ipython = sys.modules.get("IPython")  # a notebook has imported it
    shell = ipython.get_ipython() if ipython is not None else None
    if ipython is None or not hasattr(shell, "kernel"):
        return None
    from importlib import import_module

    return import_module("IPython.display").display  # type: ignore[no-any-return]


class _Html:
    """HTML that a notebook shows as it stands, and anything else as text."""

    def __init__(self, html: str, words: str):
        self._html, self._words = html, words

    def _repr_html_(self) -> str:
        return self._html

    def __repr__(self) -> str:
        return self._words
