"""Options whose texts hold more than argparse makes of them."""

import argparse
from collections.abc import Sequence
from typing import Any

from .. import units
from ..errors import LoomfmuError


def pairs(texts: Sequence[str], option: str = "--set") -> dict[str, Any]:
    """The values by their names, as an option gives them."""
    found: dict[str, Any] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals:
            raise LoomfmuError(f"{option} {text}: not of the form INSTANCE.VARIABLE=VALUE")
        key = key.strip()
        if key in found:
            raise LoomfmuError(f"{option} {key} is given twice: {found[key]} and {value.strip()}")
        found[key] = value.strip()
    return found


def share(text: str) -> float:
    """The share that --tolerance gives."""
    try:
        return units.parse(text, "1")
    except units.UnitError as error:
        wanted = "write a share such as 0.1%, or NAME=AMOUNT such as belt.free_length=0.1mm"
        raise LoomfmuError(f"--tolerance {text}: {error}; {wanted}") from None


def platforms(options: argparse.Namespace) -> tuple[str, ...]:
    """The platforms that were chosen, all by default. Raises LoomfmuError for one that is not known."""
    from ..fmi.native.platforms import PLATFORMS, check_platforms

    return check_platforms(tuple(options.platform.split(",") if options.platform else PLATFORMS))
