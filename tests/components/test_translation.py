"""Components as self-contained modules: the same results in plain Python, and translated to C."""

import ast
import ctypes
import importlib.util
import random
import shutil
import subprocess
import sys
import types
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from driving import assign, declared, drawn_inputs, drawn_parameters, values

from loomfmu.components import COMPONENTS
from loomfmu.fmi.source import flatten

every_component = pytest.mark.parametrize("component", COMPONENTS.values(), ids=COMPONENTS)
STEPS = 300


def translator() -> str | None:
    """Pyccel's command beside the running Python, or none."""
    if importlib.util.find_spec("pyccel") is None or shutil.which("gcc") is None:
        return None
    return shutil.which("pyccel", path=str(Path(sys.executable).parent)) or shutil.which("pyccel")


def loaded(name: str, path: Path) -> types.ModuleType:
    found = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def translated(tmp_path_factory):
    """All components translated to C and compiled, each in a folder of its own."""
    command = translator()
    if command is None:
        pytest.skip("pyccel or gcc is not installed: nothing to translate with")

    def compiled(name: str) -> tuple[str, types.ModuleType]:
        module = f"translated_{name.lower()}"
        folder = folders[name]
        (folder / f"{module}.py").write_text(flatten(COMPONENTS[name]), encoding="utf-8")
        call = [command, f"{module}.py", "--language", "c"]
        run = subprocess.run(call, cwd=folder, capture_output=True, text=True, check=False)
        assert run.returncode == 0, run.stdout + run.stderr
        (library,) = folder.glob(f"{module}*.so")
        return name, loaded(module, library)

    folders = {name: tmp_path_factory.mktemp(name.lower()) for name in COMPONENTS}
    with ThreadPoolExecutor(2) as pool:
        return dict(pool.map(compiled, COMPONENTS))


def read(translated, variable):
    """A field of a translated component."""
    value = getattr(translated, variable.name)
    if variable.type is bool:
        # Pyccel's Python wrapper hands out True and False without counting the reference: after enough
        # reads the interpreter would free them. Only tests go through that wrapper.
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(value))
    return value


def in_step(component, other, seed, compare):
    """Both through the same random parameters, inputs and steps; `compare` looks at all fields after each.

    Seed 0 keeps to the default parameters.
    """
    rng = random.Random(seed)
    one = component(**drawn_parameters(component, rng)) if seed else component()
    assign(other, values(one))
    drawn = drawn_inputs(component, rng)
    for each in (one, other):
        assign(each, drawn)
    problem = one.initialize(0.0)
    assert other.initialize(0.0) == problem
    compare(one, other)
    if problem and not component.problems[problem - 1].warning:
        return
    time = 0.0
    for _ in range(STEPS):
        drawn = drawn_inputs(component, rng)
        step_size = rng.choice([1e-4, 1e-3, 3e-3])
        for each in (one, other):
            assign(each, drawn)
        problem = one.step(time, step_size)
        assert other.step(time, step_size) == problem
        compare(one, other)
        time += step_size


@every_component
def test_flattened_text_imports_math_alone(component):
    tree = ast.parse(flatten(component))
    imported = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
    assert [(type(node), node.module) for node in imported] == [(ast.ImportFrom, "math")]
    assert flatten(component) == flatten(component)


@every_component
def test_no_call_decides_whether_a_while_goes_on(component):
    # Pyccel 2.0 evaluates a function called in a while's condition once, before the loop; the functions
    # of math it calls each time
    tree = ast.parse(flatten(component))
    (imports,) = (node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom))
    from_math = {name.name for name in imports.names}
    for loop in (node for node in ast.walk(tree) if isinstance(node, ast.While)):
        called = {node.func.id for node in ast.walk(loop.test) if isinstance(node, ast.Call)}
        assert called <= from_math, ast.unparse(loop.test)


@every_component
@pytest.mark.parametrize("seed", range(4))
def test_flattened_component_gives_the_same_bits(component, seed):
    space: dict = {}
    exec(compile(flatten(component), component.__name__, "exec"), space)

    def compare(one, other):
        for variable in declared(component):
            # the same operations in the same order: no tolerance
            assert getattr(other, variable.name) == getattr(one, variable.name), variable.name

    fresh = space[component.__name__]()
    assert {variable.name: variable.start for variable in declared(component)} == vars(fresh)
    in_step(component, fresh, seed, compare)


@pytest.mark.no_cover
@every_component
@pytest.mark.parametrize("seed", range(4))
def test_translated_component_agrees(translated, component, seed):
    def compare(one, other):
        for variable in declared(component):
            value, found = getattr(one, variable.name), read(other, variable)
            assert type(found) is variable.type, variable.name
            # the same operations; a C compiler may round a fused one differently: promised is 1e-12
            assert found == pytest.approx(value, rel=1e-12, abs=1e-300), variable.name

    fresh = getattr(translated[component.__name__], component.__name__)()
    for variable in declared(component):
        assert read(fresh, variable) == variable.start
    in_step(component, fresh, seed, compare)


def test_a_step_never_goes_on_for_ever(translated):
    # pieces of motion beyond number, each short against 60 kHz, are a problem to report
    damper = translated["HealdDamper"].HealdDamper()
    damper.spring_stiffness, damper.carrier_mass = 1e12, 1e-3
    assert damper.initialize(0.0) == 0
    assert damper.step(0.0, 3600.0) == 1
    assert "more than 100,000 times" in COMPONENTS["HealdDamper"].problems[0].text
