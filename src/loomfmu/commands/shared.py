"""Commands as declarations, and what several of them take and print."""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import units
from ..display import printed
from ..display.printed import say, warn
from ..errors import LoomfmuError

if TYPE_CHECKING:
    from ..studies.proving.proofs import Proofs
    from ..traces import Verdict

Action = Callable[[argparse.Namespace], int]
Argument = Callable[[Any], object]  # adds itself to a parser, or to a group of one


def argument(name: str, metavar: str | None, about: str = "", **given: Any) -> Argument:
    """Return an argument; what is `given` beside its help is that of `ArgumentParser.add_argument`."""
    return lambda parser: parser.add_argument(name, metavar=metavar, help=about or None, **given)


def flag(name: str, about: str) -> Argument:
    """Return an option without a value."""
    return lambda parser: parser.add_argument(name, action="store_true", help=about)


def one_of(*arguments: Argument, required: bool = False) -> Argument:
    """Return arguments of which at most one is given, and one must be if that is `required`."""

    def add(parser: Any) -> None:
        group = parser.add_mutually_exclusive_group(required=required)
        for each in arguments:
            each(group)

    return add


@dataclass(frozen=True)
class Command:
    """A command: its arguments and its action, whose name and whose docstring are the command's own."""

    arguments: Sequence[Argument]
    action: Action
    statuses: str = ""

    def add(self, commands: Any) -> None:
        """Add it to the commands of a parser."""
        about = (self.action.__doc__ or "").rstrip(".")
        name = self.action.__name__.rstrip("_")
        epilog = f"Exit status: {self.statuses}" if self.statuses else None
        parser = commands.add_parser(name, help=about[:1].lower() + about[1:], epilog=epilog)
        parser.set_defaults(action=self.action)
        for each in self.arguments:
            each(parser)


def command(*arguments: Argument, statuses: str = "") -> Callable[[Action], Command]:
    """Declare a function to be a command with these arguments; its help states exit `statuses` of its own."""
    return lambda action: Command(arguments, action, statuses)


def ending(suffix: str) -> Callable[[str], str]:
    """The type of an argument that names a file, whose usual suffix may be left out."""

    def named(given: str) -> str:
        whole = Path(f"{given}{suffix}")
        return str(whole) if not Path(given).is_file() and whole.is_file() else given

    return named


SCENE_FILE = argument("scene", "SCENE.toml", type=ending(".toml"))
SCENE = argument("scene", "SCENE", "a scene (.toml) or a system package (.ssp)", type=ending(".toml"))
TRACE = argument("trace", "FILE.h5", type=ending(".h5"))
SET = argument(
    "--set",
    "INSTANCE.VARIABLE=VALUE",
    "override a value of the scene, such as shaft.speed=685rpm",
    action="append",
    default=[],
    dest="overrides",
)
PROVE = argument(
    "--prove",
    "INSTANCE.VARIABLE=LOW..HIGH",
    "also prove claims for all shaft angles and all values of a range, and note it with them (repeatable)",
    action="append",
    default=[],
)
PLATFORM = argument(
    "--platform",
    "NAME[,NAME]",
    "platforms of native FMUs: linux64,aarch64-linux,win64,darwin64; all by default",
)


def vary(about: str, required: bool = False) -> Argument:
    """The variables that a command varies; where one is `required`, its range need not be given."""
    metavar = "INSTANCE.VARIABLE[=LOW..HIGH]" if required else "INSTANCE.VARIABLE=LOW..HIGH"
    return argument("--vary", metavar, about, action="append", default=[], required=required)


def place(name: str, file: str = "") -> tuple[Argument, ...]:
    """The arguments that say where many runs go, perhaps into a file too, and which processes make them."""
    return (
        argument("--output", "DIR", f"folder for the results; results/{name} by default{file}"),
        argument("--processes", "N", "worker processes on this machine; one per core by default", type=int),
        argument("--scheduler", "ADDRESS", "run on a dask cluster, such as tcp://host:8786"),
        flag("--restart", "discard earlier results in DIR and run everything again"),
    )


def force(what: str) -> Argument:
    """Leave to replace what loomfmu did not write."""
    return flag("--force", f"replace {what}")


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


def revolutions(count: str) -> str:
    """A count of revolutions."""
    return f"{count} revolution" + "s" * (count != "1")


def proofs_of(scene: Any, over: Sequence[str], given: dict[str, Any] | None = None) -> "Proofs | None":
    """Return the proofs of a scene over ranges, or None where none is given; warn of the ranges.

    Raises LoomfmuError if the scene's own values are not within the ranges: its verdicts are not proven then.
    """
    if not over:
        return None
    from ..studies.proving.prove import prove

    found = prove(scene, over=over, set=given)
    warn(doubt for span in found.over for doubt in span.doubts)
    if outside := found.outside:
        raise LoomfmuError(f"--prove: the scene's {outside}")
    return found


def print_unproven(proofs: "Proofs | None") -> None:
    """Print what --prove was to prove and could not."""
    if proofs is not None:
        from ..studies.proving.proofs_shown import show_unproven

        show_unproven(proofs)


def print_verdicts(verdicts: "Sequence[Verdict]") -> None:
    """The verdicts as a table."""
    if not verdicts:
        say("no claims")
        return
    from ..traces.verdict import HEADINGS

    rows = [verdict.row for verdict in verdicts]
    entries = []
    for word, claim, name, worst, bound, distance, error, place, note in rows:
        away = f" ({distance})" if distance != "-" else ""
        away += f", error {error}" if error != "-" else ""
        at = f", at {place}" if place != "-" else ""
        entry = f"{word}  {claim}", f"({name})", f"{worst}, bound {bound}{away}{at}"
        entries.append((*entry, f"({note})") if note else entry)
    printed.show(HEADINGS, rows, entries)
