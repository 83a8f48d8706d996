"""Draws the schematic of every FMU, `drawing.svg`: what its README calls the parts, linkages to scale."""

from math import atan2, cos, hypot, pi, sin
from pathlib import Path

from loomfmu.components import ReedBeatUp, WeftInsertion
from loomfmu.physics.linkage import spherical_rocker

FMUS = Path(__file__).parents[1] / "fmus"
BLUE, RED, GREY, PALE = "#1f5f8b", "#d1495b", "#5b6770", "#e4ebf0"
SUBSCRIPT = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
Point = tuple[float, float]


class Drawing:
    """Shapes in pixels, y downwards, collected as SVG."""

    def __init__(self, width: int, height: int, title: str) -> None:
        self.parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}"'
            f' height="{height}" font-family="sans-serif" font-size="14">',
            f"<title>{title}</title>",
            f'<rect width="{width}" height="{height}" fill="#fff"/>',
        ]

    def shape(self, tag: str, colour: str, stroke: float, fill: str, **attributes: object) -> None:
        """One element with its stroke and its fill."""
        shown = " ".join(
            f'{key.replace("_", "-")}="{value:.6g}"' if isinstance(value, float | int)
            else f'{key.replace("_", "-")}="{value}"' for key, value in attributes.items()
        )  # fmt: skip
        self.parts.append(f'<{tag} {shown} stroke="{colour}" stroke-width="{stroke:g}" fill="{fill}"/>')

    def path(
        self, *points: Point, colour: str = GREY, width: float = 2, fill: str = "none", dash: str = ""
    ) -> None:
        """Straight lines from point to point."""
        text = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        dashed = {"stroke_dasharray": dash} if dash else {}
        self.shape("polyline", colour, width, fill, points=text, stroke_linejoin="round", **dashed)

    def circle(
        self, at: Point, radius: float, colour: str = GREY, width: float = 2, fill: str = "none"
    ) -> None:
        """A circle about a point."""
        self.shape("circle", colour, width, fill, cx=at[0], cy=at[1], r=radius)

    def joint(self, *points: Point) -> None:
        """Pins that links turn about."""
        for point in points:
            self.circle(point, 4, fill="#fff")

    def pivot(self, at: Point) -> None:
        """A pin in the frame of the machine."""
        x, y = at
        self.path((x, y), (x - 8, y + 13), (x + 8, y + 13), (x, y), fill=PALE)
        self.path((x - 13, y + 13), (x + 13, y + 13))
        self.joint(at)

    def box(
        self, x: float, y: float, width: float, height: float, fill: str = PALE, colour: str = GREY
    ) -> None:
        """A rectangle by its upper left corner."""
        self.shape("rect", colour, 2, fill, x=x, y=y, width=width, height=height)

    def arrow(self, start: Point, end: Point, colour: str = RED, both: bool = False) -> None:
        """A force, a motion, or a measure with two heads."""
        self.path(start, end, colour=colour, width=1.6)
        for tip, tail in ((end, start), (start, end))[: 2 if both else 1]:
            self.head(tip, atan2(tip[1] - tail[1], tip[0] - tail[0]), colour)

    def head(self, tip: Point, angle: float, colour: str) -> None:
        """The head of an arrow."""
        sides = [(tip[0] - 9 * cos(angle + turn), tip[1] - 9 * sin(angle + turn)) for turn in (0.35, -0.35)]
        self.path(sides[0], tip, sides[1], sides[0], colour=colour, width=1, fill=colour)

    def turn(self, at: Point, radius: float, start: float, end: float, colour: str = RED) -> None:
        """A turn about a point, in degrees from the right, positive against the clock."""
        steps = [start + (end - start) * n / 24 for n in range(25)]
        points = [(at[0] + radius * cos(a * pi / 180), at[1] - radius * sin(a * pi / 180)) for a in steps]
        self.path(*points, colour=colour, width=1.6)
        sense = 1 if end > start else -1
        self.head(points[-1], -(end + sense * 80) * pi / 180, colour)

    def spring(self, start: Point, end: Point, colour: str = BLUE) -> None:
        """A coil spring between two points."""
        length = hypot(end[0] - start[0], end[1] - start[1])
        along = ((end[0] - start[0]) / length, (end[1] - start[1]) / length)
        points = [start]
        for n in range(1, 12):
            side = 0 if n in (1, 11) else (6 if n % 2 else -6)
            share = n / 12 * length
            points.append(
                (start[0] + share * along[0] - side * along[1], start[1] + share * along[1] + side * along[0])
            )
        self.path(*points, end, colour=colour)

    def text(self, at: Point, words: str, colour: str = "#222", anchor: str = "middle") -> None:
        """A label; digits behind a letter are written as an index."""
        self.parts.append(
            f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" fill="{colour}" text-anchor="{anchor}">{words}</text>'
        )

    def write(self, name: str) -> None:
        """Write the drawing of an FMU."""
        (FMUS / name / "drawing.svg").write_text("\n".join([*self.parts, "</svg>", ""]), encoding="utf-8")


