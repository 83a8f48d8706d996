"""Tables for people: in columns, or as entries where these do not fit."""

import ast
import io
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import loomfmu
from loomfmu.display import printed

HEADINGS = ("verdict", "claim", "value")
ROWS = [("FAILS", "a long claim about something", "1 mm"), ("holds", "another", "")]
ENTRIES = [("FAILS  a long claim about something", "(belt.margin)", "1 mm"), ("holds  another",)]


COLUMNS = """
verdict  claim                         value
FAILS    a long claim about something  1 mm
holds    another
"""
FILLED = """
FAILS  a long claim about something
  (belt.margin) 1 mm
holds  another
"""
NARROW = """
FAILS  a long claim
  about something
  (belt.margin) 1 mm
holds  another
"""


@given(st.floats(-1e9, 1e9), st.floats(1e-12, 1e6), st.floats(-1e9, 1e9))
def test_a_decided_value_is_shown_on_its_side_of_the_bound(value: float, error: float, bound: float) -> None:
    shown = float(f"{value:.{printed.digits(value, error, 17)}g}")
    rounding = 1e-15 * max(abs(value), abs(bound))
    assert abs(shown - value) <= error + rounding
    if abs(value - bound) > error + rounding:
        assert math.copysign(1.0, shown - bound) == math.copysign(1.0, value - bound)


def test_digits_below_the_error_are_left_out() -> None:
    errors = (0.04, 0.5, 40.0, math.nan, math.inf)
    texts = [printed.brief(5596.747, printed.digits(5596.747, error)) for error in errors]
    assert texts == ["5596.75", "5597", "5600", "5596.747", "5596.747"]


@pytest.mark.parametrize(("width", "text"), [(200, COLUMNS), (44, COLUMNS), (43, FILLED), (20, NARROW)])
def test_rows_are_in_columns_or_as_entries_that_fill_the_lines(
    width: int, text: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    printed.show(HEADINGS, ROWS, ENTRIES)
    assert capsys.readouterr().out == text + "\n"


def test_parts_of_a_stacked_entry_are_on_one_line_or_begin_one_each() -> None:
    parts = ("claim a long one about something", "A: holds", "B: FAILS")
    assert printed.as_entry(parts, 52, stacked=True) == ["  ".join(parts)]
    assert printed.as_entry(parts, 51, stacked=True) == [parts[0], "  A: holds", "  B: FAILS"]
    narrow = ["claim a long one", "  about something", "  A: holds", "  B: FAILS"]
    assert printed.as_entry(parts, 20, stacked=True) == narrow


class Terminal(io.StringIO):
    """Somebody is looking."""

    encoding = "utf-8"

    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(
    ("text", "harmless"),
    [
        ("margin [/mm]", "margin [/mm]"),
        ("force [kN] [bold]", "force [kN] [bold]"),
        ("Größe 3 µm, 布", "Größe 3 µm, 布"),
        ("\x1b]0;title\x07", r"\x1b]0;title\x07"),
        ("\x9b31m", r"\x9b31m"),  # an escape sequence in one character
        ("one\ntwo\r\tthree\x7f\x00", r"one\ntwo\r\tthree\x7f\x00"),
        ("safe\u202etxt.exe\u2066\u200f", r"safe\u202etxt.exe\u2066\u200f"),
        ("line\u2028end", r"line\u2028end"),
        ("file\udcff.h5", r"file\udcff.h5"),  # a name that is not UTF-8
    ],
)
def test_foreign_text_is_shown_and_does_nothing(text: str, harmless: str) -> None:
    for line in (text, f"FAILS {text}"):
        terminal = Terminal()
        printed.say(line, to=terminal)
        shown = terminal.getvalue().replace("\x1b[1;31m", "").replace("\x1b[0m", "")
        assert shown == line.replace(text, harmless) + "\n"


def test_what_a_stream_cannot_encode_is_spelt_out() -> None:
    stream = io.TextIOWrapper(io.BytesIO(), encoding="ascii", newline="\n")
    printed.say("3 µm", to=stream)
    stream.flush()
    assert stream.buffer.getvalue() == b"3 \\xb5m\n"


def test_nothing_else_prints() -> None:
    package = Path(loomfmu.__file__).parent
    found = set()
    for path in package.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print":
                found.add(path.relative_to(package).as_posix())
    assert found <= {"traces/damage.py"}  # it speaks to the process that started it
