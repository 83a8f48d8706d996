"""Live FMUs as the tests handle them: through fmpy alone, with every status and message at hand."""

import math
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from fmpy import calloc, free
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)

from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing import fmus
from loomfmu.declaring.variables import Component, variables_of

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
SPEED = 41.88790204786391  # 400 rev/min, what every component starts with
REVOLUTION = 2.0 * math.pi / SPEED  # s


class Live:
    """An instance of one of our FMUs. Nothing raises: calls return the FMI status."""

    def __init__(self, name: str, instance: str = "tested"):
        self.fmu = fmus.of_component(name)
        self.log: list[tuple[int, str, str]] = []
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = fmi2CallbackLoggerTYPE(self._log)
        self.callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        self.callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        self.slave = FMU2Slave(
            guid=self.fmu.guid,
            unzipDirectory=str(self.fmu.directory),
            modelIdentifier=self.fmu.identifier,
            instanceName=instance,
        )
        self.slave.instantiate(callbacks=self.callbacks, loggingOn=True)
        self.freed = False

    def _log(self, _environment: Any, _instance: bytes, status: int, category: bytes, text: bytes) -> None:
        # the wrapper puts a line of its own before what it could not do
        said = text.decode().partition("\n")[2] if status == FATAL else text.decode()
        self.log.append((status, (category or b"").decode(), said))

    @property
    def texts(self) -> list[str]:
        return [text for _status, _category, text in self.log]

    def call(self, method: str, *arguments: Any) -> int:
        try:
            getattr(self.slave, method)(*arguments)
        except FMICallException as error:
            return int(error.status)
        return OK

    def set(self, **values: Any) -> int:
        worst = OK
        for name, value in values.items():
            port = self.fmu.ports[name]
            worst = max(worst, self.call(f"set{port.kind}", [port.reference], [value]))
        return worst

    def get(self, *names: str) -> list[Any]:
        found = []
        for name in names:
            port = self.fmu.ports[name]
            found += getattr(self.slave, f"get{port.kind}")([port.reference])
        return found

    def outputs(self) -> list[Any]:
        return self.get(*(port.name for port in self.fmu.ports.values() if port.causality == "output"))

    def variables(self) -> list[Any]:
        return self.get(*self.fmu.ports)

    def start(self, **values: Any) -> "Live":
        assert self.begin(**values) == OK
        return self

    def begin(self, **values: Any) -> int:
        """Initialize it; the status of the end of that."""
        assert self.call("setupExperiment", None, 0.0, None) == OK
        self.set(**values)
        self.call("enterInitializationMode")
        return self.call("exitInitializationMode")

    def step(self, time: float, step_size: float) -> int:
        return self.call("doStep", time, step_size)

    def free(self) -> None:
        if not self.freed:
            self.freed = True
            self.slave.freeInstance()


@pytest.fixture
def live() -> Iterator[Callable[..., Live]]:
    """Opens instances and frees them after the test."""
    opened: list[Live] = []

    def open_(name: str, instance: str = "tested") -> Live:
        opened.append(Live(name, instance))
        return opened[-1]

    yield open_
    for instance in opened:
        instance.free()


def excited(component: type[Component], time: float) -> dict[str, float]:
    """Inputs that never stand still, each within its limits."""
    found = {}
    for place, variable in enumerate(v for v in variables_of(component) if v.causality == "input"):
        reach = 0.3 * (variable.nominal or max(abs(variable.start), 1.0))
        value = variable.start + reach * math.sin(50.0 * time + place)
        low = -math.inf if variable.minimum is None else variable.minimum
        high = math.inf if variable.maximum is None else variable.maximum
        found[variable.name] = min(max(value, low), high)
    return found


def outputs_of(component: Component) -> dict[str, Any]:
    names = [v.name for v in variables_of(type(component)) if v.causality == "output"]
    return {name: getattr(component, name) for name in names}


def in_a_process(script: str, *arguments: str, timeout: float = 300.0, **environment: str) -> str:
    """Run a script in a process of its own, where a crash is seen, and return what it printed."""
    done = subprocess.run(
        [sys.executable, "-X", "faulthandler", "-c", script, *arguments],
        env=os.environ | {"PYTHONPATH": os.path.dirname(__file__)} | environment,
        capture_output=True,
        text=True,
        timeout=timeout,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


NAMES = list(COMPONENTS)
