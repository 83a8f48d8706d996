"""The files that the page is made of."""

from functools import cache
from importlib.resources import files
from typing import Any

from ..errors import LoomfmuError

PAGE = files(__package__) / "page"


def text(name: str) -> str:
    """A file of the folder `page`."""
    return (PAGE / name).read_text(encoding="utf-8")


def template(name: str) -> Any:
    """A template of the folder `page`; what it is given is escaped. Raises LoomfmuError as `check`."""
    return _environment().from_string(text(name))


def check() -> None:
    """Raise LoomfmuError if the extra `report` is not installed."""
    _environment()


@cache
def _environment() -> Any:
    try:
        from jinja2 import Environment, StrictUndefined
    except ImportError:
        raise LoomfmuError('a report needs the extra "report": pip install "loomfmu[report]"') from None
    return Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
