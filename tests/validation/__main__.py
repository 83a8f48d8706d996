"""Writes `results/validation.md` and its figures: `make validation`."""

from pathlib import Path

from validation import figures, report

RESULTS = Path(__file__).parents[2] / "results"

(RESULTS / "validation.md").write_text(report.markdown(), encoding="utf-8")
for path in [RESULTS / "validation.md", *figures.write(RESULTS / "validation")]:
    print(path)
