"""FMUs for model exchange, which are solved here from one communication point to the next.

At each communication point the FMU is in event mode: there its inputs may jump. The solver, scipy's LSODA,
which switches between methods for stiff systems and others, begins anew at each, and after each event. Its
errors add up, so each stretch has its share of the tolerance: by how long it is, of the whole run.
"""

import ctypes
import math
from collections.abc import Callable
from typing import Any, NoReturn

import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model, fmi2EventInfo, fmi2ModelExchange
from fmpy.fmi3 import FMU3Model
from numpy.typing import NDArray
from scipy.integrate import LSODA

from ...errors import LoomfmuError
from ...fmi.description.model_description import DEFAULT_TOLERANCE
from .calls import ERROR, OK, Call
from .fmi3_slave import Fmi3Slave
from .foreign_slave import ForeignSlave
from .ports import Value
from .slave import Ended, Slave

Floats = NDArray[np.float64]

MOST_EVENTS = 10_000  # in one communication step
MOST_UPDATES = 1000  # of discrete states at one event
LEAST_TOLERANCE = 1e-12  # of the solver, which knows no smaller one
SLACK = 1e-9  # of a communication step: an event that close to its end is at its end
FIRST, NEXT_UP = 1e-15, 4  # s, and spacings of the time: shorter than that nothing is solved


class _Vector:
    """Numbers that are exchanged with an FMU, and the arguments of the call."""

    def __init__(self, count: int):
        self.values = np.zeros(count)
        self.arguments = ctypes.c_void_p(self.values.ctypes.data), ctypes.c_size_t(count)


