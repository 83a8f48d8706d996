"""Weaves from pegs and from WIF files."""

import itertools
from pathlib import Path

import pytest

from loomfmu.errors import LoomfmuError
from loomfmu.loom import weave

WEAVES = Path(__file__).parents[2] / "sims" / "weaves"

HEAD = (
    "[WIF]\nVersion=1.1\n[WEAVING]\nRising Shed={rising}\nShafts={shafts}\nTreadles=2\n"
    "[WEFT]\nThreads={picks}\n"
)
PLAIN_HEAD = HEAD.format(rising="true", shafts=2, picks=2)
PLAIN = "[TIEUP]\n1=1\n2=2\n[TREADLING]\n1=1\n2=2\n[THREADING]\n1=1\n2=2\n3=1\n"


def write(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "weave.wif"
    path.write_text(text, encoding="utf-8")
    return path


def test_twill_from_tie_up_and_treadling():
    read = weave.read_wif(WEAVES / "twill_2_2.wif")
    assert read.pegs == ("10011001", "11001100", "01100110", "00110011")
    assert [read.ends_of(frame) for frame in (1, 2, 3, 4)] == [2, 2, 2, 2]


def test_satin_from_lift_plan():
    read = weave.read_wif(WEAVES / "satin_5.wif")
    assert read.pegs == ("10000", "00010", "01000", "00001", "00100")
    # a satin: each end is raised once, and no two neighbours at neighbouring picks
    places = [pegs.index("1") for pegs in read.pegs]
    assert sorted(places) == list(range(5))
    assert all((a - b) % 5 not in (1, 4) for a, b in itertools.pairwise(places))


def test_a_sinking_shed_is_the_complement(tmp_path):
    rising = weave.read_wif(write(tmp_path, HEAD.format(rising="true", shafts=2, picks=2) + PLAIN))
    sinking = weave.read_wif(write(tmp_path, HEAD.format(rising="false", shafts=2, picks=2) + PLAIN))
    assert rising.pegs == ("10", "01")
    assert sinking.pegs == ("01", "10")
    assert rising.threading == (1, 2, 1)


def test_a_pick_may_use_two_treadles_or_none(tmp_path):
    body = "[TIEUP]\n1=1\n2=2\n[TREADLING]\n1=1,2\n2=0\n"
    read = weave.read_wif(write(tmp_path, HEAD.format(rising="true", shafts=2, picks=3) + body))
    assert read.pegs == ("100", "100")


def test_a_lift_plan_without_lines_is_none_and_other_sections_may_be_anything(tmp_path):
    text = PLAIN_HEAD + PLAIN + "[LIFTPLAN]\n[NOTES]\n1=a\n1=b\n[LIFTPLAN SIZES]\nno line\n"
    assert weave.read_wif(write(tmp_path, text)).pegs == ("10", "01")
    assert weave.read_wif(write(tmp_path, PLAIN_HEAD + PLAIN + "[LIFTPLAN]\n1=1\n2=2\n")).pegs == ("10", "01")


def test_pegs_as_a_list_and_as_a_text():
    assert weave.parse(["1010", "0101"], Path()).pegs == weave.parse("1010/0101", Path()).pegs


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("no ini at all", "not a WIF file"),
        ("[WEAVING]\nShafts=2\n", "it has no section [WIF]"),
        (HEAD.format(rising="true", shafts=0, picks=2) + PLAIN, "[WEAVING] Shafts = '0'"),
        (HEAD.format(rising="true", shafts=2, picks="x") + PLAIN, "[WEFT] Threads = 'x'"),
        (HEAD.format(rising="true", shafts=2, picks=2), "neither [LIFTPLAN] nor [TIEUP]"),
        (
            HEAD.format(rising="true", shafts=1, picks=2) + PLAIN,
            "[TIEUP] has a line 2=2, but 2 is not in 0 to 1",
        ),
        (HEAD.format(rising="true", shafts=2, picks=2) + "[LIFTPLAN]\n1=one\n", "[LIFTPLAN] has a line"),
        (HEAD.format(rising="true", shafts=21, picks=2) + PLAIN, "has 21 frames; the dobby has 20"),
        (HEAD.format(rising="true", shafts=2, picks=129) + PLAIN, "has 129 picks; the dobby holds 128"),
        # more than memory could hold: counted before anything is built
        (HEAD.format(rising="true", shafts="9" * 9, picks=2) + PLAIN, "has 999999999 frames"),
        (HEAD.format(rising="false", shafts=2, picks="9" * 9) + PLAIN, "has 999999999 picks"),
        (HEAD.format(rising="true", shafts="9" * 5000, picks=2) + PLAIN, "not a whole number of 1 or more"),
        (HEAD.format(rising="true", shafts="\u00b2", picks=2) + PLAIN, "[WEAVING] Shafts = '\u00b2' is not"),
        (HEAD.format(rising="true", shafts=2, picks="\uff12") + PLAIN, "[WEFT] Threads = '\uff12' is not"),
        (HEAD.format(rising="true", shafts=2, picks=2) + "[LIFTPLAN]\n1=1_0\n", "[LIFTPLAN] has a line"),
        # files that contradict themselves
        *(
            (
                PLAIN_HEAD + PLAIN.replace("2=2\n[TH", f"{line}\n[TH"),
                f"[TREADLING] has a line {line}, but {rest}",
            )
            for line, rest in {
                "2=3": "3 is not in 0 to 2",
                "3=2": "3 is not in 1 to 2",
                "2=-2": "-2 is",
            }.items()
        ),
        (PLAIN_HEAD + PLAIN.replace("3=1", "3=9"), "[THREADING] has a line 3=9, but 9 is not in 0 to 2"),
        (PLAIN_HEAD + PLAIN + "3=2\n", "[THREADING] has two lines 3="),
        (PLAIN_HEAD + PLAIN + "[TIEUP]\n1=2\n", "has two sections [TIEUP]"),
        (PLAIN_HEAD + PLAIN + "[LIFTPLAN]\n1=1\n2=1\n", "raise different frames at pick 2"),
        (HEAD.format(rising="sinking", shafts=2, picks=2) + PLAIN, "Rising Shed = 'sinking' is neither"),
    ],
)
def test_a_bad_wif_is_refused_in_one_line(tmp_path, text, message):
    path = write(tmp_path, text)
    with pytest.raises(LoomfmuError) as refused:
        weave.read_wif(path)
    assert message in str(refused.value)
    assert str(path) in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("given", ["10/0x", "", [], 7, ["10", 5], "10//01"])
