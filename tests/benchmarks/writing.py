"""What it costs to write a trace: by our writer, and by HDF5 with other blocks and compressions."""

from pathlib import Path
from time import perf_counter
from typing import Any

import h5py
import numpy as np
from children import Task, Timing, children, in_turn, middle, spread
from numpy.typing import NDArray
from own import SPEED, demo
from records import Notes, Table, say
from texts import Find, parts, whole

import loomfmu
from loomfmu.traces import Channel, TraceWriter
from loomfmu.traces.chunks import LEVEL, ROWS

NAME = "writing"
COLUMNS = (
    "writer",
    "channels",
    "rows of a block",
    "compression",
    "time [us/row/channel]",
    "spread [%]",
    "size [B/value]",
    "repeats",
)
KINDS = {
    "full": {"repeats": 7, "rows": 8 * ROWS, "channels": (10, 100)},
    "quick": {"repeats": 3, "rows": 4 * ROWS, "channels": (100,)},
    "tiny": {"repeats": 1, "rows": ROWS, "channels": (3,)},
}


def samples(directory: Path, rows: int, count: int) -> NDArray[np.float64]:
    """Reals of the demonstration loom, so many rows of so many: what is written is as it would be."""
    turns = rows / 1440
    scene = demo().scene(1440, turns)
    trace = loomfmu.run(scene, output=directory / "samples.h5", flavour="native").trace
    names = [name for name in trace if trace[name].dtype == np.float64]
    picked = [trace[names[place % len(names)]][:rows] for place in range(count)]
    return np.ascontiguousarray(np.column_stack(picked))


class Writing:
    """Samples that are kept in memory and written again and again."""

    def __init__(self, directory: Path, rows: int, count: int):
        self.directory = directory
        self.values = samples(directory, rows, count)
        self.times = np.arange(len(self.values)) * 1e-5

    def blocks(self, rows: int) -> list[slice]:
        """The rows in blocks."""
        return [slice(start, start + rows) for start in range(0, len(self.values), rows)]

    def write(self, path: Path) -> None:
        """Write all samples."""
        raise NotImplementedError

    def time(self, _steps: int, _turns: float) -> Timing:
        """Seconds for a value."""
        path = self.directory / "written.h5"
        start = perf_counter()
        self.write(path)
        duration = perf_counter() - start
        return Timing(0.0, duration / self.values.size)

    def size(self) -> float:
        """Bytes on disk for a value."""
        return (self.directory / "written.h5").stat().st_size / self.values.size


class OurWriter(Writing):
    """The writer of our traces, which also keeps what it has written readable at any time."""

    def write(self, path: Path) -> None:
        """Write all samples."""
        channels = [Channel("signals", f"n{n}", "1", "1", "", n) for n in range(self.values.shape[1])]
        writer = TraceWriter(path, {"title": "written"}, channels, {})
        none = np.empty((len(self.values), 0), dtype=np.int32)
        for block in self.blocks(ROWS):
            times = self.times[block]
            writer.append(times, SPEED * times, self.values[block], none[block])
        writer.complete([])


class PlainHdf5(Writing):
    """One dataset for each channel, as in our traces, without what else they have."""

    def __init__(self, directory: Path, rows: int, count: int, block: int, level: int | None):
        super().__init__(directory, rows, count)
        self.block, self.level = block, level

    def write(self, path: Path) -> None:
        """Write all samples."""
        packed: dict[str, Any] = {}
        if self.level is not None:
            packed = {"compression": "gzip", "compression_opts": self.level, "shuffle": True}
        with h5py.File(path, "w") as file:
            datasets = [
                file.create_dataset(
                    f"n{n}",
                    (0,),
                    "f8",
                    maxshape=(None,),
                    chunks=(min(self.block, len(self.values)),),
                    **packed,
                )
                for n in range(self.values.shape[1])
            ]
            for block in self.blocks(self.block):
                values = self.values[block]
                for n, dataset in enumerate(datasets):
                    dataset.resize((block.start + len(values),))
                    dataset[block.start :] = values[:, n]


def measure(effort: str, notes: Notes) -> list[Table]:
    """All writers in turn."""
    size: Any = KINDS[effort]
    table = Table(NAME, COLUMNS)
    for count in size["channels"]:
        say(f"{NAME}: {count} channels")
        variants: dict[str, tuple[Any, ...]] = {"loomfmu": (ROWS, f"gzip {LEVEL}")}
        made: dict[str, tuple[Any, ...]] = {"loomfmu": (OurWriter, size["rows"], count)}
        for block, level in ((ROWS, None), (ROWS, 1), (ROWS, 4), (ROWS // 4, 1), (4 * ROWS, 1)):
            name = f"plain HDF5 {block} {level}"
            variants[name] = (block, "none" if level is None else f"gzip {level}")
            made[name] = (PlainHdf5, size["rows"], count, block, level)
        with children(made, notes, inside=effort == "tiny") as asked:
            for name, found in in_turn(
                asked, dict.fromkeys(asked, Task(size["repeats"], 0, 0)), notes
            ).items():
                block, compression = variants[name]
                cost, share = 1e6 * middle(found).turn, 100.0 * spread(found)
                writer = "loomfmu" if name == "loomfmu" else "plain HDF5"
                table.add(writer, count, block, compression, cost, share, asked[name].ask("size"), len(found))
    return [table]


# ---- what is said of it


def section(find: Find) -> str:
    """Writers side by side."""
    return parts(
        "Samples of the demonstration loom, written from memory, whole files with opening and closing. Our"
        " writer flushes every block so that a reader can follow, and reserves its disk space; plain HDF5"
        " does neither and is shown with other blocks and compressions. Opening a file takes a time for each"
        " channel, which counts here too.",
        whole(find(NAME)),
    )
