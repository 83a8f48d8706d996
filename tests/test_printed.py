"""Tables for people: in columns, or as entries where these do not fit."""

import pytest

from loomfmu import printed

HEADINGS = ("verdict", "claim", "value")
ROWS = [("FAILS", "a long claim about something", "1 mm"), ("holds", "another", "")]
ENTRIES = [("FAILS  a long claim about something", "(belt.margin)", "1 mm"), ("holds  another",)]


def shown(width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> list[str]:
    monkeypatch.setenv("COLUMNS", str(width))
    printed.show(HEADINGS, ROWS, ENTRIES)
    return capsys.readouterr().out.splitlines()


def test_columns_are_as_wide_as_they_need_to_be(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    columns = [
        "",
        "verdict  claim                         value",
        "FAILS    a long claim about something  1 mm",
        "holds    another",
        "",
    ]
    assert shown(44, monkeypatch, capsys) == columns
    assert shown(200, monkeypatch, capsys) == columns


def test_parts_of_an_entry_fill_the_lines(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert shown(43, monkeypatch, capsys) == [
        "", "FAILS  a long claim about something", "  (belt.margin) 1 mm", "holds  another", "",
    ]  # fmt: skip
    assert shown(20, monkeypatch, capsys) == [
        "", "FAILS  a long claim", "  about something", "  (belt.margin) 1 mm", "holds  another", "",
    ]  # fmt: skip