class Solved(Slave):
    """One instance of an FMU for model exchange."""

    def start(self, values: dict[str, Value], stop_time: float, start_time: float = 0.0) -> None:
        """See `Slave`."""
        states, indicators, self._completes = self.fmu.exchange or (0, 0, False)
        self._states, self._rates, self._nominals = (_Vector(states) for _ in range(3))
        self._indicators = _Vector(indicators)
        self._tolerance_used = self.fmu.tolerance or DEFAULT_TOLERANCE
        if self._tolerance_used < LEAST_TOLERANCE:
            raise LoomfmuError(
                f"{self.name}.tolerance = {self._tolerance_used:g} must be at least {LEAST_TOLERANCE:g}"
                " for an FMU for model exchange"
            )
        self._at, self._next = start_time, math.inf
        self._duration = stop_time - start_time
        self._failing = ""
        self._ended_at: float | None = None
        super().start(values, stop_time, start_time)

    def finish_initialization(self) -> None:
        """Leave the initialization, and go through the events of the start."""
        super().finish_initialization()
        try:
            self._do(self._begin)
        except LoomfmuError:
            if self._ended_at is None:
                raise
            raise Ended(self.name, self._ended_at) from None

    def _begin(self) -> None:
        self._update()
        self._read_nominals()

    def step_call(self, time: ctypes.c_double, step_size: ctypes.c_double) -> Call:
        """Solve the step that `time` and `step_size` hold when it is called."""

        def stepped() -> int:
            try:
                self._advance(time.value + step_size.value)
            except FMICallException as error:
                self._failing = error.function
                return int(error.status)
            return OK

        return Call(stepped, (), "its solver")

    def failed(self, status: int, action: str, time: float) -> LoomfmuError:
        """See `Slave`."""
        if self._ended_at is not None:
            return Ended(self.name, max(time, self._ended_at))
        return super().failed(status, self._failing or action, time)

    def _fail(self, reason: str) -> NoReturn:
        self.messages.append((ERROR, reason))
        raise FMICallException("its solver", ERROR)

    def save(self) -> None:
        """See `Slave`."""
        super().save()
        self._kept = self._at, self._next

    def restore(self) -> None:
        """See `Slave`."""
        super().restore()
        self._at, self._next = self._kept

    # ---- a communication step

    def _advance(self, end: float) -> None:
        """Go on to the end of a communication step; what happens there is done, but for its inputs."""
        self._update()
        slack = SLACK * (end - self._at)
        for _ in range(MOST_EVENTS):
            timed = self._next <= end + slack
            event = self._solve(max(self._next, self._at) if timed else end) or timed
            self._call("EnterEventMode")
            if event:
                self._update()
            if self._at >= end - slack:
                return
        self._fail(f"it has more than {MOST_EVENTS} events within a communication step")

    def _update(self) -> None:
        """Go through an event until the discrete states no longer change."""
        for _ in range(MOST_UPDATES):
            more, terminate, nominals, self._next = self._update_once()
            if terminate:
                self._ended_at = self._at
                raise FMICallException("its solver", ERROR)
            if nominals:
                self._read_nominals()
            if not more:
                return
        self._fail(f"its discrete states still change after {MOST_UPDATES} updates")

    def _update_once(self) -> tuple[bool, bool, bool, float]:
        """Update the discrete states; if again, if the FMU ends, if nominals changed, the next event."""
        raise NotImplementedError

    def _read_nominals(self) -> None:
        if len(self._nominals.values):
            self._call("GetNominalsOfContinuousStates", *self._nominals.arguments)

    def _solve(self, end: float) -> bool:
        """Go on to a time, or to the first event of the states before; whether there is one."""
        self._call("EnterContinuousTimeMode")
        if len(self._states.values):
            self._call("GetContinuousStates", *self._states.arguments)
        if end - self._at <= max(FIRST, NEXT_UP * np.spacing(self._at)):
            self._go(end, self._states.values.copy())
            return self._completed()
        before = self._domain()
        solver = self._solver(end)
        while solver.status == "running":
            if message := solver.step():
                self._fail(f"LSODA stopped at {solver.t:.9g} s: {message}")
            self._go(solver.t, solver.y)
            changed = self._domain() != before
            if changed:
                self._find(solver, before)
            if self._completed() or changed:
                return True
        return False

    def _solver(self, end: float) -> Any:
        """The solver from here to a time; one without states has one that stays 0."""
        nominals = np.abs(self._nominals.values) if len(self._states.values) else np.ones(1)
        share = (end - self._at) / self._duration if self._duration > 0.0 else 1.0
        tolerance = max(self._tolerance_used * min(share, 1.0), LEAST_TOLERANCE)
        absolute = tolerance * np.where(nominals > 0.0, nominals, 1.0)
        states = self._states.values.copy() if len(self._states.values) else np.zeros(1)
        return LSODA(self._slopes, self._at, states, end, rtol=tolerance, atol=absolute)

    def _go(self, time: float, states: Floats) -> None:
        """Be at a time with these states."""
        self._at = float(time)
        self._call("SetTime", ctypes.c_double(time))
        if len(self._states.values):
            self._states.values[:] = states
            self._call("SetContinuousStates", *self._states.arguments)

    def _slopes(self, time: float, states: Floats) -> Floats:
        self._go(time, states)
        if not len(self._states.values):
            return np.zeros(1)
        self._call(self._derivatives, *self._rates.arguments)
        if not np.all(np.isfinite(self._rates.values)):
            self._fail(f"its derivatives at {time:.9g} s are not finite")
        return self._rates.values.copy()

    def _domain(self) -> bytes:
        """The signs of the event indicators."""
        if not len(self._indicators.values):
            return b""
        self._call("GetEventIndicators", *self._indicators.arguments)
        return bytes(self._indicators.values > 0.0)

    def _find(self, solver: Any, before: bytes) -> None:
        """Go to the first place of a solver's step where an indicator has changed its sign, by bisection."""
        curve, low, high = solver.dense_output(), solver.t_old, solver.t
        while low < (middle := 0.5 * (low + high)) < high:
            self._go(middle, curve(middle))
            if self._domain() == before:
                low = middle
            else:
                high = middle
        self._go(high, curve(high) if high < solver.t else solver.y)

    def _completed(self) -> bool:
        """Tell the FMU that a step of the solver is one; whether it asks for an event."""
        if not self._completes:
            return False
        event, terminate = self._flag(), self._flag()
        self._call("CompletedIntegratorStep", self._flag(), ctypes.byref(event), ctypes.byref(terminate))
        if terminate.value:
            self._ended_at = self._at
            raise FMICallException("its solver", ERROR)
        return bool(event.value)

    _flag: Callable[..., Any] = ctypes.c_int
    _derivatives = "GetDerivatives"


class Solved2(Solved, ForeignSlave):
    """Of FMI 2.0."""

    _wrapper, _interface = FMU2Model, fmi2ModelExchange

    def _update_once(self) -> tuple[bool, bool, bool, float]:
        info = fmi2EventInfo()
        self._call("NewDiscreteStates", ctypes.byref(info))
        following = info.nextEventTime if info.nextEventTimeDefined else math.inf
        return (
            bool(info.newDiscreteStatesNeeded),
            bool(info.terminateSimulation),
            bool(info.nominalsOfContinuousStatesChanged),
            following,
        )


class Solved3(Solved, Fmi3Slave):
    """Of FMI 3.0."""

    _wrapper = FMU3Model
    _flag = ctypes.c_bool
    _derivatives = "GetContinuousStateDerivatives"

    def _update_once(self) -> tuple[bool, bool, bool, float]:
        more, terminate, nominals, states, defined = (ctypes.c_bool() for _ in range(5))
        following = ctypes.c_double()
        flags = (more, terminate, nominals, states, defined, following)
        self._call("UpdateDiscreteStates", *(ctypes.byref(each) for each in flags))
        return (
            more.value,
            terminate.value,
            nominals.value,
            following.value if defined.value else math.inf,
        )
