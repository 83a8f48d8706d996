"""The instances of FMUs, kept from one run to the next: what was reset is used again."""

import atexit
import os

from .fmi3_slave import Fmi3Slave
from .fmus import Fmu
from .foreign_slave import ForeignSlave
from .slave import Slave

_resting: dict[tuple[str, str], list[Slave]] = {}


def borrow(fmu: Fmu, name: str) -> Slave:
    """An instance: one that rests from an earlier run, or a new one."""
    resting = _resting.get((fmu.sha256, name))
    return resting.pop() if resting else _opened(fmu, name)


def _opened(fmu: Fmu, name: str) -> Slave:
    """A new instance, of the class that knows its version and what its maker may have left out."""
    if fmu.fmi == 3:
        return Fmi3Slave(fmu, name)
    return Slave(fmu, name) if fmu.ours else ForeignSlave(fmu, name)


def give_back(slave: Slave) -> None:
    """Let an instance rest until it is borrowed again."""
    if slave.rest():
        _resting.setdefault((slave.fmu.sha256, slave.name), []).append(slave)
    else:
        slave.free()


@atexit.register
def free_all() -> None:
    """Free all resting instances."""
    for slaves in _resting.values():
        for slave in slaves:
            slave.free()
    _resting.clear()


if hasattr(os, "register_at_fork"):  # a forked child has the memory of the instances, but not their threads
    os.register_at_fork(after_in_child=_resting.clear)