def index(symbol: str) -> str:
    """A symbol with its index, such as l1."""
    return symbol.translate(SUBSCRIPT)


def main_shaft() -> Drawing:
    """A disc that turns from its zero."""
    d = Drawing(480, 220, "Main shaft: angle from the rapiers' outer dead centre, velocity, acceleration")
    at = (150, 110)
    d.circle(at, 75, fill=PALE)
    d.path(at, (240, 110), dash="5 4")
    d.path(at, (at[0] + 75 * cos(0.9), at[1] - 75 * sin(0.9)), colour=BLUE, width=3)
    d.turn(at, 50, 0, 51, BLUE)
    d.turn(at, 90, 70, 120)
    d.joint(at)
    d.text((178, 103), "angle", BLUE)
    d.text((248, 115), "0: the rapiers' outer dead centre", anchor="start")
    d.text((170, 17), "velocity, acceleration", RED, "start")
    return d


def driven_shaft() -> Drawing:
    """Motor, inertia and braking torques on one shaft."""
    d = Drawing(480, 200, "Driven shaft: motor, inertia, torques of the mechanisms")
    d.path((120, 100), (420, 100), width=6, colour=GREY)
    d.box(30, 65, 100, 70)
    d.text((80, 97), "motor")
    d.text((80, 117), "k (w₀ \N{MINUS SIGN} w)")
    d.box(200, 30, 34, 140)
    d.text((217, 105), "J")
    for n, x in enumerate((290, 330, 370, 410), start=1):
        d.box(x - 6, 78, 12, 44)
        d.turn((x, 100), 34, 60, 120)
        d.text((x, 150), f"T{n}".translate(SUBSCRIPT), RED)
    d.text((350, 180), "torque 1 to 4, each braking the shaft", RED)
    d.turn((165, 100), 30, 120, 60, BLUE)
    d.text((165, 60), "angle, w", BLUE)
    return d


