"""A scene as a system package for other tools: SSP 1.0, or SSP 2.0 where its FMUs are of FMI 3.0.

It holds the FMUs, the wiring with units and a diagram, the values of each instance as a parameter set, the
step in the annotations that the Open Simulation Platform and OMSimulator read, and the text of the scene in
one of our own. OMSimulator refuses elements that it does not know, so there is no ssd:SystemGeometry, and our
annotation stands where it passes over the ones of others.
"""

import math
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

from ...declaring.variables import AT_STEP_END
from ...errors import LoomfmuError, listed
from ...files import check_target, write_file, zip_with
from ...fmi import fmu_files
from ...fmi.description.model_description import DEFAULT_TOLERANCE
from ...fmi.description.xml_text import text_of
from ...fmi.native import platforms as native
from ...own import load
from ...version import __version__
from ..importing import fmus
from ..importing.conversions import Definition
from ..importing.fmus import Fmu, Port, Value
from ..scenes.graph import step_order
from ..scenes.headings import heading
from ..scenes.instances import Instance
from ..scenes.scene import Scene, files_of
from .layout import Box, bends, layout
from .outside import add_connectors, outer_connectors
from .xml import (
    FMU,
    OMS,
    OSP,
    OURS,
    PARAMETER_SET,
    SSD_FILE,
    connector,
    of_ssp_2,
    root,
    stated_unit,
    write_units,
)

PACKAGE = zip_with("a system package of loomfmu", SSD_FILE, ".ssp")
SET_NAME = "parameters"  # of every instance's set: ecos takes all sets of one name, libcosim the first

Files = dict[str, bytes]


def export(
    scene: Scene,
    path: Path,
    flavour: str | None = None,
    platforms: tuple[str, ...] | None = None,
    overwrite: bool = False,
    fmi: int = 2,
    connectors: bool = False,
) -> list[str]:
    """Write a scene as a system package, and return warnings about what other tools will do differently.

    `flavour` is "live" or "native", native by default if such FMUs can be built; `platforms` are those of
    native ones, all by default, `fmi` the version of FMI that these are for. With `connectors` the system has
    some, which libcosim and ecos reject. The same scene gives the same bytes. `overwrite` replaces a file
    that is not a system package of ours.

    Raises:
        LoomfmuError: an FMU cannot be built, the scene is a package itself, or the file cannot be written
    """
    if scene.package is not None:
        raise LoomfmuError(f"{scene.package} is already a system package")
    if own := next((str(each["kind"]) for each in scene.claims if load.is_file(each.get("kind"))), ""):
        raise LoomfmuError(f"{own} judges a claim, and a system package holds no Python files; leave it out")
    inputs = files_of(scene)
    check_target(path, PACKAGE, inputs, overwrite)  # before the FMUs are built
    flavour = flavour or default_flavour(scene)
    if flavour == "live" and fmi != 2:
        raise LoomfmuError("live FMUs are of FMI 2.0: choose native ones for FMI 3.0")
    content = fmu_files.zipped(contents(scene, flavour, platforms, fmi, connectors))
    write_file(path, content, PACKAGE, inputs, overwrite)
    return [*scene.notes, *_driven(scene), *_looped(scene), *_enumerated(scene)]


def _driven(scene: Scene) -> list[str]:
    return [
        f"{drive.instance}.{drive.variable} is driven along a table, which a system package cannot hold:"
        " other tools keep it at its first value"
        for drive in scene.drives
    ]


def _looped(scene: Scene) -> list[str]:
    """A warning about wires that close algebraic loops."""
    lagged = step_order(scene.instances, scene.wires)[1]
    if not lagged:
        return []
    wires = listed(f"{'.'.join(wire.source)} to {'.'.join(wire.sink)}" for wire in lagged)
    late = "other tools may hand over a step late what runs along them"
    return [f"wires close an algebraic loop, {wires}: {late}; loomfmu export --fmu iterates it in one FMU"]


def _enumerated(scene: Scene) -> list[str]:
    """Warnings about choices that other tools cannot set, since they do not support enumerations."""
    return [
        f"{name}.{variable} is an enumeration: libcosim and ecos reject the package, OMSimulator leaves"
        " it at its default"
        for name, instance in scene.instances.items()
        for variable in _values(scene, instance)
        if instance.fmu.ports[variable].choices
    ]


def default_flavour(scene: Scene) -> str:
    """Native where such FMUs can be built, or come with the package."""
    lacking = any(instance.fmu.no_native for instance in scene.instances.values())
    return "live" if lacking else "native"


