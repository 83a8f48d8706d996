"""`optimize`: the best designs of a scene within ranges and choices, all claims met."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from contextlib import ExitStack, closing
from dataclasses import replace
from pathlib import Path

import numpy as np

from ... import units
from ...cosim.claims.claims import called
from ...cosim.prepared import Prepared
from ...cosim.reading import protected
from ...cosim.results import Evaluation
from ...cosim.scenes.scene import files_of
from ...display.printed import as_csv
from ...display.progress import progress as progress_bar
from ...errors import LoomfmuError, listed, path_of, within
from ...extras import install, installed, need
from ...files import ANY, write_file
from ...sweeps.directory import PARTIAL, Contents, owned
from ...sweeps.schedule import check_place, cluster, local, resumable
from ...sweeps.varied import labelled
from ...sweeps.worker import job_of
from ...traces import Verdict
from .. import rewritten
from ..cases import evaluated, worst
from . import study as studies
from .binding import binding, indifferent
from .optimum import Best, Optimum, front_table
from .runs import Design, Point, Runs
from .search import ALIKE, expected, generation, searched
from .start import SAME, limits_of, own_point
from .study import Goal, Study

AGAIN = 20  # times that a better design is taken, of those that were run around the best


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

    From the best designs of each combination of options, linear programs with the components' derivatives go
    to where claims bind. Where a scene has none, or there are many combinations, differential evolution
    searches everywhere first. The result is the same on any number of processes.

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
    job = replace(job_of(study), errors="none", measures=study.measures)  # a search goes up to the bounds
    files = Files(path_of(output, "output") if output is not None else Path("results") / study.name)
    cases = repr(study.cases) if study.cases else ""  # their ends may be of a file of measured values
    fingerprint = hashlib.sha256(f"{study.text}\0{job.identity}{cases}".encode()).hexdigest()
    with resumable(files.directory, "runs"), ExitStack() as stack:
        own = own_point(study)
        with within(path):  # what could not be run or written is refused now, not after the search
            files.check(study, own)
            scene = protected(study.scene)
            loom = Prepared(scene, None, study.flavour, (), study.measures)
            tried = [evaluated(loom, case, "none") for case in study.situations]
        verdicts = tried[0].claims
        limits = limits_of(study, verdicts, path)
        inputs = [path, *files_of(study.scene)]
        stack.enter_context(owned(files, "study", study.title, fingerprint, restart, inputs))
        place = cluster(scheduler) if scheduler else local(study.scene, processes, generation(study))
        pool = stack.enter_context(closing(place))
        advance = stack.enter_context(
            progress_bar(study.title, expected(study, loom.has_derivatives), wanted=progress)
        )
        runs = stack.enter_context(closing(Runs(study, job, pool, files.runs, limits, advance, loom)))
        return found_of(runs, searched(runs, own, path), verdicts, files)


class Files(Contents):
    """The files that a search writes into its directory.

    study.json        which study it is
    runs.jsonl        every design that was run: its values and its result, as it comes
    designs.csv       the same as a table with units, at the end
    best.toml         the best scene; best_01.toml ... for a front, whose goals are in front.csv
    best.png          the picture
    """

    def __init__(self, directory: Path):
        self.runs, self.designs = directory / "runs.jsonl", directory / "designs.csv"
        self.front, self.picture = directory / "front.csv", directory / "best.png"
        super().__init__(
            directory,
            targets=(self.runs, self.designs, self.front, self.picture, directory / "best.toml"),
            numbered=((directory, r"best_\d+\.toml"),),
            unfinished=((directory, PARTIAL),),
        )

    def scene(self, number: int = 0) -> Path:
        """The scene of a best design, counted from 1 in a front."""
        return self.directory / (f"best_{number:02d}.toml" if number else "best.toml")

    def check(self, study: Study, own: Point) -> None:
        """Refuse a scene that cannot be written here with other values, and best ones that somebody edited.

        Raises LoomfmuError.
        """
        for path in self.results():
            if path.suffix == ".toml" and not rewritten.unedited(path):
                raise LoomfmuError(f"{path} was edited, or loomfmu did not write it; move it elsewhere")
        values = [each.value(number) for each, number in zip(study.variables, own, strict=True)]
        rewritten.text_for(study.scene, study.written(values), self.scene())


def found_of(runs: Runs, best: Sequence[Design], own: Sequence[Verdict], files: Files) -> Optimum:
    """Write what was found and say it; `own` are the verdicts on the scene's own design."""
    study = runs.study
    names = [called(claim, verdict) for claim, verdict in zip(study.scene.claims, own, strict=True)]
    numbers = [0] if len(best) == 1 else range(1, len(best) + 1)
    front = [
        _settled(runs, each, names, files.scene(number)) for number, each in zip(numbers, best, strict=True)
    ]
    designs = list(runs.designs.values())
    _write(files.designs, _table(study, designs, names, own))
    picture = installed("plot")
    warnings = study.notes if picture else (*study.notes, f"no picture: {install('plot')}")
    found = Optimum(
        study,
        tuple(front),
        len(designs),
        runs.ran,
        sum(each.allowed for each in designs),
        tuple(each.error for each in designs if each.error),
        _nowhere(designs, names, own),
        _constant(study, designs),
        files.directory,
        files.picture if picture else None,
        warnings,
    )
    if len(study.goals) > 1:
        headings, rows = front_table(found)
        _write(files.front, [headings, *rows])
    if picture:
        from ...report import pictures
        from .best_design import draw

        pictures.save(draw(found, designs), files.picture, study.title, overwrite=True)
    return found


