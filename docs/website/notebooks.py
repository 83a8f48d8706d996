"""Runs a notebook and writes it with its outputs, as a page of the site and as a Jupyter notebook.

A notebook is a Python file of cells, in the format "percent" that Jupytext, VS Code and Spyder read too: a
cell begins with `# %%`, one of text with `# %% [markdown]`. The site's build calls this as a program of its
own for each, in a folder with the example scenes.
"""

import ast
import base64
import contextlib
import io
import json
import re
import shutil
import sys
from pathlib import Path
from typing import Any, NamedTuple

CELL = re.compile(r"^# %%( \[markdown\])?\n", re.MULTILINE)
KERNEL = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}


class Cell(NamedTuple):
    """A cell: its text, whether that is code, and its outputs by their MIME types."""

    text: str
    code: bool
    outputs: list[dict[str, str]]


def cells(text: str) -> list[tuple[str, bool]]:
    """The text of each cell of a notebook, and whether it is code."""
    _before, *parts = CELL.split(text)
    found = []
    for mark, body in zip(parts[::2], parts[1::2], strict=True):
        shown = body.strip("\n") if not mark else re.sub(r"^# ?", "", body.strip("\n"), flags=re.MULTILINE)
        found.append((shown, not mark))
    return found


def run(text: str, name: str) -> list[Cell]:
    """Run all cells of a notebook, in order."""
    import matplotlib

    matplotlib.use("agg")
    names: dict[str, Any] = {"__name__": "__main__"}
    return [
        Cell(each, code, _outputs(each, f"{name}, cell {place}", names) if code else [])
        for place, (each, code) in enumerate(cells(text), 1)
    ]


def _outputs(text: str, name: str, names: dict[str, Any]) -> list[dict[str, str]]:
    """What a cell prints, the value of its last line and the figures that it draws."""
    from matplotlib import pyplot

    tree, printed, value = ast.parse(text), io.StringIO(), None
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, name, "exec"), names)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), name, "eval"), names)
    found = [{"text/plain": printed.getvalue()}] if printed.getvalue() else []
    figures = [pyplot.figure(number) for number in pyplot.get_fignums()]
    if value is not None and not figures:
        shown = getattr(value, "_repr_html_", lambda: None)()
        found.append({"text/plain": repr(value)} | ({"text/html": shown} if shown else {}))
    for figure in figures:
        drawn = io.BytesIO()
        figure.savefig(drawn, format="png", dpi=96, bbox_inches="tight")
        found.append({"text/plain": "a figure", "image/png": base64.b64encode(drawn.getvalue()).decode()})
    pyplot.close("all")
    return found


def page(name: str, ran: list[Cell], folder: Path) -> str:
    """The notebook as Markdown; its figures are written into a folder."""
    parts, figures = list[str](), 0
    for cell in ran:
        parts.append(f"```python\n{cell.text}\n```" if cell.code else cell.text)
        for output in cell.outputs:
            if "image/png" in output:
                figures += 1
                (folder / f"{name}_{figures}.png").write_bytes(base64.b64decode(output["image/png"]))
                parts.append(f"![Figure {figures}]({name}_{figures}.png)")
            elif "text/html" in output:
                plain = re.sub(r"<style.*?</style>", "", output["text/html"], flags=re.DOTALL)
                plain = re.sub(r"<(table|tr)\b[^>]*>", r"<\1>", plain)  # as the site's other tables
                lines = filter(str.strip, plain.splitlines())  # a blank one ends HTML in Markdown
                parts.append('<div class="output">\n' + "\n".join(map(str.strip, lines)) + "\n</div>")
            else:
                parts.append(f"```text\n{output['text/plain'].rstrip()}\n```")
    parts.append(f"[As a Jupyter notebook]({name}.ipynb), [as text]({name}.py)")
    return "\n\n".join(parts) + "\n"


def jupyter(ran: list[Cell]) -> str:
    """The notebook in Jupyter's own format, with its outputs."""
    made = []
    for place, cell in enumerate(ran, 1):
        common = {"id": f"cell-{place}", "metadata": {}, "source": cell.text.splitlines(keepends=True)}
        outputs = [{"output_type": "display_data", "metadata": {}, "data": each} for each in cell.outputs]
        code = {"cell_type": "code", "execution_count": place, "outputs": outputs}
        made.append((code if cell.code else {"cell_type": "markdown"}) | common)
    whole = {"cells": made, "metadata": KERNEL, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(whole, indent=1) + "\n"


def write(path: Path, ran: list[Cell], folder: Path) -> None:
    """Write a notebook into a folder: as Markdown, in Jupyter's own format, and as it is."""
    (folder / f"{path.stem}.md").write_text(page(path.stem, ran, folder), encoding="utf-8")
    (folder / f"{path.stem}.ipynb").write_text(jupyter(ran), encoding="utf-8")
    shutil.copy(path, folder)


def main(source: str, folder: str) -> None:
    """Run a notebook in this folder, and write it with its outputs into another one."""
    path = Path(source)
    write(path, run(path.read_text(encoding="utf-8"), path.stem), Path(folder))


if __name__ == "__main__":
    main(*sys.argv[1:])
