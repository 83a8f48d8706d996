"""Native FMUs of FMI 3 as the tests handle them: the C functions by ctypes, with every status and message."""

import ctypes
from collections.abc import Callable, Sequence
from ctypes import (
    CFUNCTYPE,
    byref,
    c_bool,
    c_char_p,
    c_double,
    c_int,
    c_int32,
    c_int64,
    c_size_t,
    c_uint32,
    c_void_p,
)
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from loomfmu.declaring.variables import Component, variables_of
from loomfmu.fmi.builder import guid

OK, WARNING, DISCARD, ERROR = range(4)
LOGGER = CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)
TYPES: dict[type, tuple[str, Any]] = {
    float: ("Float64", c_double),
    int: ("Int64", c_int64),
    bool: ("Boolean", c_bool),
}
TIME = "time"


@dataclass(frozen=True)
class Unpacked3:
    """An FMU of FMI 3, unpacked."""

    component: type[Component]
    path: Path
    directory: Path

    @property
    def binary(self) -> Path:
        return self.directory / "binaries" / "x86_64-linux" / f"{self.component.__name__}.so"


class Native3:
    """An instance. Nothing raises: calls return the FMI status."""

    def __init__(
        self,
        fmu: Unpacked3,
        kind: str = "CoSimulation",
        *,
        logging: bool = True,
        token: str | None = None,
        name: str | None = "tested",
        event_mode: bool = False,
    ) -> None:
        self.fmu = fmu
        self.library = ctypes.CDLL(str(fmu.binary))
        self.log: list[tuple[int, str, str]] = []
        self.logger = LOGGER(self._log)
        self.rows = {
            variable.name: (place, variable.type)
            for place, variable in enumerate(variables_of(fmu.component), start=1)
        }
        self.rows[TIME] = (len(self.rows) + 1, float)
        create: Callable[..., Any] = getattr(self.library, f"fmi3Instantiate{kind}")
        create.restype = c_void_p
        own_token = (guid(fmu.component) if token is None else token).encode()
        own_name = None if name is None else name.encode()
        rest: dict[str, tuple[Any, ...]] = {
            "CoSimulation": (event_mode, False, None, c_size_t(0), None, self.logger, None),
            "ModelExchange": (None, self.logger),
            "ScheduledExecution": (None, self.logger, None, None, None),
        }
        self.instance = c_void_p(create(own_name, own_token, None, False, logging, *rest[kind]))

    def _log(self, _environment: Any, status: int, category: bytes, text: bytes) -> None:
        self.log.append((status, category.decode(), text.decode()))

    @property
    def texts(self) -> list[str]:
        return [text for _status, _category, text in self.log]

    def call(self, function: str, *arguments: Any) -> int:
        return int(getattr(self.library, f"fmi3{function}")(self.instance, *arguments))

    # ---- values

    def references(self, names: Sequence[str]) -> Any:
        return (c_uint32 * len(names))(*(self.rows[name][0] for name in names))

    def set(self, **values: Any) -> int:
        worst = OK
        for name, value in values.items():
            word, kind = TYPES[self.rows[name][1]]
            given = (kind * 1)(value)
            one = c_size_t(1)
            worst = max(worst, self.call(f"Set{word}", self.references([name]), one, given, one))
        return worst

    def get(self, *names: str) -> list[Any]:
        found = []
        for name in names:
            word, kind = TYPES[self.rows[name][1]]
            value, one = (kind * 1)(), c_size_t(1)
            assert self.call(f"Get{word}", self.references([name]), one, value, one) == OK, self.texts
            found.append(value[0])
        return found

    def variables(self) -> dict[str, Any]:
        names = [variable.name for variable in variables_of(self.fmu.component)]
        return dict(zip(names, self.get(*names), strict=True))

    def output_derivative(self, name: str, order: int) -> tuple[int, float]:
        value, one = c_double(), c_size_t(1)
        orders = (c_int32 * 1)(order)
        status = self.call("GetOutputDerivatives", self.references([name]), one, orders, byref(value), one)
        return status, value.value

    # ---- life

    def enter(self, start: float = 0.0, stop: float | None = None) -> int:
        return self.call(
            "EnterInitializationMode",
            False,
            c_double(),
            c_double(start),
            stop is not None,
            c_double(stop or 0.0),
        )

    def start(self, **values: Any) -> "Native3":
        assert self.set(**values) == OK, self.texts
        assert (self.enter(), self.call("ExitInitializationMode")) == (OK, OK), self.texts
        return self

    def step(self, time: float, size: float) -> int:
        self.flags = [c_bool(True) for _ in range(3)]
        self.reached = c_double()
        places = (*(byref(flag) for flag in self.flags), byref(self.reached))
        return self.call("DoStep", c_double(time), c_double(size), True, *places)

    def update(self) -> int:
        self.flags = [c_bool(True) for _ in range(5)]
        return self.call("UpdateDiscreteStates", *(byref(flag) for flag in self.flags), byref(c_double()))

    def set_time(self, time: float) -> int:
        return self.call("SetTime", c_double(time))

    def completed(self) -> bool:
        event, terminate = c_bool(), c_bool()
        assert self.call("CompletedIntegratorStep", True, byref(event), byref(terminate)) == OK, self.texts
        return event.value

    def free(self) -> None:
        if self.instance:
            self.library.fmi3FreeInstance(self.instance)
            self.instance = c_void_p()

    # ---- state

    def save(self) -> c_void_p:
        state = c_void_p()
        assert self.call("GetFMUState", byref(state)) == OK, self.texts
        return state

    def packed(self, state: c_void_p) -> bytes:
        size = c_size_t()
        assert self.call("SerializedFMUStateSize", state, byref(size)) == OK
        content = ctypes.create_string_buffer(size.value)
        assert self.call("SerializeFMUState", state, content, size) == OK
        return content.raw

    def unpack(self, content: bytes) -> tuple[int, c_void_p]:
        state = c_void_p()
        return self.call("DeserializeFMUState", content, c_size_t(len(content)), byref(state)), state

    def drop(self, state: c_void_p) -> int:
        return self.call("FreeFMUState", byref(state))
