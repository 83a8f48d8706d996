"""From Python to C: the same results, and one line for what does not translate."""

import ctypes
import itertools
import math
import os
import re
import subprocess

import pytest
import toys
from compiled import WARNINGS, compiled, library

from loomfmu.components import COMPONENTS
from loomfmu.declaring.variables import Problem, variables_of
from loomfmu.fmi.native import translate as translating
from loomfmu.fmi.native.native_fmu import sources
from loomfmu.fmi.native.tables import tables
from loomfmu.fmi.native.translate import TranslationError, translate

HELPERS = """
int64_t whole(double x) { return python_whole(x); }
int64_t modulo(int64_t a, int64_t b) { return python_modulo_int(a, b); }
int64_t division(int64_t a, int64_t b) { return python_floor_division_int(a, b); }
double fmodulo(double a, double b) { return python_modulo_float(a, b); }
double floor_division(double a, double b) { return python_floor_division_float(a, b); }
"""


@pytest.fixture(scope="module")
def helpers(gcc, tmp_path_factory):
    loaded = library(toys.Arithmetic, tmp_path_factory.mktemp("helpers"), HELPERS)
    doubles, wholes = (ctypes.c_double, ctypes.c_double), (ctypes.c_int64, ctypes.c_int64)
    for name, kinds in (
        ("fmodulo", doubles),
        ("floor_division", doubles),
        ("modulo", wholes),
        ("division", wholes),
    ):
        getattr(loaded, name).argtypes, getattr(loaded, name).restype = kinds, kinds[0]
    loaded.whole.argtypes, loaded.whole.restype = [ctypes.c_double], ctypes.c_int64
    return loaded


def test_arithmetic_is_pythons(gcc, tmp_path):
    translated = compiled(toys.Arithmetic, tmp_path)
    values = [-7.75, -3.0, -0.5, 0.5, 1.25, 2.0, 6.5, 1e3]
    for x, y in itertools.product(values, values):
        for count in (-9, -1, 0, 3, 8, 14):
            python, c = toys.Arithmetic(x=x, y=y, count=count), translated()
            c.x, c.y, c.count = x, y, count
            assert python.step(0.0, 0.0) == c.step(0.0, 0.0) == 0
            for variable in variables_of(toys.Arithmetic):
                found, wanted = getattr(c, variable.name), getattr(python, variable.name)
                # a C compiler may write x**2 as a product, whose last bit may differ from that of pow()
                assert found == pytest.approx(wanted, rel=1e-15), (variable.name, x, y, count)


def test_arrays_are_read_and_set_as_in_python(gcc, tmp_path):
    python, c = toys.Arrays(), compiled(toys.Arrays, tmp_path)()
    for index in range(-3, 3):
        python.index = c.index = index
        assert python.step(0.25, 0.5) == c.step(0.25, 0.5) == 0
        for variable in variables_of(toys.Arrays):
            assert getattr(c, variable.name) == getattr(python, variable.name), (variable.name, index)


@pytest.mark.parametrize("index", [-(2**63), -(2**60), -4, 3, 4, 2**60, 2**63 - 1])
def test_beside_an_array_nothing_is_read(gcc, tmp_path, index):
    python, c = toys.Arrays(), compiled(toys.Arrays, tmp_path)()
    python.index = c.index = index
    with pytest.raises(IndexError):
        python.step(0.0, 0.0)
    assert c.step(0.0, 0.0) == 0
    assert math.isnan(c.real) and c.whole == 2**60 and c.truth is False


@pytest.mark.parametrize("index", [-3, 2, 2**40])
def test_beside_an_array_nothing_is_written(gcc, tmp_path, index):
    python, c = toys.Vectors(), compiled(toys.Vectors, tmp_path)()
    python.place = c.place = index
    with pytest.raises(IndexError):
        python.step(1.0, 0.5)
    assert c.step(1.0, 0.5) == 0
    assert math.isnan(c.written_1) and math.isnan(c.written_2)


def test_a_function_is_translated_once_for_each_size(gcc):
    code = translate(toys.Vectors).code
    assert re.findall(r"^static double Vectors_inner_\w+\(.*\)(?=;)", code, re.MULTILINE) == [
        "static double Vectors_inner_2_2(const struct Vectors_float_2 *a, const struct Vectors_float_2 *b)",
        "static double Vectors_inner_4_4(const struct Vectors_float_4 *a, const struct Vectors_float_4 *b)",
    ]


