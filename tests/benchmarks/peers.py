"""Third-party masters as configurations: each runs a system package of the same scene and FMUs.

Each in the best way it has: steps in bulk, not by a call from Python for each; recording by its own means.
"""

import ctypes
import shutil
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter
from typing import Any

import neighbours  # noqa: F401  the masters of the other tests
import numpy as np
from children import Timing
from own import Signals, Source

from loomfmu.cosim.scenes.scene import Scene
from loomfmu.cosim.ssp import export as ssp
from loomfmu.fmi.native.platforms import host

NOT_RUN = {
    "pyfmi": ("PyFMI", "not installable here: no wheel for this Python"),
    "OMSimulator": ("OMSimulator", "not installable here: its package fetches binaries from elsewhere"),
}
TRIED = 4  # steps before the clock starts


def absent() -> list[tuple[str, str]]:
    """Masters that are not run, and why."""
    unwritten = "it can be imported, but there was none to write this benchmark with"
    return [(name, unwritten if find_spec(module) else why) for module, (name, why) in NOT_RUN.items()]


class Peer:
    """What the masters share: the package, and how it is recorded."""

    def __init__(self, directory: Path, source: Source, flavour: str, recorded: str = "") -> None:
        self.directory, self.source, self.recorded = directory, source, recorded
        self.package = directory / "loom.ssp"
        self.scene: Scene = source.scene()
        ssp.export(self.scene, self.package, flavour, (host(),))
        self.time(45, 1.0)  # whatever is loaded, is loaded

    def time(self, steps: int, turns: float) -> Timing:
        """Seconds to set up, and for a revolution of so many steps."""
        raise NotImplementedError

    def step_size(self, steps: int) -> float:
        """A step [s]."""
        return self.source.scene(steps).step_size

    def outputs(self) -> list[tuple[str, str, Any]]:
        """Instance, variable and port of all outputs: what our trace records."""
        return [
            (name, port.name, port)
            for name, instance in self.scene.instances.items()
            for port in instance.fmu.ports.values()
            if port.causality == "output"
        ]


class Ecos(Peer):
    """ecos; `recorded` is "csv" for its writer."""

    def _open(self, steps: int) -> Any:
        from masters import ecospy

        simulation = ecospy().EcosSimulation(step_size=self.step_size(steps), ssp_path=str(self.package))
        if self.recorded:
            names = [f"{name}::{variable}" for name, variable, _port in self.outputs()]
            simulation.add_csv_writer(str(self.directory / "trace.csv"), identifiers=names)
        if not simulation.init(parameter_set=ssp.SET_NAME):
            raise RuntimeError("ecos does not initialise the package")
        return simulation

    def time(self, steps: int, turns: float) -> Timing:
        start = perf_counter()
        with self._open(steps) as simulation:
            set_up = perf_counter() - start
            simulation.step(TRIED)
            start = perf_counter()
            simulation.step(round(steps * turns))
            duration = perf_counter() - start
            simulation.terminate()
        return Timing(set_up, duration / turns)

    def signals(self, names: tuple[str, ...], steps: int) -> Signals:
        """Signals along their times, over one revolution from the end of the first step on.

        Its CSV files have too few digits.
        """
        rows: dict[str, list[float]] = {name: [] for name in names}
        with self._open(steps) as simulation:
            for _ in range(steps + 1):
                simulation.step(1)
                for name, values in rows.items():
                    values.append(simulation.get_real(name.replace(".", "::")))
            simulation.terminate()
        times = np.arange(1, steps + 2) * self.step_size(steps)
        return {"time": times, **{name: np.array(values) for name, values in rows.items()}}


