"""The packages that are installed with this one."""

import re
import tomllib
from importlib import metadata
from pathlib import Path

import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

import loomfmu

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PINNED = re.compile(r"^([A-Za-z0-9_.-]+)==(\S+)", re.MULTILINE)


def pins(name: str) -> dict[str, str]:
    """The version of each package."""
    return dict(PINNED.findall((ROOT / "pins" / name).read_text(encoding="utf-8")))


def test_the_pins_are_what_is_asked_for() -> None:
    extras = [text for extra in PROJECT["optional-dependencies"].values() for text in extra]
    for name, texts in (("run.txt", PROJECT["dependencies"]), ("test.txt", extras)):
        for text in texts:
            required = Requirement(text)
            if required.name != "loomfmu":
                assert pins(name)[canonicalize_name(required.name)] in required.specifier, text


def test_both_lists_pin_the_same_versions() -> None:
    assert pins("run.txt").items() <= pins("test.txt").items()


def test_every_file_of_a_package_has_a_hash() -> None:
    text = (ROOT / "pins" / "test.txt").read_text(encoding="utf-8")
    packages = re.split(r"^(?=\w)", text, flags=re.MULTILINE)[1:]
    assert len(packages) == len(PINNED.findall(text))  # some twice: for older and for newer Pythons
    assert [each for each in packages if "--hash=sha256:" not in each] == []


def test_all_of_them_are_free_software() -> None:
    found = []
    for name in pins("test.txt"):
        try:
            described = metadata.metadata(name)
        except metadata.PackageNotFoundError:  # of another platform or another Python
            continue
        licences = [each for each in described.get_all("Classifier", []) if each.startswith("License")]
        licences += (described.get("License") or "").splitlines()[:1]  # some have the whole text there
        if any(word in " ".join(licences) for word in ("Proprietary", "Intel Simplified")):
            found.append(name)
    assert found == []


def test_the_citation_names_this_version_and_licence() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["version"] == loomfmu.__version__
    assert (citation["license"], citation["keywords"]) == (PROJECT["license"], PROJECT["keywords"])


def test_the_workflow_tries_every_python_that_the_package_is_for() -> None:
    workflow = (ROOT / ".github" / "workflows" / "check.yml").read_text(encoding="utf-8")
    matrix = yaml.safe_load(workflow)["jobs"]["test"]["strategy"]["matrix"]
    assert f">={matrix['python'][0]}" == PROJECT["requires-python"]
