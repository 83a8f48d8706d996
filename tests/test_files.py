"""Files that are written: a name reaches the disk after its content, so that a power loss takes neither."""

import os
import stat
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

import pytest

import loomfmu
from loomfmu import catalogue, files
from loomfmu.cache import entries
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.own.new import new
from loomfmu.traces import TraceWriter

Call = tuple[str, object, object]  # "wait", inode, digest of the content; or "name", path, inode


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[Call]:
    """The calls that reach the disk in their order."""
    found: list[Call] = []
    fsync, replace = os.fsync, os.replace

    def waited(descriptor: int) -> None:
        status = os.fstat(descriptor)
        whole = os.pread(descriptor, status.st_size, 0) if stat.S_ISREG(status.st_mode) else b""
        found.append(("wait", status.st_ino, sha256(whole).hexdigest()))
        fsync(descriptor)

    def named(old: os.PathLike[str], name: os.PathLike[str]) -> None:
        found.append(("name", Path(name).absolute(), os.stat(old).st_ino))
        replace(old, name)

    monkeypatch.setattr(os, "fsync", waited)
    monkeypatch.setattr(os, "replace", named)
    return found


def shaft_trace(folder: Path) -> None:
    loomfmu.run(scenes.parse("revolutions = 1\nsteps_per_revolution = 8\n[shaft]\n"), output=folder / "a.h5")


def failed_trace(folder: Path) -> None:
    TraceWriter(folder / "a.h5", {"title": "failed", "software": "test"}, [], {}).abandon("failed")


def cached(folder: Path) -> None:
    entries.made_file(entries.STEPPER, 64 * "0", "a.so", lambda: b"code")


WRITERS: dict[str, Callable[[Path], object]] = {
    "any file": lambda folder: files.write_file(folder / "table.csv", b"a,b\n", files.ANY),
    "a trace": shaft_trace,
    "the trace of a failed run": failed_trace,
    "the examples": lambda folder: catalogue.start(folder / "examples", everything=True),
    "a mechanism": lambda folder: new("PickingCam", (), folder),
    "the cache": cached,
}


@pytest.mark.parametrize("writer", WRITERS)
def test_content_is_on_the_disk_before_its_name_and_the_name_before_the_end(
    writer: str, tmp_path: Path, calls: list[Call], monkeypatch: pytest.MonkeyPatch
) -> None:
    if writer == "the cache":
        monkeypatch.setenv("LOOMFMU_CACHE", str(tmp_path))
    WRITERS[writer](tmp_path)
    written = [path for path in tmp_path.rglob("*") if path.is_file() and "fmus" not in path.parts]
    assert written
    for path in written:
        names = [
            at for at, (kind, name, _) in enumerate(calls) if kind == "name" and name in (path, path.parent)
        ]
        assert names, f"{path} got its name in another way"
        name = calls[names[-1]][1]
        whole = calls.index(("wait", path.stat().st_ino, sha256(path.read_bytes()).hexdigest()))
        after = [inode for kind, inode, _ in calls[names[-1] :] if kind == "wait"]
        assert whole < names[-1] and isinstance(name, Path)
        assert name.parent.stat().st_ino in after


def test_a_new_folder_is_on_the_disk_before_what_is_written_into_it(
    tmp_path: Path, calls: list[Call]
) -> None:
    files.replace_file(tmp_path / "a" / "b" / "c", b"content")
    names = [at for at, call in enumerate(calls) if call[0] == "name"]
    waited = [call[1] for call in calls[: names[0]]]
    assert {tmp_path.stat().st_ino, (tmp_path / "a").stat().st_ino} <= set(waited)


def test_a_file_of_which_the_disk_takes_no_more_is_not_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Disk space may run out as late as when the content has to be there."""

    def full(_descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(loomfmu.LoomfmuError, match=r"wl680_3600.toml: cannot be written \(No space left"):
        catalogue.start(tmp_path)
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]
    monkeypatch.undo()
    (tmp_path / "wl680_3600.toml").touch()  # as earlier versions left it
    catalogue.start(tmp_path)
    assert (tmp_path / "wl680_3600.toml").stat().st_size > 0
