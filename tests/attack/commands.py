"""The command in processes of its own, several at a time or killed."""

import subprocess
import sys
from pathlib import Path


def started(directory: Path, *arguments: str) -> "subprocess.Popen[str]":
    """The command, at work."""
    return subprocess.Popen(
        [sys.executable, "-m", "loomfmu.cli", *arguments],
        cwd=directory,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
