"""Native FMUs of FMI 2 and 3 as the tests handle them: the C functions, with every status and message."""

import ctypes
from collections.abc import Sequence
from ctypes import (
    CFUNCTYPE,
    Structure,
    byref,
    c_bool,
    c_char_p,
    c_double,
    c_int,
    c_int64,
    c_size_t,
    c_uint,
    c_void_p,
)
from pathlib import Path
from typing import Any, ClassVar

from fmpy import calloc, free, platform

from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing.fmus import Fmu
from loomfmu.declaring.variables import NOTHING

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
STEPPED, SOLVED = "CoSimulation", "ModelExchange"  # the interfaces
TIME = "time_"  # the port of FMI 3's independent variable
LOGGER = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)
LOGGER3 = CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)
ALLOCATE = CFUNCTYPE(c_void_p, c_size_t, c_size_t)
RELEASE = CFUNCTYPE(None, c_void_p)


class Callbacks(Structure):
    """fmi2CallbackFunctions."""

    _fields_ = (
        ("logger", LOGGER),
        ("allocate", ALLOCATE),
        ("release", RELEASE),
        ("finished", c_void_p),
        ("environment", c_void_p),
    )


class EventInfo(Structure):
    """fmi2EventInfo."""

    _fields_ = (*((f"flag_{n}", c_int) for n in range(5)), ("next_event", c_double))


def binary(fmu: Fmu) -> Path:
    folder = platform if fmu.fmi == 2 else "x86_64-linux"
    return fmu.directory / "binaries" / folder / f"{fmu.identifier}.so"


