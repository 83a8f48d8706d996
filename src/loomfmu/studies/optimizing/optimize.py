"""`optimize`: the best designs of a scene within ranges and choices, all claims met."""

from __future__ import annotations

import hashlib
from contextlib import ExitStack, closing
from dataclasses import replace
from pathlib import Path

from ...cosim.prepared import Prepared
from ...cosim.reading import protected
from ...cosim.scenes.scene import files_of
from ...display.progress import progress as progress_bar
from ...errors import LoomfmuError, path_of
from ...extras import need
from ...sweeps.place import check_place, cluster, local, resumable
from ...sweeps.worker import job_of
from . import study as studies
from .found import Files, found_of
from .optimum import Optimum
from .runs import Runs
from .search import expected, generation, searched
from .start import limits_of, own_point


def optimize(
    path: str | Path,
    *,
    processes: int | None = None,
    output: str | Path | None = None,
    scheduler: str | None = None,
    restart: bool = False,
    progress: bool = False,
) -> Optimum:
    """Search the best design of a study, or go on with a search, and write it as a scene that runs.

    Differential evolution searches everywhere; from the best design of each combination of options, linear
    programs go on to where claims bind. The result is the same on any number of processes.

    Args:
        path: the study file
        processes: worker processes on this machine, all cores by default; 1 runs in this process
        output: directory of the results; `results/<study>` below the current directory by default
        scheduler: address of a dask scheduler, such as "tcp://host:8786", whose workers run the designs
        restart: discard earlier results in the directory, of this or another study
        progress: show a progress bar, if standard error is a terminal

    Raises:
        LoomfmuError: bad input, or a directory that holds another study; one line that names what and where
        KeyboardInterrupt: Ctrl-C; the designs that were run stay, and the same call goes on from there
    """
    check_place(processes, scheduler)
    path = path_of(path, "study")
    study = studies.load(path)
    need(path, "study", *["sweep"] * bool(scheduler))
    from ...sweeps.directory import owned

    job = replace(job_of(study), errors="none", measures=study.measures)  # a search goes up to the bounds
    files = Files(path_of(output, "output") if output is not None else Path("results") / study.name)
    fingerprint = hashlib.sha256(f"{study.text}\0{job.identity}".encode()).hexdigest()
    with resumable(files.directory, "runs"), ExitStack() as stack:
        own = own_point(study)
        try:  # what could not be run or written is refused now, not after the search
            files.check(study, own)
            scene = protected(study.scene)
            tried = Prepared(scene, None, study.flavour, (), study.measures).evaluate(errors="none")
            tried.check_end()
        except LoomfmuError as error:
            raise LoomfmuError(f"{path}: {error}") from None
        verdicts = tried.claims
        limits = limits_of(study, verdicts, path)
        inputs = [path, *files_of(study.scene)]
        stack.enter_context(owned(files, "study", study.title, fingerprint, restart, inputs))
        place = cluster(scheduler) if scheduler else local(study.scene, processes, generation(study))
        pool = stack.enter_context(place)
        advance = stack.enter_context(progress_bar(study.title, expected(study), wanted=progress))
        runs = stack.enter_context(closing(Runs(study, job, pool, files.runs, limits, advance)))
        return found_of(runs, searched(runs, own, path), verdicts, files)
