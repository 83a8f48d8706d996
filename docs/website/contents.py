"""What is on the site and in which order: every page of the repository, with nothing to list twice."""

from pathlib import Path

from loomfmu.components import COMPONENTS
from loomfmu.fmi.fmu_files import folder

ROOT = Path(__file__).parents[2]
HOME, TOUR = "README.md", "docs/tour.md"
REFERENCE = ("docs/command_line.md",)  # beside what `reference` generates
GUIDES = (
    "docs/glossary.md",
    "docs/scenes.md", "docs/claims.md", "docs/how_sure.md", "docs/report.md", "docs/traces.md",
    "docs/sweeps.md", "docs/limits.md", "docs/tolerances.md", "docs/proving.md", "docs/optimizing.md",
    "docs/fitting.md", "docs/python.md", "docs/importing.md", "docs/own_claim.md",
    "docs/own_mechanism.md",
)  # fmt: skip
PROJECT = ("CHANGELOG.md", "SECURITY.md", "THIRD_PARTY.md")
NOTEBOOKS = tuple(
    f"docs/notebooks/{each}.py" for each in ("how_fast", "which_dobby", "measured_trace", "other_tool")
)  # run when the site is built
CONTRIBUTING = (
    "CONTRIBUTING.md",
    *(f"docs/contributing/{each}.md" for each in ("architecture", "components", "tests", "words")),
)


def sections(generated: list[str]) -> dict[str, list[str]]:
    """The pages of each section, by their paths in the repository; `generated` are those of the reference.

    A page in docs/ that no tuple names comes last among the guides.
    """
    docs = [page.relative_to(ROOT).as_posix() for page in sorted((ROOT / "docs").glob("*.md"))]
    placed = {TOUR, *REFERENCE, *GUIDES}
    mechanisms = [folder(each) / "README.md" for each in COMPONENTS.values()]
    return {
        "Start": [HOME, TOUR],
        "Guides": [*GUIDES, *(page for page in docs if page not in placed)],
        "Notebooks": list(NOTEBOOKS),
        "Mechanisms": ["fmus/README.md", *(page.relative_to(ROOT).as_posix() for page in mechanisms)],
        "Reference": [*REFERENCE, *generated],
        "Evidence": ["results/validation.md", "results/benchmarks.md", "results/foreign.md"],
        "Project": list(PROJECT),
        "Contributing": list(CONTRIBUTING),
    }


def title(markdown: str) -> str:
    """The heading of a page."""
    return next(line[2:].strip() for line in markdown.splitlines() if line.startswith("# "))
