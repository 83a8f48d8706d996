"""An instance of an FMI 3.0 FMU, with the interface of `Slave`.

Floats, integers, booleans and enumerations are exchanged, and arrays of them: whole, by way of an array that
has what is known of each element. The instance is opened without event
mode and without early return: it steps as an FMI 2.0 one does.
"""

import ctypes
import math
from collections import Counter
from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

from fmpy.fmi3 import FMU3Slave

from ...errors import LoomfmuError
from . import calls
from .calls import DISCARD, OK, REFUSED, WARNING, Call, Compiled
from .ports import CARRIED, ELEMENT, RANGES, Value
from .slave import Slave

if TYPE_CHECKING:
    from .fmus import Fmu

C_TYPES: dict[str, Any] = {
    "Float64": ctypes.c_double,
    "Float32": ctypes.c_float,
    "Boolean": ctypes.c_bool,
    "Enumeration": ctypes.c_int64,
    **{f"Int{size}": getattr(ctypes, f"c_int{size}") for size in (8, 16, 32, 64)},
    **{f"UInt{size}": getattr(ctypes, f"c_uint{size}") for size in (8, 16, 32, 64)},
}
EVERYTHING = (-math.inf, math.inf)
FUNCTIONS = {"Enumeration": "Int64"}  # where the functions are not called as the type


def _in_vector(base_type: str) -> Any:
    """The C type that values of an FMI type have in the master's vectors."""
    return ctypes.c_double if base_type.startswith("Float") else ctypes.c_int32


class _Flags(ctypes.Structure):
    """The flags that `fmi3DoStep` returns with its status: `struct flags` of stepper.c."""

    _fields_ = (
        ("event", ctypes.c_bool),
        ("terminate", ctypes.c_bool),
        ("early", ctypes.c_bool),
        ("reached", ctypes.c_double),
    )