class Instance:
    """An instance of either FMI. Nothing raises: calls return the FMI status.

    Functions that both have are called by the names of FMI 2.
    """

    component: c_void_p
    # kind of a variable -> word in the functions' names, type in C
    types: ClassVar[dict[str, tuple[str, Any]]]
    flag: Any  # type of a yes or no
    rates = "GetRealOutputDerivatives"

    def __init__(self, fmu: Fmu):
        self.fmu = fmu
        self.library = ctypes.CDLL(str(binary(fmu)))
        self.log: list[tuple[int, str, str]] = []

    @property
    def texts(self) -> list[str]:
        return [text for _status, _category, text in self.log]

    def call(self, function: str, *arguments: Any) -> int:
        return int(getattr(self.library, f"fmi{self.fmu.fmi}{function}")(self.component, *arguments))

    def free(self) -> None:
        if self.component:
            getattr(self.library, f"fmi{self.fmu.fmi}FreeInstance")(self.component)
            self.component = c_void_p()

    # ---- values

    def references(self, names: Sequence[str]) -> Any:
        return (c_uint * len(names))(*(self.fmu.ports[name].reference for name in names))

    def counted(self, values: Any) -> tuple[Any, ...]:
        """The values of one reference as an argument, with their counts."""
        return c_size_t(1), values

    def set(self, **values: Any) -> int:
        worst = OK
        for name, value in values.items():
            word, kind = self.types[self.fmu.ports[name].kind]
            given = self.counted((kind * 1)(value))
            worst = max(worst, self.call(f"Set{word}", self.references([name]), *given))
        return worst

    def get(self, *names: str) -> list[Any]:
        found = []
        for name in names:
            word, kind = self.types[self.fmu.ports[name].kind]
            value = (kind * 1)()
            given = self.counted(value)
            assert self.call(f"Get{word}", self.references([name]), *given) == OK, self.texts
            found.append(bool(value[0]) if word == "Boolean" else value[0])
        return found

    def outputs(self) -> list[Any]:
        return self.get(*(port.name for port in self.fmu.ports.values() if port.causality == "output"))

    def variables(self) -> dict[str, Any]:
        names = [name for name in self.fmu.ports if name != TIME]
        return dict(zip(names, self.get(*names), strict=True))

    def output_derivative(self, name: str, order: int) -> tuple[int, float]:
        value = (c_double * 1)()
        count, *values = self.counted(value)
        status = self.call(self.rates, self.references([name]), count, (c_int * 1)(order), *values)
        return status, value[0]

    def read(self, names: Sequence[str]) -> tuple[int, list[float]]:
        """The status of reading real variables in one call, and their values."""
        word, kind = self.types["Real"]
        values = (kind * len(names))()
        return self.call(f"Get{word}", self.references(names), *self.several(values)), list(values)

    def write(self, values: dict[str, float]) -> int:
        """Set real variables in one call."""
        word, kind = self.types["Real"]
        given = (kind * len(values))(*values.values())
        return self.call(f"Set{word}", self.references(list(values)), *self.several(given))

    def several(self, values: Any) -> tuple[Any, ...]:
        """Values as an argument, with their counts."""
        return c_size_t(len(values)), values

    def derivative(
        self, unknowns: Sequence[str], knowns: Sequence[str], seed: Sequence[float], adjoint: bool = False
    ) -> tuple[int, list[float]]:
        """The status, and a sensitivity for each unknown; for each known of an adjoint derivative."""
        seeds = (c_double * len(seed))(*seed)
        values = (c_double * len(knowns if adjoint else unknowns))()
        names = (
            argument
            for each in (unknowns, knowns)
            for argument in (self.references(each), c_size_t(len(each)))
        )
        function = "GetAdjointDerivative" if adjoint else "GetDirectionalDerivative"
        status = self.call(function, *names, *self.sensitivities(seeds, values))
        return status, list(values)

    def sensitivities(self, seeds: Any, values: Any) -> tuple[Any, ...]:
        """Seeds and sensitivities as arguments."""
        return seeds, values

    # ---- life

    def enter(self, start: float = 0.0, stop: float | None = None) -> int:
        """Go into initialization mode."""
        raise NotImplementedError

    def step(self, time: float, size: float) -> int:
        raise NotImplementedError

    def update(self) -> int:
        """Find the discrete values in event mode; none asks for more."""
        raise NotImplementedError

    def start(self, **values: Any) -> "Any":
        assert self.set(**values) == OK, self.texts
        assert (self.enter(), self.call("ExitInitializationMode")) == (OK, OK), self.texts
        return self

    def ready(self, **values: Any) -> "Any":
        """In continuous-time mode."""
        self.start(**values)
        assert (self.update(), self.call("EnterContinuousTimeMode")) == (OK, OK)
        return self

    def set_time(self, time: float) -> int:
        return self.call("SetTime", c_double(time))

    def completed(self) -> bool:
        """Complete a step of the solver; whether that is an event."""
        event, terminate = self.flag(True), self.flag(True)
        assert self.call("CompletedIntegratorStep", 1, byref(event), byref(terminate)) == OK, self.texts
        assert not terminate.value
        return bool(event.value)

    def indicators(self, count: int) -> list[float]:
        values = (c_double * count)()
        assert self.call("GetEventIndicators", values, c_size_t(count)) == OK, self.texts
        return list(values)

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


class Native(Instance):
    """An instance of FMI 2, whose memory is the host's."""

    types: ClassVar = {
        "Real": ("Real", c_double),
        "Integer": ("Integer", c_int),
        "Boolean": ("Boolean", c_int),
    }
    flag = c_int

    def __init__(
        self,
        fmu: Fmu,
        kind: str = STEPPED,
        *,
        logging: bool = True,
        token: str | None = None,
        name: str | None = "tested",
        own_memory: bool = False,
    ) -> None:
        super().__init__(fmu)
        self.memory: list[int] = []  # what is allocated and not yet released
        self.fails = False  # whether there is no more memory
        self.callbacks = Callbacks(
            LOGGER(self._log),
            ALLOCATE(0) if own_memory else ALLOCATE(self._allocate),
            RELEASE(0) if own_memory else RELEASE(self._release),
        )
        create = self.library.fmi2Instantiate
        create.restype = c_void_p
        kinds = {STEPPED: 1, SOLVED: 0}
        shown = None if name is None else name.encode()
        rest = (b"file:///nowhere", byref(self.callbacks), 0, int(logging))
        self.component = c_void_p(create(shown, kinds.get(kind, 2), (token or fmu.guid).encode(), *rest))

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

    def set_derivatives(self, derivatives: dict[tuple[str, int], float]) -> int:
        count = len(derivatives)
        names = [name for name, _order in derivatives]
        orders = (c_int * count)(*(order for _name, order in derivatives))
        values = (c_double * count)(*derivatives.values())
        return self.call("SetRealInputDerivatives", self.references(names), c_size_t(count), orders, values)

    def set_up(self, start: float = 0.0, stop: float | None = None) -> int:
        return self.call(
            "SetupExperiment", 0, c_double(0.0), c_double(start), int(stop is not None), c_double(stop or 0.0)
        )

    def enter(self, start: float = 0.0, stop: float | None = None) -> int:
        return self.set_up(start, stop) or self.call("EnterInitializationMode")

    def step(self, time: float, size: float) -> int:
        return self.call("DoStep", c_double(time), c_double(size), 1)

    def update(self) -> int:
        info = EventInfo(*[1] * 5, 1.0)
        status = self.call("NewDiscreteStates", byref(info))
        assert status != OK or [getattr(info, name) for name, _type in EventInfo._fields_] == [0] * 6
        return status