def weft_insertion() -> Drawing:
    """The crank-rocker, and the four-bar to scale, at 60 degrees of the shaft."""
    d = Drawing(
        640, 300, "Weft insertion: spherical crank-rocker, four-bar C-D-K-G to scale, gears, rapier wheel"
    )
    weft = WeftInsertion()
    assert weft.initialize(0.0) == 0
    chi, _first, _second = weft.sector(weft.crank(pi / 3))
    alpha, _first, _second = spherical_rocker(weft.crank(pi / 3), weft.rocker_angle, weft.crank_cone)
    psi = alpha + weft.rocker_offset
    scale, c = 430.0, (210.0, 240.0)
    g = (c[0] + scale * weft.pivot_x, c[1] - scale * weft.pivot_y)
    k = (g[0] + scale * weft.output_length * cos(chi), g[1] - scale * weft.output_length * sin(chi))
    d_pin = (c[0] + scale * weft.crank_length * cos(psi), c[1] - scale * weft.crank_length * sin(psi))
    assert abs(hypot(k[0] - d_pin[0], k[1] - d_pin[1]) - scale * weft.coupler_length) < 1e-6
    wheel = (g[0] + 136.0, g[1])
    d.circle(wheel, 74, fill=PALE)
    d.text((wheel[0] + 40, wheel[1] - 84), "rapier wheel, d")
    crank = (60.0, 200.0)
    d.circle(crank, 34, fill=PALE)
    pin = (crank[0] + 34 * cos(pi / 3), crank[1] - 34 * sin(pi / 3))
    d.path(crank, pin, colour=BLUE, width=3)
    d.path(pin, (140.0, 150.0), c, colour=BLUE, width=3)
    d.turn(crank, 48, 100, 170)
    d.text((60, 258), "shaft, theta")
    d.text((120, 138), "spherical crank-rocker")
    d.path(c, d_pin, k, g, colour=BLUE, width=4)
    d.joint(crank, pin, (140, 150), d_pin, k)
    for at in (c, g):
        d.pivot(at)
    rim_of_gear = [(g[0] + 120 * cos(0.05 * n), g[1] + 120 * sin(0.05 * n)) for n in range(-9, 10)]
    d.path(g, *rim_of_gear, g)
    d.circle(wheel, 16, fill="#fff")
    d.joint(wheel)
    rim = wheel[1] + 74
    d.path((wheel[0], rim), (600, rim), colour=RED, width=4)
    d.box(590, rim - 7, 34, 14, RED, RED)
    d.arrow((500, rim + 24), (590, rim + 24))
    d.text((545, rim + 44), "travel s", RED)
    d.text((g[0] + 20, g[1] - 46), "sector gear, i")
    labels = {"C": (c[0] - 18, c[1] - 4), "D": (d_pin[0] - 14, d_pin[1]), "K": (k[0] - 4, k[1] - 10)}
    for label, at in (labels | {"G": (g[0] + 12, g[1] - 10)}).items():
        d.text(at, label)
    return d


def belt_monitor() -> Drawing:
    """The belt between its guide and the head, straight and buckled."""
    d = Drawing(600, 220, "Belt monitor: free length of the belt between guide and rapier head, buckled")
    for y in (80, 128):
        d.box(20, y, 190, 22)
    d.path((20, 115), (210, 115), (420, 115), colour=GREY, width=2, dash="6 4")
    bow = [(210 + 210 * n / 30, 115 - 34 * sin(pi * n / 30)) for n in range(31)]
    d.path((20, 115), *bow, colour=BLUE, width=4)
    d.box(420, 95, 120, 40)
    d.text((480, 120), "head, m")
    d.arrow((590, 115), (545, 115))
    d.text((570, 100), "F_m", RED)
    d.arrow((315, 113), (315, 84), RED)
    d.text((330, 100), "y", RED, "start")
    d.arrow((210, 170), (420, 170), GREY, both=True)
    d.text((315, 190), "free length l")
    d.arrow((420, 170), (540, 170), GREY, both=True)
    d.text((480, 190), index("head length s1"))
    d.text((115, 70), "guide with clearance")
    d.arrow((480, 50), (540, 50), BLUE)
    d.text((470, 54), "travel s", BLUE, "end")
    return d


def belt_dynamics() -> Drawing:
    """The belt that comes out of its guide, bows and pushes the head."""
    d = Drawing(
        600, 220, "Belt dynamics: the belt moves through its guide and pushes the head, bent by its bow"
    )
    for y in (84, 128):
        d.box(20, y, 190, 22)
    d.path((20, 117), (210, 117), (420, 117), colour=GREY, width=2, dash="6 4")
    bow = [(210 + 210 * n / 30, 117 - 30 * sin(pi * n / 30) + 9 * sin(2 * pi * n / 30)) for n in range(31)]
    d.path((20, 117), *bow, colour=BLUE, width=4)
    d.joint((210, 117), (420, 117))
    d.box(420, 97, 120, 40)
    d.text((480, 122), "head, m")
    d.arrow((40, 68), (100, 68), BLUE)
    d.text((110, 72), "V, A", BLUE, "start")
    d.arrow((335, 115), (335, 90), RED)
    d.text((345, 108), "u(X, t)", RED, "start")
    d.arrow((420, 60), (340, 60), GREY)
    d.text((425, 64), "X", anchor="start")
    d.arrow((590, 117), (545, 117))
    d.text((570, 102), index("P0"), RED)
    d.arrow((210, 172), (420, 172), GREY, both=True)
    d.text((315, 192), "free length L(t)")
    return d


