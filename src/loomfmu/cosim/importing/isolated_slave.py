"""An instance of an FMU in a process of its own, with the interface of `Slave`.

The same calls are made in the same order as in this process. Inputs are laid down in shared memory and handed
over with the next step, and the outputs are fetched with it: one exchange for a step.
"""

import ctypes
import pickle
from array import array
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ...errors import LoomfmuError
from .calls import ERROR, OK, WARNING, Call, Rollback, Silent
from .messages import CALLS, DONE, PLACE, SIZE, TIME, VALUES, Answer
from .ports import Value
from .process import START, Limits, Process, ProcessDied
from .slave import SIZES, Slave

if TYPE_CHECKING:
    from .fmus import Fmu

ACTIONS = {"start": "initialization", "finish_initialization": "initialization"}  # of methods


class IsolatedSlave(Slave):
    """One instance of an FMU in a process of its own, which later runs use again."""

    keeps_calls = False

    def __init__(self, fmu: "Fmu", name: str, limits: Limits):
        self.limits = limits
        super().__init__(fmu, name)

    def _connect(self) -> None:
        """Start the process: it is ready by the time when it is needed."""
        self.fmu.check_platform(self.name)
        self._process = Process(VALUES + 32 * (len(self.fmu.ports) + 1))
        self._time = ctypes.c_double.from_address(self._process.address + TIME)
        self._size = ctypes.c_double.from_address(self._process.address + SIZE)
        self._place = ctypes.c_int64.from_address(self._process.address + PLACE)
        self._forget_calls()

    def _forget_calls(self) -> None:
        self._names: list[str] = []  # of the functions of prepared calls
        self._calls: dict[tuple[Any, ...], Call] = {}
        self._taken = VALUES  # bytes of the shared memory
        self._pending: list[int] = []  # calls that hand over inputs with the next exchange
        self._getting: list[int] = []  # calls that fetch outputs
        self._fresh = False  # whether the outputs in the shared memory are those of the FMU
        self._failed = ""  # the function that failed last
        self._died: ProcessDied | None = None

    @property
    def alive(self) -> bool:
        """Return whether its process still runs."""
        return self._process.alive

    # ---- exchanges

    def _ask(self, method: str, *arguments: Any, limits: Limits | None = None) -> Any:
        """Have a method performed by the process. Raises LoomfmuError for what it raises there."""
        if self._pending and not OK <= (status := self._make([])) <= WARNING:
            raise self.failed(status, self._failed, 0.0)
        action = ACTIONS.get(method, method)
        try:
            reply = self._process.ask(
                pickle.dumps((method, arguments)), limits or self.limits, lambda: action
            )
            answer = self._taken_in(reply)
        except ProcessDied as died:
            self._died = died
            raise LoomfmuError(f"{self.name}: {died}") from None
        if answer.error:
            raise answer.error
        return answer.value

    def _taken_in(self, reply: bytes) -> Answer:
        """An answer, with what the FMU has logged taken over."""
        try:
            answer = Answer(*pickle.loads(reply))
        except Exception:  # an FMU has written into the pipe
            self._process.end()
            raise ProcessDied("it disturbs the connection to the master") from None
        self.messages[:] = answer.messages
        self._silent = {function: Silent(*each) for function, each in answer.silent.items()}
        self.fatal = answer.fatal
        return answer

    def _make(self, calls: list[int], *, get: bool = False) -> int:
        """Have prepared calls made after those that are pending, and the outputs fetched; the status."""
        batch = [*self._pending, *calls, *(self._getting if get else ())]
        self._pending.clear()
        self._fresh = False
        try:
            reply = self._process.ask(
                CALLS + array("I", batch).tobytes(),
                self.limits,
                lambda: self._under_way(batch),
            )
            answer = None if reply == DONE else self._taken_in(reply)
        except ProcessDied as died:
            self._died = died
            return ERROR
        if answer is None or answer.value is None:
            self._fresh = get
            return 0
        place, status = answer.value
        self._failed = self._names[batch[place]]
        return int(status)

    def _under_way(self, batch: list[int]) -> str:
        """The call that the FMU is in, which an FMU may overwrite."""
        place = self._place.value
        if 0 <= place < len(batch):
            return self._names[batch[place]]
        return "it overwrote memory that is not its own, and"

    # ---- life

    def start(self, values: dict[str, Value], stop_time: float, start_time: float = 0.0) -> None:
        """Instantiate the FMU, set the values and enter the initialization."""
        fmu = self.fmu
        known = (
            "ports",
            "fmi",
            "trusted",
            "needs_tool",
            "tolerance",
            "exchange",
            "path",
            "directory",
            "guid",
            "identifier",
            "library",
        )
        facts = {name: getattr(fmu, name) for name in known}
        self.forget_messages()
        self._forget_calls()
        starting = replace(self.limits, step=max(START, self.limits.step))
        self._ask("instantiate", facts | {"directory": fmu.directory.absolute()}, self.name, limits=starting)
        self._ask("start", values, stop_time, start_time)
        self.started = True

    def finish_initialization(self) -> None:
        """Leave the initialization; what the FMU complains of is raised."""
        self._ask("finish_initialization")
        self._fresh = False

    def value_calls(self, action: str, kind: str, references: Sequence[int], place: int) -> list[Call]:
        """Values between the FMU and the memory at a place, by way of the shared memory."""
        key = (action, kind, tuple(references), place)
        if key not in self._calls:
            self._calls[key] = self._prepared(action, kind, list(references), place)
        return [self._calls[key]]

    def _prepared(self, action: str, kind: str, references: list[int], address: int) -> Call:
        number, length = len(self._names), SIZES[kind] * len(references)
        shared = self._process.address + self._taken
        self._names.append(self._ask("prepare", action, kind, references, self._taken))
        self._taken += (length + 7) // 8 * 8

        def hand_over() -> int:
            ctypes.memmove(shared, address, length)
            self._pending.append(number)
            return 0

        def fetch() -> int:
            status = 0 if self._fresh and not self._pending else self._make([], get=True)
            ctypes.memmove(address, shared, length)
            return status

        if action == "Get":
            self._getting.append(number)
        return Call(hand_over if action == "Set" else fetch, (), self._names[number])

    def step_call(self, time: ctypes.c_double, step_size: ctypes.c_double) -> Call:
        """A step with what comes before and after it: inputs handed over, outputs fetched."""
        number = len(self._names)
        self._names.append(self._ask("prepare_step"))

        def stepped() -> int:
            self._time.value, self._size.value = time.value, step_size.value
            return self._make([number], get=True)

        return Call(stepped, (), self._names[number])

    # ---- rollback

    def save(self) -> None:
        """Keep the state as it is for `restore`. Raises LoomfmuError where the FMU cannot."""
        self._ask("save")

    def restore(self) -> None:
        """Go back to the state that was kept last."""
        self._ask("restore")
        self._fresh = False

    def rollback(self) -> Rollback | None:
        """None: its process is asked from Python."""
        return None

    def failed(self, status: int, action: str, time: float) -> LoomfmuError:
        """Return the error to raise for a status other than OK, of a call in the step from `time` on."""
        if self._died is None:
            try:
                return self._ask("failed", status, self._failed or action, time)  # type: ignore[no-any-return]
            except LoomfmuError as error:
                if self._died is None:
                    return error
        return LoomfmuError(f"{self.name} at {time:.9g} s: {self._died}")

    # ---- end

    def rest(self) -> bool:
        """Terminate and free the FMU; whether the process can serve another run.

        What a third-party FMU has done to its process, nobody knows: its next run gets a new one.
        """
        try:
            return bool(self._ask("terminate")) and self.fmu.trusted
        except LoomfmuError:
            return False

    def free(self) -> None:
        """End the process."""
        self._process.end()

    def forsake(self) -> None:
        """Leave its process to the process that this one was forked from."""
        self._process.forsake()
