"""A scene run without FMUs and without our master: by its components, and by fmpy's public methods."""

from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
from live_fmus import OK, Live
from numpy.typing import NDArray

from loomfmu.components import COMPONENTS
from loomfmu.cosim.run import run
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.declaring.variables import variables_of
from loomfmu.traces import Trace

# sources before sinks, written down by hand
STEMS = ("shaft", "weft", "belt", "dobby", "lock", "heald", "damper", "warp", "play", "reed")

SMALL = """
revolutions = {revolutions}
steps_per_revolution = {steps}
[loom]
machine = "WL680-3600"
head = "G6300 left"
weave = "10/01"
dampers = true
{rest}
"""

Signals = dict[str, NDArray[Any]]


def small(steps: int = 90, revolutions: float = 1, rest: str = "", **overrides: Any) -> Scene:
    """A loom with two frames."""
    text = SMALL.format(steps=steps, revolutions=revolutions, rest=rest)
    return scenes.parse(text, "small", {key.replace("__", "."): value for key, value in overrides.items()})


def traced(scene: Scene, directory: Path) -> Trace:
    """The trace of a scene's run, with live FMUs: what they fail with is worded by Python."""
    return run(scene, output=directory / f"{scene.name}.h5", flavour="live").trace


def in_order(scene: Scene) -> list[str]:
    names = sorted(scene.instances, key=lambda name: STEMS.index(name.split("_")[0]))
    for wire in scene.wires:
        assert names.index(wire.source[0]) < names.index(wire.sink[0]), str(wire)
    return names


def outputs(scene: Scene, name: str) -> list[str]:
    return [port.name for port in scene.instances[name].fmu.ports.values() if port.causality == "output"]


def by_components(scene: Scene) -> Signals:
    """Every output at every step, from the component classes alone."""
    order = in_order(scene)
    components = {name: COMPONENTS[scene.instances[name].fmu.name]() for name in order}
    wires = defaultdict(list)
    for wire in scene.wires:
        wires[wire.sink[0]].append((wire.source[0], wire.source[1], wire.sink[1]))
    found: dict[str, list[Any]] = defaultdict(list)

    def exchange(name: str) -> None:
        for source, origin, sink in wires[name]:
            setattr(components[name], sink, getattr(components[source], origin))

    def record(name: str) -> None:
        for variable in variables_of(type(components[name])):
            if variable.causality == "output":
                found[f"{name}.{variable.name}"].append(getattr(components[name], variable.name))

    for name in order:
        for variable, value in scene.instances[name].values.items():
            setattr(components[name], variable, value)
        exchange(name)
        assert components[name].initialize(0.0) == 0
        record(name)
    for step in range(scene.steps):
        for name in order:
            exchange(name)
            assert components[name].step(step * scene.step_size, scene.step_size) == 0
            record(name)
    return {signal: np.array(values) for signal, values in found.items()}


def by_public_methods(scene: Scene) -> Signals:
    """Every output at every step, from FMUs called through fmpy's public grouped methods."""
    order = in_order(scene)
    lives = {name: Live(scene.instances[name].fmu.name, name) for name in order}
    values: dict[tuple[str, str], Any] = {}
    found: dict[str, list[Any]] = defaultdict(list)

    def grouped(name: str, action: str, variables: list[str]) -> None:
        """Set from, or get into, `values`; one call for each type."""
        ports = scene.instances[name].fmu.ports
        sources = {wire.sink[1]: wire.source for wire in scene.wires if wire.sink[0] == name}
        for kind in ("Real", "Integer", "Boolean"):
            mine = [variable for variable in variables if ports[variable].kind == kind]
            references = [ports[variable].reference for variable in mine]
            method = getattr(lives[name].slave, f"{action}{kind}")
            if mine and action == "get":
                values.update(zip(((name, variable) for variable in mine), method(references), strict=True))
            elif mine:
                method(references, [values[sources[variable]] for variable in mine])

    def exchange(name: str) -> None:
        grouped(name, "set", [wire.sink[1] for wire in scene.wires if wire.sink[0] == name])

    def record(name: str) -> None:
        grouped(name, "get", outputs(scene, name))
        for variable in outputs(scene, name):
            found[f"{name}.{variable}"].append(values[name, variable])

    try:
        for name, live in lives.items():
            assert live.call("setupExperiment", None, 0.0, scene.steps * scene.step_size) == OK
            assert live.set(**scene.instances[name].values) == OK
            assert live.call("enterInitializationMode") == OK
            exchange(name)
            record(name)
        for live in lives.values():
            assert live.call("exitInitializationMode") == OK
        for step in range(scene.steps):
            for name, live in lives.items():
                exchange(name)
                assert live.step(step * scene.step_size, scene.step_size) == OK
                record(name)
    finally:
        for live in lives.values():
            live.free()
    return {signal: np.array(values) for signal, values in found.items()}
