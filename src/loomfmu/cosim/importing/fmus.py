"""FMUs: what is known of one, and its file, built and unpacked when it is first needed."""

import hashlib
import math
import os
import zipfile
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import Any

import fmpy

from ... import units
from ...cache.entries import UNPACKED, folder
from ...components import COMPONENTS
from ...components.shaft_driven import FOLLOWED
from ...declaring.variables import MOTION, SHARED, Component
from ...errors import LoomfmuError, listed, shown, suggestion
from ...extras import install
from ...files import check_archive, source
from ...fmi import identities
from ...fmi.native import platforms
from ...version import __version__
from .built import (
    FLAVOURS,
    Flavour,
    check_flavour,
    counts_in_run,
    file_here,
    file_of,
    is_here,
    is_our_build,
)
from .descriptions import (
    declared_ports,
    described,
    exchange_of,
    is_ours,
    plain_names,
    ports_of,
    tolerance_of,
    unsupported_outputs,
)
from .facts import Facts, facts_of
from .ports import Port, Value
from .refusals import check_runnable, first_line, reading

# outputs of a shaft: their units, and the outputs that are their rates
SHAFT = {"angle": ("rad", "velocity"), "velocity": ("rad/s", "acceleration"), "acceleration": ("rad/s2", "")}

__all__ = ["FLAVOURS", "Flavour", "Fmu", "Port", "Value", "file_of", "load", "of_class", "of_component"]


@dataclass(frozen=True)
class Unpacked:
    """The file of an FMU: where its content lies, and what tells it from others."""

    path: Path
    sha256: str
    directory: Path
    guid: str
    identifier: str
    version: str


