"""Benchmarks: `python tests/benchmarks [NAME...] [--quick] [--output DIR]`, all of them by default."""

import argparse
import sys
from pathlib import Path

import neighbours  # noqa: F401  the modules of the other tests
from records import ROOT, say
from running import run
from written import BENCHMARKS, write


def main() -> int:
    """Run what was asked for and write the report; 1 if one of them failed."""
    options = _parser().parse_args()
    unknown = [name for name in options.names if name not in BENCHMARKS]
    if unknown:
        print(f"there is no benchmark {unknown[0]!r}; there are {', '.join(BENCHMARKS)}", file=sys.stderr)
        return 2
    effort = "quick" if options.quick else "full"
    results = options.output or ROOT / ("build" if options.quick else "results")
    names = [] if options.report else options.names or BENCHMARKS
    failed = []
    try:
        failed = [name for name in names if not run(name, effort, results)]
    finally:  # also where it is interrupted: what was measured until then stays
        for path in write(results):
            say(str(path))
    return 1 if failed else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python tests/benchmarks", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(BENCHMARKS)}")
    parser.add_argument("--quick", action="store_true", help="few repeats, small sizes; writes to build")
    parser.add_argument("--report", action="store_true", help="write the report anew, measure nothing")
    parser.add_argument("--output", type=Path, metavar="DIR", help="of the report; results by default")
    return parser


if __name__ == "__main__":
    sys.exit(main())
