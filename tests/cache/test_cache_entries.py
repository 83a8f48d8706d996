"""What the cache holds is what was put there: to the last byte, whoever wrote it, however often at once."""

import hashlib
import os
import re
import shutil
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import pytest

from loomfmu import LoomfmuError, cli
from loomfmu.cache import entries
from loomfmu.cache.entries import FMUS, UNPACKED, folder, made_file
from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing import fmus
from loomfmu.cosim.master import steppers
from loomfmu.fmi.native.libraries import library_of

SIMS = Path(__file__).parents[2] / "sims"
SCENE = SIMS / "belt_alone.toml"
KEY = "0" * 64
FILES = {"a.txt": b"one", "deep/er/b.txt": b"two", "empty/": b""}
unix = pytest.mark.skipif(sys.platform == "win32", reason="owners, modes and links are those of Unix")


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("LOOMFMU_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def entry() -> Path:
    return folder(UNPACKED, KEY, FILES, FILES.__getitem__)


def listed(top: Path) -> dict[str, bytes]:
    return {
        path.relative_to(top).as_posix() + "/" * path.is_dir(): b"" if path.is_dir() else path.read_bytes()
        for path in top.rglob("*")
    }


WHOLE = {**FILES, "deep/": b"", "deep/er/": b""}
DAMAGES = {
    "a changed file": lambda top: (top / "a.txt").write_bytes(b"ONE"),
    "a longer file": lambda top: (top / "a.txt").write_bytes(b"one and more"),
    "a missing file": lambda top: (top / "deep/er/b.txt").unlink(),
    "a missing folder": lambda top: shutil.rmtree(top / "deep"),
    "a file too many": lambda top: (top / "deep/json.py").write_bytes(b"import os"),
    "a folder too many": lambda top: (top / "deep/__pycache__").mkdir(),
    "a file in the place of a folder": lambda top: [shutil.rmtree(top / "deep"), (top / "deep").touch()],
    "a folder in the place of a file": lambda top: [(top / "a.txt").unlink(), (top / "a.txt").mkdir()],
}


@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES)
def test_a_damaged_entry_is_put_right(damage) -> None:
    top = entry()
    assert listed(top) == WHOLE
    damage(top)
    assert listed(top) != WHOLE
    assert entry() == top
    assert listed(top) == WHOLE


@pytest.mark.parametrize("place", [UNPACKED, f"{UNPACKED}/{KEY}", "partial"])
def test_a_file_in_the_place_of_a_folder_of_the_cache_is_replaced(own_cache: Path, place: str) -> None:
    entry()
    shutil.rmtree(own_cache / place)
    (own_cache / place).write_text("not a folder")
    assert cli.main(["cache"]) == 0
    assert listed(entry()) == WHOLE
    (own_cache / UNPACKED / KEY / "a.txt").unlink()
    assert listed(entry()) == WHOLE


@unix
@pytest.mark.parametrize("place", ["a.txt", "deep", "."])
def test_links_are_not_followed(tmp_path: Path, place: str) -> None:
    """The same content today may be another one when it is run."""
    top = entry()
    aside = shutil.move(top / place, tmp_path / "aside") and tmp_path / "aside"
    (top / place).symlink_to(aside)
    assert entry() == top
    assert listed(top) == WHOLE
    assert not (top / place).is_symlink() and aside.exists()


@unix
@pytest.mark.parametrize("place", ["a.txt", "deep", ".", ".."])
def test_what_others_can_write_to_is_made_anew(place: str) -> None:
    top = entry()
    before = (top / place).stat().st_ino
    held = os.open(top / place, os.O_RDONLY)  # else its number might be given again
    (top / place).chmod(0o777)
    assert entry() == top
    assert listed(top) == WHOLE
    assert (top / place).stat().st_mode & 0o022 == 0
    assert (top / place).stat().st_ino != before
    os.close(held)


def test_a_made_file_is_made_once_and_again_where_it_is_damaged() -> None:
    made = []

    def make() -> bytes:
        made.append(1)
        return b"content"

    path = made_file(FMUS, KEY, "x.fmu", make)
    assert made_file(FMUS, KEY, "x.fmu", make) == path and len(made) == 1
    path.write_bytes(b"other")
    assert made_file(FMUS, KEY, "x.fmu", make).read_bytes() == b"content" and len(made) == 2
    path.with_name("sha256").unlink()
    assert made_file(FMUS, KEY, "x.fmu", make).read_bytes() == b"content" and len(made) == 3


