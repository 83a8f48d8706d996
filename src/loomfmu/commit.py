"""The commit that this package was built from: known to a checkout by git, to a wheel by a file in it."""

import os
import subprocess
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).parent
FILE = "commit.txt"  # which `make wheel` writes


@cache
def commit(package: Path = PACKAGE) -> str:
    """The commit of a package, followed by ", changed" if its files differ; empty if it is not known."""
    if (packed := package / FILE).is_file():
        return packed.read_text(encoding="utf-8").strip()
    if package.parent.name != "src" or not (package.parents[1] / ".git").exists():
        return ""  # another project's repository may be further up
    command = ("git", "--no-optional-locks", "status", "--porcelain=v2", "--branch", "--untracked-files=all")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    try:
        said = subprocess.run(
            [*command, "--", "."],
            cwd=package,
            env=environment,
            capture_output=True,
            text=True,
            check=True,
            timeout=10,
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    lines = said.stdout.splitlines()
    found = next((line.split()[2] for line in lines if line.startswith("# branch.oid ")), "(initial)")
    changed = any(not line.startswith("#") for line in lines)
    return "" if found == "(initial)" else found + (", changed" if changed else "")
