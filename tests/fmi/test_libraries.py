"""A library that a package brings is loaded only if it was built of the very source that lies there."""

import ctypes
import re
from pathlib import Path

import pytest

from loomfmu.fmi.native import compiler, libraries, platforms

pytestmark = pytest.mark.skipif(not platforms.host(), reason="no library is built for this platform")
ROOT = Path(__file__).parents[2]


@pytest.fixture
def brought(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Path, Path]:
    """A source and its library in a package that brings it; any other is built anew."""
    monkeypatch.setattr(platforms, "SHIPPED", tmp_path / "shipped")
    monkeypatch.setenv("LOOMFMU_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(compiler, "library_identity", lambda _source: 64 * "0")
    source = tmp_path / "stepper.c"
    source.write_text("int steps;\n")
    monkeypatch.setattr(compiler, "library", lambda _source, _platform: b"brought")
    libraries.build_all([source], [platforms.host()])
    monkeypatch.setattr(compiler, "library", lambda _source, _platform: b"built anew")
    (library,) = (tmp_path / "shipped").rglob("stepper*" + platforms.PLATFORMS[platforms.host()].suffix)
    return source, library


def test_a_library_that_a_package_brings_is_loaded(brought: tuple[Path, Path]) -> None:
    source, library = brought
    assert libraries.library_of.__wrapped__(source) == library and library.read_bytes() == b"brought"


@pytest.mark.parametrize("change", ["source", "library", "digest", "no digest"])
def test_one_that_does_not_match_its_source_is_not(brought: tuple[Path, Path], change: str) -> None:
    source, library = brought
    digest = library.with_name(f"{library.name}.sha256")
    if change == "no digest":  # an interrupted build
        digest.unlink()
    else:
        changed = {"source": source, "library": library, "digest": digest}[change]
        changed.write_bytes(changed.read_bytes()[:-1])
    found = libraries.library_of.__wrapped__(source)
    assert found != library and found.read_bytes() == b"built anew"


def test_a_machine_for_which_no_fmus_are_built_gets_libraries_of_its_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("ziglang", reason="ziglang is not installed")
    monkeypatch.setattr(platforms, "host", lambda: "")
    monkeypatch.setenv("LOOMFMU_CACHE", str(tmp_path / "cache"))
    (tmp_path / "twice.h").write_text("static int twice(int value) { return 2 * value; }\n")
    source = tmp_path / "four.c"
    source.write_text(
        '#include "twice.h"\n__attribute__((visibility("default"))) int four(void) { return twice(2); }\n'
    )
    assert ctypes.CDLL(str(libraries.needed_library(source))).four() == 4


def test_make_wheel_builds_nothing_in_the_checkout() -> None:
    recipe = re.search(r"^wheel:.*\n((?:\t.*\n)+)", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert recipe is not None
    building = [line for line in recipe[1].splitlines() if "build_all" in line or " wheel " in line]
    assert len(building) == 2 and all("$(COPY)" in line for line in building)