def weft_tension() -> Drawing:
    """The yarn from its package to the head."""
    d = Drawing(640, 240, "Weft tension: package, brake, guide eyes, the yarn on its way, the rapier head")
    y = 110.0
    d.path((30, y - 45), (90, y - 30), (90, y + 30), (30, y + 45), (30, y - 45), fill=PALE)
    d.text((60, y + 72), "package: T₀")
    d.path((90, y), (180, y), (250, y), (285, y + 42), (320, y), (560, y), colour=BLUE, width=3)
    d.circle((250, y + 9), 9, fill=PALE)
    d.circle((285, y + 33), 9, fill=PALE)
    d.circle((320, y + 9), 9, fill=PALE)
    d.text((285, y + 72), "eyes: μ, φ")
    for side in (-1, 1):
        d.box(160, y + 9 * side - 5, 40, 10)
        d.arrow((180, y + 52 * side), (180, y + 18 * side))
    d.text((180, y + 72), "brake: B")
    d.path((560, y - 14), (596, y - 14), (616, y), (596, y + 14), (560, y + 14), (560, y - 14), fill=PALE)
    d.text((585, y + 36), "head")
    d.arrow((570, y - 40), (625, y - 40))
    d.text((598, y - 50), "v, a", RED)
    d.arrow((190, y - 70), (560, y - 70), GREY, both=True)
    d.text((375, y - 78), "length L: q, EA, τ; drag c, d")
    d.text((440, y + 22), "tension", BLUE)
    return d


def weft_transfer() -> Drawing:
    """Both heads where they meet, with their travels and what they overlap by."""
    d = Drawing(640, 250, "Weft transfer: giver and taker in mid-shed, travels, separation, overlap")
    for x, sense, colour, symbol in ((60.0, 1, BLUE, "s1"), (580.0, -1, GREY, "s2")):
        tip = 320 + 30 * sense
        y = 100 - 16 * sense
        d.path((x - 40 * sense, y), (tip - 90 * sense, y), colour=colour, width=4)
        body = [(tip - 90 * sense, y - 13), (tip - 14 * sense, y - 13), (tip, y), (tip - 14 * sense, y + 13)]
        d.path(*body, (tip - 90 * sense, y + 13), body[0], colour=colour, fill=PALE)
        d.path((x, 40), (x, 220), dash="6 4")
        d.path((tip, 32), (tip, 165 + 15 * -sense), dash="3 3", width=1)
        d.arrow((x, 160 - 15 * sense), (tip, 160 - 15 * sense), colour)
        d.text((x + 110 * sense, 153 - 15 * sense), index(f"travel {symbol}"), colour)
    d.text((190, 70), "giver", BLUE)
    d.text((450, 102), "taker", GREY)
    d.arrow((290, 36), (350, 36), both=True)
    d.text((320, 26), "overlap", RED)
    d.arrow((60, 205), (580, 205), GREY, both=True)
    d.text((320, 225), "separation: tips of the heads at their outer dead centres")
    return d


def dobby_drive() -> Drawing:
    """The modulator between shaft and rotor, and the crank that lifts a frame."""
    d = Drawing(600, 240, "Dobby drive: shaft, modulator, rotor with the crank of a frame")
    shaft, rotor = (80.0, 120.0), (330.0, 120.0)
    d.circle(shaft, 50, fill=PALE)
    d.path(shaft, (shaft[0] + 35, shaft[1] - 35), colour=BLUE, width=3)
    d.turn(shaft, 62, 60, 120)
    d.text((80, 195), "shaft, x")
    d.box(165, 90, 90, 60)
    d.text((210, 117), "modulator")
    d.text((210, 137), "law, z")
    d.arrow((135, 120), (163, 120), GREY)
    d.arrow((255, 120), (275, 120), GREY)
    d.circle(rotor, 52, fill=PALE)
    crank = (rotor[0] + 42 * cos(0.7), rotor[1] - 42 * sin(0.7))
    d.path(rotor, crank, colour=BLUE, width=3)
    d.path(crank, (500, 120), colour=BLUE, width=3)
    d.turn(rotor, 64, 60, 120)
    d.text((330, 200), "rotor, S(x)")
    d.path((500, 40), (500, 200))
    d.box(488, 100, 24, 40)
    d.joint(shaft, rotor, crank, (500, 120))
    d.arrow((535, 190), (535, 50), RED, both=True)
    d.text((545, 124), "lift", RED, "start")
    return d