def contents(
    scene: Scene,
    flavour: str,
    platforms: tuple[str, ...] | None = None,
    fmi: int = 2,
    connectors: bool = False,
) -> Files:
    """All files of the package by their names in it."""
    files: Files = {}
    sources: dict[str, str] = {}

    def written(document: Element) -> bytes:
        return text_of(of_ssp_2(document) if fmi == 3 else document)

    for name, instance in scene.instances.items():
        file = _file(instance.fmu, flavour, platforms or tuple(native.PLATFORMS), fmi)
        sources[name] = _place(files, file)
        values = _values(scene, instance)
        if values:
            files[f"resources/{name}.ssv"] = written(_parameter_set(instance, values))
    files[SSD_FILE] = written(_structure(scene, sources, files, connectors))
    return files


def _file(fmu: Fmu, flavour: str, platforms: tuple[str, ...], fmi: int) -> Path:
    """The file of an FMU: built in that flavour, or the one that the scene names."""
    if fmu.component is None or not fmu.built:
        return fmu.path
    return fmus.file_of(fmu.component, flavour, platforms, fmi)


def _place(files: Files, file: Path) -> str:
    """Put an FMU into the package, once, and return its name there."""
    content, number = file.read_bytes(), 1
    source = f"resources/{file.stem}.fmu"
    while files.get(source, content) != content:  # another FMU has that name
        number += 1
        source = f"resources/{file.stem}_{number}.fmu"
    files[source] = content
    return source


# ---- parameters


def _values(scene: Scene, instance: Instance) -> dict[str, Value]:
    """Return the start values to set; an input driven by a table has its first value.

    `inputs_at_step_end` is about the master, not the loom: other tools hand over values of the step's
    start, which is its default. So it is left out unless the scene itself sets it. A choice is left out
    where it is the default: libcosim and ecos reject a package in which one is set.
    """
    driven = {d.variable: d.values[0] for d in scene.drives if d.instance == instance.name}
    return {
        name: value
        for name, value in (instance.values | driven).items()
        if not (name == AT_STEP_END and value is True)
        and not (instance.fmu.ports[name].choices and value == instance.fmu.ports[name].start)
    }


def _parameter_set(instance: Instance, values: dict[str, Value]) -> Element:
    """The values of an instance, those of an enumeration as the names of its items."""
    document = root(
        "ssv:ParameterSet",
        "ssv",
        "ssc",
        version="1.0",
        name=SET_NAME,
        generationTool=f"loomfmu {__version__}",
    )
    listed = SubElement(document, "ssv:Parameters")
    units: dict[str, Definition] = {}
    for name, value in values.items():
        port = instance.fmu.ports[name]
        parameter = SubElement(listed, "ssv:Parameter", name=port.own)
        if port.choices:
            SubElement(parameter, "ssv:Enumeration", value=port.choice(value))
            continue
        attributes = {"value": str(value).lower() if port.kind == "Boolean" else repr(value)}
        if stated_unit(port) and port.definition is not None:
            attributes["unit"] = port.unit
            units[port.unit] = port.definition
        SubElement(parameter, f"ssv:{port.kind}", attributes)
    write_units(document, "ssv:Units", units)
    return document


# ---- structure


def _structure(scene: Scene, sources: dict[str, str], files: Files, connectors: bool) -> Element:
    prefixes = ("ssd", "ssc", "osp", "oms", "loomfmu")
    document = root(
        "ssd:SystemStructureDescription",
        *prefixes,
        version="1.0",
        name=scene.name,
        description=heading(scene),
        generationTool=f"loomfmu {__version__}",
    )
    system = SubElement(document, "ssd:System", name=scene.name, description=heading(scene))
    ports = _connectors(scene)
    boxes = layout(
        list(scene.instances),
        scene.wires,
        {name: ([p.name for p in ins], [p.name for p in outs]) for name, (ins, outs) in ports.items()},
    )
    elements = SubElement(system, "ssd:Elements")
    for name in scene.instances:
        bound = f"resources/{name}.ssv" if f"resources/{name}.ssv" in files else None
        _component(elements, name, sources[name], ports[name], boxes[name], bound)
    _connections(system, scene, boxes)
    _master(system, scene)
    every = [port for ins, outs in ports.values() for port in (*ins, *outs)]
    if connectors:
        add_connectors(system, outer := outer_connectors(scene))
        every += [each.port for each in outer]
    used = {p.unit: p.definition for p in every if stated_unit(p) and p.definition}
    write_units(document, "ssd:Units", used)
    _experiment(document, scene)
    return document


