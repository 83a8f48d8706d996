"""Damage that a process does not survive: over some of it HDF5 loops for ever or crashes."""

import math
import signal
import subprocess
import sys
from pathlib import Path
from types import ModuleType

from ..errors import LoomfmuError
from .reader import Trace

resource: ModuleType | None
try:
    import resource
except ImportError:  # Windows
    resource = None

SECONDS = 5.0  # of CPU time that reading all of a small trace's attributes may take: usually a tenth
RATE = 3e6  # bytes of a file that add a second; there are attributes for every signal
PATIENCE = 20.0  # how many times as long it may take on a busy machine, a slow disk, or Windows
REFUSED = 2  # exit status of a reader that says itself what is wrong
READER = "import sys; from loomfmu.traces.damage import main; sys.exit(main(sys.argv[1], int(sys.argv[2])))"


def check(path: Path) -> None:
    """Read all that a trace says of itself in a process of its own, which can be stopped.

    Raises LoomfmuError where that fails or takes too long.
    """
    limit = math.ceil(SECONDS + (path.stat().st_size / RATE if path.is_file() else 0.0))
    command = [sys.executable, "-P", "-c", READER, str(path), str(limit)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE * limit)
    except subprocess.TimeoutExpired:
        raise _endless(path, f"{PATIENCE * limit:.0f} s") from None
    if resource and done.returncode == -signal.SIGXCPU:
        raise _endless(path, f"{limit} s of CPU time")
    if done.returncode == REFUSED:
        raise LoomfmuError(done.stdout.strip())
    if done.returncode:
        reason = (done.stderr.strip() or f"exit status {done.returncode}").splitlines()[-1]
        raise LoomfmuError(f"{path}: the file is damaged (HDF5 fails: {reason})")


def _endless(path: Path, limit: str) -> LoomfmuError:
    why = f"HDF5 has not finished reading its attributes after {limit}"
    return LoomfmuError(f"{path}: the file is damaged ({why})")


def main(path: str, limit: int) -> int:
    """Check a file in this process, within a limit on its CPU time [s]."""
    _limit_cpu_time(limit)
    try:
        Trace(path).check()
    except LoomfmuError as error:
        print(error)
        return REFUSED
    return 0


def _limit_cpu_time(seconds: int) -> None:
    """Let the system end this process after so much CPU time, wherever it is; Windows cannot."""
    if resource is None:
        return
    for kind, soft in ((resource.RLIMIT_CPU, seconds), (resource.RLIMIT_CORE, 0)):
        hard = resource.getrlimit(kind)[1]
        if hard == resource.RLIM_INFINITY or soft < hard:
            resource.setrlimit(kind, (soft, hard))