def heald_frame() -> Drawing:
    """A frame at its lift, with the warp it carries."""
    d = Drawing(600, 260, "Heald frame: lift, stroke, height of the warp at the rapier's station")
    d.path((30, 150), (570, 150), dash="6 4")
    d.text((60, 168), "closed shed")
    d.path((60, 150), (330, 70), (560, 150), colour=BLUE, width=3)
    d.box(300, 20, 60, 14)
    d.box(300, 126, 60, 14)
    for x in (310, 330, 350):
        d.path((x, 34), (x, 126))
    d.circle((330, 70), 5, BLUE, fill="#fff")
    d.path((300, 230), (360, 230), dash="5 4")
    d.arrow((395, 230), (395, 140), RED)
    d.text((405, 190), "lift", RED, "start")
    d.text((330, 248), "lowered position")
    d.arrow((455, 230), (455, 50), GREY, both=True)
    d.text((465, 205), "stroke H", anchor="start")
    d.arrow((170, 150), (170, 119), RED)
    d.text((160, 112), "warp_height", RED)
    d.text((60, 140), "fell")
    d.text((170, 168), "rapier")
    return d


def heald_damper() -> Drawing:
    """The carrier on its springs between the stops of the frame."""
    d = Drawing(640, 300, "Heald damper: carrier on four springs between stops inside its frame")
    d.box(80, 30, 300, 16)
    d.box(80, 254, 300, 16)
    d.path((80, 30), (80, 270), (380, 270), (380, 30), (80, 30))
    d.box(130, 130, 200, 40)
    d.text((230, 155), "carrier, m")
    for x in (150, 310):
        d.spring((x, 46), (x, 130))
        d.spring((x, 170), (x, 254))
    d.text((328, 92), "c", BLUE)
    for y in (70, 216):
        d.box(215, y if y > 100 else 46, 30, 38 if y > 100 else 34)
    d.text((208, 66), "stop", anchor="end")
    d.arrow((255, 82), (255, 128), GREY, both=True)
    d.text((262, 112), "Z", anchor="start")
    d.arrow((400, 150), (400, 100), RED)
    d.text((408, 128), "z: displacement in the frame", RED, "start")
    d.arrow((50, 250), (50, 150), BLUE)
    d.text((40, 140), "lift y", BLUE)
    d.arrow((230, 128), (230, 100), RED)
    d.text((222, 112), "F_w", RED, "end")
    return d


def warp_tension() -> Drawing:
    """A thread over its eye, from the fell to the back rest."""
    d = Drawing(600, 220, "Warp tension: a thread from the fell over the eye to the back rest")
    fell, eye, back = (60.0, 160.0), (240.0, 60.0), (540.0, 160.0)
    d.path(fell, back, dash="6 4")
    d.path(fell, eye, back, colour=BLUE, width=3)
    d.circle(eye, 6, BLUE, fill="#fff")
    d.circle((back[0], back[1] + 18), 18, fill=PALE)
    d.box(20, 156, 40, 8)
    d.arrow((240, 158), (240, 68), GREY, both=True)
    d.text((250, 120), "y", anchor="start")
    for x0, x1, label in ((60, 240, "l1"), (240, 540, "l2")):
        d.arrow((x0, 195), (x1, 195), GREY, both=True)
        d.text(((x0 + x1) / 2, 213), index(label))
    d.arrow((240, 52), (240, 18), RED)
    d.text((250, 30), "\N{MINUS SIGN}frame_load: the healds hold the threads up", RED, "start")
    d.text((140, 96), "T₀ + F", BLUE, "end")
    d.text((40, 148), "fell")
    d.text((548, 142), "back rest")
    return d


