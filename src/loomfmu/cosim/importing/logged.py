"""The log of an FMU: its messages, and warnings that come without one."""

import ctypes
from collections.abc import Callable
from typing import Any

from .calls import DISCARD, WARNING, Silent

MOST_MESSAGES = 50  # of a third-party FMU that are kept
PYTHONFMU = "Fatal py exception encountered: "  # a line of its wrapper's own, before what the exception says


class Logged:
    """An instance that logs. `messages` holds what it logged as (status, text)."""

    def __init__(self, name: str):
        self.name = name
        self.messages: list[tuple[int, str]] = []
        self._left_out = 0  # earlier messages
        self.logged = ctypes.c_int64()  # warnings so far, left out or not
        self.heard = ctypes.c_int64()  # messages so far, of an FMU of ours
        self._silent: dict[str, Silent] = {}  # of each function

    def _log(
        self, _environment: Any, _instance: bytes, status: int, _category: bytes, message: bytes
    ) -> None:
        self.logged.value += status == WARNING
        self.heard.value += 1
        text = (message or b"").decode(errors="replace")
        self.messages.append((status, text.partition("\n")[2] if text.startswith(PYTHONFMU) else text))

    def _keep(self, status: int, text: bytes) -> None:
        """Keep a message of a third-party FMU; of many the last ones, since some log at every step."""
        self.logged.value += status == WARNING
        if status < WARNING:
            return
        if not self.messages:
            self._left_out = 0
        noted = self._left_out > 0  # in a message before the others
        self.messages.append((status, " ".join((text or b"").decode(errors="replace").split())))
        if len(self.messages) - noted > MOST_MESSAGES:
            del self.messages[noted]
            self._left_out += 1
            self.messages[:noted] = [(WARNING, f"{self._left_out} earlier messages left out")]

    def _reason(self, error: Exception | None = None) -> str:
        """The last complaint that the FMU logged, in one line."""
        texts = [text for status, text in self.messages if status >= DISCARD]
        return " ".join((texts[-1] if texts else str(error or "no reason given")).split())

    def silent_of(self, function: str) -> Silent:
        """The record of a function's warnings that came without a message."""
        return self._silent.setdefault(function, Silent())

    def noted(self, name: str, time: float, function: Callable[..., int], *arguments: Any) -> int:
        """Call a function of the FMU; its status, a warning without a message being recorded."""
        logged = self.logged.value
        status = function(*arguments)
        if status == WARNING:
            self.warned(name, time, logged)
        return status

    def warned(self, name: str, time: float, logged: int) -> None:
        """Record a warning of a function if nothing was logged since there were so many warnings."""
        if self.logged.value == logged:
            self.silent_of(name).note(time)

    @property
    def silent(self) -> dict[str, tuple[int, float]]:
        """Warnings without a message: their number and the time of the first [s], by function."""
        return {name: (each.count, each.first) for name, each in self._silent.items() if each.count}

    def forget_messages(self) -> None:
        """Begin a run without those of the one before."""
        self.messages.clear()
        for each in self._silent.values():
            each.count = 0

    def warnings(self) -> list[str]:
        """Return its warnings, each in one line."""
        logged = [f"{self.name}: {text}" for status, text in self.messages if status == WARNING]
        return logged + [
            f"{self.name} returned a warning without a message in {function} at {first:.9g} s"
            + f", the first of {count}" * (count > 1)
            for function, (count, first) in self.silent.items()
        ]
