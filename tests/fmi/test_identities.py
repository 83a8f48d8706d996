"""What tells one build of our FMUs from another."""

import json
from pathlib import Path

import pytest

from loomfmu.components import COMPONENTS
from loomfmu.components.main_shaft import MainShaft
from loomfmu.fmi import identities, live_fmu
from loomfmu.fmi.native import native_fmu


@pytest.fixture
def anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is remembered of what was read before."""
    for name in ("sources", "_kept", "_shipped"):
        monkeypatch.setattr(identities, name, getattr(identities, name).__wrapped__)


@pytest.mark.parametrize("name", COMPONENTS)
def test_what_is_kept_is_what_would_be_computed(name: str) -> None:
    component = COMPONENTS[name]
    kept = identities.identity(component)
    assert kept["guid"] == live_fmu.guid(component)
    assert kept["live"].startswith(kept["guid"])
    assert kept["native"].startswith(native_fmu.identity(component))


@pytest.mark.usefixtures("anew")
def test_every_source_counts(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    before = identities.sources()
    folders = {
        "components": "cam.py",
        "declaring": "array.py",
        "physics": "law.py",
        "fmi/native/shell": "shell.c",
    }
    files = [part for part in identities.PARTS if part.endswith(".py")]
    for part, file in folders.items():
        (tmp_path / part).mkdir(parents=True)
        (tmp_path / part / file).write_text("1")
    for part in files:
        (tmp_path / part).write_text("1")
    monkeypatch.setattr(identities, "documents", lambda: tmp_path / "fmus")
    monkeypatch.setattr(identities, "PACKAGE", tmp_path)
    found = {before, identities.sources()}
    for file in sorted(tmp_path.rglob("*.*")):
        file.write_text("2")
        found.add(identities.sources())
    (tmp_path / "fmus/cam").mkdir(parents=True)
    (tmp_path / "fmus/cam/README.md").write_text("1")
    found.add(identities.sources())
    assert len(found) == 2 + len(folders) + len(files) + 1


@pytest.mark.usefixtures("anew")
def test_what_a_package_brings_is_not_used_once_its_sources_have_changed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(identities, "SHIPPED", tmp_path)
    assert identities.shipped(MainShaft) is None
    (tmp_path / "fmi2").mkdir()
    (tmp_path / "fmi2/MainShaft.fmu").write_bytes(b"")
    identities.write(tmp_path)
    assert identities.shipped(MainShaft) == tmp_path / "fmi2/MainShaft.fmu"
    assert identities.shipped(MainShaft, fmi=3) is None
    kept = json.loads((tmp_path / "identities.json").read_bytes())
    for damaged in (json.dumps(kept | {"sources": "others"}), "{", "[]", "{}"):
        (tmp_path / "identities.json").write_text(damaged)
        assert identities.shipped(MainShaft) is None
