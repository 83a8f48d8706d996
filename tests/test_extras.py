"""What needs an extra says so in one line, before it begins; everything else works without extras."""

import ast
import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import base_install
import pytest
from packaging.requirements import Requirement

from loomfmu import commands
from loomfmu.cosim.claims import judging
from loomfmu.extras import EXTRAS
from loomfmu.fmi.native import libraries, platforms

ROOT = Path(__file__).parents[1]
SCENE = """
revolutions = 1
steps_per_revolution = 90
[loom]
machine = "WL680-3600"
head = "G6300 left"
[[claims]]
kind = "lowest_margin"
bound = 0.1
"""
SWEEP = 'scene = "scene.toml"\n[grid]\n"shaft.speed" = ["500 rpm"]\n'
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
BASE = {Requirement(text).name for text in PROJECT["dependencies"]}
FILES = {
    "scene.toml": SCENE,
    "sweep.toml": SWEEP,
    "map.toml": f'{SWEEP}[map]\nx = "shaft.speed"\nvalue = "claim_1.worst"\n',
    "matters.toml": 'scene = "scene.toml"\n[sensitivity]\nsamples = 4\n'
    '"shaft.speed" = ["500 rpm", "600 rpm"]\n',
    "study.toml": 'scene = "scene.toml"\nmaximise = "shaft.speed"\n'
    '[ranges]\n"shaft.speed" = ["500 rpm", "600 rpm"]\n',
    "data.csv": "shaft_angle [deg],belt.length_factor [1]\n"
    + "".join(f"{x},0.8\n" for x in range(0, 300, 20)),
}
FIT = "fit scene.toml data.csv --vary belt.guide_clearance=0.2mm..0.4mm"
LIMIT = "limit scene.toml --vary shaft.speed=590rpm..610rpm --points 3"
TOLERANCES = "tolerances scene.toml --vary belt.guide_clearance=0.2mm..0.3mm"
OUTCOMES = {  # of commands and calls: their exit status, or the extras that they need
    "run scene.toml": 0,
    "run scene.toml --report": "report",
    "show results/scene.h5": 0,
    "report results/scene.h5": "report",
    "page scene.toml": "report,native",
    "diagram results/scene.h5": 0,
    "diagram results/scene.h5 --output diagram.png": "plot",
    "plot results/scene.h5 belt.margin": "plot",
    "compare results/scene.h5 results/scene.h5": 0,
    "compare results/scene.h5 results/scene.h5 --report compared.html": "report",
    "sweep sweep.toml": "sweep",
    "sweep map.toml": "sweep,plot",
    "sweep matters.toml": "sweep,study",
    LIMIT: 0,
    f"{LIMIT} --output limits.csv": 0,
    f"{LIMIT} --output limits.png": "plot",
    TOLERANCES: 0,
    f"{TOLERANCES} --picture worst.svg": "plot",
    "optimize study.toml": "study",
    "optimize study.toml --scheduler tcp://localhost:1": "study,sweep",
    FIT: 0,
    f"{FIT} --output fitted.toml": "study",
    f"{FIT} --picture fitted.svg": "plot",
    "list": 0,
    "init examples --all": 0,
    "new PickingCam": 0,
    "build MainShaft": 0,
    "build MainShaft --native --platform linux64 --output native": "native",
    "export scene.toml --ssp scene.ssp": 0,
    "export scene.toml --fmu scene.fmu": "native",
    "cache": 0,
    "Trace.plot": "plot",
    "Trace.to_xarray": "xarray",
    "Result.report": "report",
    "evaluate": 0,
    "sweep": "sweep",
    "optimize": "study",
    "write_dxf": "cam",
    "dir": 0,
}


def imported(path: Path) -> set[str]:
    """The packages that a file imports, anywhere in it, but for the type checker."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {each.name.partition(".")[0] for each in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found.add(str(node.module).partition(".")[0])
    return found


def test_extras_are_what_the_project_declares() -> None:
    imported_as = {"python-flint": "flint"}
    extras = {
        extra: {imported_as.get(name, name) for name in (Requirement(text).name for text in texts)}
        for extra, texts in PROJECT["optional-dependencies"].items()
    }
    assert {extra: set(packages) for extra, packages in EXTRAS.items()} == {
        extra: packages - BASE for extra, packages in extras.items() if extra in EXTRAS
    }
    whole = Requirement(PROJECT["optional-dependencies"]["all"][0])
    assert whole.extras == set(EXTRAS)
    assert set(extras) - set(EXTRAS) == {"all", "foreign", "site", "test"}


def test_what_the_package_imports_is_installed_with_it_or_with_an_extra() -> None:
    files = [path for path in (ROOT / "src" / "loomfmu").rglob("*.py") if "template" not in path.parts]
    found = set().union(*map(imported, files)) - set(sys.stdlib_module_names) - {"loomfmu"}
    brought = {"markdown_it": "markdown-it-py", "zlib_ng": "zlib-ng", "PIL": "matplotlib"}
    names = {brought.get(name, name) for name in found}
    assert names - BASE - {"pytest"} <= set(sum(EXTRAS.values(), ()))


def outcomes(folder: Path, lines: Iterable[str], *shipped: Path) -> dict[str, Any]:
    """The outcomes of commands and calls, where a package brings libraries in a folder, or none."""
    for name, text in FILES.items():
        (folder / name).write_text(text)
    done = subprocess.run(
        [sys.executable, base_install.__file__, *shipped],
        cwd=folder,
        input=json.dumps(list(lines)),
        capture_output=True,
        text=True,
        check=True,
    )
    found = {}
    for line, (status, said) in zip(lines, json.loads(done.stdout), strict=True):
        named = re.fullmatch(r'[^\n]+ needs? [^\n]*: pip install "loomfmu\[([a-z,]+)\]"', said)
        found[line] = named[1] if named and status == 2 else status if status != 2 else said
    return found


@pytest.mark.no_cover
@pytest.mark.usefixtures("fmu_cache")
def test_without_library_and_compiler_only_claims_are_refused(tmp_path: Path) -> None:
    (tmp_path / "plain.toml").write_text(SCENE.partition("[[claims]]")[0])
    expected = {"run scene.toml": "native", "evaluate": "native", "run plain.toml": 0}
    assert outcomes(tmp_path, expected) == expected


@pytest.mark.slow
@pytest.mark.no_cover
@pytest.mark.usefixtures("fmu_cache")
def test_without_extras_everything_works_or_names_what_it_needs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(platforms, "SHIPPED", tmp_path / "shipped")
    libraries.build_all([judging.SOURCE], [platforms.host()])  # as a wheel brings it
    assert outcomes(tmp_path, OUTCOMES, tmp_path / "shipped") == OUTCOMES
    known = next(each.choices for each in commands.parser()._actions if each.dest == "command")
    tried = {line.partition(" ")[0] for line in OUTCOMES} - set(base_install.CALLS)
    assert tried == set(known or ()) - {"sweep", "optimize"}
    assert set(EXTRAS) == set(
        ",".join(each for each in OUTCOMES.values() if isinstance(each, str)).split(",")
    )
