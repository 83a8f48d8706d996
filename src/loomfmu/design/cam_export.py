"""Export of a cam: a table, a drawing, a program for a milling machine. All in mm."""

from io import StringIO
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..extras import need
from ..files import starts_with, write_file
from .cam import Cam, Floats
from .quantities import Quantity, read, whole
from .rocker_cam import RockerCam

COLUMNS = (
    "cam_angle_deg",
    "profile_x_mm",
    "profile_y_mm",
    "cutter_x_mm",
    "cutter_y_mm",
    "pressure_angle_deg",
    "curvature_radius_mm",
)
TABLE = starts_with("a table of a cam", ",".join(COLUMNS).encode(), suffix=".csv")
DRAWING = starts_with("a DXF drawing", b"  0\nSECTION\n", suffix=".dxf")
STRAIGHT = 1e4  # mm: an arc of a larger radius is written as a line


class Move(NamedTuple):
    """A cut to (x, y) [mm]: `code` G1, G2 or G3, the centre of an arc at (i, j) from its start."""

    code: str
    x: float
    y: float
    i: float = 0.0
    j: float = 0.0

    def __str__(self) -> str:
        end = f"{self.code} X{self.x:.4f} Y{self.y:.4f}"
        return end if self.code == "G1" else f"{end} I{self.i:.4f} J{self.j:.4f}"


def write_csv(cam: Cam | RockerCam, path: Path, overwrite: bool = False) -> None:
    """Write the points of profile and cutter's path, with pressure angle and radius of curvature.

    `overwrite` replaces a file that is not such a table. Raises LoomfmuError.
    """
    columns = np.column_stack(
        [
            np.degrees(cam.angle),
            1e3 * cam.profile,
            1e3 * cam.path,
            np.degrees(cam.pressure_angle),
            1e3 * cam.curvature_radius,
        ]
    )
    rows = [",".join(f"{value:.6f}" for value in row) for row in columns]
    write_file(path, "\n".join([",".join(COLUMNS), *rows, ""]).encode(), TABLE, overwrite=overwrite)


def write_dxf(cam: Cam | RockerCam, path: Path, overwrite: bool = False) -> None:
    """Write profile, cutter's path and lowest circle as a drawing, each on a layer of its own.

    `overwrite` replaces a file that is not a drawing.

    Raises:
        LoomfmuError: ezdxf is not installed, or the file cannot be written
    """
    need("a DXF file", "cam")
    from ezdxf.filemanagement import new

    drawing = new("R2010", units=4)  # mm
    space = drawing.modelspace()
    for layer, curve in (("PROFILE", cam.profile), ("CUTTER", cam.path)):
        drawing.layers.add(layer)
        corners = [(float(x), float(y)) for x, y in 1e3 * _open(curve)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    drawing.layers.add("LOWEST")
    space.add_circle((0.0, 0.0), 1e3 * cam.lowest_radius, dxfattribs={"layer": "LOWEST"})
    text = StringIO()
    drawing.write(text)
    write_file(path, text.getvalue().encode(), DRAWING, overwrite=overwrite)


def gcode(
    cam: Cam | RockerCam,
    *,
    arcs: bool = True,
    tolerance: Quantity = 2e-6,
    passes: int = 11,
    cut: Quantity = 1e-3,
    feed: float = 150.0,
    spindle: float = 4000.0,
) -> str:
    """Milling program that runs the cutter's centre clockwise round the cam, in the form of Appendix 3.

    Args:
        cam: what to mill, with a cutter of its roller's radius
        arcs: use G2 and G3 where an arc stays within the tolerance, otherwise G1 from point to point
        tolerance: of an arc from the points that it replaces [m]
        passes: rounds, the first at the surface
        cut: depth from one round to the next [m]
        feed: of the cutter [mm/min]
        spindle: its speed [rev/min]

    >>> from loomfmu.design.cam import design_cam
    >>> gcode(design_cam()).splitlines()[1]
    'G21 G90 G64 G17 G40 G49'
    """
    passes, depth = whole("passes", passes, 1), read("cut", cut)
    (x, y), moves = cutter_moves(cam, arcs=arcs, tolerance=tolerance)
    radii = f"{1e3 * cam.lowest_radius:.3f} to {1e3 * cam.highest_radius:.3f}"
    lines = [
        f"(cutter radius {1e3 * cam.roller_radius:.3f}, cam radii {radii})",
        "G21 G90 G64 G17 G40 G49",
        f"F{feed:g}",
        "T1 M6",
        "M3 M8",
        f"S{spindle:g}",
        f"G0 X{x:.4f} Y{y:.4f}",
        "#1=0",
        f"M98 P1 L{passes}",
        "G0 Z5",
        "M30",
        "O1",
        "G1 Z#1",
        *(str(move) for move in moves),
        f"#1=[#1-{1e3 * depth:g}]",
        "M99",
        "",
    ]
    return "\n".join(lines)


def cutter_moves(
    cam: Cam | RockerCam, *, arcs: bool = True, tolerance: Quantity = 2e-6
) -> tuple[tuple[float, float], list[Move]]:
    """Start and moves of the cutter's centre round the cam, clockwise and closed [mm], to 0.1 um."""
    points = np.round(1e3 * _open(cam.path)[::-1], 4)
    points = np.vstack([points, points[:1]])
    allowed = 1e3 * read("tolerance", tolerance)
    moves: list[Move] = []
    at, last = 0, len(points) - 1
    while at < last:
        end, move = _longest_arc(points, at, allowed) if arcs else (at, None)
        if move is None:
            end = at + 1
            move = Move("G1", float(points[end, 0]), float(points[end, 1]))
        moves.append(move)
        at = end
    return (float(points[0, 0]), float(points[0, 1])), moves


def _open(curve: Floats) -> Floats:
    """A closed curve without its last point, if that is the first again."""
    return curve[:-1] if np.hypot(*(curve[-1] - curve[0])) < 1e-7 else curve


def _longest_arc(points: Floats, at: int, tolerance: float) -> tuple[int, Move | None]:
    """The arc from a point that replaces most of the points after it, up to a quarter of the curve."""
    found: tuple[int, Move | None] = (at, None)
    farthest = min(len(points) - 1, at + len(points) // 4)
    for end in range(at + 2, farthest + 1, 2):
        replaced = points[at : end + 1]
        centre = _centre(replaced[0], replaced[(end - at) // 2], replaced[-1])
        if centre is None:
            break
        radii = np.hypot(*(replaced - centre).T)
        if radii[0] > STRAIGHT or np.ptp(radii) > tolerance:
            break
        chord, reach = replaced[-1] - replaced[0], centre - replaced[0]
        code = "G3" if chord[0] * reach[1] - chord[1] * reach[0] > 0.0 else "G2"
        x, y = replaced[-1]
        found = end, Move(code, float(x), float(y), float(reach[0]), float(reach[1]))
    return found


def _centre(first: Floats, middle: Floats, last: Floats) -> Floats | None:
    """Centre of the circle through three points; none for points on a line."""
    a, b = middle - first, last - first
    cross = 2.0 * (a[0] * b[1] - a[1] * b[0])
    if cross == 0.0:
        return None
    aa, bb = a @ a, b @ b
    return np.asarray(first + np.array([b[1] * aa - a[1] * bb, a[0] * bb - b[0] * aa]) / cross)
