"""The commands that run a scene many times, with their arguments."""

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ..display.printed import say, warn
from ..errors import LoomfmuError
from ..extras import need
from ..files import check_target
from .shared import SCENE, SET, argument, command, ending, flag, force, pairs, place, vary


@command(
    argument("sweep", "SWEEP.toml", type=ending(".toml")),
    *place("SWEEP", "; FILE.csv also writes the table there"),
    force("a file at FILE.csv that is not the table of a sweep"),
)
def sweep(options: argparse.Namespace) -> int:
    """Run a scene with many combinations of values."""
    from ..sweeps.run import sweep as run_sweep

    found = run_sweep(options.sweep, progress=True, overwrite=options.force, **_places(options))
    from ..sweeps.summary import show  # after the extra `sweep` is known to be installed

    warn(found.warnings)
    show(found)
    return 0 if found.holds and not found.untraced else 1


def _places(options: argparse.Namespace) -> dict[str, Any]:
    """Return where many runs go, and which processes make them."""
    return {name: getattr(options, name) for name in ("output", "processes", "scheduler", "restart")}


@command(
    SCENE,
    vary(
        "what is varied, such as shaft.speed or shaft.speed=300rpm..900rpm; a second one gives the limits of"
        " the first at values of the second",
        required=True,
    ),
    argument("--from", "LOW", "where the range of the first --vary begins, with its unit", dest="from_"),
    argument(
        "--to",
        "HIGH",
        "where it ends; by default both are the variable's bounds, or half and twice the scene's value",
    ),
    argument("--points", "N", "values of the first that are tried first (41)", type=int),
    argument("--rows", "N", "values of the second that are taken (11)", type=int),
    flag("--corners", "find limits that also hold at all corners of the scene's [tolerances]"),
    flag("--prove", "also prove each range for all shaft angles, up to its limits"),
    SET,
    argument("--output", "FILE.csv|svg|png|pdf", "also write the limits as a table or a picture"),
    force("the file even if it is not such a table or picture"),
    statuses="0 all claims hold in some range; 1 in none; 2 bad input or a failed FMU.",
)
def limit(options: argparse.Namespace) -> int:
    """Find the values at which claims begin to fail."""
    from ..studies.limits import limit_tables
    from ..studies.limits.limits import limit as find

    inputs = [Path(options.scene)]
    output = Path(options.output) if options.output else None
    if output is not None:
        limit_tables.check(output, inputs, options.force)  # before the runs, not after them
    counts = {name: getattr(options, name) for name in ("points", "rows")}
    found = find(
        options.scene,
        vary=options.vary,
        from_=options.from_,
        to=options.to,
        set=pairs(options.overrides),
        corners=options.corners,
        prove=options.prove,
        progress=True,
        **{name: count for name, count in counts.items() if count is not None},
    )
    writers = {output: lambda path: limit_tables.write(found, path, inputs, options.force)}
    return _reported(found, limit_tables.show, writers)


def _reported(
    found: Any, show: Callable[[Any], None], writers: Mapping[Path | None, Callable[[Path], object]]
) -> int:
    """Write the files that were asked for, show what was found, whether they could be, and return the status.

    First the files: the reader of our output may have had enough.
    """
    files = {path: write for path, write in writers.items() if path is not None}
    try:
        for path, write in files.items():
            write(path)
    finally:
        warn(found.warnings)
        show(found)
    say(*(f"written: {path}" for path in files))
    return 0 if found else 1


@command(
    SCENE,
    vary(
        "a tolerance, such as belt.guide_clearance=0.2mm..0.5mm (repeatable); those of the scene's"
        " [tolerances] by default"
    ),
    flag("--prove", "also prove the worst cases, for all shaft angles and all values within the tolerances"),
    argument("--looms", "N", "draw N looms instead, and find in which share of them claims hold", type=int),
    argument("--share", "SHARE", "with --looms: the share, such as 99%%, in which all claims are to hold"),
    argument("--seed", "N", "with --looms: the seed of the drawing (1)", type=int),
    SET,
    argument("--picture", "FILE.svg|png|pdf", "also draw the worst cases"),
    force("the picture even if loomfmu did not draw it"),
    statuses=(
        "0 all hold in their worst cases, in all looms, or in the share of them; 1 a claim fails or is"
        " undecided; 2 bad input or a failed FMU."
    ),
)
def tolerances(options: argparse.Namespace) -> int:
    """Find the worst case of every claim within tolerances, or the share of looms in which it holds."""
    if options.looms is not None:
        return _shares(options)
    if options.share is not None or options.seed is not None:
        raise LoomfmuError("--share and --seed are of looms that are drawn; add --looms N")
    from ..report import pictures
    from ..studies.tolerances.tolerances import tolerances as find
    from ..studies.tolerances.worst_cases import draw, show

    inputs = [Path(options.scene)]
    picture = Path(options.picture) if options.picture else None
    if picture is not None:  # before the runs, not after them
        pictures.check(picture, inputs, options.force)
    found = find(
        options.scene,
        vary=options.vary,
        set=pairs(options.overrides),
        prove=options.prove,
        progress=True,
    )
    drawn = {picture: lambda path: pictures.save(draw(found), path, found.title, inputs, options.force)}
    return _reported(found, show, drawn)


def _shares(options: argparse.Namespace) -> int:
    """Draw looms and show the shares of them in which claims hold."""
    from ..studies.tolerances.draw import draw_looms
    from ..studies.tolerances.shares import show

    if options.prove or options.picture:
        raise LoomfmuError("--prove and --picture are of worst cases; leave out --looms")
    found = draw_looms(
        options.scene,
        looms=options.looms,
        vary=options.vary,
        set=pairs(options.overrides),
        seed=1 if options.seed is None else options.seed,
        share=options.share,
        progress=True,
    )
    return _reported(found, show, {})


