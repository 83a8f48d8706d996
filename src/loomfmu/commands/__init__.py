"""The commands of `loomfmu`: the arguments and the action of each, and the help."""

import argparse
import re
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from ..display.printed import complain, say
from ..errors import misspelt, shown, suggestion
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


REWORDED = (  # messages of argparse, and how they read here
    (r"the following arguments are required: (.+), (.+?)", r"\1 and \2 are missing"),
    (r"the following arguments are required: (.+)", r"\1 is missing"),
    (r"one of the arguments (\S+) (\S+) is required", r"\1 or \2 is missing"),
    (r"argument (\S+): expected .*argument", r"\1 needs a value"),
    (r"argument (\S+): not allowed with argument (\S+)", r"\1 and \2 exclude each other; leave out one"),
    (r"argument (\S+): invalid int value: (.+)", r"\1 = \2 is not a whole number"),
    (r"argument (\S+): ignored explicit argument (.+)", r"\1 takes no value, but has \2"),
    (r"argument COMMAND: (.+?) is unknown(.*)", r"there is no command \1\2"),
    (r"argument (\S+): (.+)", r"\1 = \2"),
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

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As it stands, but a command itself refuses what it does not know, and so can name what is near."""
        options, unknown = super().parse_known_args(args, namespace)
        for first in unknown[:1]:
            name = first.partition("=")[0]
            if not name.startswith("-"):
                self.error(f"{shown(first)} is one argument too many; write {self._shortest}")
            near = misspelt(name, self._option_string_actions)
            self.error(f"there is no {name}; {f'did you mean {near[0]}?' if near else self._help}")
        return options, unknown

    def error(self, message: str) -> NoReturn:
        """Print one line, on what is wrong and what would be right, and exit."""
        for pattern, reworded in REWORDED:
            if found := re.fullmatch(pattern, message):
                message = found.expand(reworded)
                message += "" if ";" in message else f"; {self._remedy(found[1], 'missing' in reworded)}"
                break
        complain(f"{self.prog}: {message}")
        sys.exit(2)

    def _remedy(self, name: str, missing: bool) -> str:
        option = self._option_string_actions.get(name)
        if missing and " " in self.prog:
            return f"write {self._shortest}"
        return f"write {_form(option)}" if option and option.metavar else self._help

    @property
    def _help(self) -> str:
        return f"see {self.prog} --help"

    @property
    def _shortest(self) -> str:
        """The command with all that it needs, and no more."""
        chosen = [group._group_actions[0] for group in self._mutually_exclusive_groups if group.required]
        return " ".join(
            [self.prog, *(_form(each) for each in self._actions if each.required or each in chosen)]
        )


def _form(action: argparse.Action) -> str:
    """Return how an argument is written, such as `--from LOW`."""
    return " ".join([*action.option_strings[:1], str(action.metavar)])


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
