"""Brings the references and the masters of the other tests within reach of an import."""

import sys
from pathlib import Path

TESTS = Path(__file__).parents[1]

for folder in (TESTS, TESTS / "foreign", TESTS / "benchmarks"):
    if str(folder) not in sys.path:
        sys.path.append(str(folder))
