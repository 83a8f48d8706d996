"""The small packages that `make foreign` tries: our runs give the values by hand."""

import os
from pathlib import Path
from xml.etree.ElementTree import fromstring

import packages
import pytest
from small_packages import SMALL

from loomfmu import LoomfmuError
from loomfmu.cosim.ssp import read
from loomfmu.cosim.ssp.xml import full

REFUSED = {"transformation of an integer", "mapping of a yes-or-no value"}  # which are right


@pytest.mark.parametrize("name", SMALL)
def test_it_is_a_structure(name: str) -> None:
    root = fromstring(SMALL[name].structure)
    assert root.tag == full("ssd:SystemStructureDescription") and root.find(full("ssd:System")) is not None


def test_ours_give_the_values_by_hand(tmp_path: Path) -> None:
    folders = [Path(each) for each in filter(None, os.environ.get("FOREIGN_FMUS", "").split(":"))]
    made = packages.small(folders, tmp_path)
    if not made:
        pytest.skip("FOREIGN_FMUS names no folder with those of Reference-FMUs")
    for name, path in made.items():
        wanted = SMALL[name].expected
        if isinstance(wanted, str) or name in REFUSED:
            with pytest.raises(LoomfmuError):
                read.load(path)
        else:
            found = packages.ours(read.load(path), tmp_path)
            assert found[packages.plain(SMALL[name].signal)][-1] == pytest.approx(wanted, rel=1e-12), name