def heald_play() -> Drawing:
    """The bars in the loops of a heald, with the play between them."""
    d = Drawing(560, 300, "Heald play: the loops of a heald on the bars of its carrier")
    for y, label in ((40.0, "upper bar"), (240.0, "lower bar")):
        d.text((220, y + 15), label, anchor="end")
    for y in (22.0, 222.0):
        d.box(235, y, 30, 56, fill="none", colour=BLUE)
    d.box(242, 40, 16, 20)
    d.box(242, 240, 16, 20)
    d.path((250, 78), (250, 222), colour=BLUE, width=3)
    d.circle((250, 150), 7, BLUE, fill="#fff")
    d.path((110, 170), (243, 152), colour=GREY)
    d.path((257, 152), (390, 170), colour=GREY)
    d.text((160, 150), "thread, pulls with L / N")
    d.arrow((285, 60), (285, 78), GREY, both=True)
    d.arrow((285, 22), (285, 40), GREY, both=True)
    d.text((295, 55), "play: the sum of both", anchor="start")
    d.arrow((330, 250), (330, 200), RED)
    d.text((340, 228), "w: displacement in the play", RED, "start")
    d.arrow((30, 280), (30, 180), BLUE)
    d.text((40, 190), "lift y", BLUE, "start")
    return d


def pattern_lock() -> Drawing:
    """The pawl between two discs, thrown over by its spring."""
    d = Drawing(560, 280, "Pattern lock: the pawl, its spring, the slots of the two discs")
    pivot = (280.0, 60.0)
    for x, label in ((150.0, "disc"), (410.0, "disc")):
        d.circle((x, 210), 52, fill=PALE)
        d.text((x, 215), label)
    d.box(196, 200, 16, 22, "#fff")
    d.box(348, 200, 16, 22, "#fff")
    foot = (216.0, 205.0)
    d.path(pivot, foot, colour=BLUE, width=12)
    d.path(pivot, (344, 205), dash="6 4", colour=BLUE)
    d.pivot((280, 60))
    d.turn(pivot, 110, 248, 290)
    d.text((280, 190), "turn φ", RED)
    arm = (pivot[0] - 20, pivot[1] + 45)
    d.spring(arm, (90, 105))
    d.path((90, 90), (90, 120))
    d.text((160, 92), "spring: P, C", BLUE)
    d.arrow((300, 60), (300, 106), GREY, both=True)
    d.text((308, 88), "R", anchor="start")
    d.text((100, 146), "pawl: M, b, c", BLUE)
    return d


def reed_beat_up() -> Drawing:
    """The six-bar to scale, 60 degrees before the beat-up."""
    d = Drawing(600, 330, "Reed beat-up: crank, coupler, rocker with its arm, rod and reed, to scale")
    reed = ReedBeatUp(start_angle=-pi / 3)
    assert reed.initialize(0.0) == 0
    scale, origin = 330.0, (260.0, 295.0)

    def at(x: float, y: float) -> Point:
        return origin[0] + scale * x, origin[1] - scale * y

    crank = reed.beat_up_crank + reed.crank_direction * -pi / 3
    pin = (reed.crank_x + reed.crank_length * cos(crank), reed.crank_y + reed.crank_length * sin(crank))
    chi, _first, _second = reed.rocker(crank, 1.0)
    end = (reed.rocker_length * cos(chi), reed.rocker_length * sin(chi))
    arm = (reed.arm_length * cos(chi + reed.arm_angle), reed.arm_length * sin(chi + reed.arm_angle))
    centre = at(reed.crank_x, reed.crank_y)
    d.path(at(-0.1, reed.reed_height), at(0.85, reed.reed_height), dash="6 4")
    d.circle(centre, scale * reed.crank_length, PALE, 8)
    d.path(centre, at(*pin), at(*end), colour=BLUE, width=4)
    d.path(origin, at(*arm), colour=BLUE, width=5)
    d.path(at(*arm), at(reed.position, reed.reed_height), colour=BLUE, width=3)
    tip = at(reed.position, reed.reed_height)
    d.box(tip[0] - 6, tip[1] - 34, 12, 68)
    d.joint(at(*pin), at(*end), at(*arm), tip)
    d.pivot(centre)
    d.pivot(origin)
    for label, where in (
        ("l1", (centre[0] - 30, centre[1] - 6)), ("l2", at(-0.09, 0.475)), ("l3, q", at(0.05, 0.28)),
        ("l5", at(0.25, 0.71)), ("O", (centre[0] - 22, centre[1] + 22)),
    ):  # fmt: skip
        d.text(where, index(label))
    d.text((tip[0], tip[1] - 42), "reed")
    d.arrow((tip[0] + 20, tip[1] + 22), (tip[0] + 80, tip[1] + 22))
    d.text((tip[0] + 16, tip[1] + 44), "position x", RED, "start")
    d.arrow(at(0.8, 0.0), at(0.8, reed.reed_height), GREY, both=True)
    d.text(at(0.82, 0.25), "H", anchor="start")
    return d


