"""Our FMUs in other tools, and theirs and their packages in ours: `make foreign` writes `results/foreign.md`.

Each trial is a process of its own, since some crash. `FOREIGN_FMUS` names folders, separated by `:`, of FMUs
and packages to try beside those made here; OMSimulator and PyFMI are tried where they can be imported.
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
import packages
import pytest
import tools
from page import written
from small_packages import SMALL

from loomfmu import LoomfmuError

TARGET = Path(__file__).parents[2] / "results" / "foreign.md"
PATIENCE = 300.0  # [s] of one trial
FOLDERS = re.compile(r"(?<![\w.])/(\S+/)+")  # where something was tried is of no use
LOGGED = re.compile(r"^error: +(?:\[\w+\] )?(.*)$", re.MULTILINE)  # by OMSimulator


def main() -> None:
    """Try everything, or one trial if its name is given."""
    if len(sys.argv) > 1:
        trial(*sys.argv[1:])
        return
    masters = {tool: {case: asked("master", tool, case) for case in tools.CASES} for tool in tools.ALONE}
    late = {(tool, steps): asked("late", tool, str(steps)) for tool, steps in tools.LATE}
    checkers = {
        checker: {fmi: asked("checker", checker, fmi) for fmi in ("2", "3")} for checker in tools.CHECKERS
    }
    releases = {tool: asked("version", tool).get("version", "") for tool in (*masters, *checkers)}
    folders = [Path(each) for each in filter(None, os.environ.get("FOREIGN_FMUS", "").split(":"))]
    with TemporaryDirectory() as directory:
        place = Path(directory)
        small = {
            name: {"expected": SMALL[name].expected, **asked("small", path, SMALL[name].signal)}
            for name, path in packages.small(folders, place).items()
        }
        theirs = {
            name: asked("package", path) for folder in folders for name, path in packages.found(folder, place)
        }
        places = {place / "made": others.made(place / "made")}
        places |= {folder: sorted(folder.rglob("*.fmu")) for folder in folders}
        found = [
            {"FMU": path.relative_to(root).as_posix(), **others.about(path), **asked("import", path)}
            for root, paths in places.items()
            for path in paths
        ]
    text = written(masters, late, checkers, releases, small, theirs, found, tools.STEPS, others.MOST)
    TARGET.write_text(text, encoding="utf-8")
    print(TARGET)


def asked(kind: str, *words: str | Path) -> dict[str, Any]:
    """What a trial says; where it does not end by itself, that."""
    command = [sys.executable, Path(__file__).parent, kind, *words]
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return {"said": f"does not end within {PATIENCE:g} s"}
    said = {}
    for line in done.stdout.splitlines():
        if line.startswith('{"'):
            said |= json.loads(line)
    if done.returncode:
        said["said"] = f"ends its process (status {done.returncode})"
    if "said" in said and (logged := LOGGED.search(done.stdout + done.stderr)):
        said["said"] = logged[1]
    for key in {"refused", "said"} & said.keys():
        said[key] = re.sub(r"^one(\.fmu)?: ", "", FOLDERS.sub("", said[key].replace(f"{words[0]}: ", "")))
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
        elif kind == "late":
            say(tools.late(words[0], int(words[1])))
        elif kind == "checker":
            say({"number": tools.checked(words[0], int(words[1]))})
        elif kind == "version":
            say({"version": tools.release(*words)})
        elif kind == "small":
            packages.tried(Path(words[0]), words[1], say)
        elif kind == "package":
            packages.compared(Path(words[0]), say)
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
