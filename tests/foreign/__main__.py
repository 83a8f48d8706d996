"""Our FMUs in other tools, and FMUs of others in ours: `make foreign` writes `results/foreign.md`.

Each trial is a process of its own, since some crash. `FOREIGN_FMUS` names folders, separated by `:`, of FMUs
to try beside those that are made here; OMSimulator and PyFMI are tried where they can be imported.
"""

import json
import os
import re
import subprocess
import sys
import traceback
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import others
import pytest
import tools
from page import written

from loomfmu import LoomfmuError

TARGET = Path(__file__).parents[2] / "results" / "foreign.md"
PATIENCE = 300.0  # [s] of one trial


def main() -> None:
    """Try everything, or one trial if its name is given."""
    if len(sys.argv) > 1:
        trial(*sys.argv[1:])
        return
    masters = {tool: {case: asked("master", tool, case) for case in tools.CASES} for tool in tools.ALONE}
    checkers = {
        checker: {fmi: asked("checker", checker, fmi) for fmi in ("2", "3")} for checker in tools.CHECKERS
    }
    releases = {tool: asked("version", tool).get("version", "") for tool in (*masters, *checkers)}
    with TemporaryDirectory() as directory:
        places = {Path(directory): others.made(Path(directory))}
        for folder in map(Path, filter(None, os.environ.get("FOREIGN_FMUS", "").split(":"))):
            places[folder] = sorted(folder.rglob("*.fmu"))
        found = [
            {"FMU": path.relative_to(root).as_posix(), **others.about(path), **asked("import", path)}
            for root, paths in places.items()
            for path in paths
        ]
    text = written(masters, checkers, releases, found, tools.STEPS, others.MOST)
    TARGET.write_text(text, encoding="utf-8")
    print(TARGET)


def asked(kind: str, *words: str | Path) -> dict[str, Any]:
    """What a trial says; where it does not end by itself, that."""
    command = [sys.executable, Path(__file__).parent, kind, *words]
    try:
        done = subprocess.run(command, capture_output=True, errors="replace", timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return {"said": f"does not end within {PATIENCE:g} s"}
    said = {}
    for line in done.stdout.splitlines():
        if line.startswith('{"'):
            said |= json.loads(line)
    if done.returncode:
        said["said"] = f"ends its process (status {done.returncode})"
    if kind == "import" and "refused" in said:  # the place where it was tried is of no use
        said["refused"] = re.sub(rf"^one(\.fmu)?: |{re.escape(str(words[0]))}:? ", "", said["refused"])
    print(*words, said, file=sys.stderr, flush=True)
    return said


def say(found: dict[str, Any]) -> None:
    """Hand something over to who asked, whatever an FMU leaves on the line."""
    print("\n" + json.dumps(found), flush=True)


def trial(kind: str, *words: str) -> None:
    """One trial, in this process."""
    try:
        if kind == "master":
            say({"difference": tools.tried(*words)})
        elif kind == "checker":
            say({"number": tools.checked(words[0], int(words[1]))})
        elif kind == "version":
            say({"version": tools.release(*words)})
        else:
            others.compared(Path(words[0]), say)
    except pytest.skip.Exception as error:
        say({"absent": str(error)})
    except LoomfmuError as error:
        say({"refused": str(error)})
    except Exception as error:
        text = (
            str(error).splitlines()[0] if str(error) else traceback.extract_tb(error.__traceback__)[-1].line
        )
        say({"said": text})
    sys.stdout.flush()
    os._exit(0)  # what an FMU or a tool does at the end is not tried


main()
