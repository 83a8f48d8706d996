"""Refusals of FMUs that cannot be read or run, each in one line."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ...errors import LoomfmuError, shown


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Say whatever is wrong with a model description in one line."""
    try:
        yield
    except Exception as error:  # fmpy raises its own kinds for a description that is none
        raise LoomfmuError(f"{path}: its modelDescription.xml cannot be read ({_reason(error)})") from None


def _reason(error: Exception) -> str:
    """The first line of an error, and of a list that follows its first entry."""
    if isinstance(error, TypeError):  # fmpy converts what is not there
        return "an element lacks an attribute that FMI requires"
    lines = str(error).splitlines()
    heading = len(lines) > 1 and lines[0].endswith(":")
    return f"{lines[0]} {lines[1].strip(' -')}" if heading else first_line(error)


def first_line(error: Exception) -> str:
    """The first line of an error, or its kind."""
    reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
    return str(reason).splitlines()[0]


def check_runnable(path: Path, description: Any) -> None:
    """Refuse what the master cannot step."""
    version, kind = description.fmiVersion, description.coSimulation or description.modelExchange
    if version == "1.0":
        raise LoomfmuError(f"{path}: an FMI 1.0 FMU; only FMI 2.0 and 3.0 are supported")
    if kind is None:
        raise LoomfmuError(
            f"{path}: an FMU for scheduled execution; only co-simulation and model exchange are supported"
        )
    clocks = [each.name for each in description.modelVariables if each.type == "Clock"]
    if clocks:  # FMI 3.0 requires event mode for them
        raise LoomfmuError(f"{path}: {clocks[0]} is a clock; FMUs with clocks are not supported")
    if not re.fullmatch("[A-Za-z_][A-Za-z0-9_]*", kind.modelIdentifier or ""):
        raise LoomfmuError(
            f"{path}: modelIdentifier = {shown(kind.modelIdentifier)} is not a C identifier;"
            " it must name a library of the FMU by letters, digits and _, and no digit first"
        )