class Fmi3Slave(Slave):
    """One instance of an FMI 3.0 co-simulation FMU."""

    standard = "fmi3"
    _state_word = "State"
    _wrapper = FMU3Slave
    refuses_by_log = False

    def __init__(self, fmu: "Fmu", name: str):
        super().__init__(fmu, name)
        self.pooled = fmu.trusted
        if not fmu.trusted:  # it may have threads that log: they need Python's lock
            self._library = self._guarded_library()
        self._flags = _Flags()
        self._types = {port.reference: port.base_type for port in fmu.ports.values()}
        self._names = {port.reference: port.name for port in fmu.ports.values()}
        elements = [port for port in fmu.ports.values() if port.array]
        sizes = Counter(port.reference % ELEMENT for port in elements)
        self._arrays = {
            port.reference % ELEMENT: (C_TYPES[port.base_type] * sizes[port.reference % ELEMENT])()
            for port in elements
        }

    def _open(self) -> Any:
        slave = self._loaded(self._wrapper)
        slave.instantiate(loggingOn=self.fmu.trusted, logMessage=self._log_3)
        return slave

    def _log_3(self, _environment: Any, status: int, _category: bytes, message: bytes) -> None:
        self._keep(status, message)

    def start(self, values: dict[str, Value], stop_time: float, start_time: float = 0.0) -> None:
        """Set the values and enter the initialization."""
        self.forget_messages()
        self.started = True
        for port in self.fmu.ports.values():
            if port.array:
                array, element = self._element(port.reference)
                self._arrays[array][element] = values.get(port.name, port.start or 0)
        given = {self.fmu.ports[name].reference % ELEMENT: name for name in values}
        for reference, name in given.items():  # an array once
            port = self.fmu.ports[name]
            function = FUNCTIONS.get(port.base_type, port.base_type)
            content = list(self._arrays[reference]) if port.array else [values[name]]
            self._do(getattr(self._slave, f"set{function}"), [reference], content)
        defined, tolerance = self._tolerance()
        first, stop = ctypes.c_double(start_time), ctypes.c_double(stop_time)
        experiment = (ctypes.c_bool(defined.value), tolerance, first, ctypes.c_bool(True), stop)
        self._do(self._call, "EnterInitializationMode", *experiment)

    def _ended(self) -> float | None:
        return float(self._flags.reached) if self._flags.terminate else None

    # ---- prepared calls

    def value_calls(self, action: str, kind: str, references: Sequence[int], place: int) -> list[Call]:
        """Values between the FMU and the memory at a place, one FMI call for each array or run of a type."""
        made: list[Call] = []
        for (base_type, array), run in groupby(references, self._kind):
            same = list(run)
            made.append((self._whole if array else self._typed)(action, base_type, same, place))
            place += ctypes.sizeof(_in_vector(base_type)) * len(same)
        return made

    def _kind(self, reference: int) -> tuple[str, int | None]:
        """The type of a variable, and the array that it is in."""
        return self._types[reference], self._element(reference)[0] if reference >= ELEMENT else None

    @staticmethod
    def _element(reference: int) -> tuple[int, int]:
        """The array that an element is in, and its place there."""
        return reference % ELEMENT, reference // ELEMENT - 1

    def _whole(self, action: str, base_type: str, references: Sequence[int], place: int) -> Call:
        """One FMI call for an array, of which some elements are exchanged."""
        array, own = self._element(references[0])[0], C_TYPES[base_type]
        elements = [self._element(each)[1] for each in references]
        name, content = f"fmi3{action}{FUNCTIONS.get(base_type, base_type)}", self._arrays[array]
        between, limits = (own * len(elements))(), _limits(action, base_type)
        values = (_in_vector(base_type) * len(elements)).from_address(place)
        function, one = self._library[name], ctypes.c_size_t(1)

        def exchanged(*arguments: Any) -> int:
            if action == "Set":
                if not self._fits(values, between, references, base_type, limits):
                    return REFUSED
                for element, value in zip(elements, between, strict=True):
                    content[element] = value
                return int(function(*arguments))
            status = int(function(*arguments))
            between[:] = [content[element] for element in elements]
            sound = not OK <= status <= WARNING or self._fits(between, values, references, "", limits)
            return status if sound else REFUSED

        arguments = (
            self._component,
            (ctypes.c_uint32 * 1)(array),
            one,
            content,
            ctypes.c_size_t(len(content)),
        )
        return Call(exchanged, arguments, name)

    def _typed(self, action: str, base_type: str, references: Sequence[int], place: int) -> Call:
        """One FMI call; where the types differ in width, by way of an array of the FMU's own type."""
        count = len(references)
        own, masters = C_TYPES[base_type], _in_vector(base_type)
        name = f"fmi3{action}{FUNCTIONS.get(base_type, base_type)}"
        function = self._library[name]
        array, size = (ctypes.c_uint32 * count)(*references), ctypes.c_size_t(count)
        kind = calls.GET_3 if action == "Get" else calls.SET_3
        compiled = Compiled(
            kind, calls.address(function), self._component, ctypes.addressof(array), count, place
        )
        if own is masters:
            arguments = (self._component, array, size, ctypes.c_void_p(place), size)
            return Call(function, arguments, name, compiled)
        between = (own * count)()
        values = (masters * count).from_address(place)
        low, high = _limits(action, base_type)
        compiled.values, compiled.masters = ctypes.addressof(between), place
        compiled.type, compiled.low, compiled.high = calls.CONVERTED.index(base_type), low, high

        def converted(*arguments: Any) -> int:
            if action == "Set" and not self._fits(values, between, references, base_type, (low, high)):
                return REFUSED
            status = int(function(*arguments))
            fetched = action == "Get" and OK <= status <= WARNING
            if fetched and not self._fits(between, values, references, "", (low, high)):
                return REFUSED
            return status

        return Call(converted, (self._component, array, size, between, size), name, compiled)

    def _fits(
        self, source: Any, target: Any, references: Sequence[int], base_type: str, limits: tuple[float, float]
    ) -> bool:
        """Copy values to where there is room for an FMI type, or for what the master has; none if one does
        not fit."""
        low, high = limits
        for reference, value in zip(references, source, strict=True):
            if value < low or value > high:
                whose = (
                    f"the range of {base_type}"
                    if base_type
                    else "the range of 32-bit integers; leave it out of record"
                )
                self.messages.append(
                    (REFUSED, f"{self._names[reference]} = {value} is outside [{low}, {high}], {whose}")
                )
                return False
        target[:] = source[:]
        return True

    def step_call(self, time: ctypes.c_double, step_size: ctypes.c_double) -> Call:
        """`fmi3DoStep` from the time that `time` holds; an FMU that ends the simulation says Discard."""
        function, flags = self._library["fmi3DoStep"], self._flags
        pointers = [
            ctypes.c_void_p(ctypes.addressof(flags) + getattr(_Flags, name).offset)
            for name, _type in _Flags._fields_
        ]

        def stepped(*arguments: Any) -> int:
            flags.reached = time.value
            status = int(function(*arguments))
            return DISCARD if status in (OK, WARNING) and (flags.terminate or flags.early) else status

        arguments = (self._component, time, step_size, ctypes.c_bool(True), *pointers)
        compiled = Compiled(
            calls.STEP_3, calls.address(function), self._component, values=ctypes.addressof(flags)
        )
        return Call(stepped, arguments, "fmi3DoStep", compiled)

    def failed(self, status: int, action: str, time: float) -> LoomfmuError:
        """See `Slave`; without early return allowed, an FMU must not return early either."""
        if status == DISCARD and self._flags.early and not self._flags.terminate:
            self.messages.append((DISCARD, "it returned early, which was not allowed"))
        return super().failed(status, action, time)


def _limits(action: str, base_type: str) -> tuple[float, float]:
    """Return the least and the greatest value that a variable of an FMI type, or the master, can take."""
    if action == "Set":
        return RANGES.get(base_type, EVERYTHING)
    return EVERYTHING if _in_vector(base_type) is ctypes.c_double else CARRIED
