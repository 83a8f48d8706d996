"""FMUs as files: built if need be, unpacked once, their descriptions read."""

import hashlib
import os
import shutil
import tempfile
import zipfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import fmpy

from .. import units
from ..components import COMPONENTS
from ..errors import LoomfmuError, suggestion
from ..fmi import builder
from ..variables import variables_of

Value = float | int | bool


@dataclass(frozen=True)
class Port:
    """A variable of an FMU as its model description tells it."""

    name: str
    kind: str  # Real, Integer, Boolean
    reference: int
    causality: str
    unit: str
    display: str
    minimum: float | None
    maximum: float | None
    start: Value | None
    description: str
    choices: tuple[str, ...] = ()
    first_choice: int = 1
    rate: str | None = None

    def value(self, given: Any, where: str) -> Value:
        """A value as people write it, in the port's own type and unit, within its limits.

        Raises LoomfmuError with the name, the value and the limits.
        """
        if self.kind == "Boolean":
            if str(given).lower() not in ("true", "false"):
                raise LoomfmuError(f"{where} = {given!r} is neither true nor false")
            return str(given).lower() == "true"
        if self.choices and isinstance(given, str) and not given.isdigit():
            choice = given.replace("-", "_").replace(" ", "_")
            if choice not in self.choices:
                raise LoomfmuError(f"{where} = {given!r} is unknown{suggestion(choice, self.choices)}")
            return self.choices.index(choice) + self.first_choice
        try:
            value = units.parse(given, self.unit)
        except units.UnitError as error:
            raise LoomfmuError(f"{where}: {error}") from None
        return self._within(value, where)

    def _within(self, value: float, where: str) -> Value:
        low = -float("inf") if self.minimum is None else self.minimum
        high = float("inf") if self.maximum is None else self.maximum
        if not low <= value <= high or abs(value) == float("inf"):
            factor = units.unit(self.display).factor
            label = "" if self.display == "1" else f" {self.display}"
            raise LoomfmuError(
                f"{where} = {value / factor:.7g}{label} is outside"
                f" [{low / factor:.7g}, {high / factor:.7g}]{label}"
            )
        if self.kind == "Integer":
            if value != int(value):
                raise LoomfmuError(f"{where} = {value:.7g} is not a whole number")
            return int(value)
        return value


@dataclass(frozen=True)
class Fmu:
    """An FMU ready to be instantiated."""

    name: str
    path: Path
    sha256: str
    directory: Path
    guid: str
    identifier: str
    version: str
    ports: dict[str, Port]

    def port(self, name: str, where: str) -> Port:
        """A variable by name. Raises LoomfmuError, naming the nearest."""
        if name not in self.ports:
            raise LoomfmuError(f"{where}: {self.name} has no variable {name!r}{suggestion(name, self.ports)}")
        return self.ports[name]


def cache_directory() -> Path:
    """Where built and unpacked FMUs are kept: LOOMFMU_CACHE, or loomfmu in the user's cache directory."""
    if "LOOMFMU_CACHE" in os.environ:
        return Path(os.environ["LOOMFMU_CACHE"])
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "loomfmu"


@cache
def of_component(name: str) -> Fmu:
    """The FMU of one of our components, built unless the same one was built before."""
    if name not in COMPONENTS:
        raise LoomfmuError(f"there is no component {name!r}{suggestion(name, COMPONENTS)}")
    built = cache_directory() / "fmus" / builder.guid(COMPONENTS[name])
    path = built / f"{name}.fmu"
    if not path.exists():
        builder.build(name, built)
    return load(path)


def load(path: Path) -> Fmu:
    """Read an FMU. Raises LoomfmuError for a file that is none."""
    try:
        content = path.read_bytes()
        sha256 = hashlib.sha256(content).hexdigest()
        directory = _unpacked(path, sha256)
        description = fmpy.read_model_description(str(directory), validate=False)
    except FileNotFoundError:
        raise LoomfmuError(f"{path}: there is no such FMU") from None
    except (OSError, zipfile.BadZipFile, KeyError) as error:
        raise LoomfmuError(f"{path}: not a readable FMU ({error})") from None
    except Exception as error:  # fmpy raises its own kinds for a description that is none
        reason = (str(error) or type(error).__name__).splitlines()[0]
        raise LoomfmuError(f"{path}: its modelDescription.xml cannot be read ({reason})") from None
    if description.fmiVersion != "2.0" or description.coSimulation is None:
        raise LoomfmuError(f"{path}: an FMI {description.fmiVersion} FMU; only FMI 2.0 co-simulation is run")
    ports = {variable.name: _port(variable, description) for variable in description.modelVariables}
    return Fmu(
        name=description.modelName, path=path, sha256=sha256, directory=directory, guid=description.guid,
        identifier=description.coSimulation.modelIdentifier, version=description.version or "", ports=ports,
    )  # fmt: skip


def _unpacked(path: Path, sha256: str) -> Path:
    """The FMU's files, unpacked once for all runs and processes."""
    target = cache_directory() / "unpacked" / sha256
    if not target.exists():
        target.parent.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(dir=target.parent))
        try:
            fmpy.extract(str(path), unzipdir=str(temporary))
            temporary.rename(target)
        except OSError:
            if not target.exists():  # else another process was faster
                raise
        finally:
            shutil.rmtree(temporary, ignore_errors=True)
    return target


def _start(kind: str, text: str) -> Value:
    if kind == "Boolean":
        return text == "true"
    return int(text) if kind == "Integer" else float(text)


def _port(variable: Any, description: Any) -> Port:
    kind = {"Enumeration": "Integer"}.get(variable.type, variable.type)
    items = variable.declaredType.items if variable.type == "Enumeration" and variable.declaredType else []
    component = COMPONENTS.get(description.modelName)
    rates = {v.name: v.rate for v in variables_of(component)} if component else {}

    def limit(text: Any) -> float | None:
        return None if text is None else float(text)

    return Port(
        name=variable.name,
        kind=kind,
        reference=variable.valueReference,
        causality=variable.causality,
        unit=variable.unit or "1",
        display=variable.displayUnit or variable.unit or "1",
        minimum=1 if items else limit(variable.min),
        maximum=len(items) if items else limit(variable.max),
        start=None if variable.start is None else _start(kind, variable.start),
        description=variable.description or "",
        choices=tuple(item.name for item in items),
        first_choice=int(items[0].value) if items else 1,
        rate=rates.get(variable.name),
    )
