"""Where FMUs are kept: where the user says, in the user's cache, or in a temporary one."""

import os
import stat
import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

import pytest
from live_fmus import in_a_process
from sharing import KEPT

from loomfmu import LoomfmuError
from loomfmu.cache import directory
from loomfmu.cache.directory import cache_directory, compiler_environment
from loomfmu.cosim.importing import fmus
from loomfmu.fmi import live_fmu

unix = pytest.mark.skipif(sys.platform == "win32", reason="owners and modes of files are those of Unix")


WHAT_TO_DO = "which every run fills anew; set LOOMFMU_CACHE to a folder that only you can write to"


@pytest.fixture(autouse=True)
def no_cache_named(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("LOOMFMU_CACHE", "XDG_CACHE_HOME", "ZIG_GLOBAL_CACHE_DIR"):
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def no_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A home in which nobody can write, not even root."""
    (tmp_path / "home").write_text("a file")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    return tmp_path / "home"


def test_it_is_named_or_in_the_users_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache_directory() == tmp_path / ".cache" / "loomfmu"
    monkeypatch.setenv("XDG_CACHE_HOME", "")  # as if it were not set, says its specification
    assert cache_directory() == tmp_path / ".cache" / "loomfmu"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "other"))
    assert cache_directory() == tmp_path / "other" / "loomfmu"
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LOOMFMU_CACHE", "mine")
    assert cache_directory() == tmp_path / "mine"
    monkeypatch.setenv("LOOMFMU_CACHE", "~/mine")
    assert cache_directory() == tmp_path / "mine"
    monkeypatch.setenv("LOOMFMU_CACHE", "")
    assert cache_directory() == tmp_path / "other" / "loomfmu"
    assert sorted(path.name for path in tmp_path.iterdir()) == [".cache", "mine", "other"]


@unix
def test_an_empty_home_is_none_and_not_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import pwd

    monkeypatch.setattr(pwd, "getpwuid", lambda _: SimpleNamespace(pw_dir=str(tmp_path / "real")))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", "")
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert cache_directory() == tmp_path / "real" / ".cache" / "loomfmu"


@unix
def test_the_users_own_cache_is_closed_to_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    (tmp_path / "loomfmu").mkdir()
    (tmp_path / "loomfmu").chmod(0o777)
    assert stat.S_IMODE(cache_directory().stat().st_mode) == 0o700


@unix
def test_a_named_cache_that_cannot_be_one_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "shared").mkdir()
    (tmp_path / "shared").chmod(0o775)
    named = {
        str(tmp_path / "shared"): "can be written to by others; name a folder that only you can write to",
        str(tmp_path / "file"): "is a file, not a folder",
        str(tmp_path / "file" / "within"): r"cannot be used \(Not a directory\)",
        f"{tmp_path}/\udcff": "is not valid UTF-8",
        "~nobody_at_all/x": "Could not determine home directory",
    }
    for name, why in named.items():
        monkeypatch.setenv("LOOMFMU_CACHE", name)
        with pytest.raises(LoomfmuError, match=f"^LOOMFMU_CACHE = .*{why}"):
            cache_directory()


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where temporary caches are made; the user's own would be in the folder above."""
    monkeypatch.setattr(directory, "_temporary", [])
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    return tmp_path / "temporary"


@unix
def test_a_file_in_the_place_of_the_users_cache_is_named(
    tmp_path: Path, temporary: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "loomfmu").touch()
    assert cache_directory().parent == temporary
    said = f"loomfmu: the cache {tmp_path / 'loomfmu'} is a file, not a folder; using a temporary one,"
    assert caplog.messages == [f"{said} {WHAT_TO_DO}"]


@unix
def test_another_users_cache_is_not_used(
    tmp_path: Path, temporary: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    cache_directory()
    monkeypatch.setattr(os, "getuid", lambda: tmp_path.stat().st_uid + 1)
    monkeypatch.setattr(directory, "SYSTEM", -1)
    assert cache_directory().parent == temporary
    said = f"loomfmu: the cache {tmp_path / 'loomfmu'} belongs to another user; using a temporary one,"
    assert caplog.messages == [f"{said} {WHAT_TO_DO}"]
    monkeypatch.setenv("LOOMFMU_CACHE", str(tmp_path / "loomfmu"))
    with pytest.raises(LoomfmuError, match=r"LOOMFMU_CACHE = .* belongs to another user; name a folder"):
        cache_directory()


@pytest.mark.parametrize("flavour", [["--live"], pytest.param(["--native"], marks=pytest.mark.slow)])
def test_a_run_without_a_home_that_can_be_written_takes_a_temporary_one(
    no_home: Path, tmp_path: Path, flavour: list[str]
) -> None:
    if flavour == ["--native"]:
        pytest.importorskip("ziglang", reason="ziglang is not installed: no native FMU can be built")
    (tmp_path / "temporary").mkdir()
    (tmp_path / "x.toml").write_text("duration = 1\nstep = 0.1\n[belt]\n")
    # that the compiler has a cache of its own, too, is for the slow one: it takes ten seconds
    zig = {"ZIG_GLOBAL_CACHE_DIR": str(KEPT / "zig")} if flavour == ["--live"] else {}
    done = subprocess.run(
        [sys.executable, "-m", "loomfmu.cli", "run", "x.toml", *flavour, "--output", "x.h5"],
        cwd=tmp_path,
        env=os.environ | {"TMPDIR": str(tmp_path / "temporary")} | zig,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0
    assert done.stderr == (
        f"loomfmu: the cache {no_home}/.cache/loomfmu cannot be used (Not a directory);"
        f" using a temporary one, {WHAT_TO_DO}\n"
    )
    assert list((tmp_path / "temporary").iterdir()) == []  # it has cleared up
    assert sorted(path.name for path in tmp_path.iterdir()) == ["home", "temporary", "x.h5", "x.toml"]


def test_the_processes_of_a_run_share_the_temporary_one(no_home: Path, tmp_path: Path) -> None:
    text = in_a_process(
        """
import multiprocessing
from loomfmu.cache.directory import cache_directory
if __name__ == "__main__":
    print(cache_directory() == cache_directory())
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        print(pool.apply(cache_directory) == cache_directory())
    print(cache_directory().exists())
"""
    )
    assert text.split() == ["True"] * 3


def test_the_compiler_has_a_cache_that_it_can_write(
    no_home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LOOMFMU_CACHE", str(tmp_path / "mine"))
    assert compiler_environment()["ZIG_GLOBAL_CACHE_DIR"] == str(tmp_path / "mine" / "zig")
    monkeypatch.setenv("ZIG_GLOBAL_CACHE_DIR", "own")
    assert compiler_environment()["ZIG_GLOBAL_CACHE_DIR"] == "own"
    monkeypatch.delenv("ZIG_GLOBAL_CACHE_DIR")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert compiler_environment()["ZIG_GLOBAL_CACHE_DIR"] == str(tmp_path / ".cache" / "zig")


@unix
@pytest.mark.parametrize("mask", [0o022, 0o027])
def test_a_built_fmu_is_as_open_as_the_umask_lets_it_be_and_the_cache_is_closed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mask: int
) -> None:
    monkeypatch.setenv("LOOMFMU_CACHE", str(tmp_path / "cache"))
    before = os.umask(mask)
    try:
        made = live_fmu.build("MainShaft", tmp_path)
        unpacked = fmus.load(made).directory
    finally:
        os.umask(before)
    assert stat.S_IMODE(made.stat().st_mode) == 0o666 & ~mask
    assert {stat.S_IMODE(path.stat().st_mode) for path in (unpacked, *unpacked.parents[:2])} == {0o700}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["MainShaft.fmu", "cache"]
