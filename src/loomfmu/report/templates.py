"""The files that the page is made of."""

from functools import cache
from importlib.resources import files
from typing import Any

from ..extras import need

PAGE = files(__package__) / "page"


def text(name: str) -> str:
    """A file of the folder `page`."""
    return (PAGE / name).read_text(encoding="utf-8")


def template(name: str) -> Any:
    """A template of the folder `page`; what it is given is escaped. Raises LoomfmuError as `check`."""
    return _environment().from_string(text(name))


def check() -> None:
    """Raise LoomfmuError if the extra `report` is not installed."""
    need("a report", "report")


@cache
def _environment() -> Any:
    check()
    from jinja2 import Environment, StrictUndefined

    return Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
