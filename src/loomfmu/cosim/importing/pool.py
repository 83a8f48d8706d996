"""The instances of FMUs, kept from one run to the next: what was reset is used again."""

import atexit
import os
from collections.abc import Iterable
from typing import TYPE_CHECKING

from .isolated_slave import IsolatedSlave
from .process import Limits
from .slave import Slave

if TYPE_CHECKING:
    from .fmus import Fmu

Key = tuple[str, str, bool]  # the FMU's hash, the instance's name, whether it has a process of its own
_resting: dict[Key, list[Slave]] = {}


def borrow(fmu: "Fmu", name: str, limits: Limits | None = None) -> Slave:
    """An instance: one that rests from an earlier run, or a new one.

    With limits it has a process of its own, which has to keep to them.
    """
    resting = _resting.get((fmu.sha256, name, limits is not None), [])
    while resting:
        slave = resting.pop()
        if not isinstance(slave, IsolatedSlave):
            return slave
        if limits and slave.alive:
            slave.limits = limits
            return slave
        slave.free()
    return IsolatedSlave(fmu, name, limits) if limits else opened(fmu, name)


def opened(fmu: "Fmu", name: str) -> Slave:
    """A new instance in this process, of the class that fits its version and its vendor."""
    if fmu.exchange:
        from .model_exchange import Solved2, Solved3  # they need a solver

        return (Solved3 if fmu.fmi == 3 else Solved2)(fmu, name)
    # most scenes have our own FMUs of FMI 2.0 alone
    if fmu.fmi == 3:
        from .fmi3_slave import Fmi3Slave

        return Fmi3Slave(fmu, name)
    if not fmu.trusted:
        from .foreign_slave import ForeignSlave

        return ForeignSlave(fmu, name)
    return Slave(fmu, name)


def give_back(slave: Slave) -> None:
    """Let an instance rest until it is borrowed again."""
    if slave.rest():
        key = slave.fmu.sha256, slave.name, isinstance(slave, IsolatedSlave)
        _resting.setdefault(key, []).append(slave)
    else:
        slave.free()


def free(instances: Iterable[tuple["Fmu", str]]) -> None:
    """Free what rests of these instances, each an FMU and a name."""
    for fmu, name in instances:
        for isolated in (False, True):
            for slave in _resting.pop((fmu.sha256, name, isolated), ()):
                slave.free()


@atexit.register
def free_all() -> None:
    """Free all resting instances."""
    for slaves in _resting.values():
        for slave in slaves:
            slave.free()
    _resting.clear()


def _forked() -> None:
    """A forked process has the memory of the instances, but neither their threads nor their processes."""
    for slaves in _resting.values():
        for slave in slaves:
            if isinstance(slave, IsolatedSlave):
                slave.forsake()
    _resting.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forked)