def belt_wrap() -> Drawing:
    """The belt on its wheel, held at its end by a block."""
    d = Drawing(560, 280, "Belt wrap: the belt on its wheel, blocks that hold its ends")
    wheel = (240.0, 160.0)
    d.circle(wheel, 90, fill=PALE)
    arc = [(wheel[0] + 96 * cos(a * pi / 180), wheel[1] - 96 * sin(a * pi / 180)) for a in range(20, 161, 5)]
    left, right = (wheel[0] - 118, wheel[1] - 6), (wheel[0] + 118, wheel[1] - 6)
    d.path(left, *reversed(arc), right, colour=BLUE, width=4)
    for x, sense in ((left[0], 1), (right[0], -1)):
        d.box(x - 12 - 14 * sense, wheel[1] - 16, 24, 30)
        d.arrow((x - 70 * sense, wheel[1]), (x - 30 * sense, wheel[1]))
        d.text((x - 60 * sense, wheel[1] - 10), "F", RED)
    d.joint(wheel)
    d.arrow((wheel[0] - 64, wheel[1] + 64), (wheel[0] + 64, wheel[1] - 64), GREY, both=True)
    d.text((wheel[0] + 22, wheel[1] + 6), "D", anchor="start")
    d.text((420, 205), "block, clearance c")
    d.text((240, 48), "belt: EI, bent by M = 2 EI / D", BLUE)
    return d


def detaching_roller() -> Drawing:
    """Two pairs of rollers with the fringe between them."""
    d = Drawing(560, 300, "Detaching rollers: back and front roller with their top rollers")
    for x, label, torque in ((190.0, "back roller", "M₁"), (370.0, "front roller", "M₂")):
        d.circle((x, 200), 46, fill=PALE)
        d.circle((x, 108), 44, fill=PALE)
        d.joint((x, 200), (x, 108))
        d.arrow((x, 22), (x, 58))
        d.text((x + 10, 40), "P", RED, "start")
        d.turn((x, 200), 58, 230, 300)
        d.text((x, 282), f"{label}, {torque}")
        d.text((x + 6, 190), "r₁", anchor="start")
        d.text((x + 6, 112), "r₂", anchor="start")
    d.path((60, 153), (500, 153), colour=BLUE, width=3)
    d.arrow((450, 153), (510, 153), BLUE)
    d.text((85, 143), "fibres, n", BLUE)
    return d


def main() -> None:
    """Draw all of them."""
    for draw in (
        main_shaft, driven_shaft, weft_insertion, belt_monitor, belt_dynamics, weft_tension, weft_transfer,
        dobby_drive, heald_frame, heald_damper, warp_tension, heald_play, pattern_lock, reed_beat_up,
        belt_wrap, detaching_roller,
    ):  # fmt: skip
        draw().write(draw.__name__)


if __name__ == "__main__":
    main()
