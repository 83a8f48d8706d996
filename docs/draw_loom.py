"""Draws `loom_side.svg` and `loom_front.svg`, the pictures of the glossary: drawings of a report at rest."""

import re
from pathlib import Path
from tempfile import TemporaryDirectory

import loomfmu
from loomfmu.report.drawings import sections
from loomfmu.report.section import Subject
from loomfmu.report.templates import text

HERE = Path(__file__).parent
SCENE = HERE.parent / "sims" / "full_loom.toml"
FIGURES = {"motion-side": "loom_side.svg", "motion-front-transfer": "loom_front.svg"}
USED = (  # of the page's style: its colours on paper, the roles that have them, and how parts are drawn
    r"^(?::root \{.*?^\}|\.\w+ \{ --role: [^\n]*"
    r"|\.motion (?:\.(?!waits|stale|wide)|text|\[|:is\(poly).*?\}(?=\n))"
)
ROOT = ".motion { font-family: sans-serif; background: var(--panel); }"


def drawn(html: str, figure: str) -> str:
    """Return the drawing of a figure of the page as a file of its own."""
    found = re.search(rf'<figure id="{figure}">.*?(<svg.*?</svg>)', html, re.DOTALL)
    assert found, figure
    style = "\n".join(re.findall(USED, text("style.css"), re.DOTALL | re.MULTILINE))
    plain = re.sub(r' data-\w+="[^"]*"', "", found[1].replace(" hidden>", ' hidden="">'))
    opened = f'<svg xmlns="http://www.w3.org/2000/svg" class="motion"><style>\n{ROOT}\n{style}\n</style>'
    return re.sub(r"<svg([^>]*)>", lambda tag: opened.replace(">", f"{tag[1]}>", 1), plain, count=1) + "\n"


def main() -> None:
    """Draw the loom with every mechanism, where its report opens."""
    with TemporaryDirectory() as folder:
        trace = loomfmu.run(SCENE, output=Path(folder) / "loom.h5").trace
        html = sections(Subject([trace]))[0].html
    for figure, name in FIGURES.items():
        (HERE / name).write_text(drawn(html, figure), encoding="utf-8")


if __name__ == "__main__":
    main()
