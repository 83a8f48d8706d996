"""Arguments that several commands take."""

import argparse
from collections.abc import Callable
from pathlib import Path


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
