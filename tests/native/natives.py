"""Native FMUs as the tests handle them: the C functions by ctypes, with every status and message at hand."""

import ctypes
from collections.abc import Sequence
from ctypes import CFUNCTYPE, Structure, byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from typing import Any

from fmpy import calloc, free, platform

from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing.fmus import Fmu
from loomfmu.declaring.variables import NOTHING

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
LOGGER = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)
ALLOCATE = CFUNCTYPE(c_void_p, c_size_t, c_size_t)
RELEASE = CFUNCTYPE(None, c_void_p)
C_TYPES = {"Real": c_double, "Integer": c_int, "Boolean": c_int}


class Callbacks(Structure):
    """fmi2CallbackFunctions."""

    _fields_ = (
        ("logger", LOGGER),
        ("allocate", ALLOCATE),
        ("release", RELEASE),
        ("finished", c_void_p),
        ("environment", c_void_p),
    )


def library(fmu: Fmu) -> ctypes.CDLL:
    """The FMU's library, with the types of what is no int."""
    loaded = ctypes.CDLL(str(fmu.directory / "binaries" / platform / f"{fmu.identifier}.so"))
    loaded.fmi2Instantiate.restype = c_void_p
    loaded.fmi2GetVersion.restype = loaded.fmi2GetTypesPlatform.restype = c_char_p
    return loaded


class Native:
    """An instance of a native FMU. Nothing raises: calls return the FMI status."""

    def __init__(
        self,
        fmu: Fmu,
        *,
        logging: bool = True,
        guid: str | None = None,
        name: str | None = "tested",
        kind: int = 1,
        own_memory: bool = False,
    ) -> None:
        self.fmu = fmu
        self.library = library(fmu)
        self.log: list[tuple[int, str, str]] = []
        self.memory: list[int] = []  # what is allocated and not yet released
        self.fails = False  # whether there is no more memory
        self.callbacks = Callbacks(
            LOGGER(self._log),
            ALLOCATE(0) if own_memory else ALLOCATE(self._allocate),
            RELEASE(0) if own_memory else RELEASE(self._release),
        )
        self.component = c_void_p(
            self.library.fmi2Instantiate(
                None if name is None else name.encode(),
                kind,
                (guid or fmu.guid).encode(),
                b"file:///nowhere",
                byref(self.callbacks),
                0,
                int(logging),
            )
        )

    def _log(self, _environment: Any, _instance: bytes, status: int, category: bytes, text: bytes) -> None:
        self.log.append((status, category.decode(), text.decode()))

    def _allocate(self, count: int, size: int) -> int | None:
        if self.fails:
            return None
        self.memory.append(calloc(count, size))
        return self.memory[-1]

    def _release(self, memory: int) -> None:
        self.memory.remove(memory)
        free(memory)

    @property
    def texts(self) -> list[str]:
        return [text for _status, _category, text in self.log]

    def call(self, function: str, *arguments: Any) -> int:
        return int(getattr(self.library, f"fmi2{function}")(self.component, *arguments))

    # ---- values

    def references(self, names: Sequence[str]) -> Any:
        return (c_uint * len(names))(*(self.fmu.ports[name].reference for name in names))

    def set(self, **values: Any) -> int:
        worst = OK
        for name, value in values.items():
            kind = self.fmu.ports[name].kind
            given = (C_TYPES[kind] * 1)(value)
            worst = max(worst, self.call(f"Set{kind}", self.references([name]), c_size_t(1), given))
        return worst

    def get(self, *names: str) -> list[Any]:
        found = []
        for name in names:
            kind = self.fmu.ports[name].kind
            value = (C_TYPES[kind] * 1)()
            assert self.call(f"Get{kind}", self.references([name]), c_size_t(1), value) == OK, self.texts
            found.append(bool(value[0]) if kind == "Boolean" else value[0])
        return found

    def outputs(self) -> list[Any]:
        return self.get(*(port.name for port in self.fmu.ports.values() if port.causality == "output"))

    def variables(self) -> dict[str, Any]:
        return dict(zip(self.fmu.ports, self.get(*self.fmu.ports), strict=True))

    def set_derivatives(self, derivatives: dict[tuple[str, int], float]) -> int:
        count = len(derivatives)
        names = [name for name, _order in derivatives]
        orders = (c_int * count)(*(order for _name, order in derivatives))
        values = (c_double * count)(*derivatives.values())
        return self.call("SetRealInputDerivatives", self.references(names), c_size_t(count), orders, values)

    def output_derivative(self, name: str, order: int) -> tuple[int, float]:
        value = c_double()
        status = self.call(
            "GetRealOutputDerivatives", self.references([name]), c_size_t(1), (c_int * 1)(order), byref(value)
        )
        return status, value.value

    # ---- life

    def set_up(self, start: float = 0.0, stop: float | None = None) -> int:
        return self.call(
            "SetupExperiment", 0, c_double(0.0), c_double(start), int(stop is not None), c_double(stop or 0.0)
        )

    def initialize(self) -> int:
        return max(self.call("EnterInitializationMode"), self.call("ExitInitializationMode"))

    def start(self, **values: Any) -> "Native":
        assert (self.set_up(), self.set(**values), self.initialize()) == (OK, OK, OK), self.texts
        return self

    def step(self, time: float, size: float) -> int:
        return self.call("DoStep", c_double(time), c_double(size), 1)

    def free(self) -> None:
        if self.component:
            self.library.fmi2FreeInstance(self.component)
            self.component = c_void_p()

    # ---- state

    def save(self) -> c_void_p:
        state = c_void_p()
        assert self.call("GetFMUstate", byref(state)) == OK, self.texts
        return state

    def packed(self, state: c_void_p) -> bytes:
        size = c_size_t()
        assert self.call("SerializedFMUstateSize", state, byref(size)) == OK
        content = ctypes.create_string_buffer(size.value)
        assert self.call("SerializeFMUstate", state, content, size) == OK
        return content.raw

    def unpack(self, content: bytes) -> tuple[int, c_void_p]:
        state = c_void_p()
        return self.call("DeSerializeFMUstate", content, c_size_t(len(content)), byref(state)), state

    def drop(self, state: c_void_p) -> int:
        return self.call("FreeFMUstate", byref(state))


MEMORYLESS = tuple(name for name, component in COMPONENTS.items() if component.keeps == NOTHING)