class Native3(Instance):
    """An instance of FMI 3."""

    types: ClassVar = {
        "Real": ("Float64", c_double),
        "Integer": ("Int64", c_int64),
        "Boolean": ("Boolean", c_bool),
    }
    flag = c_bool
    rates = "GetOutputDerivatives"

    def __init__(
        self,
        fmu: Fmu,
        kind: str = STEPPED,
        *,
        logging: bool = True,
        token: str | None = None,
        name: str | None = "tested",
        event_mode: bool = False,
    ) -> None:
        super().__init__(fmu)
        self.logger = LOGGER3(self._log)
        create = getattr(self.library, f"fmi3Instantiate{kind}")
        create.restype = c_void_p
        shown = None if name is None else name.encode()
        rest: dict[str, tuple[Any, ...]] = {
            STEPPED: (event_mode, False, None, c_size_t(0), None, self.logger, None),
            SOLVED: (None, self.logger),
            "ScheduledExecution": (None, self.logger, None, None, None),
        }
        given = (token or fmu.guid).encode()
        self.component = c_void_p(create(shown, given, None, False, logging, *rest[kind]))

    def _log(self, _environment: Any, status: int, category: bytes, text: bytes) -> None:
        self.log.append((status, category.decode(), text.decode()))

    def call(self, function: str, *arguments: Any) -> int:
        own = function.replace("FMUstate", "FMUState").replace("DeSerialize", "Deserialize")
        return super().call(own, *arguments)

    def counted(self, values: Any) -> tuple[Any, ...]:
        return c_size_t(1), values, c_size_t(1)

    def several(self, values: Any) -> tuple[Any, ...]:
        return c_size_t(len(values)), values, c_size_t(len(values))

    def sensitivities(self, seeds: Any, values: Any) -> tuple[Any, ...]:
        return seeds, c_size_t(len(seeds)), values, c_size_t(len(values))

    def enter(self, start: float = 0.0, stop: float | None = None) -> int:
        given = (c_double(start), stop is not None, c_double(stop or 0.0))
        return self.call("EnterInitializationMode", False, c_double(), *given)

    def step(self, time: float, size: float) -> int:
        """One step; it reaches its end without an event."""
        flags, self.reached = [c_bool(True) for _ in range(3)], c_double()
        places = (*(byref(flag) for flag in flags), byref(self.reached))
        status = self.call("DoStep", c_double(time), c_double(size), True, *places)
        assert status != OK or (not any(flag.value for flag in flags) and self.reached.value == time + size)
        return status

    def update(self) -> int:
        flags = [c_bool(True) for _ in range(5)]
        status = self.call("UpdateDiscreteStates", *(byref(flag) for flag in flags), byref(c_double()))
        assert status != OK or not any(flag.value for flag in flags)
        return status


MEMORYLESS = tuple(name for name, component in COMPONENTS.items() if component.keeps == NOTHING)
