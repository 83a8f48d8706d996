"""What it costs to prove claims, and to confirm the proof: by the number of parameters that vary."""

import tempfile
from pathlib import Path
from statistics import median
from time import perf_counter

from own import DEMO
from records import Notes, Table, say
from texts import Find, parts, whole

import loomfmu
from loomfmu.studies.proving import certificate
from loomfmu.studies.proving.check import check

NAME = "proving"
COLUMNS = ("parameters", "boxes", "proven", "prove [s]", "confirm [s]", "repeats")
OVER = (
    "shaft.speed=300rpm..600rpm",
    "belt.guide_clearance=0mm..0.3mm",
    "belt.bending_stiffness=0.245..0.255",
    "belt.head_mass=105g..113g",
)
# repeats, numbers of parameters
KINDS: dict[str, tuple[int, tuple[int, ...]]] = {
    "full": (3, (0, 1, 2, 4)),
    "quick": (3, (0, 1)),
    "tiny": (1, (0,)),
}


def measure(effort: str, notes: Notes) -> list[Table]:
    """The demonstration loom, all claims; the first of each builds the libraries and does not count."""
    repeats, counts = KINDS[effort]
    table = Table(NAME, COLUMNS)
    for count in counts:
        say(f"{NAME}: {count} parameters")
        times = []
        for _ in range(repeats + 1):
            start = perf_counter()
            found = loomfmu.prove(DEMO, over=OVER[:count])
            times.append(perf_counter() - start)
        with tempfile.TemporaryDirectory() as folder:
            certificate.write(found, Path(folder, "proof.json"))
            start = perf_counter()
            if count < 2:  # it takes minutes with more
                check(Path(folder, "proof.json"))
            confirmed = perf_counter() - start if count < 2 else "-"
        boxes, proven = sum(each.boxes for each in found.claims), sum(map(bool, found.claims))
        table.add(count, boxes, proven, median(times[1:]), confirmed, repeats)
    return [table]


def section(find: Find) -> str:
    """All claims of the demonstration loom that can be proven."""
    return parts(
        "All claims of the demonstration loom but the one on its damper, for all shaft angles of three"
        f" revolutions and the first of these ranges: {', '.join(OVER)}. Confirming runs"
        " the components' Python on intervals.",
        whole(find(NAME)),
    )
