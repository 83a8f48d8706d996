"""A scene as a C program: its components in one loop, or its native FMUs or one of all under a plain host.

All take `steps [file]`, print the seconds that the steps took, and write all outputs of every step to the
file if there is one. They are compiled as the FMUs are.
"""

import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from own import Source, with_fmus

from loomfmu.components import COMPONENTS
from loomfmu.cosim import whole
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.graph import step_order
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.declaring.variables import variables_of
from loomfmu.fmi.native import compiler, native_fmu, platforms
from loomfmu.fmi.native.translate import translate

HERE = Path(__file__).parent
KINDS = ("Real", "Integer", "Boolean")


@dataclass(frozen=True)
class Program:
    """A compiled program and what it writes: the names of its columns."""

    path: Path
    columns: tuple[str, ...]

    def seconds(self, steps: int) -> float:
        """Seconds that so many steps take."""
        return float(_run(str(self.path), str(steps)))

    def trace(self, steps: int) -> dict[str, Any]:
        """All outputs after every step, the start first."""
        file = self.path.with_suffix(".trace")
        _run(str(self.path), str(steps), str(file))
        rows = np.fromfile(file).reshape(steps + 1, len(self.columns))
        file.unlink()
        return dict(zip(self.columns, rows.T, strict=True))


def _run(*command: str, directory: Path | None = None) -> str:
    run = subprocess.run(command, cwd=directory, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        raise RuntimeError(f"{Path(command[0]).name}: {(run.stderr.strip().splitlines() or ['failed'])[0]}")
    return run.stdout


def _compiled(directory: Path, source: str, options: tuple[str, ...] = ()) -> Path:
    """A program from a C file of that directory, compiled with the flags of the FMUs."""
    target = next(iter(platforms.PLATFORMS[platforms.host()].targets))
    flags = [flag for flag in compiler.FLAGS if flag != "-shared"]
    program = directory / Path(source).stem
    _run(
        sys.executable,
        "-m",
        "ziglang",
        "cc",
        "-target",
        target,
        *flags,
        *options,
        "-o",
        str(program),
        source,
        "-lm",
        "-ldl",
        directory=directory,
    )
    return program


def _outputs(scene: Scene) -> list[tuple[str, str, str]]:
    """Instance, variable and kind of all outputs: in the order of the steps, those of a kind together."""
    order, _lagged = step_order(scene.instances, scene.wires)
    return [
        (name, port.name, kind)
        for name in order
        for kind in KINDS
        for port in scene.instances[name].fmu.ports.values()
        if port.causality == "output" and port.kind == kind
    ]


def _columns(scene: Scene) -> tuple[str, ...]:
    return tuple(f"{name}.{variable}" for name, variable, _kind in _outputs(scene))


# ---- one loop


def loop(source: Source, directory: Path) -> Program:
    """The components of a scene, translated and wired in one program, stepped as our master does."""
    scene = source.scene()
    text = "\n".join(_loop_parts(scene))
    (directory / "loop.c").write_text(text, encoding="utf-8")
    for name, place in (("python_arithmetic.h", native_fmu.SHELL), ("timed_loop.h", HERE)):
        (directory / name).write_bytes((place / name).read_bytes())
    return Program(_compiled(directory, "loop.c"), _columns(scene))


def _loop_parts(scene: Scene) -> Iterator[str]:
    order, lagged = step_order(scene.instances, scene.wires)
    if lagged:
        raise ValueError(f"a loop of wires is not translated: {lagged[0]}")
    yield "#define _POSIX_C_SOURCE 199309L"  # for the clock
    yield '#include <stdbool.h>\n#include <stdint.h>\n#include "python_arithmetic.h"\n'
    for component in dict.fromkeys(scene.instances[name].fmu.name for name in order):
        yield _component(component)
    for name in order:
        yield f"static struct {scene.instances[name].fmu.name} {name};"
    yield from _function("static void set_up(void)", _settings(scene, order))
    for action in ("initialize", "step"):
        arguments = "0.0" if action == "initialize" else "time, size"
        lines = []
        for name in order:
            lines += [
                f"{_place(scene, *wire.sink)} = {_place(scene, *wire.source)};"
                for wire in scene.wires
                if wire.sink[0] == name
            ]
            lines.append(
                f"if ({scene.instances[name].fmu.name}__{action}(&{name}, {arguments}) != 0) return 1;"
            )
        declared = "void" if action == "initialize" else "double time, double size"
        yield from _function(f"static int {action}_all({declared})", [*lines, "return 0;"])
    written = [
        f"*row++ = (double){_place(scene, name, variable)};" for name, variable, _kind in _outputs(scene)
    ]
    yield from _function("static void record(double *row)", written)
    yield f"#define COLUMNS {len(written)}\n#define STEP_SIZE {scene.step_size!r}\n"
    yield '#include "timed_loop.h"\n'


def _function(head: str, lines: list[str]) -> Iterator[str]:
    yield "\n".join([head, "{", *(f"    {line}" for line in lines), "}", ""])


def _component(name: str) -> str:
    """A translated component."""
    translated = translate(COMPONENTS[name]).plain
    return f"{translated.struct}\n\n{translated.functions}"


def _settings(scene: Scene, order: list[str]) -> list[str]:
    lines = []
    for name in order:
        instance = scene.instances[name]
        lines.append(f"{instance.fmu.name}__init__(&{name});")
        for variable, value in instance.values.items():
            lines.append(f"{_place(scene, name, variable)} = {_literal(value)};")
    return lines


def _place(scene: Scene, name: str, variable: str) -> str:
    """Where the C of a component keeps a variable."""
    component = COMPONENTS[scene.instances[name].fmu.name]
    return f"{name}.{next(v.member for v in variables_of(component) if v.name == variable)}"


def _literal(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else repr(value)


# ---- the native FMUs under a plain host


def host(source: Source, directory: Path) -> Program:
    """The native FMUs of a scene, called through FMI in the same order as by our master."""
    scene = with_fmus(source.scene(), "native")
    return Program(_hosted(scene, directory), _columns(scene))


def whole_fmu(source: Source, directory: Path) -> Program:
    """The scene as one native FMU under the same host; its columns are named as those of the others."""
    scene = source.scene()
    whole.export(scene, directory / "whole.fmu", (platforms.host(),))
    text = f'duration = {scene.step_size!r}\nstep = {scene.step_size!r}\n[all]\nfmu = "whole.fmu"\n'
    alone = scenes.parse(text, "alone", directory=directory)
    ports = alone.instances["all"].fmu.ports
    names = (ports[variable].own for _name, variable, _kind in _outputs(alone))
    return Program(_hosted(alone, directory), tuple(re.sub(r"\[(\d+)\]", r"_\1", name) for name in names))


def _hosted(scene: Scene, directory: Path) -> Path:
    """A host of the native FMUs of a scene."""
    (directory / "plan.h").write_text("\n".join(_plan(scene)), encoding="utf-8")
    for name in ("host.c", "timed_loop.h"):
        (directory / name).write_bytes((HERE / name).read_bytes())
    return _compiled(directory, "host.c", (f"-I{native_fmu.HEADERS}",))


def _plan(scene: Scene) -> Iterator[str]:
    """The tables that host.c reads."""
    order, _lagged = step_order(scene.instances, scene.wires)
    slots = {(name, variable): place for place, (name, variable, _kind) in enumerate(_outputs(scene))}
    yield f"#define INSTANCES {len(order)}\n#define COLUMNS {len(slots)}"
    yield f"#define STEP_SIZE {scene.step_size!r}\n"
    yield "static const struct made made[INSTANCES] = {"
    for name in order:
        fmu = scene.instances[name].fmu
        library = fmu.directory / "binaries" / platforms.host() / f"{fmu.identifier}.so"
        yield f'    {{"{name}", "{library}", "{fmu.guid}"}},'
    yield "};\n\nstatic const struct setting settings[] = {"
    for place, name in enumerate(order):
        instance = scene.instances[name]
        for variable, value in instance.values.items():
            port = instance.fmu.ports[variable]
            yield f"    {{{place}, {port.kind.upper()}, {port.reference}, {float(value)!r}}},"
    calls, moves = _calls(scene, order, slots)
    yield "};\n\nstatic const struct call calls[] = {"
    yield from (f"    {{{', '.join(map(str, call))}}}," for call in calls)
    yield "};\n\nstatic const unsigned references[] = {"
    yield f"    {', '.join(str(reference) for reference, _slot in moves)}"
    yield "};\n\nstatic const int slots[] = {"
    yield f"    {', '.join(str(slot) for _reference, slot in moves)}"
    yield "};"


def _calls(
    scene: Scene, order: list[str], slots: dict[tuple[str, str], int]
) -> tuple[list[tuple[int, str, str, int, int]], list[tuple[int, int]]]:
    """Calls of a step: instance, action, kind, first move, number of moves; and the moves of their values."""
    calls: list[tuple[int, str, str, int, int]] = []
    moves: list[tuple[int, int]] = []

    def call(place: int, action: str, kind: str, moved: list[tuple[int, int]]) -> None:
        if moved:
            calls.append((place, action, kind.upper(), len(moves), len(moved)))
            moves.extend(moved)

    for place, name in enumerate(order):
        ports = scene.instances[name].fmu.ports
        wires = [wire for wire in scene.wires if wire.sink[0] == name]
        for kind in KINDS:
            moved = [
                (ports[w.sink[1]].reference, slots[w.source]) for w in wires if ports[w.sink[1]].kind == kind
            ]
            call(place, "SET", kind, moved)
        calls.append((place, "STEP", "REAL", 0, 0))
        for kind in KINDS:
            own = [port for port in ports.values() if port.causality == "output" and port.kind == kind]
            call(place, "GET", kind, [(port.reference, slots[name, port.name]) for port in own])
    return calls, moves
