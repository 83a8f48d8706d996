"""Results as CSV files, which the report is written from, and the machine they were found on."""

import csv
import os
import platform
import subprocess
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PACKAGES = ("loomfmu", "numpy", "scipy", "h5py", "fmpy", "libcosimpy", "ecospy", "ziglang", "mpmath")

Row = dict[str, Any]


@dataclass
class Table:
    """A table: each column's head has its unit in brackets. Numbers are written with all their digits."""

    name: str
    columns: Sequence[str]
    rows: list[Row] = field(default_factory=list)

    def add(self, *cells: Any) -> None:
        """Add a row, its cells in the order of the columns."""
        self.rows.append(dict(zip(self.columns, cells, strict=True)))

    def write(self, directory: Path) -> Path:
        """Write the table as a CSV file."""
        directory.mkdir(parents=True, exist_ok=True)
        path = directory / f"{self.name}.csv"
        temporary = path.with_suffix(".partial")
        with temporary.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, self.columns, lineterminator="\n")
            writer.writeheader()
            writer.writerows({key: _text(cell) for key, cell in row.items()} for row in self.rows)
        temporary.replace(path)
        return path


def _text(cell: Any) -> str:
    return f"{cell:.6g}" if isinstance(cell, float) else str(cell)


def read(directory: Path, name: str) -> list[Row]:
    """Rows of a table that was written, numbers as floats; none where there is no such file."""
    path = directory / f"{name}.csv"
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return [{key: _value(cell) for key, cell in row.items()} for row in csv.DictReader(file)]


def _value(cell: str) -> Any:
    try:
        return float(cell)
    except ValueError:
        return cell


@dataclass
class Notes:
    """What was not run, or not as often as the rest, and why."""

    benchmark: str
    found: dict[tuple[str, str], None] = field(default_factory=dict)

    def __call__(self, what: str, why: str) -> None:
        """Note that something was not run; a note is kept once."""
        self.found[what, why] = None

    def rows(self) -> list[Row]:
        """The notes as rows of the table of all notes."""
        return [{"benchmark": self.benchmark, "what": what, "why": why} for what, why in self.found]


def replaced(directory: Path, name: str, benchmark: str, rows: Iterable[Row], columns: Sequence[str]) -> None:
    """Write a table that all benchmarks share, with one's rows in place of those it had."""
    others = [row for row in read(directory, name) if row["benchmark"] != benchmark]
    Table(name, columns, [*others, *rows]).write(directory)


def machine() -> Row:
    """The machine and what runs on it."""
    return {
        "CPU": _cpu(),
        "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        "kernel": f"{platform.system()} {platform.release()}",
        "Python": platform.python_version(),
        "packages": "; ".join(_versions()),
        "commit": _commit(),
        "date": datetime.now(UTC).strftime("%Y-%m-%d"),
    }


def _cpu() -> str:
    """Name of the processor, with its family and model, as its name alone may say little."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    found: dict[str, str] = {}
    for line in lines:
        key, _, value = line.partition(":")
        found.setdefault(key.strip(), value.strip())
    family, model = found.get("cpu family", "?"), found.get("model", "?")
    return f"{found.get('model name', platform.machine())} (family {family}, model {model})"


def _versions() -> list[str]:
    found = []
    for name in PACKAGES:
        try:
            found.append(f"{name} {metadata.version(name)}")
        except metadata.PackageNotFoundError:
            found.append(f"{name} not installed")
    return found


def _commit() -> str:
    """The commit that was measured, with a plus where files differ from it."""
    hash_, changed = git("rev-parse", "--short", "HEAD"), git("status", "--porcelain", "--", "src")
    return f"{hash_.strip()}{'+' if changed else ''}" if hash_ else "unknown"


def git(*arguments: str) -> str:
    """What git says, or nothing where there is no git."""
    try:
        run = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    except OSError:
        return ""
    return run.stdout if run.returncode == 0 else ""


def committed(name: str) -> list[Row]:
    """Rows of a table as it was committed last."""
    text = git("show", f"HEAD:results/benchmarks/{name}.csv")
    return [{key: _value(cell) for key, cell in row.items()} for row in csv.DictReader(text.splitlines())]


def installed() -> dict[str, str]:
    """The environment of a command as of an installed package: Python keeps its bytecode."""
    return {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}


def say(text: str) -> None:
    """Tell what goes on."""
    print(text, file=sys.stderr, flush=True)