@dataclass(frozen=True)
class Fmu:
    """An FMU that can be instantiated.

    `ours` are those that say that this package made them: scenes set their values in its terms. `trusted` are
    those that it makes to the last bit: they run in this process and can be reset. `component` is what one of
    these is made of, which declares what others must know; None if that is not known. `single` is one that a
    process may have one instance of. `flavour` is that of one which is built when its file is first needed,
    and empty for one that was given as a file. `fixed_step` is one that takes equal steps only, `needs_tool`
    one that says it needs the tool that made it; `unsupported` are outputs without a port. `tolerance` is the
    relative one that it states for its own solver, None if it states none. Of one for model exchange alone,
    which is solved here, `exchange` has the numbers of its states and event indicators, and whether it wants
    each solver step reported.
    """

    name: str
    ports: dict[str, Port]
    fmi: int = 2
    ours: bool = True
    trusted: bool = True
    single: bool = False
    fixed_step: bool = False
    needs_tool: bool = False
    unsupported: tuple[str, ...] = ()
    tolerance: float | None = None
    exchange: tuple[int, int, bool] | None = None
    flavour: str = ""
    component: type[Component] | None = field(default=None, repr=False)
    given: Unpacked | None = field(default=None, repr=False)

    @property
    def keeps(self) -> str:
        """The kind of state that it keeps; of a third-party FMU the fullest, so that every step counts."""
        return self.component.keeps if self.component else MOTION

    @cached_property
    def facts(self) -> Facts | None:
        """Facts of its component; None if that is not known."""
        return facts_of(self.component) if self.component else None

    @cached_property
    def rated_inputs(self) -> tuple[tuple[str, str], ...]:
        """Its inputs with another one that is their rate, and that."""
        ports = self.ports.items()
        return tuple((name, port.rate) for name, port in ports if port.causality == "input" and port.rate)

    @cached_property
    def shaft_inputs(self) -> tuple[str, ...]:
        """The inputs by which it follows a shaft; its inputs tell where its component is not known."""
        if self.facts:
            return self.facts.shaft_inputs
        return tuple(FOLLOWED) if FOLLOWED.keys() <= self.ports.keys() else ()

    @property
    def built(self) -> bool:
        """Return whether it is built for a scene and not given as a file."""
        return bool(self.flavour)

    @cached_property
    def file(self) -> Unpacked:
        """Its file, built and unpacked at the first call."""
        if self.given is not None:
            return self.given
        assert self.component is not None, "what is built is built of a component"
        path = file_here(self.component, self.flavour)
        sha256, directory = _unpacked(path)
        guid = identities.identity(self.component)["guid"]
        return Unpacked(path, sha256, directory, guid, self.name, __version__)

    def in_flavour(self, flavour: str) -> "Fmu":
        """This FMU as it is built in a flavour; one that was given as a file stays as it is.

        Where no native one can be had it is a live one: see `no_native`.
        """
        if self.component is None or not self.built:
            return self
        made = of_class(self.component, "live" if flavour == "native" and self.no_native else flavour)
        if made.flavour == self.flavour:
            return self
        return replace(made, ports=self.ports) if any(port.inner for port in self.ports.values()) else made

    @property
    def no_native(self) -> str:
        """The reason why it has no native version here; empty if it has one or is given as a file."""
        if self.component is None or not self.built:
            return ""
        if not platforms.host():
            return f"none are built for {platforms.MACHINE}"
        if identities.shipped(self.component) or platforms.compiler():
            return ""
        return f"the compiler that builds it is not installed: {install('native')}"

    @property
    def path(self) -> Path:
        """Path of the file."""
        return self.file.path

    @property
    def sha256(self) -> str:
        """SHA-256 of the file."""
        return self.file.sha256

    @property
    def directory(self) -> Path:
        """The folder into which the file is unpacked."""
        return self.file.directory

    @property
    def guid(self) -> str:
        """Its GUID, or in FMI 3 its instantiation token."""
        return self.file.guid

    @property
    def identifier(self) -> str:
        """The name after which its functions and its library are named."""
        return self.file.identifier

    @property
    def version(self) -> str:
        """Its version, as its vendor states it."""
        return self.file.version

    @property
    def library(self) -> Path:
        """The library for this machine, if there is one."""
        names = [fmpy.platform_tuple, *([fmpy.platform] if self.fmi == 2 else [])]
        file = f"{self.identifier}{fmpy.sharedLibraryExtension}"
        found = [self.directory.absolute() / f"binaries/{name}/{file}" for name in names]
        return next((each for each in found if each.exists()), found[-1])

    def check_platform(self, where: str) -> None:
        """Refuse a file that has no library for this machine, naming the platforms that it has."""
        if self.library.exists():
            return
        here = self.library.parent.name
        with zipfile.ZipFile(self.path) as archive:
            libraries = [PurePosixPath(name) for name in archive.namelist()]
        matching = [each for each in libraries if each.match(f"binaries/*/{self.identifier}.*")]
        found = sorted({each.parent.name for each in matching})
        known = f"it has {listed(found)}" if found else "it has none"
        raise LoomfmuError(f"{where}: {self.path} has no library for this platform, {here}; {known}")

    def name_of(self, variable: str) -> str:
        """Return the scene's name of a variable, given that name or the FMU's own."""
        if variable in self.ports:
            return variable
        return self._plain_names.get(variable, variable)

    @cached_property
    def outputs(self) -> list[str]:
        """The names of its outputs."""
        return [port.name for port in self.ports.values() if port.causality == "output"]

    @cached_property
    def _plain_names(self) -> dict[str, str]:
        """The scene's names of the variables, by the FMU's own names; of two, the first."""
        return {port.own: port.name for port in reversed(self.ports.values())}

    def port(self, name: str, where: str) -> Port:
        """A variable by name. Raises LoomfmuError, naming the nearest."""
        if name not in self.ports:
            raise LoomfmuError(f"{where}: {self.name} has no variable {name!r}{suggestion(name, self.ports)}")
        return self.ports[name]

    def with_units(self, stated: Any, name: str) -> "Fmu":
        """This FMU with the units that a scene states for its variables, where it states none."""
        if not isinstance(stated, dict) or not all(isinstance(unit, str) for unit in stated.values()):
            raise LoomfmuError(f'{name}.units = {shown(stated)} must be a table of variable = "unit"')
        ports = dict(self.ports)
        for key, unit in stated.items():
            port = self.port(self.name_of(key), f"{name}.units")
            ports[port.name] = port.with_unit(unit, None, f"{name}.units.{key}")
        return replace(self, ports=ports)

    def elements(self, name: str) -> list[Port]:
        """The elements of an array, given the name of it that scenes or the FMU have; none of a scalar."""
        return self._arrays.get(name, [])

    @cached_property
    def _arrays(self) -> dict[str, list[Port]]:
        found: dict[str, list[Port]] = {}
        for port in self.ports.values():
            if port.array:
                found.setdefault(port.array, []).append(port)
        return dict(zip(plain_names(found), found.values(), strict=True)) | found

    @property
    def inner(self) -> list[str]:
        """The names of locals that a scene may record; of ours, those that drawings need."""
        if self.component:
            return [*self.component.drawn]
        known = () if self.ours else self.ports.values()
        return [port.name for port in known if port.causality == "local" and port.name not in SHARED]

    def with_outputs(self, names: Iterable[str]) -> "Fmu":
        """This FMU with locals that are recorded as its outputs are."""
        added = {name: replace(self.ports[name], causality="output", inner=True) for name in names}
        return replace(self, ports=self.ports | added)

    def with_tolerance(self, given: Any, where: str) -> "Fmu":
        """This FMU with another relative tolerance for its solver. Raises LoomfmuError."""
        try:
            tolerance = units.parse(given, "1")
        except units.UnitError as error:
            raise LoomfmuError(f"{where}: {error}") from None
        if not 0.0 < tolerance < math.inf:
            raise LoomfmuError(f"{where} = {shown(given)} must be a finite number above 0")
        return replace(self, tolerance=tolerance)

    def as_shaft(self) -> "Fmu":
        """This FMU in the place of the main shaft: it outputs the angle, and its other outputs are rates."""
        ports = dict(self.ports)
        for variable, (unit, rate) in SHAFT.items():
            port = ports.get(variable)
            fits = port is not None and port.causality == "output" and port.unit == unit
            if port is not None and fits:
                ports[variable] = replace(port, rate=port.rate or (rate if rate in ports else None))
            elif variable == "angle":
                raise LoomfmuError(f"{self.path}: the shaft of a scene must have an output angle in rad")
        return replace(self, ports=ports)


