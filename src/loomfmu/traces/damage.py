"""Damage that a process does not survive: over some of it HDF5 loops for ever or crashes."""

import subprocess
import sys
from pathlib import Path

from ..errors import LoomfmuError
from .reader import Trace

SECONDS = 5.0  # that reading all of a small trace's attributes may take: usually a tenth of a second
RATE = 3e6  # bytes of a file that add a second; there are attributes for every signal
REFUSED = 2  # exit status of a reader that says itself what is wrong
READER = "import sys; from loomfmu.traces.damage import main; sys.exit(main(sys.argv[1]))"


def check(path: Path) -> None:
    """Read all that a trace says of itself in a process of its own, which can be stopped.

    Raises LoomfmuError where that fails or takes too long.
    """
    limit = SECONDS + (path.stat().st_size / RATE if path.is_file() else 0.0)
    command = [sys.executable, "-P", "-c", READER, str(path)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        why = f"HDF5 has not finished reading its attributes after {limit:.0f} s"
        raise LoomfmuError(f"{path}: the file is damaged ({why})") from None
    if done.returncode == REFUSED:
        raise LoomfmuError(done.stdout.strip())
    if done.returncode:
        reason = (done.stderr.strip() or f"exit status {done.returncode}").splitlines()[-1]
        raise LoomfmuError(f"{path}: the file is damaged (HDF5 fails: {reason})")


def main(path: str) -> int:
    """What the process does."""
    try:
        Trace(path).check()
    except LoomfmuError as error:
        print(error)
        return REFUSED
    return 0
