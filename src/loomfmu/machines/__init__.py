"""Published machines, belts and measurements, as data files that name their source.

`MACHINES` and `HEADS` are the parameter sets that a scene picks by name.
"""

import csv
from importlib import resources

from .. import units
from ..errors import LoomfmuError, suggestion

# column of the data file -> (component, parameter, unit of the column)
MACHINE_COLUMNS = {
    "rocker_bc_ac_deg": ("WeftInsertion", "rocker_angle", "deg"),
    "crank_cone_ac_oc_deg": ("WeftInsertion", "crank_cone", "deg"),
    "rocker_offset_bc_dc_deg": ("WeftInsertion", "rocker_offset", "deg"),
    "crank_phase_deg": ("WeftInsertion", "crank_phase", "deg"),
    "dc_mm": ("WeftInsertion", "crank_length", "mm"),
    "dk_mm": ("WeftInsertion", "coupler_length", "mm"),
    "kg_mm": ("WeftInsertion", "output_length", "mm"),
    "pivot_x_mm": ("WeftInsertion", "pivot_x", "mm"),
    "pivot_y_mm": ("WeftInsertion", "pivot_y", "mm"),
    "assembly": ("WeftInsertion", "assembly", "1"),
    "wheel_diameter_mm": ("WeftInsertion", "wheel_diameter", "mm"),
    "head_length_mm": ("BeltMonitor", "head_length", "mm"),
    "idle_travel_mm": ("BeltMonitor", "idle_travel", "mm"),
}

# the parameter that takes the mass of the rapier head
HEAD_MASS = {"BeltMonitor": "head_mass", "WeftInsertion": "moving_mass"}

# kind of published data -> the components whose parameters it sets
TAKERS = {
    "machine": (*dict.fromkeys(owner for owner, _name, _unit in MACHINE_COLUMNS.values()), "WeftTransfer"),
    "head": tuple(HEAD_MASS),
}

Value = float | int | bool


def table(name: str) -> list[dict[str, str]]:
    """Rows of a data file, its `#` lines left out.

    >>> table("length_factor")[1]
    {'clearance_mm': '0.30', 'length_factor': '0.80'}
    """
    text = (resources.files(__name__) / f"{name}.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


MACHINES = {row["machine"]: row for row in table("weft_insertion_mechanisms")}
HEADS = {f"{row['belt']} {row['side']}": row for row in table("rapier_heads")}
PUBLISHED = {"machine": MACHINES, "head": HEADS}


def parameters(component: str, *, machine: str | None = None, head: str | None = None) -> dict[str, Value]:
    """Parameters (SI) that a component takes from a published machine and a rapier head.

    Raises:
        LoomfmuError: there is no machine or head of that name; the message suggests the nearest.

    >>> parameters("BeltMonitor", machine="WL680-3600", head="G6300 left")
    {'head_length': 0.55, 'idle_travel': 0.243, 'head_mass': 0.1105}
    """
    values: dict[str, Value] = {}
    if machine is not None:
        values |= _machine_parameters(component, named("machine", machine))
    if head is not None:
        mass = units.parse(f"{named('head', head)['mass_g']} g", "kg")
        name = HEAD_MASS.get(component)
        if name is not None:
            values[name] = mass
    return values


def _machine_parameters(component: str, row: dict[str, str]) -> dict[str, Value]:
    values: dict[str, Value] = {}
    for column, (owner, name, unit) in MACHINE_COLUMNS.items():
        if owner == component and row[column] != "":
            value = float(row[column]) * units.unit(unit).factor
            values[name] = int(value) if name == "assembly" else value
    if component == "WeftInsertion":
        values["planar_linkage"] = row["dc_mm"] != ""
        values["gear_ratio"] = float(row["gear_teeth_driver"]) / float(row["gear_teeth_driven"])
    if component == "WeftTransfer":  # each guide ends at an edge of the loom's width: identified
        values["separation"] = float(row["width_m"]) + 2e-3 * float(row["idle_travel_mm"])
    return values


def named(kind: str, name: object) -> dict[str, str]:
    """The data of a published machine or head. Raises LoomfmuError with the nearest name."""
    rows = PUBLISHED[kind]
    if not isinstance(name, str) or name not in rows:
        raise LoomfmuError(f"there is no {kind} {name!r}{suggestion(str(name), rows)}")
    return rows[name]
