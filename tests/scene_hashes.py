"""Print a hash of what each scene and sweep of sims/ computes: signals, verdicts and tables, to the bit.

A change that is to leave all values as they are leaves these lines as they are:

    .venv/bin/python tests/scene_hashes.py > before.txt
    .venv/bin/python tests/scene_hashes.py | diff before.txt -
"""

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pyarrow.parquet

import loomfmu

SIMS = Path(__file__).parents[1] / "sims"


def of_scene(scene: Path, flavour: str) -> str:
    """The hash of all signals that a run of a scene records, and of its verdicts."""
    result = loomfmu.run(scene, output="trace.h5", flavour=flavour)
    found = hashlib.sha256()
    for signal in result.trace:
        found.update(signal.encode() + result.trace[signal].tobytes())
    for verdict in result.trace.verdicts:
        found.update(repr(verdict).encode())
    return found.hexdigest()


def of_sweep(sweep: Path) -> str:
    """The hash of the table of a sweep."""
    folder = Path(sweep.stem)
    command = [sys.executable, "-m", "loomfmu", "sweep", str(sweep), "--output", str(folder)]
    subprocess.run(command, check=False, stdout=subprocess.DEVNULL)  # status 1 where a claim fails
    rows = pyarrow.parquet.read_table(folder / "table.parquet").to_pylist()
    return hashlib.sha256(repr(rows).encode()).hexdigest()


def main() -> None:
    """Hash everything in a copy of sims/, in a folder that is deleted afterwards."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="scenes and sweeps, such as twill; all by default")
    parser.add_argument("--live", action="store_true", help="scenes alone, with live FMUs")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(shutil.copytree(SIMS, Path(folder, "sims")))
        for path in sorted(Path().rglob("*.toml")):
            sweep = path.parent.name == "sweeps"
            if path.parent.name == "studies" or (given.names and path.stem not in given.names):
                continue
            if not (sweep and given.live):
                found = of_sweep(path) if sweep else of_scene(path, "live" if given.live else "native")
                print(found[:16], path, flush=True)


if __name__ == "__main__":
    main()
