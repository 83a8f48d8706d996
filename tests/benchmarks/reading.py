"""What it costs to read a trace: to open a large one in several tools, and to read a long one."""

import tempfile
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import h5py
import numpy as np
from own import DEMO
from records import ROOT, Notes, Table, say
from texts import Find, parts, whole

import loomfmu

NAME = "reading"
COLUMNS = ("what", "by", "time [ms]", "times the first", "repeats")
LARGE = ROOT / "sims" / "full_loom.toml"
# repeats, the scene that is opened, revolutions of the demonstration loom that are read
KINDS: dict[str, tuple[int, Path, int]] = {
    "full": (7, LARGE, 300),
    "quick": (3, LARGE, 30),
    "tiny": (1, DEMO, 1),
}


def measure(effort: str, notes: Notes) -> list[Table]:
    """All tools in turn, all in this process: times to open are those after the imports."""
    repeats, scene, turns = KINDS[effort]
    table = Table(NAME, COLUMNS)
    with tempfile.TemporaryDirectory() as folder:
        large, long, plain = (Path(folder, name) for name in ("large.h5", "long.h5", "plain.h5"))
        loomfmu.run(scene, output=large)
        loomfmu.run(DEMO, set={"revolutions": turns}, output=long)
        _unpack(long, plain)
        for name, tasks in (
            (f"open {scene.stem}, all groups", _openers(large)),
            (f"one signal of {turns} revolutions", _readers(long, plain, ["belt/margin"])),
            (f"all of {turns} revolutions", _readers(long, plain, _signals(long))),
        ):
            say(f"{NAME}: {name}")
            times: dict[str, list[float]] = {by: [] for by in tasks}
            for by, task in (repeats + 1) * list(tasks.items()):  # the first of each imports
                start = perf_counter()
                task()
                times[by].append(perf_counter() - start)
            base = median(next(iter(times.values()))[1:])
            for by, found in times.items():
                middle = median(found[1:])
                table.add(name, by, 1e3 * middle, middle / base, repeats)
    return [table]


def _signals(path: Path) -> list[str]:
    with h5py.File(path) as file:
        groups = {name: each for name, each in file.items() if isinstance(each, h5py.Group)}
        return [f"{name}/{key}" for name, group in groups.items() for key in group]


def _unpack(trace: Path, plain: Path) -> None:
    """Write the values of a trace as h5py does by default, in one piece and not packed."""
    with h5py.File(trace) as source, h5py.File(plain, "w") as file:
        for name in _signals(trace):
            file[name] = np.asarray(source[name])


def _openers(path: Path) -> dict[str, Callable[[], Any]]:
    import xarray

    def by_h5py() -> None:
        with h5py.File(path) as file:
            for name in _signals(path):
                file[name].shape  # noqa: B018

    def tree(engine: str) -> Callable[[], Any]:
        return lambda: xarray.open_datatree(path, engine=engine).close()

    engines = {f"xarray, {engine}": tree(engine) for engine in ("h5netcdf", "netcdf4")}
    return {"h5py": by_h5py, "loomfmu.Trace": lambda: list(loomfmu.Trace(path)), **engines}


def _readers(trace: Path, plain: Path, names: list[str]) -> dict[str, Callable[[], Any]]:
    """The plain numbers come first: the others are compared with them."""

    def by_h5py(path: Path) -> Callable[[], None]:
        def read() -> None:
            with h5py.File(path) as file:
                for name in names:
                    file[name][:]

        return read

    def by_trace() -> None:
        with loomfmu.Trace(trace) as run:
            for name in names:
                signal = name.replace("/", ".")
                run.read(signal if signal in run else name.rpartition("/")[2])

    return {"h5py, plain numbers": by_h5py(plain), "h5py": by_h5py(trace), "loomfmu.Trace": by_trace}


# ---- what is said of it


def section(find: Find) -> str:
    """Tools side by side."""
    return parts(
        "Opening gives the shape of every signal. The last column compares with the first line of a kind:"
        " with h5py, or with the same numbers written plainly, without packing.",
        whole(find(NAME)),
    )
