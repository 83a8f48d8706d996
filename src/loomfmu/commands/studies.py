"""The commands that run a scene many times: `sweep`, `limit`, `tolerances`, `optimize`, `fit`."""

import argparse

from ..display.printed import warn
from .options import pairs


def sweep(options: argparse.Namespace) -> int:
    """Run a scene with many combinations of values."""
    from ..sweeps.run import sweep as run_sweep

    found = run_sweep(
        options.sweep,
        processes=options.processes,
        output=options.output,
        scheduler=options.scheduler,
        restart=options.restart,
        progress=True,
    )
    from ..sweeps.report import show  # after the extra `sweep` is known to be installed

    warn(found.warnings)
    show(found)
    return 0 if found.holds and not found.untraced else 1


def limit(options: argparse.Namespace) -> int:
    """Find the values at which claims begin to fail."""
    from ..studies.limits import command

    return command.run(options, pairs(options.overrides))


def tolerances(options: argparse.Namespace) -> int:
    """Find the worst case of every claim within tolerances."""
    from ..studies.tolerances import command

    return command.run(options, pairs(options.overrides))


def optimize(options: argparse.Namespace) -> int:
    """Find the best design."""
    from ..studies.optimizing import command

    return command.run(options)


def fit(options: argparse.Namespace) -> int:
    """Find parameters from measured curves."""
    from ..studies.fitting import command

    return command.run(options, pairs(options.overrides))