def _connectors(scene: Scene) -> dict[str, tuple[list[Port], list[Port]]]:
    """Inputs and outputs of each instance that are shown.

    Inputs are those that are wired: fmpy wires one that is left open to the source it has last met.
    Enumerations are shown where they are wired, as integers, since libcosim knows no enumeration.
    """
    wired = {wire.source for wire in scene.wires}
    shown: dict[str, tuple[list[Port], list[Port]]] = {}
    for name, instance in scene.instances.items():
        ports = instance.fmu.ports.values()
        outputs = [port for port in ports if port.causality == "output" and not port.inner]
        kept = [port for port in outputs if port.base_type != "Enumeration" or (name, port.name) in wired]
        shown[name] = [], kept
    for wire in scene.wires:
        owner, variable = wire.sink
        shown[owner][0].append(scene.instances[owner].fmu.ports[variable])
    return shown


def _component(
    elements: Element,
    name: str,
    source: str,
    ports: tuple[list[Port], list[Port]],
    box: Box,
    bound: str | None,
) -> None:
    component = SubElement(
        elements, "ssd:Component", name=name, type=FMU, source=source, implementation="CoSimulation"
    )
    if any(ports):
        listed = SubElement(component, "ssd:Connectors")
        for kind, x, chosen, heights in (
            ("input", "0", ports[0], box.inputs),
            ("output", "1", ports[1], box.outputs),
        ):
            for port in chosen:
                written = connector(listed, port.own, kind, port)
                SubElement(written, "ssd:ConnectorGeometry", x=x, y=repr(round(heights[port.name], 6)))
    SubElement(
        component,
        "ssd:ElementGeometry",
        x1=repr(box.left),
        y1=repr(box.bottom),
        x2=repr(box.right),
        y2=repr(box.top),
    )
    if bound is not None:
        bindings = SubElement(component, "ssd:ParameterBindings")
        SubElement(bindings, "ssd:ParameterBinding", type=PARAMETER_SET, source=bound)


def _connections(system: Element, scene: Scene, boxes: dict[str, Box]) -> None:
    if not scene.wires:
        return
    listed = SubElement(system, "ssd:Connections")
    for wire in scene.wires:
        (source, output), (sink, entry) = wire.source, wire.sink
        connection = SubElement(
            listed,
            "ssd:Connection",
            startElement=source,
            startConnector=scene.instances[source].fmu.ports[output].own,
            endElement=sink,
            endConnector=scene.instances[sink].fmu.ports[entry].own,
        )
        points = bends(wire, boxes)
        SubElement(
            connection,
            "ssd:ConnectionGeometry",
            pointsX=" ".join(map(repr, points[0])),
            pointsY=" ".join(map(repr, points[1])),
        )


def _master(system: Element, scene: Scene) -> None:
    """Write what OMSimulator requires of a system: the master that steps it, and the end time."""
    (annotation,) = _annotations(system, OMS)
    information = SubElement(SubElement(annotation, "oms:Annotations"), "oms:SimulationInformation")
    SubElement(
        information,
        "oms:FixedStepMaster",
        description="oms-ma",
        stepSize=_plain(scene.step_size),
        relativeTolerance=repr(DEFAULT_TOLERANCE),
    )


def _experiment(document: Element, scene: Scene) -> None:
    """Start, stop and step, and the text of the scene."""
    experiment = SubElement(
        document, "ssd:DefaultExperiment", startTime="0.0", stopTime=_plain(scene.steps * scene.step_size)
    )
    step, ours = _annotations(experiment, OSP, OURS)
    algorithm = SubElement(step, "osp:Algorithm")
    SubElement(algorithm, "osp:FixedStepAlgorithm", baseStepSize=repr(_whole_nanoseconds(scene.step_size)))
    if scene.step is None:
        times = {"revolutions": repr(scene.periods), "steps_per_revolution": repr(scene.steps_per_period)}
    else:
        times = {"duration": repr(scene.periods), "step": repr(scene.step)}
    SubElement(ours, "loomfmu:Scene", times).text = scene.text


def _plain(time: float) -> str:
    """A time without the rounding of the products that it comes from.

    >>> _plain(0.09999999999999999)
    '0.1'
    """
    return repr(float(f"{time:.15g}"))


def _whole_nanoseconds(step_size: float) -> float:
    """The step as libcosim counts it, in whole nanoseconds: it cuts off what a rounded product lacks.

    >>> _whole_nanoseconds(9.999999999999999e-05)
    0.0001
    """
    count = max(1, round(step_size * 1e9))
    nearest = count * 1e-9
    return nearest if int(nearest * 1e9) == count else math.nextafter(nearest, math.inf)


def _annotations(parent: Element, *kinds: str) -> list[Element]:
    section = SubElement(parent, "ssd:Annotations")
    return [SubElement(section, "ssc:Annotation", type=kind) for kind in kinds]
