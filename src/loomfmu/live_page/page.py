"""A scene as a page in which its FMUs themselves run, compiled to WebAssembly: one HTML file, offline.

Beside them it holds a run of the scene, which can be read and printed before anything is varied.
"""

import shlex
import tempfile
from base64 import b64encode
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from .. import units
from ..cosim.claims.claims import place_of
from ..cosim.importing.fmus import Fmu, build, unbuilt
from ..cosim.master.steppers import SOURCE
from ..cosim.reading import checked, drawn
from ..cosim.recorded import usual_path
from ..cosim.run import run
from ..cosim.scenes.headings import heading
from ..cosim.scenes.scene import Scene, files_of
from ..cosim.standard import standard
from ..cosim.whole import system
from ..declaring.upstream import sources_of, upstream
from ..declaring.variables import Variable, variables_of
from ..display.progress import progress
from ..errors import LoomfmuError, path_of
from ..extras import need
from ..files import check_target, starts_with, write_file
from ..fmi.native.libraries import library_of
from ..fmi.system.system import System, component_of
from ..fmi.system.system_fmu import module
from ..report.document import PRINT, assembled, sections
from ..report.section import Section, Subject
from ..report.templates import template
from ..traces import Trace
from .claims import Proven, claims, rules
from .knobs import Knob, Marks, ends_of, knobs

MARK = "<!DOCTYPE html>\n<!-- a page of loomfmu -->\n"
PAGE = starts_with("a page of loomfmu", MARK.encode(), suffix=".html", advice=PRINT)
Rows = dict[str, tuple[int, Variable]]  # the variables of the module, by name, with their numbers
POLICY = " 'wasm-unsafe-eval'"
SCRIPTS = ("live_steps.js", "live.js", "live_rules.js", "live_judge.js", "live_claims.js")


def write(
    scene: str | Path | Scene,
    vary: Sequence[str] = (),
    output: str | Path | None = None,
    set: dict[str, Any] | None = None,
    overwrite: bool = False,
    warn: Callable[[str], object] = lambda _warning: None,
    proven: Proven = ({}, {}),
    marks: Callable[[Scene, Knob], Marks] | None = None,
) -> Path:
    """Write the page of a scene and return its path.

    Args:
        scene: path of a scene file, or a scene that was read before
        vary: what can be varied, such as "shaft.speed=400rpm..800rpm" or "dobby.law"; a range is 20 % around
            the scene's value if none is given, and without anything it is the shaft's speed
        output: the file; `results/<scene>_page.html` below the current directory by default, with the values
            that differ from the scene's in its name
        set: values that differ from the scene's
        overwrite: also replace a file that is not such a page
        warn: called with each warning of the scene and of the ranges
        proven: what to say of claims that are proven, by their numbers, and the ranges for which they are
        marks: gives what is marked on each slider of a real number, such as
            `loomfmu.studies.limits.marks.marks`, which searches for the limits of all claims

    Raises:
        LoomfmuError: bad input, what cannot be compiled or varied, or the file cannot be written
    """
    need("a page that runs its scene", "report", "native")
    loaded = checked(scene, set, "native")
    path = path_of(output, "output") if output else usual_path(loaded, "_page.html")
    inputs = files_of(loaded)
    check_target(path, PAGE, inputs, overwrite)
    whole = system(loaded, "a page that runs the scene", "use loomfmu run --report")
    if whole.closing:
        sink, source = whole.closing[0]
        raise LoomfmuError(
            f"loop: {source} -> {sink} closes an algebraic loop, which a page that runs the scene cannot"
            f' hold; use loomfmu run --report, or cut the wire by [wires] "{sink}" = false'
        )
    rows = {each.name: (number, each) for number, each in enumerate(variables_of(component_of(whole)))}
    varied = knobs(loaded, [name for name, (_, each) in rows.items() if each.settable], vary)
    with tempfile.TemporaryDirectory(prefix="loomfmu-") as directory:
        stepping, judging = _compiled(whole, (loaded.instances[each.name].fmu for each in whole.parts))
        started = run(drawn(loaded), output=Path(directory) / "start.h5", progress=True)
        with started.trace as trace:
            subject = Subject([trace], live=True)
            data = _data(loaded, subject, rows, varied) | _stepping(whole, trace, rows)
            judged = claims(loaded, ends_of(loaded, varied), trace, started.claims, proven)
            data |= {"wasm": stepping, "judging": judged | {"wasm": judging}}
            ranges = [each for each in varied if not (each.choices or each.whole)]
            marked = {each.key: marks(loaded, each) for each in ranges if marks}
            controls = template("live.html.j2").render(knobs=varied, marked=marked)
            live = Section("live", "Values", controls, SCRIPTS, data)
            keys = [knob.key for knob in varied]
            called = f"{heading(loaded, keys)}; varied: {', '.join(keys)}"
            content = assembled(subject, [live, *sections(subject)], MARK, POLICY, called)
    bare = (
        f"{each.key} is not a real number: its limits are not marked" for each in varied if each not in ranges
    )
    doubts = (doubt for knob in varied for doubt in knob.doubts)
    left = (
        f"{place_of(table)} is not judged in the page: {row['not_live']}"
        for table, row in zip(loaded.claims, judged["claims"], strict=True)
        if "not_live" in row
    )
    for warning in dict.fromkeys((*doubts, *(bare if marks else ()), *left, *started.warnings)):
        warn(warning)
    return write_file(path, content.encode(), PAGE, inputs, overwrite)