@pytest.mark.parametrize("name", ["../x", "/x", "a/../../x", "a\\x", "C:x"])
def test_an_fmu_with_a_member_outside_of_it_is_refused(tmp_path: Path, name: str) -> None:
    with zipfile.ZipFile(tmp_path / "bad.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", "")
        archive.writestr(name, "anything")
    with pytest.raises(
        LoomfmuError, match=r"bad\.fmu: not a readable FMU \(its member .* lies outside of it"
    ):
        fmus.load(tmp_path / "bad.fmu")
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] == ["bad.fmu"]


# ---- what is run


def run(cache: Path, *options: str) -> str:
    """Two FMUs in a process of its own; what it printed but for how long it took and what it replaced."""
    done = subprocess.run(
        [sys.executable, "-m", "loomfmu.cli", "run", SCENE, "--output", cache / "x.h5", *options],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    return "".join(
        line for line in done.stdout.splitlines(True) if not re.search(" us each; |^replaced: ", line)
    )


def test_what_was_changed_in_an_unpacked_fmu_is_put_right_when_it_is_read() -> None:
    path = fmus.file_of(COMPONENTS["MainShaft"], "live", ())
    (unpacked,) = fmus.load(path).directory.glob("resources/*/component.py")
    clean, planted = unpacked.read_bytes(), unpacked.parents[1] / "math.py"
    unpacked.write_bytes(clean + b"1 / 0\n")
    planted.touch()  # an FMU's resources come first in Python's path
    assert fmus.load(path).directory in planted.parents
    assert unpacked.read_bytes() == clean and not planted.exists()


@pytest.mark.slow
def test_a_line_added_to_an_unpacked_live_fmu_is_not_run(own_cache: Path, tmp_path: Path) -> None:
    said, mark = run(own_cache, "--live"), tmp_path / "was run"
    (unpacked,) = own_cache.glob("unpacked/*/resources/*beltmonitor*/component.py")
    clean = unpacked.read_bytes()
    unpacked.write_bytes(clean + f"open({str(mark)!r}, 'w')\n".encode())
    planted = unpacked.parents[1] / "math.py"
    planted.write_text(f"open({str(mark)!r}, 'w')\n")
    assert run(own_cache, "--live") == said
    assert not mark.exists() and not planted.exists()
    assert unpacked.read_bytes() == clean


@pytest.mark.slow
def test_no_bytecode_lies_beside_the_source_that_is_checked(own_cache: Path) -> None:
    run(own_cache, "--live")
    assert list(own_cache.rglob("*.py")) and not list(own_cache.rglob("*.pyc"))


@pytest.mark.slow
def test_a_native_library_that_was_exchanged_is_not_run(own_cache: Path) -> None:
    pytest.importorskip("ziglang", reason="ziglang is not installed: no native FMU can be built")
    said = run(own_cache, "--native")
    libraries = [path for path in own_cache.rglob("*") if path.suffix in (".so", ".dll", ".dylib")]
    assert {path.stem for path in libraries} == {"WeftInsertion", "BeltMonitor", "stepper", "judge"}
    clean = [path.read_bytes() for path in libraries]
    for path, content in zip(libraries, clean, strict=True):
        path.write_bytes(content[:-9] + b"\0" * 9)
    built = next(own_cache.glob("fmus/*/BeltMonitor.fmu"))
    built.write_bytes(b"nonsense")
    assert run(own_cache, "--native") == said
    assert [path.read_bytes() for path in libraries] == clean  # the same source gives the same bytes


def test_a_damaged_stepper_is_built_again(own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("ziglang", reason="ziglang is not installed")
    kept = library_of.__wrapped__(steppers.SOURCE)
    if kept is None or own_cache not in kept.parents:
        pytest.skip("the package brings its stepper")
    clean = kept.read_bytes()
    kept.write_bytes(clean[:100])
    assert library_of.__wrapped__(steppers.SOURCE) == kept
    assert kept.read_bytes() == clean


COLD = """
import sys, time
from pathlib import Path
from loomfmu.cosim.ssp import read
while not Path(sys.argv[2]).exists():
    time.sleep(0.001)
scene = read.load(Path(sys.argv[1]))
print(sorted(each.fmu.sha256 for each in scene.instances.values()))
"""


@pytest.mark.slow
def test_six_cold_starts_of_one_package_at_once(own_cache: Path, tmp_path: Path) -> None:
    assert cli.main(["export", str(SCENE), "--ssp", str(tmp_path / "x.ssp"), "--flavour", "live"]) == 0
    shutil.rmtree(own_cache)
    command = [sys.executable, "-c", COLD, str(tmp_path / "x.ssp"), str(tmp_path / "go")]
    started = [
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(6)
    ]
    time.sleep(1.0)  # most of them stand ready by then
    (tmp_path / "go").touch()
    said = [process.communicate(timeout=300) for process in started]
    assert [error for _, error in said] == [""] * 6
    assert len({output for output, _ in said}) == 1
    assert list(own_cache.glob("partial/*")) == []


# ---- all entries


def test_an_entry_in_use_is_kept(own_cache: Path) -> None:
    top = entry()
    os.utime(top, (0, 0))
    entry()
    assert time.time() - top.stat().st_mtime < entries.DAY


def test_the_command_shows_the_cache_and_empties_it(
    own_cache: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made_file(FMUS, hashlib.sha256(b"x").hexdigest(), "x.fmu", lambda: bytes(3_000_000))
    (own_cache / "notes.txt").write_text("mine")
    assert cli.main(["cache"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0] == f"{own_cache}: 3.0 MB, 1 entries"
    assert said[1].split() == ["fmus", "3.0", "MB", "1", "entries"]
    assert cli.main(["cache", "--clear"]) == 0
    assert capsys.readouterr().out.startswith(f"{own_cache}: 0.0 MB, 0 entries\n")
    assert [path.name for path in own_cache.rglob("*") if path.is_file()] == ["notes.txt"]


def test_a_folder_that_is_a_link_is_not_emptied(own_cache: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    kept = elsewhere / ("0123456789abcdef" * 2)
    kept.mkdir(parents=True)
    kind = own_cache / "packages"
    shutil.rmtree(kind, ignore_errors=True)
    kind.parent.mkdir(parents=True, exist_ok=True)
    kind.symlink_to(elsewhere)
    entries.clear()
    assert kept.is_dir()


USES = """
import sys
from pathlib import Path
from loomfmu.cache.entries import FMUS, made_file
path = made_file(FMUS, "0" * 64, "x.fmu", lambda: b"content")
print("ready", flush=True)
sys.stdin.readline()
print(path.read_bytes() == b"content", flush=True)
"""


def another_user() -> subprocess.Popen[str]:
    """A process that uses the cache until it reads a line."""
    command = [sys.executable, "-c", USES]
    user = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert user.stdout is not None and user.stdout.readline() == "ready\n"
    return user


@unix
def test_a_cache_that_another_process_uses_is_not_emptied(
    own_cache: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    user = another_user()
    assert cli.main(["cache", "--clear"]) == 2
    assert capsys.readouterr().err == (
        f"loomfmu: {own_cache}: in use by another loomfmu; end it (or its Python session) and try again\n"
    )
    assert user.communicate("\n")[0] == "True\n"
    assert cli.main(["cache", "--clear"]) == 0
    assert "0 entries" in capsys.readouterr().out


@unix
def test_what_long_was_not_used_is_deleted_by_the_next_one_to_use_the_cache_alone(own_cache: Path) -> None:
    fmus_in_it = own_cache / FMUS
    for name in (old := "1" * 64, young := "2" * 64, other := "of_somebody_else"):
        (fmus_in_it / name).mkdir(parents=True)
    for name in (old, other):
        os.utime(fmus_in_it / name, (0, 0))
    first = another_user()
    assert not (fmus_in_it / old).exists()
    (fmus_in_it / old).mkdir()
    os.utime(fmus_in_it / old, (0, 0))  # as what the first one has used for a month
    another_user().communicate("\n")
    assert sorted(path.name for path in fmus_in_it.iterdir()) == sorted([KEY, old, young, other])
    first.communicate("\n")
    another_user().communicate("\n")
    assert sorted(path.name for path in fmus_in_it.iterdir()) == sorted([KEY, young, other])
