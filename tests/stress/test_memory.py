"""Many runs in one process."""

import pytest
from live_fmus import in_a_process

WARM_UP = 50
ARENA = 1 << 20  # bytes that Python takes from the system at once

SCRIPT = """
import gc, os, sys, tempfile
import psutil
import loomfmu
from loomfmu.components import COMPONENTS
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.loom.standard_loom import COMPONENT_OF

runs, warm_up = int(sys.argv[1]), int(sys.argv[2])
text = '''
revolutions = 1
steps_per_revolution = 45
record = ["belt.lowest_margin"]
[loom]
weave = "10"
dampers = true
[[claims]]
kind = "lowest_margin"
bound = 0.1
'''
used = {instance.fmu.name for instance in scenes.parse(text).instances.values()}
stems = {name: stem for stem, name in COMPONENT_OF.items()}  # a source under another name is refused
for name in sorted(set(COMPONENTS) - used):
    text += f'[{stems.get(name, "other")}]\\ncomponent = "{name}"\\n'
used = {instance.fmu.name for instance in scenes.parse(text).instances.values()}
assert used == set(COMPONENTS)
process = psutil.Process()
with tempfile.TemporaryDirectory() as directory:
    path = os.path.join(directory, "scene.toml")
    with open(path, "w") as file:
        file.write(text)
    for run in range(warm_up + runs):
        result = loomfmu.run(path, output=os.path.join(directory, "run.h5"))
        assert result.holds
        os.unlink(result.path)  # replacing a file makes the file system write it out at once
        if run == warm_up - 1:
            gc.collect()  # which is due at any time: what waits for it is no leak
            before = process.memory_info().rss, process.num_fds(), len(sys.path), len(sys.modules)
gc.collect()
after = process.memory_info().rss, process.num_fds(), len(sys.path), len(sys.modules)
print(*(new - old for old, new in zip(before, after)))
"""


@pytest.mark.slow
@pytest.mark.parametrize("runs", [250, pytest.param(1000, marks=pytest.mark.slow)])
def test_many_runs_take_no_more_memory_than_a_few(runs: int) -> None:
    grown, files, paths, modules = map(int, in_a_process(SCRIPT, str(runs), str(WARM_UP)).split())
    print(f"memory grew by {grown / runs / 1000:.2f} kB a run")
    # measured 0.1 kB a run. An instance that is not reused leaks 12 to 19 kB and a place in sys.path: a
    # run may leave a third of one, which is also what a new page for every run would be
    assert (grown - ARENA) / runs < 5_000
    assert (files, paths, modules) == (0, 0, 0)


LONG = """
import sys, tempfile
from pathlib import Path
import numpy as np
import psutil
from loomfmu.traces import ROWS, Channel, TraceWriter

blocks, warm_up = int(sys.argv[1]), int(sys.argv[2])
channels = [Channel("loom", f"signal_{n}", "m", "m", "One of many", n) for n in range(50)]
times, reals = np.zeros(ROWS), np.zeros((ROWS, 50))
process = psutil.Process()
with tempfile.TemporaryDirectory() as directory:
    writer = TraceWriter(Path(directory) / "long.h5", {"title": "long"}, channels, {})
    for block in range(warm_up + blocks):
        writer.append(times, times, reals, np.zeros((ROWS, 1), dtype="i4"))
        if block == warm_up - 1:
            before = process.memory_info().rss
    print(process.memory_info().rss - before)
    writer.abandon("interrupted")
"""


def test_a_long_run_takes_no_more_memory_than_a_short_one() -> None:
    grown = int(in_a_process(LONG, "150", "20"))
    print(f"memory grew by {grown / 1e6:.1f} MB in 150 blocks of 50 signals, 61 MB")
    # what HDF5 keeps of the places of the blocks; it would keep all blocks, up to 8 MB of each signal,
    # if its cache were not told to keep one
    assert grown < 10e6