def _compiled(whole: System, fmus: Iterable[Fmu]) -> list[str]:
    """The modules that step and judge the scene, compiled beside the libraries and FMUs of its run."""
    libraries = [partial(library_of, each) for each in (standard().RULES, SOURCE)]
    missing = [partial(build, [each]) for each in unbuilt(fmus)]
    makes: list[Callable[[], Any]] = [partial(module, whole), rules, *libraries, *missing]
    with progress("compiling the scene for the browser", len(makes)) as advance, ThreadPoolExecutor() as pool:
        made = [pool.submit(each) for each in makes]
        for each in made:
            each.add_done_callback(lambda _done: advance(1))
    return [b64encode(each.result()).decode() for each in made[:2]]


def _data(scene: Scene, subject: Subject, rows: Rows, varied: Sequence[Knob]) -> dict[str, Any]:
    """Return the data with which the script runs the module: rows of variables, and values that it lacks."""
    trace = subject.trace
    parameters = {name: row for name, (row, each) in rows.items() if each.settable}
    constants = {
        f"{name}.{port}": value
        for name, instance in scene.instances.items()
        for port, value in instance.effective().items()
        if f"{name}.{port}" not in rows
    }
    return {
        "steps": scene.steps,
        "signals": {name: _signal(trace, name, rows[name][1]) for name in trace if name in rows},
        "parameters": parameters,
        "constants": constants,
        "knobs": [asdict(knob) for knob in varied],
        "turns": subject.turns,
        **_command(
            str(trace.attributes.get("command", "loomfmu run SCENE.toml")), [knob.key for knob in varied]
        ),
    }


def _command(text: str, keys: Sequence[str]) -> dict[str, Any]:
    """Return the command that runs the scene, without the values of some keys, and those that it set."""
    words = shlex.split(text)
    given = [
        (place, key) for place, word in enumerate(words) if (key := word.partition("=")[0]) in keys and place
    ]
    left_out = {each for place, _key in given for each in (place - 1, place)}
    kept = [word for place, word in enumerate(words) if place not in left_out]
    return {"command": shlex.join(kept), "set": [key for _place, key in given]}


def _stepping(whole: System, trace: Trace, rows: Rows) -> dict[str, Any]:
    """Return the data with which the script steps only the parts that a changed value affects.

    `samples` are the row of each signal, the number of the part that it is of, and whether it feeds another
    part; those that are not recorded come last. `reaches` are each part and those that depend on it.
    """
    numbers = {part.name: number for number, part in enumerate(whole.parts, start=1)}  # 0 is what is driven
    owner = {name: name.partition(".")[0] for name in rows}
    sources = set(whole.wires.values())
    names = [*(name for name in trace if name in rows), *sorted(sources - set(trace))]
    sinks = sources_of((owner[sink], owner[source]) for sink, source in whole.wires.items())
    return {
        "samples": [(rows[name][0], numbers[owner[name]], int(name in sources)) for name in names],
        "reaches": {name: sorted(upstream([name], sinks), key=numbers.__getitem__) for name in numbers},
    }


def _signal(trace: Trace, name: str, variable: Variable) -> dict[str, Any]:
    display = trace.display(name)
    return {
        "unit": "" if display == "1" else display,
        "factor": units.unit(display).factor,
        "about": trace.description(name),
        "steps": variable.type is not float,
    }
