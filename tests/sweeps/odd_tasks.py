"""Tasks that do not end well, for worker processes to do; a worker imports them by name."""

import os
import signal
from pathlib import Path
from typing import Any

from loomfmu.sweeps import worker
from loomfmu.sweeps.worker import Batch, Job

POISON = 60.125  # rad/s, a speed that ends the process; exact in binary


def pid(_number: int) -> int:
    return os.getpid()


def refuse(number: int) -> None:
    raise ValueError(f"not {number}")


def end() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def deadly_rows(job: Job, settings: list[dict[str, Any]]) -> Batch:
    """As `run_rows`, but one value of the shaft's speed ends the process, as a crash in an FMU would."""
    if any(each["shaft.speed"] == POISON for each in settings):
        end()
    return worker.run_rows(job, settings)


def unlucky_rows(job: Job, settings: list[dict[str, Any]]) -> Batch:
    """As `run_rows`, but the process ends once, as if it was killed from outside."""
    mark = Path(job.path).with_name("ended_once")
    if len(settings) == 1 and settings[0]["shaft.speed"] == POISON and not mark.exists():
        mark.touch()
        end()
    return worker.run_rows(job, settings)
