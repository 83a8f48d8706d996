"""Scenes as one FMU, as tests handle them: exported, instantiated by fmpy, stepped."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from numpy.typing import NDArray

from loomfmu.cosim import whole
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.fmi.native.platforms import host

Signals = dict[str, NDArray[np.float64]]
GETTERS = {
    "Real": "getReal",
    "Integer": "getInteger",
    "Enumeration": "getInteger",
    "Boolean": "getBoolean",
    "Float64": "getFloat64",
    "Int64": "getInt64",
}


def exported(scene: Scene, directory: Path, fmi: int = 2) -> Path:
    """The scene as one FMU for this platform."""
    path = directory / f"{scene.name}.fmu"
    whole.export(scene, path, (host(),), fmi)
    return path


class Whole:
    """A scene as one FMU, unpacked; variables have the names that scenes use."""

    def __init__(self, path: Path, directory: Path):
        self.path = path
        self.description = fmpy.read_model_description(str(path))
        self.directory = fmpy.extract(str(path), str(directory))
        self.fmi = int(self.description.fmiVersion[0])
        self.variables = {_plain(each.name): each for each in self.description.modelVariables}
        self.outputs = [name for name, each in self.variables.items() if each.causality == "output"]

    def instance(self, name: str = "tested", start: float = 0.0, **values: Any) -> "Instance":
        """A new instance that has left initialization, with `belt__margin=1.0` for `belt.margin`."""
        made = Instance(self, name)
        made.initialize(start, {key.replace("__", "."): value for key, value in values.items()})
        return made


def _plain(name: str) -> str:
    return name.replace("[", "_").replace("]", "")


class Instance:
    """An instance of such an FMU."""

    def __init__(self, whole: Whole, name: str):
        self.whole = whole
        self.log: list[str] = []
        model = whole.description
        made = FMU2Slave if whole.fmi == 2 else FMU3Slave
        self.slave = made(
            guid=model.guid,
            unzipDirectory=whole.directory,
            instanceName=name,
            modelIdentifier=model.coSimulation.modelIdentifier,
        )
        if whole.fmi == 2:
            callbacks = fmpy.fmi2.fmi2CallbackFunctions()
            callbacks.logger = fmpy.fmi2.fmi2CallbackLoggerTYPE(self._log)
            callbacks.allocateMemory = fmpy.fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
            callbacks.freeMemory = fmpy.fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
            self.callbacks = callbacks
            self.slave.instantiate(callbacks=callbacks, loggingOn=True)
        else:
            self.slave.instantiate()

    def _log(self, _environment: Any, _name: Any, _status: int, _category: Any, text: bytes) -> None:
        self.log.append(text.decode())

    def initialize(self, start: float = 0.0, values: dict[str, Any] | None = None) -> None:
        """Set values and leave initialization."""
        if self.whole.fmi == 2:
            self.slave.setupExperiment(startTime=start)
            self.set(values or {})
            self.slave.enterInitializationMode()
        else:
            self.set(values or {})
            self.slave.enterInitializationMode(startTime=start)
        self.slave.exitInitializationMode()

    def set(self, values: dict[str, Any]) -> None:
        for name, value in values.items():
            variable = self.whole.variables[name]
            setter = GETTERS[variable.type].replace("get", "set")
            if self.whole.fmi == 3 and variable.type == "Enumeration":
                setter = "setInt64"
            getattr(self.slave, setter)([variable.valueReference], [value])

    def get(self, names: Iterable[str]) -> dict[str, float]:
        found: dict[str, float] = {}
        kinds: dict[str, list[str]] = {}
        for name in names:
            kind = self.whole.variables[name].type
            getter = "getInt64" if self.whole.fmi == 3 and kind == "Enumeration" else GETTERS[kind]
            kinds.setdefault(getter, []).append(name)
        for getter, same in kinds.items():
            references = [self.whole.variables[name].valueReference for name in same]
            found |= zip(same, map(float, getattr(self.slave, getter)(references)), strict=True)
        return found

    def all(self) -> dict[str, float]:
        """All outputs."""
        return self.get(self.whole.outputs)

    def step(self, time: float, size: float) -> None:
        self.slave.doStep(currentCommunicationPoint=time, communicationStepSize=size)

    def along(self, steps: int, size: float, every: int = 1) -> Signals:
        """All outputs at the start and after communication steps of `every` steps of that size."""
        rows = [self.all()]
        for step in range(0, steps, every):
            self.step(step * size, every * size)
            rows.append(self.all())
        return {name: np.array([row[name] for row in rows]) for name in self.whole.outputs}

    def save(self) -> tuple[Any, bytes]:
        """Its state, and the same as bytes."""
        slave, word = self.slave, "state" if self.whole.fmi == 2 else "State"
        state = getattr(slave, f"getFMU{word}")()
        return state, getattr(slave, f"serializeFMU{word}")(state)

    def restore(self, saved: Any) -> None:
        """Go back to a state, or to one from bytes."""
        slave, old = self.slave, self.whole.fmi == 2
        if isinstance(saved, bytes):
            saved = slave.deSerializeFMUstate(saved) if old else slave.deserializeFMUState(saved)
        slave.setFMUstate(saved) if old else slave.setFMUState(saved)

    def free(self) -> None:
        self.slave.freeInstance()
