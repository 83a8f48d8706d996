"""The commands of `loomfmu`: the arguments and the action of each, and the help."""

import argparse
import re
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from ..display.printed import complain, say
from ..errors import shown, suggestion
from ..version import __version__
from . import package, scenes, studies, traces

ABOUT = (
    "Simulate the mechanisms of a weaving loom as FMUs over the main shaft's angle, and check claims about"
    ' them, such as "the rapier belt does not buckle".'
)
STATUSES = (
    "Exit status: 0 all claims hold; 1 a claim fails or is undecided; 2 bad input or a failed FMU;"
    " 130 interrupted."
)

COMMANDS = (  # in the order of the help
    scenes.run,
    traces.show,
    traces.report,
    scenes.page,
    traces.diagram,
    traces.plot,
    traces.compare,
    studies.sweep,
    studies.limit,
    studies.tolerances,
    studies.prove,
    studies.optimize,
    studies.fit,
    package.list_,
    package.init,
    package.new,
    package.build,
    scenes.export,
    package.cache,
)


class _Parser(argparse.ArgumentParser):
    """Every command takes `--debug`; errors are printed like all other messages."""

    def __init__(self, **named: Any) -> None:
        super().__init__(**named)
        # suppressed: else the default of a command would replace a `--debug` before it
        self.add_argument("--debug", action="store_true", default=argparse.SUPPRESS, help="show tracebacks")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            hint = suggestion(str(value), map(str, action.choices))
            raise argparse.ArgumentError(action, f"{shown(value)} is unknown{hint}")

    def error(self, message: str) -> NoReturn:
        self.print_usage(sys.stderr)
        complain(f"{self.prog}: error: {message}")
        sys.exit(2)


class _Version(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        say(f"loomfmu {__version__}")
        parser.exit()


def with_negative(arguments: Sequence[str]) -> list[str]:
    """Arguments in which negative values belong to their options, which argparse takes for options.

    >>> with_negative(["limit", "--from", "-0.15mm", "--live"])
    ['limit', '--from=-0.15mm', '--live']
    """
    found: list[str] = []
    for each in arguments:
        if found and re.fullmatch(r"--[a-z-]+", found[-1]) and re.match(r"-\.?\d", each):
            found[-1] += f"={each}"
        else:
            found.append(each)
    return found


def parser() -> argparse.ArgumentParser:
    """Return the parser; `action` is the function of the command."""
    parser = _Parser(prog="loomfmu", description=ABOUT, epilog=STATUSES)
    parser.set_defaults(debug=False)
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and exit")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for each in COMMANDS:
        each.add(commands)
    return parser
