"""The notebooks of the documentation run, and their pages show what they print, return and draw."""

import re
import subprocess
import sys
import traceback
from pathlib import Path

import nbformat
import pytest
from website import contents, notebooks

from loomfmu import cli

SHOWN = {  # words of the outputs, not of the cells
    "how_fast": ("All claims hold from 300 to 646.8164 rev/min", "how_fast_1.png", "<td>0.9</td>"),
    "which_dobby": ("<th>slotted_levers</th>", "<td>holds</td>", "<td>FAILS</td>", "which_dobby_1.png"),
    "measured_trace": ("<td>7.104031 N/mm</td>", "```text\nTrue\n```", "measured_trace_2.png"),
    "other_tool": ("WeftInsertion 2.0", "other_tool_1.png"),
}


@pytest.mark.slow
@pytest.mark.parametrize("path", contents.NOTEBOOKS)
def test_a_notebook_runs_and_its_page_has_its_outputs(
    path: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fmu_cache: None
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["init"]) == 0
    (tmp_path / "measured.csv").write_bytes((contents.ROOT / "docs" / "measured.csv").read_bytes())
    source = contents.ROOT / path
    subprocess.run([sys.executable, notebooks.__file__, source, tmp_path], check=True)
    page = (tmp_path / f"{source.stem}.md").read_text()
    for words in SHOWN[source.stem]:
        assert words in page
    nbformat.validate(nbformat.read(tmp_path / f"{source.stem}.ipynb", as_version=4))
    if source.stem == "other_tool":
        found = re.search(r"largest difference of the travel: (\d\S+) m", page)
        assert found and float(found[1]) < 1e-13  # rounding: the travel is 2 m


@pytest.mark.parametrize("path", contents.NOTEBOOKS)
def test_the_links_of_a_notebook_lead_somewhere(path: str) -> None:
    source = contents.ROOT / path
    text = "\n".join(each for each, code in notebooks.cells(source.read_text()) if not code)
    for link in re.findall(r"\]\(([^)\s#]+)", text):
        assert link.startswith("https://") or (source.parent / link).exists(), link


NOTEBOOK = """# %% [markdown]
# # Title
#
# Text.

# %%
print("said")
value = 1 / 4
value

# %%
class Shown:
    def _repr_html_(self):
        return "<style>a\\n\\n{}</style><b>\\n\\nbold</b><table border=1 class=a><tr style=b></tr></table>"

Shown()

# %%
from matplotlib import pyplot

pyplot.plot([1, 2])
"""


def test_outputs_follow_their_cells(tmp_path: Path) -> None:
    path = tmp_path / "small.py"
    path.write_text(NOTEBOOK)
    (tmp_path / "out").mkdir()
    notebooks.write(path, notebooks.run(NOTEBOOK, "small"), tmp_path / "out")
    page = (tmp_path / "out" / "small.md").read_text()
    assert page.startswith("# Title\n\nText.\n\n```python\nprint(")
    assert "value\n```\n\n```text\nsaid\n```\n\n```text\n0.25\n```\n" in page
    assert '<div class="output">\n<b>\nbold</b><table><tr></tr></table>\n</div>' in page
    assert (tmp_path / "out" / "small_1.png").read_bytes()[:4] == b"\x89PNG" and "(small_1.png)" in page
    kept = nbformat.read(tmp_path / "out" / "small.ipynb", as_version=4)
    nbformat.validate(kept)
    assert [len(cell.get("outputs", [])) for cell in kept.cells] == [0, 2, 1, 1]


def test_an_error_ends_it_and_names_its_cell() -> None:
    with pytest.raises(ZeroDivisionError) as error:
        notebooks.run("# %% [markdown]\n# a\n\n# %%\n1 / 0\n", "small")
    assert 'File "small, cell 2"' in "".join(traceback.format_exception(error.value))
