"""The command `loomfmu`."""

import argparse
import atexit
import gc
import os
import sys
from collections.abc import Callable, Sequence

INTERRUPTED = 130

SELDOM = 100_000  # objects: to search for garbage as often as Python does takes a tenth of a run

atexit.register(gc.freeze)  # last of all: Python ends without a search for garbage, 60 ms of a run


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit status."""
    gc.set_threshold(SELDOM)
    try:  # Ctrl-C may come while the commands are imported, which takes a quarter of a second
        from .commands import parser, with_negative
        from .commands.status import status_of
    except KeyboardInterrupt:
        return INTERRUPTED
    options = argparse.Namespace(debug=False)
    # numpy starts a thread for each core, which takes 40 ms; nothing here has matrices for so many
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

    def command() -> int:
        given = sys.argv[1:] if arguments is None else arguments
        parser().parse_args(with_negative(given) or ["--help"], options)
        action: Callable[[argparse.Namespace], int] = options.action
        return action(options)

    return status_of(command, options)


if __name__ == "__main__":
    sys.exit(main())
