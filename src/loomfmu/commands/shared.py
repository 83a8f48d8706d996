"""Arguments that several commands take, and what their texts hold."""

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from .. import units
from ..errors import LoomfmuError


def ending(suffix: str) -> Callable[[str], str]:
    """The type of an argument that names a file, whose usual suffix may be left out."""

    def named(given: str) -> str:
        whole = Path(f"{given}{suffix}")
        return str(whole) if not Path(given).is_file() and whole.is_file() else given

    return named


def add_scene(command: argparse.ArgumentParser) -> None:
    """The scene that a command takes."""
    command.add_argument(
        "scene", type=ending(".toml"), metavar="SCENE", help="a scene (.toml) or a system package (.ssp)"
    )


def add_set(command: argparse.ArgumentParser) -> None:
    """Values that a command overrides."""
    command.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="INSTANCE.VARIABLE=VALUE",
        dest="overrides",
        help="override a value of the scene, such as shaft.speed=685rpm",
    )


def add_vary(command: argparse.ArgumentParser, about: str, required: bool = False) -> None:
    """The variables that a command varies; where one is `required`, its range need not be given."""
    metavar = "INSTANCE.VARIABLE[=LOW..HIGH]" if required else "INSTANCE.VARIABLE=LOW..HIGH"
    command.add_argument(
        "--vary", action="append", default=[], required=required, metavar=metavar, help=about
    )


def add_place(command: argparse.ArgumentParser, name: str) -> None:
    """Add the options that say where many runs go and which processes make them."""
    command.add_argument("--output", metavar="DIR", help=f"folder for the results; results/{name} by default")
    command.add_argument(
        "--processes", type=int, metavar="N", help="worker processes on this machine; one per core by default"
    )
    command.add_argument(
        "--scheduler", metavar="ADDRESS", help="run on a dask cluster, such as tcp://host:8786"
    )
    command.add_argument(
        "--restart", action="store_true", help="discard earlier results in DIR and run everything again"
    )


def add_platform(command: argparse.ArgumentParser) -> None:
    """The platforms of native FMUs."""
    command.add_argument(
        "--platform",
        metavar="NAME[,NAME]",
        help="platforms of native FMUs: linux64,win64,darwin64; all by default",
    )


def add_force(command: argparse.ArgumentParser, what: str) -> None:
    """Leave to replace what loomfmu did not write."""
    command.add_argument("--force", action="store_true", help=f"replace {what}")


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
