"""`show`: what it prints and returns."""

from pathlib import Path

import h5py
import pytest
from small_scenes import CLAIM, HEAD, LOOM, SHAFT, one_line, scene

from loomfmu.cli import main


@pytest.mark.parametrize(("bound", "status"), [(0.1, 0), (0.9, 1)])
def test_show_summarises_and_tells_again_whether_all_claims_held(
    capsys: pytest.CaptureFixture[str], bound: float, status: int
) -> None:
    main(["run", scene(HEAD + LOOM + CLAIM.format(bound=bound))])
    capsys.readouterr()
    assert main(["show", "results/scene.h5"]) == status
    lines = capsys.readouterr().out.splitlines()
    heading = "WL680-3600, G6300 left, weave 10/01, 400 rev/min (loomfmu "
    assert lines[0].startswith(heading) and lines[0].endswith(", complete)")
    assert lines[1:4] == [
        'scene "Small"',
        "run by: loomfmu run scene.toml",
        "91 samples over 0.15 s, 1 revolution",
    ]
    row = next(line.split() for line in lines if line.startswith("shaft.angle"))
    assert row == ["shaft.angle", "0", "360", "360", "deg"]
    row = next(line.split() for line in lines if line.startswith("weft.stroke"))
    assert row[1:] == ["2.09529", "2.09529", "2.09529", "m"]
    assert any("lowest margin" in line for line in lines)


CUT = "the run ended at 25 % of its length, by motor; set may_end = true if it may"


@pytest.mark.parametrize(
    ("attribute", "value", "said"),
    [
        ("status", "interrupted", ", interrupted)\n"),
        ("status", "running", ", running, or killed)\n"),
        ("cut_short", CUT, f', cut short)\nscene "Small"\n{CUT}\n'),  # as a run stores it
        ("claims", None, "claims not judged: the run did not finish\n"),
    ],
)
def test_a_trace_of_a_run_that_did_not_finish_says_so_and_does_not_hold(
    attribute: str, value: str | None, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", scene(HEAD + SHAFT)]) == 0
    with h5py.File("results/scene.h5", "r+") as file:
        if value is None:
            del file.attrs[attribute]
        else:
            file.attrs[attribute] = value
    capsys.readouterr()
    assert main(["show", "results/scene.h5"]) == 1
    assert said in capsys.readouterr().out


def test_a_trace_that_is_cut_off_or_damaged_is_told_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    main(["run", scene(HEAD + LOOM)])
    content = bytearray(Path("results/scene.h5").read_bytes())
    half = len(content) // 2
    Path("cut.h5").write_bytes(content[:half])
    for place in range(2000, len(content), 997):
        content[place] ^= 0xFF
    Path("damaged.h5").write_bytes(content)
    capsys.readouterr()
    assert main(["show", "cut.h5"]) == 2
    left = f"it is cut off: {half} of its {len(content)} bytes are left"
    assert one_line(capsys) == f"cut.h5: cannot be read as a trace ({left})"
    assert main(["show", "damaged.h5"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("loomfmu: damaged.h5: ") and said.count("\n") == 1 and "Traceback" not in said


def test_names_with_brackets_and_escapes_are_only_shown(capsys: pytest.CaptureFixture[str]) -> None:
    text = HEAD.replace("Small", r"force [kN] \u202e [/mm]") + LOOM
    text += CLAIM.format(bound=0.9) + 'name = "margin [/mm] [bold]"\n'
    assert main(["run", scene(text)]) == 1
    first = capsys.readouterr()
    assert main(["show", "results/scene.h5"]) == 1
    again = capsys.readouterr()
    for printed in (first.out, again.out):
        assert r"force [kN] \u202e [/mm]" in printed
        assert "FAILS  margin [/mm] [bold]" in printed
        assert not {"\x1b", "\u202e"} & set(printed)
    assert main(["run", "no\x1b[2Jfile\u202e.toml"]) == 2
    assert capsys.readouterr().err.startswith(r"loomfmu: no\x1b[2Jfile\u202e.toml: cannot be read")
    with pytest.raises(SystemExit):
        main(["run", "a", "\x1b[2J"])
    assert "\x1b" not in capsys.readouterr().err
