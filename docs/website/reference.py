"""Pages of the reference that are written from the code: commands, keys of scenes, claims, Python."""

import argparse
import inspect
import os
import re
from collections.abc import Iterable
from dataclasses import MISSING, fields
from unittest import mock

import loomfmu
from loomfmu import claim, mechanism
from loomfmu import commands as cli_commands
from loomfmu.components import COMPONENTS
from loomfmu.cosim.claims.arguments import Argument, argument_of
from loomfmu.cosim.claims.claim import AT_LEAST
from loomfmu.cosim.claims.claims import kinds
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.cosim.scenes.settings import COUPLINGS, KEYS
from loomfmu.declaring.variables import variables_of
from loomfmu.fmi.description.documentation import limits_text, start_text
from loomfmu.loom.standard_loom import LOOM_KEYS

DESIGN = (
    "loom",
    "buckling",
    "shed",
    "cam",
    "cam_export",
    "rocker_cam",
    "contact",
    "guidance",
    "dobby",
    "loads",
    "reed",
)
CHOICES = {"coupling": COUPLINGS}


def pages() -> dict[str, str]:
    """The generated pages by their paths on the site."""
    return {
        "reference/commands.md": commands(),
        "reference/scene_keys.md": scene_keys(),
        "reference/claims.md": kinds_of_claims(),
        "reference/python.md": python(),
        "reference/design.md": design(),
        "reference/mechanism.md": own_mechanism(),
        "reference/claim.md": own_claim(),
    }


def commands() -> str:
    """What `--help` prints, command by command."""
    parser = cli_commands.parser()
    found = next(each for each in parser._actions if isinstance(each, argparse._SubParsersAction))
    with mock.patch.dict(os.environ, COLUMNS="90", NO_COLOR="1"):
        helps = {"loomfmu": parser.format_help()} | {
            f"loomfmu {name}": command.format_help() for name, command in found.choices.items()
        }
    shown = "\n".join(f"## {name}\n\n```text\n{text.rstrip()}\n```\n" for name, text in helps.items())
    return f"# Commands and options\n\n[The command line](../docs/command_line.md) explains them.\n\n{shown}"


def scene_keys() -> str:
    """The keys of a scene, of its standard loom, and the values of every component."""
    stated = {each.name: each.default for each in fields(Scene) if each.default not in (MISSING, None)}
    rows = []
    for key in KEYS:
        choices = CHOICES.get(key, ())
        default = choices[0] if choices else stated.get(key, "")
        rows.append((f"`{key}`", ", ".join(f"`{each}`" for each in choices), default))
    parts = [
        "# Keys of a scene",
        "[Scenes](../docs/scenes.md#keys) says what each key means.",
        _table(("key", "choices", "default"), rows),
        "## Keys of [loom]",
        ", ".join(f"`{key}`" for key in LOOM_KEYS),
    ]
    for name, component in COMPONENTS.items():
        settable = [each for each in variables_of(component) if each.settable]
        values = [
            (f"`{each.name}`", each.display, start_text(each), limits_text(each), each.description)
            for each in settable
        ]
        parts += [f"## {name}", _table(("key", "unit", "default", "limits", "what it is"), values)]
    return "\n\n".join(parts) + "\n"


def kinds_of_claims() -> str:
    """Every kind of claim with its arguments."""
    parts = ["# Kinds of claims", "[Claims](../docs/claims.md) says how they are judged."]
    for name, kind in sorted(kinds().items()):
        parts += [f"## {name}", inspect.cleandoc(kind.__doc__ or "")]
        judged = kind.unit[1] if kind.unit[1] != "1" else ""
        side = "at least" if kind.sense == AT_LEAST else "at most"
        parts.append(f"The worst value must be {side} the bound{f', in {judged}' if judged else ''}.")
        rows = [
            (
                f"`{each.name}`",
                _type(argument_of(each)),
                "needed" if each.default is MISSING else each.default,
            )
            for each in fields(kind)
        ]
        parts.append(_table(("argument", "what it is", "default"), rows))
    return "\n\n".join(parts) + "\n"


def _type(argument: Argument) -> str:
    """An argument of a claim in words."""
    words = re.sub("(?<=.)(?=[A-Z])", " ", type(argument).__name__).lower()
    unit = getattr(argument, "display", "") or argument.unit
    return f"{words} [{unit}]" if unit and unit != "1" else words


def python() -> str:
    """The public names of the package."""
    homes = {name: getattr(loomfmu, name) for name in dir(loomfmu) if name[0].islower() or name[0].isupper()}
    names = [f"{each.__module__}.{each.__name__}" for each in homes.values() if not inspect.ismodule(each)]
    about = "[The Python interface](../docs/python.md) shows how they are used."
    return f"# Python: loomfmu\n\n{about}\n\n{_described(names)}"


def design() -> str:
    """The modules of `loomfmu.design`."""
    about = "[Design](../docs/python.md#design) shows how they are used."
    modules = "\n".join(f"::: loomfmu.design.{name}\n" for name in DESIGN)
    return f"# Python: loomfmu.design\n\n{about}\n\n{modules}"


def own_mechanism() -> str:
    """What the file of a mechanism imports."""
    about = "[A mechanism of your own](../docs/own_mechanism.md) shows how they are used."
    named = {name: getattr(mechanism, name) for name in mechanism.__all__}
    described = [each for each in named.values() if inspect.isfunction(each) or inspect.isclass(each)]
    return f"# Python: loomfmu.mechanism\n\n{about}\n\n" + _described(
        f"{each.__module__}.{each.__name__}" for each in described
    )


def own_claim() -> str:
    """What the file of a claim imports."""
    about = "[A claim of your own](../docs/own_claim.md) shows how they are used."
    named = (getattr(claim, name) for name in claim.__all__)
    return f"# Python: loomfmu.claim\n\n{about}\n\n" + _described(
        f"{each.__module__}.{each.__name__}" for each in named
    )


def _described(names: Iterable[str]) -> str:
    """What mkdocstrings takes for objects to describe."""
    return "\n".join(f"::: {name}\n" for name in names)


def _table(heads: tuple[str, ...], rows: Iterable[Iterable[object]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(
        "| " + " | ".join(str("" if cell is None else cell) for cell in row) + " |" for row in lines
    )
