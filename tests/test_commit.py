"""The commit that stands in traces."""

import shutil
import subprocess
from pathlib import Path

import pytest

from loomfmu.commit import FILE, commit


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package in src of a folder that is no repository."""
    made = tmp_path / "src" / "package"
    made.mkdir(parents=True)
    (made / "module.py").write_text("A = 1\n")
    return made


def git(folder: Path, *words: str) -> str:
    who = ("-c", "user.name=n", "-c", "user.email=n@example.org")
    return subprocess.run(
        ["git", *who, *words], cwd=folder, check=True, capture_output=True, text=True
    ).stdout.strip()


@pytest.mark.skipif(not shutil.which("git"), reason="git is not installed")
def test_a_checkout_knows_its_commit_and_whether_it_was_changed(
    package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def told() -> str:
        commit.cache_clear()
        return commit(package)

    root = package.parents[1]
    assert told() == ""
    git(root, "init", "-q")
    assert told() == ""
    git(root, "add", ".")
    git(root, "commit", "-q", "-m", "first")
    head = git(root, "rev-parse", "HEAD")
    (root / "notes.txt").write_text("outside of the package")
    assert told() == head
    (package / "new.py").write_text("")
    assert told() == f"{head}, changed"
    (package / "new.py").unlink()
    (package / "module.py").write_text("A = 2\n")
    assert told() == f"{head}, changed"
    monkeypatch.setenv("GIT_DIR", str(Path(__file__).parents[1] / ".git"))
    assert told() == f"{head}, changed"
    monkeypatch.setenv("PATH", "")
    assert told() == ""


def test_an_installed_package_has_that_of_its_file_alone(package: Path, tmp_path: Path) -> None:
    (tmp_path / ".git").mkdir()  # of another project, in whose folder the package lies
    installed = package.rename(tmp_path / "installed")
    assert commit(installed) == ""
    commit.cache_clear()
    (installed / FILE).write_text("abc\n")
    assert commit(installed) == "abc"
