"""The weft yarn from its package over brake and eyes to the head that draws it."""

from ..rules import mm
from .sketch import Figure, Sketch, Value, title
from .tracks import Tracks

BRAKE = 0.0  # place along the yarn [mm]
EYE = 0.6  # place of the eyes, as a share of the way from the brake to where the head takes the yarn
CENTI = 100.0  # cN in 1 N


def yarn(tracks: Tracks, name: str) -> Figure:
    """The yarn between its package and the head, which draws it farther away from the brake."""
    length = tracks.mm(f"{name}.length")
    tension = tracks.add(f"{name}.tension_cN", ["*", CENTI, f"{name}.tension"])
    longest = float(tracks.values(["highest", mm(f"{name}.length")]))
    eye = EYE * 1000.0 * tracks.parameter(f"{name}.supply_length")
    unit = 0.02 * longest  # what is schematic grows with the drawing
    sketch = Sketch(tracks, -15.0 * unit, -6.0 * unit, longest + 5.0 * unit, 6.0 * unit)
    sketch.box(-11.0 * unit, -2.5 * unit, -8.0 * unit, 2.5 * unit, role="body")
    sketch.line((-8.0 * unit, 0.0), (BRAKE, 0.0), (eye, 0.0), role="link weft")
    for y in (1.0, -1.0):
        sketch.line((BRAKE - unit, y * 0.5 * unit), (BRAKE + unit, y * 0.5 * unit), role="rail")
        sketch.line((BRAKE, y * 0.5 * unit), (BRAKE, y * 2.5 * unit))
        sketch.line((eye, y * 0.5 * unit), (eye, y * 2.5 * unit))
    sketch.line((eye, 0.0), (length, 0.0), role="link weft")
    if f"{name}.slack" in tracks.trace:
        slack = tracks.add(f"{name}.hangs", f"{name}.slack", 0.01, 4)
        with sketch.group(shown=slack):
            sketch.line((eye, 0.0), (length, 0.0), role="link risk")
    with sketch.group(shift=(length, 0.0)):
        nose = ((0.0, unit), (2.0 * unit, unit), (3.0 * unit, 0.0), (2.0 * unit, -unit), (0.0, -unit))
        sketch.line(*nose, role="body belt", closed=True)
    sketch.label(-9.5 * unit, 2.5 * unit, "package", shift=(0.0, -6.0))
    sketch.label(BRAKE, 2.5 * unit, "brake", shift=(0.0, -6.0))
    sketch.label(eye, -2.5 * unit, "eyes", shift=(0.0, 14.0))
    return sketch.figure(
        f"yarn-{name}",
        title("Weft from package to head", name, "yarn"),
        "The weft, drawn over its brake and eyes by the head that carries it: the giver, then the taker.",
        [Value("tension", tension, "cN"), Value("length from the brake", length, "mm")],
        "Lengths along the yarn are to scale, and both heads move to the right."
        " Dark orange: the weft hangs slack.",
    )
