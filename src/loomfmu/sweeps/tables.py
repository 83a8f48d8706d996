"""The table of a sweep: its columns, and what they and the whole say of themselves.

One row for each combination: its number, the value on each axis, final values of signals, of each claim
whether it holds, whether it is decided, its worst value, its bound, the signed distance between them, its
numerical error and the verdict's note, whether all hold, the first one that does not, warnings, and why a row
could not be run. All in SI; a column's metadata has `unit`, `display_unit` and `description`, that of a claim
its name as `claim`; the table's has the texts of sweep and scene.
"""

import json
from dataclasses import asdict
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from .. import units
from ..cosim.importing.fmus import Port
from ..version import __version__
from .axes import Axis
from .plan import SweepPlan
from .varied import shown_unit
from .worker import Batch, ClaimResult, Label

TYPES = {"Real": pa.float64(), "Integer": pa.int64(), "Boolean": pa.bool_(), "Text": pa.string()}


def claim_columns(number: int, *parts: str) -> list[str]:
    """Names of the columns of a claim, counted from 0, for these parts of its `ClaimResult`."""
    return [f"claim_{number + 1}.{part}" for part in parts]


def table_of(plan: SweepPlan, rows: range, batch: Batch) -> Any:
    """The part of the table that a batch is."""
    numbers = np.arange(rows.start, rows.stop)
    columns = [numbers, *plan.columns(numbers).values(), *zip(*batch.results, strict=True)]
    schema = schema_of(plan, batch.labels)
    arrays = []
    values: Any
    for values, field in zip(columns, schema, strict=True):
        if field.type == pa.bool_():  # a Boolean of an FMU is a number
            values = [value if value is None else bool(value) for value in values]
        arrays.append(pa.array(values, type=field.type))
    return pa.Table.from_arrays(arrays, schema=schema)


def schema_of(plan: SweepPlan, labels: tuple[Label, ...]) -> Any:
    """Columns with their units, and what the table says of itself; a claim's unit only if it has a label."""
    fields = [
        pa.field("row", pa.int64(), metadata={"description": "Number of the combination"}),
        *(_axis(axis) for axis in plan.axes),
        *(_value(signal, plan.port(signal)) for signal in plan.values),
    ]
    for number in range(len(plan.scene.claims)):
        name = str(plan.scene.claims[number].get("name") or "")
        fields += _claim(number, name, labels[number] if labels else None)
    fields += [
        pa.field("holds", pa.bool_(), metadata={"description": "Whether all claims hold"}),
        pa.field("first_failing_claim", pa.string(), metadata={"description": "The first claim that fails"}),
        pa.field("warnings", pa.string(), metadata={"description": "Warnings of the FMUs and the master"}),
        pa.field("error", pa.string(), metadata={"description": "Why the combination could not be run"}),
    ]
    about = {
        "title": plan.title,
        "sweep": plan.text,
        "scene": plan.scene.text,
        "flavour": plan.flavour,
        "software": f"loomfmu {__version__}",
        "claims": json.dumps([asdict(label) for label in labels]),
        "pandas": json.dumps(_for_pandas(fields)),
    }
    return pa.schema(fields, metadata=about)


def _for_pandas(fields: list[Any]) -> dict[str, Any]:
    """Return pandas' metadata of Booleans: a row that could not be run has none, which its own type holds."""
    booleans = [field.name for field in fields if field.type == pa.bool_()]
    about = {"pandas_type": "bool", "numpy_type": "boolean", "metadata": None}
    columns = [{"name": name, "field_name": name, **about} for name in booleans]
    return {"index_columns": [], "column_indexes": [], "columns": columns}


def labels_of(table: Any) -> tuple[Label, ...]:
    """Return the labels of the claims of a table or of a part of it."""
    return tuple(Label(**each) for each in json.loads(table.schema.metadata[b"claims"]))


def column_of(table: Any, name: str) -> tuple[str, str, NDArray[np.float64]]:
    """The words of a column, the unit that people read it in, and its values in that; NaN for none."""
    about = about_column(table, name)
    display = about.get("display_unit", "1")
    values = table[name].cast("float64").to_numpy() / units.unit(display).factor
    words = about.get("description", name) if name.startswith("claim_") else name
    return words, shown_unit(about.get("unit", "1"), display), values


def about_column(table: Any, name: str) -> dict[str, str]:
    """Return what a column says of itself."""
    metadata = table.schema.field(name).metadata or {}
    return {key.decode(): text.decode() for key, text in metadata.items()}


def is_number(table: Any, name: str) -> bool:
    """Return whether a column has real numbers."""
    return bool(table.schema.field(name).type == TYPES["Real"])


def whole_table(plan: SweepPlan, parts: list[Any]) -> Any:
    """The parts as one table, sorted by row, the same whatever the parts were."""
    labels = next((found for part in parts if (found := labels_of(part))), ())
    schema = schema_of(plan, labels)
    joined = pa.concat_tables([part.cast(schema) for part in parts])
    joined = joined.sort_by("row").combine_chunks()
    return pa.Table.from_arrays(joined.columns, schema=schema)


def _axis(axis: Axis) -> Any:
    varied = axis.varied
    about = _about(varied.unit, varied.display, varied.description)
    about["axis"] = "sample" if axis.sampled else "grid"
    return pa.field(axis.key, TYPES[varied.kind], metadata=about)


def _value(signal: str, port: Port) -> Any:
    about = _about(port.unit, port.display, port.description)
    if port.meanings:
        about["meanings"] = " ".join(port.meanings)
        about["first_meaning"] = str(port.numbers[0])
    return pa.field(signal, TYPES[port.kind], metadata=about)


def _claim(number: int, name: str, label: Label | None) -> list[Any]:
    """The columns of a claim, which say its name if it has one of its own."""
    about: dict[str, str] = {}
    if label is not None:
        about = _about(label.unit, label.display_unit, label.claim) | {"signal": label.signal}
    said = {
        "holds": (pa.bool_(), {"description": about.get("description", "")}),
        "note": (pa.string(), {"description": "What limits the verdict"}),
        "decided": (pa.bool_(), {"description": "Whether it is decided"}),
    }
    types = [said.get(part, (pa.float64(), about)) for part in ClaimResult._fields]
    names = claim_columns(number, *ClaimResult._fields)
    named = {"claim": name} if name else {}
    return [
        pa.field(column, type_, metadata=words | named)
        for column, (type_, words) in zip(names, types, strict=True)
    ]


def _about(unit: str, display: str, description: str) -> dict[str, str]:
    return {"unit": unit, "display_unit": display, "description": description}