@command(
    argument("scene", "SCENE", "the scene (.toml or .ssp)", nargs="?"),
    argument(
        "--over",
        "INSTANCE.VARIABLE=LOW..HIGH",
        "a parameter and its range, such as shaft.speed=300rpm..640rpm (repeatable)",
        action="append",
        default=[],
    ),
    argument("--claim", "NAME", "only this claim (repeatable)", action="append"),
    argument("--boxes", "N", "boxes that are tried for a claim before it is left open (200000)", type=int),
    SET,
    argument("--certificate", "FILE.json", "also write what others need to confirm it"),
    argument("--picture", "FILE.svg|png|pdf", "also draw what is proven and what is left open"),
    argument("--check", "FILE.json", "confirm a certificate instead of proving"),
    force("the certificate or the picture even if loomfmu did not write it"),
    statuses=(
        "0 all claims are proven, or confirmed; 1 one is refuted, left open or cannot be proven; 2 bad input."
    ),
)
def prove(options: argparse.Namespace) -> int:
    """Prove claims for all shaft angles and all values within ranges."""
    if (options.scene is None) == (options.check is None):
        raise LoomfmuError("prove takes either a SCENE or --check FILE.json")
    if options.check is not None:
        need("confirming a certificate", "proof")
        from ..studies.proving.check import check

        given = ("over", "claim", "certificate", "picture", "overrides", "boxes")
        if any(getattr(options, name) for name in given):
            raise LoomfmuError("--check takes a certificate alone: the ranges and the claims are in it")
        say(*check(options.check, progress=True))
        return 0
    from ..report import pictures
    from ..studies.proving import certificate
    from ..studies.proving.proofs_shown import draw, show
    from ..studies.proving.prove import prove as find
    from ..studies.proving.search import MOST

    inputs, output = [Path(options.scene)], Path(options.certificate) if options.certificate else None
    if output is not None:
        check_target(output, certificate.CERTIFICATE, inputs, options.force)
    picture = Path(options.picture) if options.picture else None
    if picture is not None:
        pictures.check(picture, inputs, options.force)
    found = find(
        options.scene,
        over=options.over,
        set=pairs(options.overrides),
        claims=options.claim,
        boxes=MOST if options.boxes is None else options.boxes,
    )
    writers = {
        output: lambda path: certificate.write(found, path, inputs, options.force),
        picture: lambda path: pictures.save(draw(found), path, found.scene.title, inputs, options.force),
    }
    return _reported(found, show, writers)


@command(
    argument("study", "STUDY.toml", type=ending(".toml")),
    *place("STUDY"),
    statuses=(
        "0 all claims hold in the best design; 1 one is undecided there, or no design"
        " meets all claims; 2 bad input or a failed FMU."
    ),
)
def optimize(options: argparse.Namespace) -> int:
    """Find the best design within ranges and choices, all claims met."""
    from ..studies.optimizing.best_design import show
    from ..studies.optimizing.optimize import optimize as find

    found = find(options.study, progress=True, **_places(options))
    warn(found.warnings)
    show(found)
    return 0 if found.holds else 1


@command(
    SCENE,
    argument(
        "data",
        "DATA.csv|h5",
        "columns with units, such as shaft_angle [deg],damper_1.displacement [mm]; or a trace",
    ),
    vary("a parameter to find, such as damper_1.spring_stiffness=1N/mm..20N/mm (repeatable)", required=True),
    argument(
        "--signal",
        "SIGNAL",
        "what is fitted of the data (repeatable); all columns of a table by default",
        action="append",
        default=[],
    ),
    argument(
        "--offset",
        "LOW..HIGH",
        "also find what is added to the times or shaft angles of the data, such as -2ms..2ms",
    ),
    argument(
        "--loss",
        "LOSS",
        "soft_l1, huber, cauchy or arctan where some values may be far off; linear (least squares)",
        default="linear",
    ),
    SET,
    argument("--output", "FILE.toml", "also write the scene with the fitted values"),
    argument("--picture", "FILE.svg|png|pdf", "also draw measured and computed curves"),
    force("these files even if they are not a scene and a picture"),
    statuses=(
        "0 the data are explained; 1 a signal is hardly explained, or a parameter ended"
        " at an end of its range; 2 bad input or a failed FMU."
    ),
)
def fit(options: argparse.Namespace) -> int:
    """Find parameters of a scene from measured curves."""
    from ..cosim.reading import checked
    from ..report import pictures
    from ..studies import rewritten
    from ..studies.fitting.fit import fit as find
    from ..studies.fitting.fitted_values import draw, show

    inputs = [Path(options.scene), Path(options.data)]
    output, picture = (Path(each) if each else None for each in (options.output, options.picture))
    scene = checked(options.scene, pairs(options.overrides), "native")
    # before the runs, not after them
    if output is not None:
        if output.suffix != ".toml":
            raise LoomfmuError(f"{output}: a scene is written as .toml; --picture draws the curves")
        check_target(output, rewritten.KIND, inputs, options.force)
        rewritten.check(scene)
    if picture is not None:
        pictures.check(picture, inputs, options.force)
    found = find(
        scene,
        options.data,
        vary=options.vary,
        signals=options.signal,
        offset=options.offset,
        loss=options.loss,
    )
    writers = {
        output: lambda path: found.write(path, options.force),
        picture: lambda path: pictures.save(draw(found), path, found.title, inputs, options.force),
    }
    return _reported(found, show, writers)