def _settled(runs: Runs, design: Design, names: Sequence[str], path: Path) -> Best:
    """A best design, written and judged; of a single goal the better one that runs around it may show.

    Where the goal jumps, linear programs may have missed that.
    """
    for _ in range(AGAIN):
        found = _written(runs, design, names, path)
        better = min((d for d in runs.designs.values() if d.allowed), key=lambda each: each.heights[0])
        gained = float(design.heights[0] - better.heights[0])
        if len(runs.study.goals) > 1 or gained <= ALIKE * abs(float(design.heights[0])):
            break
        design = better
    return found


def _written(runs: Runs, design: Design, names: Sequence[str], path: Path) -> Best:
    """A best design, written as a scene and judged as that scene runs."""
    study = runs.study
    rewritten.write(study.scene, study.written(design.values), path, True, _origin(study, path))
    loom = Prepared(path, None, study.flavour, (), study.measures)
    # with their errors, as any run of it has them
    cases = {case.name: evaluated(loom, case, "all") for case in study.situations}
    verdicts = worst({name: each.claims for name, each in cases.items()})
    errors = [max(_error_of(goal, each) for each in cases.values()) for goal in study.goals]
    values = dict(zip((each.key for each in study.variables), design.values, strict=True))
    goals = [goal.sign * float(height) for goal, height in zip(study.goals, design.heights, strict=True)]
    limits = binding(runs, design, names, np.array([each.bound for each in verdicts]))
    return Best(values, tuple(goals), tuple(errors), verdicts, tuple(limits), indifferent(runs, design), path)


def _error_of(goal: Goal, found: Evaluation) -> float:
    of_kind = {"signal": found.measured, "claim": found.claims}
    return of_kind[goal.kind][goal.place].error if goal.kind in of_kind else 0.0


def _origin(study: Study, path: Path) -> str:
    """The description of a scene that is written: where it comes from."""
    which = "The best design" if len(study.goals) == 1 else f"{path.stem}: a design of the front"
    goals = listed(goal.words for goal in study.goals)
    changed = listed([*study.fixed, *(each.key for each in study.variables)])
    worst = f" in the worst of {len(study.cases)} cases" if study.cases else ""
    return f"{which} of {study.name}.toml ({goals}{worst}): {study.path.name} with other values of {changed}."


def _constant(study: Study, designs: Sequence[Design]) -> tuple[str, ...]:
    """The goals that are the same in all designs."""
    heights = np.array([each.heights for each in designs if np.all(np.isfinite(each.heights))])
    if len(heights) < 2:
        return ()
    alike = np.ptp(heights, axis=0) <= SAME * np.max(np.abs(heights), axis=0)
    return tuple(goal.name for goal, same in zip(study.goals, alike, strict=True) if same)


def _nowhere(designs: Sequence[Design], names: Sequence[str], own: Sequence[Verdict]) -> tuple[str, ...]:
    """Return the claims, or safety distances, that no design meets, with the nearest that any came."""
    found = []
    for number, (name, verdict) in enumerate(zip(names, own, strict=True)):
        if any(each.room[number] >= 0.0 for each in designs):
            continue
        distances = [each.distances[number] for each in designs if np.isfinite(each.distances[number])]
        undecided = [each.undecided[number] for each in designs if each.undecided[number]]
        nearest = verdict.shown(max(distances, default=0.0))
        if any(each >= 0.0 for each in distances):
            text = (
                f"keeps the safety distance from '{name}'; the largest distance from its bound is {nearest}"
            )
        elif undecided:
            text = f"meets '{name}', undecided in {len(undecided)} of them: {undecided[0]}"
        else:
            near = f"; the nearest distance from its bound is {nearest}" if distances else ""
            text = f"meets '{name}'{near}"
        found.append(text)
    return tuple(found)


def _table(
    study: Study, designs: Sequence[Design], names: Sequence[str], own: Sequence[Verdict]
) -> list[list[str]]:
    """All designs, in the units that people read."""
    columns = [labelled(each.key, each.varied.shown_unit) for each in study.variables]
    columns += [labelled(goal.words, goal.shown_unit) for goal in study.goals]
    columns += [f"distance of {name} [{verdict.label}]" for name, verdict in zip(names, own, strict=True)]
    rows = [[*columns, "holds", "error"]]
    for each in designs:
        values = [
            f"{value / units.unit(variable.varied.display).factor:.13g}"
            if isinstance(value, float)
            else str(value)
            for variable, value in zip(study.variables, each.values, strict=True)
        ]
        values += [
            f"{goal.sign * height / units.unit(goal.display).factor:.13g}"
            for goal, height in zip(study.goals, each.heights, strict=True)
        ]
        values += [
            f"{verdict.displayed(distance):.13g}"
            for verdict, distance in zip(own, each.distances, strict=True)
        ]
        rows.append([*values, str(each.allowed).lower(), each.error])
    return rows


def _write(path: Path, rows: Sequence[Sequence[str]]) -> None:
    write_file(path, as_csv(rows).encode(), ANY)
