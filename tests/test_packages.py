"""The packages that are installed with this one."""

from importlib import metadata
from pathlib import Path

PINS = Path(__file__).parents[1] / "constraints.txt"


def test_all_of_them_are_free_software() -> None:
    found = []
    for line in PINS.read_text().splitlines():
        try:
            described = metadata.metadata(line.partition("==")[0])
        except metadata.PackageNotFoundError:  # of another platform or another Python
            continue
        licences = [each for each in described.get_all("Classifier", []) if each.startswith("License")]
        licences += (described.get("License") or "").splitlines()[:1]  # some have the whole text there
        if any(word in " ".join(licences) for word in ("Proprietary", "Intel Simplified")):
            found.append(line)
    assert found == []