class Libcosim(Peer):
    """libcosim; `recorded` is "series" for its observer in memory, "csv" for that of files."""

    def _open(self, steps: int) -> tuple[Any, Any]:
        from masters import libcosimpy

        cosim = libcosimpy()
        execution = cosim.Execution.from_ssp_file(str(self.package), round(1e9 * self.step_size(steps)))
        observer = None
        if self.recorded == "series":
            observer = cosim.Observer.create_time_series(10_000_000)
            execution.add_observer(observer)
            self._observe(execution, observer)
        elif self.recorded == "csv":
            observer = self._writer()
            execution.add_observer(observer)
        return execution, observer

    def _observe(self, execution: Any, observer: Any) -> None:
        """All outputs of the types that it keeps series of."""
        from libcosimpy.CosimEnums import CosimVariableType

        types = {"Real": CosimVariableType.REAL, "Integer": CosimVariableType.INTEGER}
        indices = {info.name.decode(): info.index for info in execution.slave_infos()}
        for name, _variable, port in self.outputs():
            if port.kind in types:
                observer.start_time_series(indices[name], port.reference, types[port.kind])

    def _writer(self) -> Any:
        """Its writer of CSV files, told which variables to write; the binding leaves that function out."""
        from libcosimpy._internal import libcosimc, wrap_function
        from libcosimpy.CosimObserver import CosimObserver

        log, told = self.directory / "log", self.directory / "LogConfig.xml"
        shutil.rmtree(log, ignore_errors=True)
        log.mkdir()
        lines = []
        for name in self.scene.instances:
            mine = [each for each in self.outputs() if each[0] == name and each[2].base_type != "Enumeration"]
            variables = "".join(f'<variable name="{variable}"/>' for _name, variable, _port in mine)
            lines.append(f'<simulator name="{name}" decimationFactor="1">{variables}</simulator>')
        told.write_text(f"<simulators>{''.join(lines)}</simulators>", encoding="utf-8")
        create = wrap_function(
            lib=libcosimc(),
            funcname="cosim_file_observer_create_from_cfg",
            argtypes=[ctypes.c_char_p, ctypes.c_char_p],
            restype=ctypes.POINTER(CosimObserver),
        )
        return CosimObserver(
            CosimObserver._CosimObserver__create_key, create(str(log).encode(), str(told).encode())
        )

    def time(self, steps: int, turns: float) -> Timing:
        start = perf_counter()
        execution, observer = self._open(steps)
        execution.step(TRIED)  # it initialises with the first
        set_up = perf_counter() - start
        start = perf_counter()
        if not execution.step(round(steps * turns)):
            raise RuntimeError("libcosim does not step the package")
        duration = perf_counter() - start
        del execution, observer
        return Timing(set_up, duration / turns)

    def signals(self, names: tuple[str, ...], steps: int) -> Signals:
        """Signals along their times, over one revolution from the end of the first step on."""
        execution, observer = self._open(steps)
        if not execution.step(steps + 1):
            raise RuntimeError("libcosim does not step the package")
        indices = {info.name.decode(): info.index for info in execution.slave_infos()}
        found = {"time": np.arange(1, steps + 2) * self.step_size(steps)}
        for signal in names:
            name, variable = signal.split(".")
            reference = self.scene.instances[name].fmu.ports[variable].reference
            series = observer.time_series_real_samples(indices[name], reference, 1, steps + 1)
            found[signal] = np.array(series[2])
        return found


class Fmpy(Peer):
    """fmpy's own master for packages, written in Python; it keeps all rows in memory."""

    def _run(self, steps: int, count: int) -> Any:
        from masters import fmpy_rows

        return fmpy_rows(self.source.scene(steps), self.package, count)

    def time(self, steps: int, turns: float) -> Timing:
        """Seconds of its one call until the last FMU is there, and from then to the end of the steps."""
        from fmpy.ssp import simulation

        marks: list[float] = []

        def marked(function: Any) -> Any:
            def call(*arguments: Any) -> Any:
                marks.append(perf_counter())
                result = function(*arguments)
                marks.append(perf_counter())
                return result

            return call

        instantiate, free = simulation.instantiate_fmu, simulation.free_fmu
        simulation.instantiate_fmu, simulation.free_fmu = marked(instantiate), marked(free)
        start = perf_counter()
        try:
            self._run(steps, round(steps * turns))
        finally:
            simulation.instantiate_fmu, simulation.free_fmu = instantiate, free
        begun, ended = marks[len(marks) // 2 - 1 : len(marks) // 2 + 1]
        return Timing(begun - start, (ended - begun) / turns)

    def signals(self, names: tuple[str, ...], steps: int) -> Signals:
        """Signals over one revolution from the end of the first step on.

        It stamps them with the times at the start of the steps.
        """
        rows = self._run(steps, steps + 1)
        times = rows["time"] + self.step_size(steps)
        return {"time": times, **{name: rows[name] for name in names}}