_known: dict[tuple[type[Component], str], Fmu] = {}


def of_component(name: str, flavour: str = "live") -> Fmu:
    """The FMU of one of our components by its name, live or native; see `of_class`."""
    if name not in COMPONENTS:
        raise LoomfmuError(f"there is no component {name!r}{suggestion(name, COMPONENTS)}")
    return of_class(COMPONENTS[name], flavour)


def of_class(component: type[Component], flavour: str = "live") -> Fmu:
    """The FMU of a component, live or native. It is built only when its file is needed."""
    check_flavour(flavour)
    if (component, flavour) not in _known:
        same = _known.get((component, "live" if flavour == "native" else "native"))
        ports = same.ports if same else declared_ports(component)
        _known[component, flavour] = Fmu(component.__name__, ports, flavour=flavour, component=component)
    return _known[component, flavour]


def unbuilt(chosen: Iterable[Fmu]) -> list[Fmu]:
    """Those of some FMUs that have yet to be built, each once."""
    found: dict[tuple[type[Component], str], Fmu] = {}
    for fmu in chosen:
        used = "file" in vars(fmu)  # it is known by now
        if fmu.component and fmu.built and not used and not is_here(fmu.component, fmu.flavour):
            found.setdefault((fmu.component, fmu.flavour), fmu)
    return list(found.values())


def build(chosen: Iterable[Fmu]) -> None:
    """Build FMUs side by side. Raises LoomfmuError as `file_of`."""
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(lambda fmu: fmu.component and file_here(fmu.component, fmu.flavour), chosen))


def load(path: Path) -> Fmu:
    """Read any FMU. Raises LoomfmuError for a file that is not one, or not one that can be run."""
    sha256, directory = _unpacked(path)
    return _read(path, sha256, directory)


def _unpacked(path: Path) -> tuple[str, Path]:
    """The SHA-256 of an FMU, and where its content lies."""
    try:
        with source(path).open("rb") as file:
            sha256 = hashlib.file_digest(file, "sha256").hexdigest()
            with zipfile.ZipFile(file) as archive:
                # compared with the FMU at each start: what runs is what the hash names
                check_archive(archive)
                names = list(filter(counts_in_run, dict.fromkeys(archive.namelist())))
                directory = folder(UNPACKED, sha256, names, archive.read)
        found = (directory / "modelDescription.xml").exists()
    except FileNotFoundError:
        raise LoomfmuError(f"{path}: there is no such FMU") from None
    except LoomfmuError:  # of the cache
        raise
    except Exception as error:  # zipfile raises a dozen kinds for a damaged archive
        raise LoomfmuError(f"{path}: not a readable FMU ({first_line(error)})") from None
    if not found:
        raise LoomfmuError(f"{path}: not a readable FMU (it has no modelDescription.xml)")
    return sha256, directory


def _read(path: Path, sha256: str, directory: Path) -> Fmu:
    with reading(path):
        description = described(directory)
    check_runnable(path, description)
    with reading(path):
        ours, fmi = is_ours(description), int(description.fmiVersion[0])
        trusted = ours and is_our_build(path, description.modelName, fmi)
        component = COMPONENTS[description.modelName] if trusted else None
        ports = ports_of(description, component)
        tolerance = tolerance_of(description)
    stepped = description.coSimulation
    kind = stepped or description.modelExchange
    return Fmu(
        name=description.modelName,
        ports=ports,
        fmi=fmi,
        ours=ours,
        trusted=trusted,
        single=kind.canBeInstantiatedOnlyOncePerProcess,
        fixed_step=bool(stepped and not stepped.canHandleVariableCommunicationStepSize),
        needs_tool=kind.needsExecutionTool,
        component=component,
        unsupported=unsupported_outputs(description),
        tolerance=tolerance,
        exchange=None if stepped else exchange_of(description),
        given=Unpacked(
            path, sha256, directory, description.guid, kind.modelIdentifier, description.version or ""
        ),
    )