@pytest.mark.parametrize("component", [toys.CallsInWhile, toys.ReadsItsResult, toys.Loops, toys.Vectors])
def test_what_c_does_in_another_way_is_done_as_in_python(gcc, tmp_path, component):
    python, c = component(), compiled(component, tmp_path)()
    for time in (0.0, 0.5, 2.0):
        assert python.step(time, 0.25) == c.step(time, 0.25) == 0
        for variable in variables_of(component):
            assert getattr(c, variable.name) == getattr(python, variable.name), variable.name


def test_remainders_and_quotients(helpers):
    floats = [-8.0, -5.5, -1.0, -0.1, -0.0, 0.0, 0.1, 1.0, 3.0, 1e300, 5e-324, math.inf]
    for a, b in itertools.product(floats, floats):
        if b != 0.0 and not math.isinf(a):
            for found, wanted in ((helpers.fmodulo(a, b), a % b), (helpers.floor_division(a, b), a // b)):
                assert math.copysign(1.0, found) == math.copysign(1.0, wanted) and found == wanted, (a, b)
    integers = [-(2**63), -(2**60), -17, -3, -1, 1, 2, 5, 2**60, 2**63 - 1]
    for a, b in itertools.product([*integers, 0], integers):
        assert helpers.modulo(a, b) == a % b
        assert helpers.division(a, b) == min(a // b, 2**63 - 1)
    assert helpers.modulo(5, 0) == helpers.division(5, 0) == 0  # Python raises


def test_whole_numbers_of_any_double_are_defined(helpers):
    for value in (-2.9, 2.9, 0.0, -(2.0**53), 2.0**59):
        assert helpers.whole(value) == int(value)
    for value in (1e30, math.inf):
        assert helpers.whole(value) == 2**60 and helpers.whole(-value) == -(2**60)
    assert helpers.whole(math.nan) == 0


@pytest.mark.parametrize("name", COMPONENTS)
def test_it_holds_no_globals_and_all_variables_in_their_order(tools, name):
    translated = translate(COMPONENTS[name])
    found = re.findall(r"^    \w+ (\w+)(?:\[(\d+)\])?;", translated.header, re.MULTILINE)
    arrays = {array: [f"{array}_{place + 1}" for place in range(int(size))] for array, size in found if size}
    members = [name for member, _size in found for name in arrays.get(member, [member])]
    assert members == [v.name for v in variables_of(COMPONENTS[name])]
    for line in translated.code.splitlines():
        if line and line[0] not in " {}/" and not line.startswith(("#", " *")):
            assert line.startswith(("static ", "struct ")) and ("(" in line or line.endswith("};")), line


def test_translations_repeat(tools):
    first = translate(COMPONENTS["MainShaft"])
    translating._done.clear()
    again = translate(COMPONENTS["MainShaft"])
    assert (again.plain, again.dual) == (first.plain, first.dual)


@pytest.mark.parametrize(
    ("component", "function", "line", "reason"),
    [
        (toys.UsesDictionary, "step", "values = {0: time}", "Dict is not in the subset"),
        (toys.DependsOnOrder, "step", "self.total = self.value + self.counted(time)",
         "counted() changes what the rest of this line uses: write two statements"),
        (toys.ChangesType, "step", "count = 0.5 * time", "count is int and becomes float"),
    ],
)  # fmt: skip
def test_what_does_not_translate_is_named_with_its_place(tools, component, function, line, reason):
    with pytest.raises(TranslationError) as caught:
        translate(component)
    text = str(caught.value)
    assert "\n" not in text
    assert text.startswith(f"{component.__name__}.{function} (toys.py, line ")
    assert f": `{line}` does not translate to C: {reason}" in text
    with open(toys.__file__, encoding="utf-8") as file:
        number = int(re.search(r"line (\d+)\)", text)[1])
        assert file.read().splitlines()[number - 1].strip() == line


REFUSED = {
    "y = max(x, 2.0)": "max is not a function of math, of physics or of this file; write a if a > b else b",
    "y = f'{x}'": "JoinedStr is not in the subset",
    "y = 'a'": "'a' is not a number",
    "y = lambda: x": "Lambda is not in the subset",
    "assert x > 0": "Assert is not in the subset",
    "raise ValueError": "Raise is not in the subset",
    "y = x is None": "Is is not in the subset",
    "y = None": "None is not a number",
    "y = self.step.time": "self.step.time is not a variable of the component",
    "y = self.jump(x)": "self.jump is not a method of the component",
    "y = sqrt(x=x)": "an argument is given by its name",
    "for y in (1, 2):\n            pass": "a for that does not run over range()",
    "while x < 1.0:\n            x = 2.0\n        else:\n            x = 1.0": "an else of a loop",
    "y = z = x": "an assignment to several names",
    "y = self.value[0]": "self.value is not an array of the component",
    "y = self.pair[2]": "self.pair has 2 elements",
    "y = self.pair[-3]": "self.pair has 2 elements",
    "y = self.pair[x]": "x is float where int is needed",
    "y = self.pair": "self.pair is an array: read self.pair[index] or pass *self.pair",
    "y = self.pair_1": "self.pair_1 is not a variable of the component",
    "self.pair[0] = x": "self.pair[0] cannot be assigned to",
    "self.pair = x": "x is not several values",
    "self.pair = (x, x, x)": "3 values for 2 names",
    "y = self.square(*self.pair)": "self.square takes 1 arguments",
    "y = self.step(x, x)": "self.step calls itself, and recursion does not translate",
    "y = self.square(*x)": "x is not an array",
    "y = [x, x]\n        y = [x]\n        x = y[0]": "y is list[float] of 2 and becomes list[float] of 1",
    "y = [x, x]\n        z = y\n        x = z[0]": "y would be one array under two names: copy it, list(y)",
    "y = [x, x]\n        z = Pair(x, y)\n        x = z.x": "y would be one array under two names",
    "y = Pair(x, [x])\n        z = y.all\n        x = z[0]": "y.all would be one array under two names",
    "y = [x, x]\n        y[2] = x": "y has 2 elements",
    "y = [x, x]\n        y = y + y": "y is list[float] of 2, not a number",
    "y = [x, x]\n        x = y == y": "y is list[float] of 2, not a number",
    "y = [x] * self.count\n        x = y[0]": "an array is made by a list of one number",
    "y = [x for _ in range(self.count)]\n        x = y[0]": "the size of an array must be known",
    "y = [x for _ in range(2) if x > 1.0]\n        x = y[0]": "a list is made by one loop over range()",
    "y = [x for a in range(2) for b in range(2)]": "a list is made by one loop over range()",
    "y = []": "an array has one element or more",
    "x = summed([x for _ in range(2)])": "a list over range() stands by itself",
    "x = summed(doubled([x, x]))": "give doubled([x, x]) a name before it is passed on",
    "x = summed(self.pair)": "self.pair[index] or pass *self.pair or list(self.pair)",
    "x = summed(x)": "x is float, not list[float]",
    "x = summed(TABLE)": "TABLE is several numbers: read TABLE[index] or list(TABLE)",
    "TABLE[0] = x": "TABLE[0] cannot be assigned to",
    "x = summed([1, 2])": "[1, 2] is list[int] of 2, not list[float]",
    "y = [x, x]\n        x = y[0] + filled(y)": "filled() changes y, which the rest of this line uses",
    "y = Pair(x, [x])\n        x = filled(y.all)": "y.all would be changed, and a record is not",
    "y = Pair(x, [x])\n        y.x = 2.0": "y.x cannot be assigned to",
    "y = Pair(x, [x])\n        y.all[0] = 2.0": "y.all[0] cannot be assigned to",
    "y = Pair(x, [x])\n        x = y.z": "Pair has no field z",
    "y = Pair(x)": "Pair takes x, all",
    "y = Pair(x, x)": "all is float, not list[float]",
    "x = renewed([x])": "q is an argument: write its elements, or give the new value another name",
    "y = kept([x])": "q would be one array under two names: copy it, list(q)",
    "y, z = twice(x)": "q is returned twice: copy it",
    "y = either(x)": "[x, x] is list[float] of 2 where list[float] of 1 is needed",
    "y = [x, x]\n        a, b, c = y\n        x = a": "2 values for 3 names",
    "y = [0, 1]\n        y[self.add()] += 1": "y[self.add()] would be computed twice",
    "def g(y: float) -> float:\n            return y": "FunctionDef is not in the subset",
    "x = sometimes(x)": "sometimes may end without the return that is declared",
    "if x > 1.0:\n            y = x\n        x = y": "y may not be set yet: give it a value before",
    "y += x": "y may not be set yet",
    "while x < 1.0:\n            y = 2.0\n            x = y\n        x = y": "y may not be set yet",
    "for n in range(int(x)):\n            y = x\n        x = y": "y may not be set yet",
    "for n in range(3):\n            if x > n: break\n            y = x\n        x = y": "y may",
    "for n in range(3):\n            if x > n: continue\n            y = x\n        x = y": "y may",
    "x = float(n)\n        for n in range(3):\n            x = x + n": "n may not be set yet",
}
SET = [  # on all ways
    "if x > 1.0: y = x\n        else: y = 1.0\n        x = y",
    "if x > 1.0: y = x\n        elif x > 0.0: return 0\n        else: y = 1.0\n        x = y",
    "for n in range(3):\n            y = x * n\n        x = y + n",
    "while True:\n            y = x\n            if y > 1.0: break\n            x = x + 1.0\n        x = y",
    "y = [x * n for n in range(3)]\n        x = y[1]",
]


@pytest.fixture
def odd(tmp_path, monkeypatch):
    """Makes a component with these lines in its step."""

    def made(line):
        (tmp_path / "odd.py").write_text(ODD.replace("{line}", line))
        monkeypatch.syspath_prepend(tmp_path)
        monkeypatch.delitem(__import__("sys").modules, "odd", raising=False)
        return __import__("odd").Odd

    return made


@pytest.mark.parametrize(("line", "reason"), REFUSED.items())
def test_what_is_not_in_the_subset(odd, line, reason):
    with pytest.raises(TranslationError, match=re.escape(reason)):
        translate(odd(line))


@pytest.mark.parametrize("line", SET)
def test_names_that_all_ways_set_translate(odd, line):
    assert "Odd__step" in translate(odd(line)).plain.functions


ODD = '''
from dataclasses import dataclass
from math import sqrt
from loomfmu.declaring.arrays import array
from loomfmu.declaring.declarations import output
from loomfmu.declaring.variables import Component
TABLE = (1.0, 2.0)

@dataclass(frozen=True)
class Pair:
    x: float
    all: list[float]

def summed(q: list[float]) -> float:
    return q[0]

def doubled(q: list[float]) -> list[float]:
    return [2.0 * q[n] for n in range(len(q))]

def filled(q: list[float]) -> float:
    q[0] = 1.0
    return q[0]

def renewed(q: list[float]) -> float:
    q = [1.0]
    return q[0]

def kept(q: list[float]) -> list[float]:
    return q

def twice(x: float) -> tuple[list[float], list[float]]:
    q = [x]
    return q, q

def either(x: float) -> list[float]:
    if x > 0.0:
        return [x]
    return [x, x]

def sometimes(x: float) -> float:
    if x > 0.0:
        return x

@dataclass(slots=True)
class Odd(Component):
    """Odd."""

    value: float = output("1", "A value")
    pair: tuple[float, ...] = array(output("1", "One of two") for _ in range(2))

    count: int = output("1", "A count", start=2)

    def square(self, x: float) -> float:
        """Square."""
        return x * x

    def add(self) -> int:
        """Count."""
        self.count = self.count + 1
        return self.count

    def initialize(self, time: float) -> int:
        """Start."""
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Step."""
        x = time
        {line}
        self.value = sqrt(x)
        return 0
'''


def test_only_variables_are_shown_in_problems():
    class Other(COMPONENTS["MainShaft"]):
        """Another."""

        problems = (Problem("{{x}} {speed}"), Problem("at {place}"))

    with pytest.raises(ValueError, match=r"Other: a problem shows \{place\}, which is not a variable"):
        tables(Other, "token")


HOST = """
#include "fmi2.c"
static int marks;
static void logger(void *e, fmi2String i, fmi2Status s, fmi2String c, fmi2String m, ...)
{
    char text[200];
    (void)e; (void)i; (void)s; (void)c;
    snprintf(text, sizeof text, m, "never", "shown");
    puts(text);
    marks++;
}
int main(void)
{
    fmi2CallbackFunctions callbacks = {logger, NULL, NULL, NULL, NULL};
    fmi2ValueReference share = FIRST_REFERENCE;
    fmi2Real value = 1.5;
    fmi2Component c = fmi2Instantiate("100 %s %n", fmi2CoSimulation, MODEL_TOKEN, "", &callbacks, 0, 1);
    if (c == NULL || fmi2SetReal(c, &share, 1, &value) != fmi2Error || marks != 1) return 1;
    fmi2FreeInstance(c);
    return 0;
}
"""


def test_messages_are_safe_for_hosts_that_take_them_for_formats(gcc, tmp_path, monkeypatch):
    for file, text in sources(toys.Arithmetic).items():
        (tmp_path / file).write_text(text)
    (tmp_path / "host.c").write_text(HOST)
    call = [gcc, "-std=c99", *WARNINGS, "-Wno-format-nonliteral", "-o", "host", "host.c", "-lm"]
    run = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    # a locale with a decimal comma changes nothing either: the host has set none, C's own is used
    run = subprocess.run([tmp_path / "host"], capture_output=True, text=True, env=os.environ, check=True)
    assert run.stdout == "share = 150 % is outside [0, 100] %\n"


def test_integers_beyond_64_bits_wrap(gcc, tmp_path):
    toy = compiled(toys.Wraps, tmp_path)()
    toy.step(0.0, 1.0)
    assert toy.grows
    toy.count = 2**63 - 1
    toy.step(0.0, 1.0)
    assert not toy.grows
