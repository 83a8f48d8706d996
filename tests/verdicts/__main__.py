"""Verdicts on random scenes beside the truth: `PYTHONPATH=tests python -m verdicts`, or `make verdicts`.

`--seed 24 --family belt --scene 7` judges one scene again, `--list-wrong` says how to see a wrong verdict.
"""

import argparse
import os
import signal
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from pathlib import Path

from verdicts.drawing import FAMILIES, drawn
from verdicts.figures import summary, table
from verdicts.judging import Found, confirmed, judged
from verdicts.listing import listed

SEED, SCENES = 24, 50  # of each family: some 140,000 verdicts
FOLDER = Path(__file__).parents[2] / "build" / "verdicts"


def main() -> int:
    """Judge random scenes and write the figures, also where it is interrupted; 1 if a verdict is wrong."""
    options, found = _parser().parse_args(), list[Found]()
    with suppress(KeyboardInterrupt):
        for some in _all(options):
            found += some
            for paragraph in listed(some, FOLDER) if options.list_wrong else ():
                print(paragraph, end="\n\n", flush=True)
    text = table(found)
    if options.output and found:
        options.output.write_text(text, encoding="utf-8")
    print(options.output or text)
    print(summary(found))
    return 1 if any(each.wrong for each in found) else 0


def _all(options: argparse.Namespace) -> Iterator[list[Found]]:
    """The verdicts on each scene."""
    numbers = [options.scene] if options.scene is not None else range(options.scenes)
    wanted = [(options.seed, family, number) for number in numbers for family in options.family or FAMILIES]
    pool = ProcessPoolExecutor(
        options.jobs, initializer=signal.signal, initargs=(signal.SIGINT, signal.SIG_IGN)
    )
    try:
        for done, some in enumerate(pool.map(_one, wanted), 1):
            yield some
            if sys.stderr.isatty():
                print(f"\r{done} of {len(wanted)} scenes", end="", file=sys.stderr, flush=True)
    finally:
        pool.shutdown(cancel_futures=True)


def _one(place: tuple[int, str, int]) -> list[Found]:
    """All verdicts on one scene."""
    return confirmed(list(judged(drawn(*place))))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m verdicts", description=__doc__)
    parser.add_argument("--seed", type=int, default=SEED, help=f"{SEED} by default")
    parser.add_argument("--scenes", type=int, default=SCENES, help=f"of each family; {SCENES} by default")
    parser.add_argument("--scene", type=int, metavar="NUMBER", help="only the one with this number")
    parser.add_argument("--family", nargs="+", choices=FAMILIES, help="all of them by default")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes; one for each core")
    parser.add_argument("--list-wrong", action="store_true", help="write wrong verdicts as scenes")
    parser.add_argument("--output", type=Path, metavar="CSV", help="where the figures go")
    return parser


if __name__ == "__main__":
    sys.exit(main())