def test_bad_pegs_are_refused(given):
    with pytest.raises(LoomfmuError, match="weave"):
        weave.parse(given, Path())


def test_a_shorter_string_repeats_within_the_longest_or_is_refused():
    assert weave.parse("1/10/1001", Path()).picks == 4
    message = r"frame 3 has 3 picks and another frame 4; write all frames with the same number of picks"
    with pytest.raises(LoomfmuError, match=message):
        weave.parse("1100/0110/001", Path())


def test_a_missing_wif_names_its_path():
    with pytest.raises(LoomfmuError, match=r"nowhere.wif: cannot be read \(No such file"):
        weave.parse("nowhere.wif", Path())


def test_a_mark_of_the_encoding_is_skipped(tmp_path):
    text = "\ufeff" + HEAD.format(rising="true", shafts=2, picks=2) + PLAIN
    assert weave.read_wif(write(tmp_path, text)).pegs == ("10", "01")


def test_a_file_too_large_for_a_weave_is_refused(tmp_path):
    with pytest.raises(LoomfmuError, match=r"weave\.wif: is larger than 4 MB, the most for a WIF file$"):
        weave.read_wif(write(tmp_path, ";" * (weave.MOST_BYTES + 1)))


def test_a_name_with_nul_is_refused():
    with pytest.raises(LoomfmuError, match=r"cannot be read \(embedded null byte\)"):
        weave.parse("a\0.wif", Path())
