"""Builds one native FMU of a system."""

import hashlib
import uuid
from pathlib import Path

from ...declaring.variables import Component
from ...version import __version__
from ..description import documentation
from ..description.model_description import model_description
from ..description.related_files import related_files
from ..description.terminals import terminal_files
from ..fmu_files import NAMESPACE
from ..native import native_fmu as native
from ..native.libraries import module_of
from ..native.tables import dual_tables, tables
from .code import inner_step, stepped, translated
from .loops import RULE, loop_of
from .system import STEP, STEPS, System, component_of

LOOP = """ These wires close an algebraic loop, so the
parts of a step that lie on it are repeated until both ends agree to {tolerance:g}:

{wires}
"""

ICON = Path(__file__).with_name("icon.png")

README = """# {title}

{description}

## What is inside

The components below in one library, translated to C. Sources are stepped before their sinks, and a wire hands
over the value at the end of the step: there is no delay between components.{loop}

| instance | component | what it is |
|---|---|---|
{parts}

{wires}

## Steps

The components step on a grid of their own, set by the parameter {grid}. A communication step may hold
several of these steps. One that does not end on the grid ends with a shorter step, and the next one starts
with a step to the grid. Inputs are held over a communication step.

## Other platforms

The FMU needs no Python and no library but those of the system. The folder `sources` holds all of it; one
command, run in that folder, builds it for another platform:

    {command}
"""


def contents(
    system: System, platforms: tuple[str, ...], fmi: int, reference: bytes | None = None
) -> dict[str, bytes]:
    """All files of the FMU by their names in it, with reference results. Raises as `build_native`."""
    component = component_of(system)
    translation = translated(system)
    token = _token(component, translation.header + translation.code)
    model = tables(component, token, stepped(system), inner_step(system), loop_of(system, component))
    dual_model = dual_tables(component, stepped(system))
    documents = {
        native.ICONS[fmi]: ICON.read_bytes(),
        "documentation/index.html": documentation.page(system.name, _readme(system, component, fmi)),
        **terminal_files(component),
        **related_files(component, reference),
    }
    code = native.with_shell(translation, model, dual_model, fmi)
    # inputs are held over several steps, so that no derivative of them counts
    capabilities = {"canInterpolateInputs": "false"}
    return native.assembled(component, token, documents, code, platforms, fmi, capabilities)


def module(system: System) -> bytes:
    """The system as a module of WebAssembly for a page, see `shell/page.c`. Raises as `build_native`."""
    translation = translated(system)
    model = tables(component_of(system), "", stepped(system), inner_step(system))
    return module_of("page.c", native.with_shell(translation, model, "", native.PAGE))


def _token(component: type[Component], code: str) -> str:
    """Identity of the FMU: of its variables and all that is computed."""
    digest = hashlib.sha256(model_description(component, "", __version__) + code.encode())
    return str(uuid.uuid5(NAMESPACE, digest.hexdigest()))


def _readme(system: System, component: type[Component], fmi: int) -> str:
    parts = "\n".join(
        f"| `{part.name}` | {part.component.__name__} | {(part.component.__doc__ or '').splitlines()[0]} |"
        for part in system.parts
    )
    wires, closing = (
        "\n".join(f"- `{source}` to `{sink}`" for sink, source in each)
        for each in (system.wires.items(), system.closing)
    )
    driven = "\n".join(
        f"- `{sink}` follows a table of {len(drive.points)} points" for sink, drive in system.drives.items()
    )
    readme = README.format(
        title=system.title,
        description=system.description,
        loop=LOOP.format(tolerance=RULE.tolerance, wires=closing) if closing else "",
        parts=parts,
        wires="\n".join(filter(None, (wires, driven))),
        grid=f"`{STEP if system.step else STEPS}`",
        command=native.COMMAND.format(name=system.name, fmi=fmi),
    )
    return documentation.with_table(readme, component) + documentation.names_note(component)
