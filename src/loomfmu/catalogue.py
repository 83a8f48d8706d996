"""FMUs with their variables, published machines and rapier heads, and the example scenes."""

import re
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from . import units
from .components import COMPONENTS
from .declaring.variables import Component, Variable, variables_of
from .errors import LoomfmuError, listed, suggestion
from .files import ANY, write_file
from .fmi.description.documentation import accuracy_text, limits_text, start_text
from .machines import HEADS, MACHINES, parameters
from .own import load

if TYPE_CHECKING:
    from .cosim.importing.fmus import Fmu

STARTERS = (
    "wl680_3600.toml",
    "sweeps/safe_speed.toml",
)  # what `loomfmu init` writes: a loom, and a sweep of it
KINDS = (".py", ".toml", ".wif")  # of files that make up the examples
HEADINGS = {"parameter": "parameters", "input": "inputs, with start values", "output": "outputs"}
MOST_VALUES = 6  # of a run of numbered variables that are shown one by one


def examples() -> Path:
    """The folder of the example scenes: in the package, or beside it in a checkout."""
    package = Path(__file__).parent
    installed = package / "sims"
    return installed if installed.is_dir() else package.parents[1] / "sims"


def start(directory: Path, *, everything: bool = False) -> list[Path]:
    """Write the demo's scene and a sweep of it into a folder, or every example; the files written.

    Raises LoomfmuError: the folder is a file, or a file is there already and differs, and nothing has been
    written; or a file cannot be written, and those before it have been.
    """
    if directory.is_file() or directory.suffix in KINDS:
        raise LoomfmuError(
            f"{directory} is not a folder; init takes one and writes {listed(STARTERS)} into it"
        )
    source = examples()
    found = sorted(path for path in source.rglob("*") if path.suffix in KINDS)
    chosen = found if everything else [source / name for name in STARTERS]
    targets = {path: directory / path.relative_to(source) for path in chosen}
    for path, target in targets.items():
        if target.is_symlink() or (target.exists() and not _free(target, path)):
            raise LoomfmuError(
                f"{target} already exists and differs; nothing was written: name another folder"
            )
    for path, target in targets.items():
        write_file(target, path.read_bytes(), ANY)
    return list(targets.values())


def _free(target: Path, path: Path) -> bool:
    """Return whether a file is empty, as a full disk may leave it, or already has the text to be written."""
    return target.is_file() and target.read_bytes() in (b"", path.read_bytes())


def components(names: Sequence[str]) -> list[type[Component]]:
    """The components of these names, or of files such as cam.py:PickingCam; all of ours if there are none.

    Raises LoomfmuError for an unknown name, and for two components of the same name.
    """
    found: dict[str, type[Component]] = {}
    for name in names or COMPONENTS:
        if not load.is_file(name) and name not in COMPONENTS:
            raise LoomfmuError(f"there is no FMU {name!r}{suggestion(name, COMPONENTS)}")
        each = load.component(name) if load.is_file(name) else COMPONENTS[name]
        if found.setdefault(each.__name__, each) is not each:
            raise LoomfmuError(
                f"{name}: two components are called {each.__name__}; their FMUs would be the same file"
            )
    return list(found.values())


def overview() -> Iterator[str]:
    """Lines that name every FMU with its inputs and outputs, then machines, heads and example scenes."""
    for name, component in COMPONENTS.items():
        yield f"{name}: {_summary(component)}"
        for causality in ("input", "output"):
            names = map(_name, _numbered(v for v in variables_of(component) if v.causality == causality))
            yield f"    {causality}s: {', '.join(names) or 'none'}"
    yield f"machines: {', '.join(MACHINES)}"
    yield f"heads: {', '.join(HEADS)}"
    yield f"scenes: {', '.join(sorted(path.stem for path in examples().glob('*.toml')))}"
    yield "`loomfmu list NAME` describes an FMU, a machine or a head; `loomfmu init --all` writes the scenes."


def details(name: str, width: int = 80) -> Iterator[str]:
    """Lines that describe an FMU with all its variables, or the values of a machine or a head.

    Raises LoomfmuError for an unknown name.
    """
    if name.lower().endswith(".fmu"):
        from .cosim.importing import fmus

        return _file(fmus.load(Path(name)), width)
    if name in COMPONENTS or load.is_file(name):
        (component,) = components([name])
        return _variables(component.__name__, component, width)
    if name in MACHINES:
        return _values(name, machine=name)
    if name in HEADS:
        return _values(name, head=name)
    hint = suggestion(name, [*COMPONENTS, *MACHINES, *HEADS])
    raise LoomfmuError(f"{name!r} is neither an FMU, a machine nor a rapier head{hint}")


