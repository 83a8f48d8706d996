"""The arguments of the commands that run a scene many times."""

from typing import Any

from .shared import add_force, add_place, add_scene, add_set, ending


def sweep(commands: Any) -> None:
    """Arguments of `sweep`."""
    sweep = commands.add_parser("sweep", help="run a scene with many combinations of values")
    sweep.add_argument("sweep", type=ending(".toml"), metavar="SWEEP.toml")
    add_place(sweep, "SWEEP")


def limit(commands: Any) -> None:
    """Arguments of `limit`."""
    limit = commands.add_parser(
        "limit",
        help="find the values at which claims begin to fail",
        epilog="Exit status: 0 all claims hold in some range; 1 in none; 2 bad input or a failed FMU.",
    )
    add_scene(limit)
    limit.add_argument(
        "--vary",
        action="append",
        required=True,
        metavar="INSTANCE.VARIABLE[=LOW..HIGH]",
        help="what is varied, such as shaft.speed or shaft.speed=300rpm..900rpm; a second one gives the"
        " limits of the first at values of the second",
    )
    limit.add_argument(
        "--from",
        dest="from_",
        metavar="LOW",
        help="where the range of the first --vary begins, with its unit",
    )
    limit.add_argument(
        "--to", metavar="HIGH", help="where it ends; by default half to twice the scene's value"
    )
    limit.add_argument(
        "--points", type=int, metavar="N", help="values of the first that are tried first (41)"
    )
    limit.add_argument("--rows", type=int, metavar="N", help="values of the second that are taken (11)")
    add_set(limit)
    limit.add_argument(
        "--output", metavar="FILE.csv|svg|png|pdf", help="also write the limits as a table or a picture"
    )
    add_force(limit, "the file even if it is not such a table or picture")


def tolerances(commands: Any) -> None:
    """Arguments of `tolerances`."""
    tolerances = commands.add_parser(
        "tolerances",
        help="find the worst case of every claim within tolerances",
        epilog="Exit status: 0 all hold in their worst cases; 1 a claim fails or is undecided;"
        " 2 bad input or a failed FMU.",
    )
    add_scene(tolerances)
    tolerances.add_argument(
        "--vary",
        action="append",
        default=[],
        metavar="INSTANCE.VARIABLE=LOW..HIGH",
        help="a tolerance, such as belt.guide_clearance=0.2mm..0.5mm (repeatable); those of the scene's"
        " [tolerances] by default",
    )
    add_set(tolerances)
    tolerances.add_argument("--picture", metavar="FILE.svg|png|pdf", help="also draw the worst cases")
    add_force(tolerances, "the picture even if loomfmu did not draw it")


def optimize(commands: Any) -> None:
    """Arguments of `optimize`."""
    optimize = commands.add_parser(
        "optimize",
        help="find the best design within ranges and choices, all claims met",
        epilog="Exit status: 0 all claims hold in the best design; 1 one is undecided there, or no design"
        " meets all claims; 2 bad input or a failed FMU.",
    )
    optimize.add_argument("study", type=ending(".toml"), metavar="STUDY.toml")
    add_place(optimize, "STUDY")


def fit(commands: Any) -> None:
    """Arguments of `fit`."""
    fit = commands.add_parser(
        "fit",
        help="find parameters of a scene from measured curves",
        epilog="Exit status: 0 parameters were found; 1 a signal is hardly explained, or a parameter ended at"
        " an end of its range; 2 bad input or a failed FMU.",
    )
    add_scene(fit)
    fit.add_argument(
        "data",
        metavar="DATA.csv|h5",
        help="columns with units, such as shaft_angle [deg],heald_1.displacement [mm]; or a trace",
    )
    fit.add_argument(
        "--vary",
        action="append",
        required=True,
        metavar="INSTANCE.VARIABLE[=LOW..HIGH]",
        help="a parameter to find, such as damper_1.spring_stiffness=1N/mm..20N/mm (repeatable)",
    )
    fit.add_argument(
        "--signal",
        action="append",
        default=[],
        metavar="SIGNAL",
        help="what is fitted of the data (repeatable); all columns of a table by default",
    )
    fit.add_argument(
        "--offset",
        metavar="LOW..HIGH",
        help="also find what is added to the times or shaft angles of the data, such as -2ms..2ms",
    )
    fit.add_argument(
        "--loss",
        metavar="LOSS",
        default="linear",
        help="soft_l1, huber, cauchy or arctan where some values may be far off; linear (least squares)",
    )
    add_set(fit)
    fit.add_argument("--output", metavar="FILE.toml", help="also write the scene with the fitted values")
    fit.add_argument("--picture", metavar="FILE.svg|png|pdf", help="also draw measured and computed curves")
    add_force(fit, "these files even if they are not a scene and a picture")
