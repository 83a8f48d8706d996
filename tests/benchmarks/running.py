"""Runs one benchmark and keeps what it found."""

import traceback
from pathlib import Path
from time import perf_counter

from records import Notes, Table, machine, replaced
from written import BENCHMARKS, FOLDER, NOTES, RUNS


def run(name: str, effort: str, results: Path) -> bool:
    """Run a benchmark and write its tables below a directory; whether it came to its end.

    What was committed last is left in its tables' place if it fails, and a note says why.
    """
    notes, start = Notes(name), perf_counter()
    tables: list[Table] = []
    try:
        tables = BENCHMARKS[name][1].measure(effort, notes)
    except Exception as error:
        traceback.print_exc()
        notes("failed", (str(error) or type(error).__name__).splitlines()[0])
    folder = results / FOLDER
    for table in tables:
        table.write(folder)
    if tables:
        row = {"benchmark": name, "effort": effort, "duration [s]": perf_counter() - start, **machine()}
        replaced(folder, "runs", name, [row], RUNS)
    replaced(folder, "notes", name, notes.rows(), NOTES)
    return bool(tables)
