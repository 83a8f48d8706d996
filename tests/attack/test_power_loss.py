"""The power fails: what a command has written is on the disk whole, and so is what it was about to replace.

The disk is an ext4 file system in a file. A copy of that file is what a power loss would leave; mounting the
copy replays its journal, as the next start of the machine would.
"""

import os
import random
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from attack_figures import record
from commands import started

from loomfmu import Trace

SCENE = 'steps_per_revolution = 720\nrecord = ["belt.*"]\n[loom]\nmachine = "WL680-3600"\n'
MEGABYTES = 48
TOOLS = ("mkfs.ext4", "mount", "umount")
SOON = (
    "commit=1"  # names reach the disk after a second, not five; contents nobody waits for still take thirty
)


@contextmanager
def mounted(image: Path, *options: str) -> Iterator[Path]:
    """The folder where a file system in a file is mounted."""
    folder = image.with_suffix(".mounted")
    folder.mkdir(exist_ok=True)
    chosen = ",".join(("loop", *options))
    done = subprocess.run(["mount", "-o", chosen, image, folder], capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(f"this machine mounts no image: {done.stderr.strip()}")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)


@pytest.fixture
def disk(tmp_path: Path) -> Path:
    """An empty ext4 file system in a file."""
    if os.name == "nt" or os.geteuid() != 0 or not all(map(shutil.which, TOOLS)):
        pytest.skip("only root on Linux can mount a file system")
    image = tmp_path / "disk.image"
    with image.open("wb") as file:
        file.truncate(MEGABYTES << 20)
    subprocess.run(["mkfs.ext4", "-q", "-F", image], check=True)
    return image


def written(folder: Path) -> str:
    """How much has been written to the device of a file system."""
    number = os.stat(folder).st_dev
    return Path(f"/sys/dev/block/{os.major(number)}:{os.minor(number)}/stat").read_text().split()[4]


@contextmanager
def after_power_loss(image: Path, folder: Path) -> Iterator[Path]:
    """What is on the disk if the power fails now."""
    copy = image.with_name("lost.image")
    before = ""
    while before != (before := written(folder)):  # a copy during which nothing was written is of one moment
        shutil.copyfile(image, copy)
    with mounted(copy) as found:
        yield found


def run(folder: Path, revolutions: int) -> subprocess.Popen[str]:
    (folder / "scene.toml").write_text(f"revolutions = {revolutions}\n{SCENE}")
    return started(folder, "run", "scene.toml")


def revolutions_of(path: Path) -> int:
    """The revolutions of a trace that is whole to its last value."""
    with Trace(path) as trace:
        assert trace.status == "complete"
        number = round(float(trace.attributes["revolutions"]))
        assert trace.rows == 720 * number + 1
        assert all(trace[signal].size == trace.rows for signal in trace)
        return number


def lose_power(image: Path, rounds: int, seed: int) -> None:
    """Take the power away during runs that replace one another's trace, and after each."""
    moments = random.Random(seed)
    with mounted(image, SOON) as folder:
        before = time.monotonic()
        assert run(folder, 1).communicate() and (folder / "results" / "scene.h5").exists()
        length = time.monotonic() - before
        for number in range(2, 2 + rounds):
            running = run(folder, number)
            time.sleep(moments.uniform(0.0, length))
            with after_power_loss(image, folder) as found:
                assert revolutions_of(found / "results" / "scene.h5") in (number - 1, number)
            assert running.communicate() and running.returncode == 0
            time.sleep(moments.choice((0.0, 1.5, 3.0)))
            with after_power_loss(image, folder) as found:
                assert revolutions_of(found / "results" / "scene.h5") == number
    record("power losses during and after runs", 2 * rounds)


@pytest.mark.slow
@pytest.mark.parametrize(("rounds", "seed"), [(2, 1), (60, 2)])
def test_traces_outlast_power_losses(disk: Path, fmu_cache: None, rounds: int, seed: int) -> None:
    lose_power(disk, rounds, seed)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "command",
    [("init", "--all", "examples"), ("new", "PickingCam"), ("build", "MainShaft", "--output", "fmus")],
)
def test_what_a_command_has_written_outlasts_a_power_loss(
    disk: Path, command: tuple[str, ...], fmu_cache: None
) -> None:
    with mounted(disk, SOON) as folder:
        assert started(folder, *command).communicate()[1] == ""
        files = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
        assert all(files.values())
        with after_power_loss(disk, folder) as found:
            assert {path: (found / path.relative_to(folder)).read_bytes() for path in files} == files
