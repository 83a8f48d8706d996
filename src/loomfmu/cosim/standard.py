"""The machine that scenes need not spell out, the claims on it, and the error bars of verdicts.

The top of the package hands them down.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any, Protocol


class Standard(Protocol):
    """A module that knows a machine; `loomfmu.loom` is one. Importing it adds its kinds of claims."""

    @property
    def COMPONENT_OF(self) -> Mapping[str, str]:
        """The component of each instance that a scene need not spell out, by its name without number."""

    @property
    def SOURCES(self) -> Mapping[str, tuple[str, ...]]:
        """For each kind of terminal, the instances whose outputs it carries, the first one that a scene has.

        # is the number of the instance that follows it.
        """

    @property
    def RULES(self) -> Path:
        """The C file with all rules by which claims are judged, those of `claims/native` included."""

    def instances_of(self, table: dict[str, Any], directory: Path) -> dict[str, dict[str, Any]]:
        """Return the instances of the machine that a table describes, each with the keys of its own table."""

    def resolve(self, tables: dict[str, Any], directory: Path) -> dict[str, str]:
        """Put the contents of files that the machine's table names in their place; return their texts."""

    def pattern(self, pegs: Any, where: str) -> dict[str, int]:
        """Return the parameters that a pattern stands for."""

    def pegs(self, values: Mapping[str, Any]) -> str:
        """Return the pattern that parameters stand for."""

    def weave_of(self, instances: Iterable[str], trace: Any) -> tuple[str, ...]:
        """Return the parameters of all patterns on which instances of a run depend."""

    def added(self, tables: dict[str, Any], directory: Path) -> Iterable[str]:
        """Return warnings about tables that add an instance to the machine, perhaps by a slip."""

    def mirrored(self, instances: Mapping[str, Any], wires: Iterable[Any]) -> Iterable[str]:
        """Return warnings about instances that are taken to move alike, but do not."""


_handed: list[Callable[[], Any]] = []


def hand_down(import_machine: Callable[[], Standard], import_bars: Callable[[], Any]) -> None:
    """Take the functions that import the machine and `error_bars`, when they are first needed."""
    _handed[:] = [import_machine, import_bars]
    standard.cache_clear()


@cache
def standard() -> Standard:
    """Return the machine."""
    found: Standard = _handed[0]()
    return found


def error_bars(scene: Any, derive: Callable[..., Any], claims: int) -> Callable[[Any], Any]:
    """Return the function that adds the error bars by tolerances to the verdicts on the claims of a scene."""
    found: Callable[[Any], Any] = _handed[1]()(scene, derive, claims)
    return found
