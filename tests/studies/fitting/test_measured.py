"""Measured tables: units of all columns, gaps, and one line for each mistake."""

from pathlib import Path

import numpy as np
import pytest

import loomfmu
from loomfmu import LoomfmuError
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.studies.fitting import measured

SIMS = Path(__file__).parents[3] / "sims"
DEMO = SIMS / "wl680_3600.toml"


def read(folder: Path, text: str, *signals: str) -> measured.Measured:
    path = folder / "data.csv"
    path.write_text(text)
    return measured.read(path, scenes.load(DEMO), signals)


def test_columns_come_in_si_and_gaps_are_no_values(tmp_path: Path) -> None:
    text = "# a loom\nshaft_angle [deg], belt.free_length [mm], belt.margin [%]\n0, 100, 50\n180, , 25\n"
    found = read(tmp_path, text)
    assert found.over == "shaft_angle" and found.count == 3
    assert found.along == pytest.approx([0.0, np.pi], rel=1e-15)
    assert found.columns["belt.margin"] == pytest.approx([0.5, 0.25], rel=1e-15)
    assert found.columns["belt.free_length"][0] == 0.1 and np.isnan(found.columns["belt.free_length"][1])
    assert list(read(tmp_path, text, "belt.margin").columns) == ["belt.margin"]


def test_signals_may_be_measured_at_the_same_places_in_rows_of_their_own(tmp_path: Path) -> None:
    text = "shaft_angle [deg],belt.free_length [mm],belt.margin [1]\n0,100,\n0,,0.5\n"
    assert read(tmp_path, text).count == 2


def test_a_trace_is_a_measurement(tmp_path: Path) -> None:
    path = tmp_path / "demo.h5"
    loomfmu.run(DEMO, output=path, set={"revolutions": 1, "steps_per_revolution": 36})
    found = measured.read(path, scenes.load(DEMO), ["belt.margin"])
    assert found.over == "shaft_angle" and found.count == 37
    with pytest.raises(LoomfmuError, match="name the signals of this trace"):
        measured.read(path, scenes.load(DEMO))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "the file is empty"),
        ('time [s],belt.margin [1]\n0,"' + 200_000 * "1" + '"\n', "line 2: not a table \\(field larger"),
        ("shaft_angle [deg],belt.margin\n0,1\n", r"'belt.margin' has no unit; .* 'belt.margin \[1\]'$"),
        ("time [s],belt.axial_force\n0,1\n", r"such as 'belt.axial_force \[N\]'$"),
        ("time [s],belt.force\n0,1\n", r"such as 'belt.force \[mm\]', or \[1\] for a pure number$"),
        ("shaft_angle,belt.margin [1]\n0,1\n", r"'shaft_angle' has no unit; .* 'shaft_angle \[deg\]'$"),
        ("angle [deg],belt.margin [1]\n0,1\n", "the first column is 'angle', not shaft_angle or time"),
        ("shaft_angle [s],belt.margin [1]\n0,1\n", "column shaft_angle is in 's', which does not fit rad"),
        ("time [s],belt.free_length [N]\n0,1\n", "column belt.free_length is in 'N', which does not fit m"),
        ("time [s],belt.free_length [1]\n0,1\n", "column belt.free_length is in '1', which does not fit m"),
        ("time [s],belt.free_lenth [m]\n0,1\n", "belt has no output 'belt.free_lenth'|did you mean"),
        ("time [s],belt.margin [1],belt.margin [1]\n0,1,1\n", "line 1: two columns are called belt.margin"),
        ("time [s],belt.margin [1]\n0\n", "line 2: 1 values for 2 columns"),
        ("time [s],belt.margin [1]\n0,1\n1,one\n", "line 3: belt\\.margin \\[1\\]: 'one' is not a number"),
        ("time [s],belt.margin [1]\n0,inf\n", "line 2: belt\\.margin \\[1\\]: inf is not finite"),
        ("time [s],belt.margin [1]\n,1\n", "line 2: there is no time"),
        (
            "# a loom\n\ntime [s],belt.margin [1]\n0,1\n# again\n0.0,2\n",
            "line 6: time = 0.0 has a second value of belt.margin, after that in line 4",
        ),
        ("time [s],belt.margin [1]\n0,\n", "there are no measured values"),
        ("time [s]\n0\n", "there is no column beside time"),
        ("time [s];belt.margin [1]\n0;1\n", "separate the columns with commas"),
        ("time [s],damper_1.stop_contacts [1]\n0,1\n", "damper_1.stop_contacts is not a real number"),
    ],
)
def test_each_mistake_is_one_line(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(LoomfmuError, match=said) as caught:
        read(tmp_path, text)
    assert str(caught.value).startswith(str(tmp_path / "data.csv"))
