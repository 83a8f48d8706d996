"""Where FMUs are kept: where the user says, in the user's cache, or in a temporary one."""

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest
from live_fmus import in_a_process

from loomfmu.cosim.importing import fmus
from loomfmu.fmi import builder
from loomfmu.fmi.cache import cache_directory, compiler_environment

SIMS = Path(__file__).parents[2] / "sims"


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


@pytest.mark.parametrize("flavour", [[], ["--native"]])
def test_a_run_without_a_home_that_can_be_written_takes_a_temporary_one(
    no_home: Path, tmp_path: Path, flavour: list[str]
) -> None:
    if flavour:
        pytest.importorskip("ziglang", reason="ziglang is not installed: no native FMU can be built")
    (tmp_path / "temporary").mkdir()
    done = subprocess.run(
        [sys.executable, "-m", "loomfmu.cli", "run", SIMS / "belt_alone.toml", *flavour, "--output", "x.h5"],
        cwd=tmp_path, env=os.environ | {"TMPDIR": str(tmp_path / "temporary")},
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert list((tmp_path / "temporary").iterdir()) == []  # it has cleared up
    assert sorted(path.name for path in tmp_path.iterdir()) == ["home", "temporary", "x.h5"]


def test_the_processes_of_a_run_share_the_temporary_one(no_home: Path, tmp_path: Path) -> None:
    text = in_a_process(
        """
import multiprocessing
from loomfmu.fmi.cache import cache_directory
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
    assert "ZIG_GLOBAL_CACHE_DIR" not in compiler_environment()


@pytest.mark.skipif(sys.platform == "win32", reason="modes of files are those of Unix")
@pytest.mark.parametrize("mask", [0o022, 0o027])
def test_files_are_as_open_to_others_as_the_umask_lets_them_be(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mask: int
) -> None:
    monkeypatch.setenv("LOOMFMU_CACHE", str(tmp_path / "cache"))
    before = os.umask(mask)
    try:
        made = builder.build("MainShaft", tmp_path)
        unpacked = fmus.load(made).directory
    finally:
        os.umask(before)
    assert stat.S_IMODE(made.stat().st_mode) == 0o666 & ~mask
    assert stat.S_IMODE(unpacked.stat().st_mode) == 0o777 & ~mask
    assert sorted(path.name for path in tmp_path.iterdir()) == ["MainShaft.fmu", "cache"]
