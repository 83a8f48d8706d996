"""System packages of others and by hand: our results beside those of OMSimulator."""

import csv
import ctypes
import re
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import small_packages
from masters import Signals, oms_library
from tools import difference

from loomfmu import LoomfmuError
from loomfmu.cosim.run import run
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.cosim.ssp import read
from loomfmu.cosim.ssp.xml import SSD_FILE

USUAL = {"duration": 1.0, "step": 0.01}  # [s], of a package that states neither
ROUNDED = 1e-6  # of a step: what times in a file of OMSimulator may be off


def found(folder: Path, place: Path) -> Iterator[tuple[str, Path]]:
    """The packages in a folder, also those that lie unpacked, as those of OMSimulator's own tests do."""
    for path in sorted(folder.rglob("*.ssp")):
        yield path.relative_to(folder).as_posix(), path
    for structure in sorted(folder.rglob(SSD_FILE)):
        inside = structure.parent
        path = place / f"{inside.name}.ssp"
        with zipfile.ZipFile(path, "w") as archive:
            for file in sorted(inside.rglob("*")):
                if file.is_file():
                    archive.write(file, file.relative_to(inside))
        yield inside.relative_to(folder).as_posix(), path


def small(folders: list[Path], place: Path) -> dict[str, Path]:
    """The packages that are made by hand, where a folder has the FMUs of which they are made."""
    for folder in folders:
        for path in sorted(folder.rglob("2.0/Dahlquist.fmu")):
            fmus = path.parents[1]
            if all((fmus / f"{source}.fmu").exists() for source in small_packages.SOURCES.values()):
                return small_packages.made(place, fmus)
    return {}


def plain(name: str) -> str:
    """The name of a signal as both tools have it: letters, digits and _."""
    return re.sub(r"\W+", "_", name).strip("_")


def loaded(path: Path) -> Scene:
    """A package, with the usual times where it states none."""
    try:
        return read.load(path)
    except LoomfmuError as error:
        if not re.search("duration|step", str(error)):
            raise
        return read.load(path, USUAL)


def theirs(path: Path, start: float, stop: float) -> Signals:
    """The result of OMSimulator: its signals by plain names, along `time`."""
    library, model, result = oms_library(), ctypes.c_char_p(), path.with_suffix(".csv")
    with TemporaryDirectory() as directory:
        call(library.oms_setTempDirectory, directory.encode())
        call(library.oms_importFile, str(path).encode(), ctypes.byref(model))
        call(library.oms_setStartTime, model, ctypes.c_double(start))
        call(library.oms_setStopTime, model, ctypes.c_double(stop))
        call(library.oms_setResultFile, model, str(result).encode(), 1)
        for function in ("instantiate", "initialize", "simulate", "terminate", "delete"):
            call(getattr(library, f"oms_{function}"), model)
    with result.open() as file:
        heads, *rows = csv.reader(file)
    inside = (plain(".".join(head.split(".")[2:])) or head for head in heads)  # of the model's system
    return dict(zip(inside, np.array(rows, float).T, strict=True))


def call(function: Callable[..., int], *arguments: Any) -> None:
    """Call a function of OMSimulator, which logs the reason where it fails."""
    if function(*arguments):
        raise RuntimeError(f"{function.__name__} fails")


def ours(scene: Scene, directory: Path) -> Signals:
    """Our run: the signals by plain names, those of the system without its name, and `time`."""
    trace = run(scene, output=directory / "ours.h5").trace
    inside = {each: each.partition(".")[2] for each in scene.connectors}
    return {plain(inside.get(each, each)): np.asarray(trace[each], float) for each in trace} | {
        "time": np.asarray(trace.time)
    }


def tried(path: Path, signal: str, say: Callable[[dict[str, Any]], None]) -> None:
    """Say the last value of a signal in ours and in OMSimulator."""
    start, stop = 0.0, 1.0
    with TemporaryDirectory() as directory:
        try:
            scene = read.load(path)
            found = ours(scene, Path(directory))
            start, stop = scene.start_time, scene.start_time + scene.steps * scene.step_size
            say({"ours": float(found[plain(signal)][-1])})
        except LoomfmuError as error:
            say({"refused": str(error)})
    say({"theirs": float(theirs(path, start, stop)[plain(signal)][-1])})


def compared(path: Path, say: Callable[[dict[str, Any]], None]) -> None:
    """Say how far the signals of OMSimulator are from ours, at the worst time and at the end."""
    with TemporaryDirectory() as directory:
        scene = loaded(path)
        found = ours(scene, Path(directory))
    time = found.pop("time")
    say({"steps": scene.steps})
    rows = theirs(path, time[0], time[-1])
    places = np.searchsorted(rows["time"], time + ROUNDED * scene.step_size, side="right") - 1
    common = sorted(found.keys() & rows.keys())
    say({"signals": len(common)})
    expected, others = ({each: of[each] for each in common} for of in (found, rows))
    others = {each: values[places] for each, values in others.items()}
    say({"difference": difference(expected, others)})
    scales = {each: np.max(np.abs(values)) or 1.0 for each, values in expected.items()}
    say({"at_end": max(abs(others[each][-1] - expected[each][-1]) / scales[each] for each in common)})
