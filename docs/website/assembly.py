"""Lays out what MkDocs reads: the pages as they lie in the repository, so that their links stay as they are.

Four things change: equations in fences become MathML, lists within lists are indented as MkDocs expects,
notebooks are run and shown with their outputs, and a marker such as
`<!-- site: loomfmu run x.toml --report > results/x.html -->` becomes what is written, in a frame.
"""

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import yaml

from loomfmu.fmi.description import equations

from . import contents, notebooks, reference

HERE = Path(__file__).parent
FENCE = re.compile(r"^```.*?^```$", re.DOTALL | re.MULTILINE)
EQUATIONS = re.compile(r"^```\n(.*?)^```$", re.DOTALL | re.MULTILINE)
NESTED = re.compile(r"^((?: {2})+)(?=(?:[-*]|\d+\.) )", re.MULTILINE)
LINK = re.compile(r"\]\(([^)\s#]+)(?:#[^)\s]*)?\)")
MARKER = re.compile(r"^<!-- site: (loomfmu .*) > (\S+) -->$", re.MULTILINE)


def assemble(target: Path, run_notebooks: bool = True) -> dict[str, list[str]]:
    """Write pages, the files they link to and the configuration; returns the pages by section.

    Notebooks that are not run, which takes half a minute, are shown without outputs.
    """
    pages = target / "pages"
    shutil.rmtree(target, ignore_errors=True)
    generated = reference.pages()
    sections = contents.sections(list(generated))
    titled = []
    for name, paths in sections.items():
        entries = []
        for path in paths:
            if path in contents.NOTEBOOKS:
                path, text = _notebook(path, pages, run_notebooks)
            elif path in generated:
                text = generated[path]
            else:
                text = (contents.ROOT / path).read_text(encoding="utf-8")
            entries.append({contents.title(text): path})
            if (contents.ROOT / path).exists():
                _copy_linked(path, text, pages)
                text = converted(path, text, pages)
            file = pages / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
        titled.append({name: entries})
    for name in ("style.css", "iframe-worker.js"):
        shutil.copy(HERE / name, pages / name)
    configuration = (HERE / "mkdocs.yml").read_text(encoding="utf-8")
    navigation = yaml.safe_dump({"nav": titled}, sort_keys=False, allow_unicode=True)
    (target / "mkdocs.yml").write_text(f"{configuration}\n{navigation}", encoding="utf-8")
    return sections


def converted(path: str, text: str, pages: Path) -> str:
    """A page of the repository as MkDocs reads it."""
    if path.startswith("fmus/"):
        text = EQUATIONS.sub(lambda block: equations.table(block[1]), text)
    parts = FENCE.split(text)
    fences = [*FENCE.findall(text), ""]
    text = "".join(NESTED.sub(r"\1\1", part) + fence for part, fence in zip(parts, fences, strict=True))
    return MARKER.sub(lambda marker: _frame(path, marker[1], marker[2], pages), text)


def _copy_linked(path: str, text: str, pages: Path) -> None:
    """Take along the files that a page links to; of a folder, a page that lists them."""
    for link in LINK.findall(FENCE.sub("", text)):
        if link.startswith(("http://", "https://")):
            continue
        source = (contents.ROOT / path).parent.joinpath(link).resolve()
        copy = pages / source.relative_to(contents.ROOT)
        if source.is_dir():
            shutil.copytree(source, copy, dirs_exist_ok=True)
        elif source.suffix != ".md":
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, copy)


def _scratch(pages: Path) -> Path:
    """A folder outside of the site with the example scenes."""
    scratch = pages.parent / "scratch"
    scratch.mkdir(parents=True, exist_ok=True)
    init = [sys.executable, "-m", "loomfmu.cli", "init"]
    subprocess.run(init, cwd=scratch, check=True, stdout=subprocess.DEVNULL)
    return scratch


def _notebook(path: str, pages: Path, run: bool) -> tuple[str, str]:
    """Run a notebook beside the example scenes and the measured data; its page, and the text of that."""
    source, scratch, folder = contents.ROOT / path, _scratch(pages), (pages / path).parent
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(contents.ROOT / "docs" / "measured.csv", scratch)
    if run:  # in a program of its own: a notebook may change what it likes
        subprocess.run([sys.executable, HERE / "notebooks.py", source, folder], cwd=scratch, check=True)
    else:
        unrun = [notebooks.Cell(*each, []) for each in notebooks.cells(source.read_text(encoding="utf-8"))]
        notebooks.write(source, unrun, folder)
    page = Path(path).with_suffix(".md")
    return page.as_posix(), (folder / page.name).read_text(encoding="utf-8")


def _frame(path: str, command: str, file: str, pages: Path) -> str:
    """Run a command in a scratch folder; what it writes, linked and in a frame."""
    scratch = _scratch(pages)
    subprocess.run([sys.executable, "-m", "loomfmu.cli", *shlex.split(command)[1:]], cwd=scratch, check=True)
    shown = (pages / path).parent / Path(file).name
    shown.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(scratch / file, shown)
    return (
        f'<p><a href="{shown.name}">Open it on a page of its own</a></p>\n\n'
        f'<iframe class="framed" src="{shown.name}" title="{command}" loading="lazy"></iframe>'
    )
