"""The arguments of the commands that take traces."""

from typing import Any

from .shared import add_force, ending


def show(commands: Any) -> None:
    """Arguments of `show`."""
    show = commands.add_parser("show", help="summarise a trace")
    show.add_argument("trace", type=ending(".h5"), metavar="FILE.h5")


def report(commands: Any) -> None:
    """Arguments of `report`."""
    report = commands.add_parser("report", help="write a trace as a page to look at (HTML)")
    report.add_argument(
        "traces", nargs="+", type=ending(".h5"), metavar="FILE.h5", help="the trace; others are laid over it"
    )
    report.add_argument("--output", metavar="FILE.html", help="beside the first trace by default")
    add_force(report, "FILE.html even if it is not a report")


def diagram(commands: Any) -> None:
    """Arguments of `diagram`."""
    diagram = commands.add_parser("diagram", help="draw the timing diagram of a trace (SVG, PNG or PDF)")
    diagram.add_argument("trace", type=ending(".h5"), metavar="FILE.h5")
    diagram.add_argument(
        "--revolution",
        type=int,
        metavar="N",
        help="counted from 1; that of the worst failure by default, or the last whole one",
    )
    diagram.add_argument("--round", action="store_true", help="as rings around the shaft")
    diagram.add_argument(
        "--output", metavar="FILE.svg|png|pdf", help="FILE_diagram.svg beside the trace by default"
    )
    add_force(diagram, "the picture even if loomfmu did not draw it")


def plot(commands: Any) -> None:
    """Arguments of `plot`."""
    plot = commands.add_parser("plot", help="plot signals of a trace (PNG, SVG or PDF)")
    plot.add_argument("trace", type=ending(".h5"), metavar="FILE.h5")
    plot.add_argument(
        "names",
        nargs="+",
        metavar="SIGNAL",
        help="signals such as belt.margin; other traces (MORE.h5) before them are laid over the first",
    )
    plot.add_argument(
        "--over", choices=("angle", "time"), help="the shaft's angle if a shaft turns, by default"
    )
    plot.add_argument("--fold", action="store_true", help="lay the revolutions over one another")
    plot.add_argument(
        "--ylim",
        metavar="LOW..HIGH",
        help="the range that is drawn, with its unit, such as 0..1 or 0mm..5mm",
    )
    plot.add_argument(
        "--output", metavar="FILE.png|svg|pdf", help="FILE_plot.png beside the trace by default"
    )
    add_force(plot, "the picture even if loomfmu did not draw it")


def compare(commands: Any) -> None:
    """Arguments of `compare`."""
    compare = commands.add_parser(
        "compare",
        help="report what differs between two traces, where first and by how much",
        epilog="Exit status: 0 equal within the tolerance; 1 they differ; 2 bad input.",
    )
    compare.add_argument("first", metavar="A.h5")
    compare.add_argument("second", metavar="B.h5")
    compare.add_argument(
        "--tolerance",
        action="append",
        default=[],
        metavar="SHARE|NAME=VALUE",
        help="what may differ, as a share of each signal's largest magnitude (1e-9), such as 0.1%%; or, for"
        " one signal, an amount with its unit, such as belt.free_length=0.1mm",
    )
    compare.add_argument(
        "--ignore",
        action="append",
        default=[],
        metavar="NAME",
        help="leave signals and values out, such as 'motor.*'",
    )
    compare.add_argument(
        "--over",
        choices=("angle", "time"),
        help="compare at equal shaft angles or at equal times; shaft angles by default if the shafts turn",
    )
    compare.add_argument(
        "--all", action="store_true", help="list all signals that differ, not only those that do so most"
    )
    compare.add_argument("--report", metavar="FILE.html", help="also write a page that shows B over A")
    add_force(compare, "FILE.html even if it is not a report")