def _summary(component: type[Component]) -> str:
    return (component.__doc__ or "").splitlines()[0]


def _variables(name: str, component: type[Component], width: int) -> Iterator[str]:
    yield f"{name}: {_summary(component)}"
    yield f"equations: {component.origin}"
    yield from textwrap.wrap(f"accuracy for given inputs: {accuracy_text(component)}", width)
    variables = variables_of(component)
    for causality, heading in HEADINGS.items():
        chosen = [variable for variable in variables if variable.causality == causality]
        if chosen:
            yield f"\n{heading}"
        for same in _numbered(chosen):
            yield from _described(same, width)


def _numbered(variables: Iterable[Variable]) -> list[list[Variable]]:
    """Variables in their order, those together that differ by their number alone."""
    runs = groupby(variables, key=lambda variable: re.sub(r"\d+$", "", variable.name))
    return [list(same) for _stem, same in runs]


def _name(numbered: Sequence[Variable]) -> str:
    """The name of a variable, or the first and the last of a run of numbered ones."""
    first, last = numbered[0].name, numbered[-1].name
    return first if first == last else f"{first} .. {last}"


def _file(fmu: "Fmu", width: int) -> Iterator[str]:
    """An FMU that was given as a file: its variables by the names that scenes use, in its display units."""
    yield f"{fmu.name}: FMI {fmu.fmi}.0, version {fmu.version or 'unknown'}"
    for causality, heading in HEADINGS.items():
        chosen = [port for port in fmu.ports.values() if port.causality == causality]
        if chosen:
            yield f"\n{heading}"
        for port in chosen:
            shown = port.unit if port.display == "1" else port.display
            factor = units.unit(shown).factor if port.kind == "Real" and shown in units.UNITS else 1.0
            unit = f" {shown}" if shown and shown != "1" else ""
            start = "" if port.start is None else str(port.start).lower()
            if port.start is not None and port.kind == "Real":
                start = f"{port.start / factor:.9g}"
            if port.choices and port.start in port.numbers:
                start = port.choices[port.numbers.index(int(port.start))]
            line = port.name + (f" = {start}{unit}" if start else unit.replace(" ", " in "))
            limits = {"from": port.minimum, "to": port.maximum} if not port.choices else {}
            words = [f"{word} {limit / factor:g}" for word, limit in limits.items() if limit is not None]
            line += f"  [{' '.join(words)}]" if words else ""
            for text, indent in ((line, 2), (port.description, 6)):
                yield from textwrap.wrap(text, width, initial_indent=indent * " ", subsequent_indent=6 * " ")


def _described(numbered: Sequence[Variable], width: int) -> Iterator[str]:
    """A variable, or a run of numbered ones: its values and limits, and below what it is."""
    first = numbered[0]
    name = _name(numbered)
    unit = "" if first.display == "1" else f" {first.display}"
    starts = [start_text(variable) for variable in numbered]
    shown = ", ".join(starts) if len(starts) <= MOST_VALUES else f"{starts[0]} .. {starts[-1]}"
    line = f"{name} = {shown}{unit}" if first.settable else name + unit.replace(" ", " in ")
    if limits_text(first):
        line += f"  [{limits_text(first)}]"
    yield from textwrap.wrap(line, width, initial_indent=2 * " ", subsequent_indent=6 * " ")
    yield from textwrap.wrap(first.description, width, initial_indent=6 * " ", subsequent_indent=6 * " ")


def _values(name: str, *, machine: str | None = None, head: str | None = None) -> Iterator[str]:
    yield f"{name}: published {'machine' if machine else 'rapier head'}"
    for owner, component in COMPONENTS.items():
        given = parameters(owner, machine=machine, head=head)
        for variable in variables_of(component):
            if variable.name in given:
                unit = "" if variable.display == "1" else f" {variable.display}"
                shown = start_text(replace(variable, start=given[variable.name]))
                yield f"  {owner}.{variable.name} = {shown}{unit}"
