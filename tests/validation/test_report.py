"""The validation report: the same as the committed one, honest about what is not reproduced."""

import pickle
import re
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image
from sharing import made_of_sources

from validation import calls, digits, figures, report
from validation.computed import accuracy, verdicts
from validation.published import MARKS, OUTCOMES, Published
from validation.sections import Row, Section, read

ROOT = Path(__file__).parents[2]
LARGEST = 60_000  # bytes of a figure


@dataclass(frozen=True)
class Generated:
    """What the sources give: the report, its chapters and figures, and each number that was rounded."""

    text: str
    chapters: tuple[report.Chapter, ...]
    figures: dict[str, bytes]
    rounded: list[tuple[float, int]]


@pytest.fixture(scope="module")
def generated(untraced, tmp_path_factory):
    seen, original = [], digits.rounded

    def rounded(value, places):
        seen.append((value, places))
        return original(value, places)

    def made():
        with pytest.MonkeyPatch.context() as patch, untraced():
            patch.setattr(digits, "rounded", rounded)
            text, chapters = report.markdown(), report.chapters()
            drawn = {
                path.name: path.read_bytes() for path in figures.write(tmp_path_factory.mktemp("figures"))
            }
        return pickle.dumps(Generated(text, chapters, drawn, seen))

    return pickle.loads(made_of_sources(Path(__file__).parent, made))


@pytest.fixture(scope="module")
def text(generated):
    return generated.text


def test_committed_report_is_the_one_that_the_tables_and_the_components_give(text):
    assert (ROOT / "results" / "validation.md").read_text(encoding="utf-8") == text


def test_the_last_bits_of_a_computation_do_not_show(generated):
    assert len(generated.rounded) > 1000
    for value, places in generated.rounded:
        shown = digits.rounded(value, places)
        # a tie would fall to either side on another machine
        assert digits.rounded(value * (1.0 + 1e-9), places) == shown, value
        assert digits.rounded(value * (1.0 - 1e-9), places) == shown, value


def test_nothing_is_undefined(text):
    assert not re.search(r"\b(nan|NaN|inf|None)\b|[{}]", text)
    with pytest.raises(ValueError, match="no place in the report"):
        digits.number(float("nan"), 1)


def test_every_row_has_as_many_cells_as_its_heading(text):
    for block in re.findall(r"(?:^\|.*\n)+", text, flags=re.M):
        assert len({line.count(" | ") for line in block.splitlines()}) == 1, block[:80]


def test_figures_are_the_committed_ones_and_small(generated):
    shown = set(re.findall(r"\(validation/(\w+\.png)\)", generated.text))
    committed = ROOT / "results" / "validation"
    assert shown == set(figures.described()) == {path.name for path in committed.iterdir()}
    assert set(generated.figures) == shown
    for name, content in generated.figures.items():
        assert content == (committed / name).read_bytes(), name
        assert len(content) < LARGEST
        with Image.open(BytesIO(content)) as image:
            assert image.width == 800


# Honest


def test_what_is_not_reproduced_is_marked_and_listed(generated):
    text = generated.text
    listed = text.split("\n## Not reproduced\n")[1].split("\n## ")[0]
    missed = [n.verdict for chapter in generated.chapters for n in chapter.numbers if not n.reproduced]
    assert len(missed) == listed.count("computed") == 112
    for verdict in missed:
        assert verdict in listed and text.count(f"not reproduced: {verdict}") + text.count(f": {verdict}") > 1


@pytest.mark.parametrize(
    ("start", "role", "count", "total"),
    [  # how many numbers of a section have a role, of how many
        ("Table 1: end of", "used", 20, 30),  # both ends of the window, not the free length
        ("Table 2: measured buckling", "used", 15, 15),  # the length factors are fitted to them
        ("Table 3: length factor", "consistent", 5, 5),  # fitted to loads of the same source
        ("Figure 10", "used", 1, 2),
        ("Table 5: safe speed", "used", 10, 30),
        ("Table 5: safe speed", "derived", 20, 30),  # by 1/mu from those for 0.8
        ("Table 5: critical", "derived", 19, 29),
        ("Table 6: safe speed", "used", 10, 40),  # case I, as in Table 5
        ("Table 6: critical", "derived", 40, 40),  # Table 5 again
        ("Table 7", "computed", 10, 40),  # case I; the others by 1/sqrt(m)
        ("Sections 3.1 and 3.6", "used", 4, 5),
        ("Table 2.2", "consistent", 44, 44),
        ("Section 2.5", "consistent", 5, 5),
        ("Section 3.4 and Figure 3.18", "used", 3, 3),
        ("Sections 3.5 and 5.1", "used", 2, 5),
        ("Sections 3.2 and 3.4, Figures 5 and 6", "used", 5, 5),
        ("Table 1 and Figures 8 and 9", "used", 3, 9),
        ("Table 2 against itself", "consistent", 11, 11),
        ("Appendix 2", "used", 2, 3),
    ],
)
def test_what_a_number_can_prove(generated, start, role, count, total):
    sections = (section for chapter in generated.chapters for section in chapter.sections)
    numbers = next(section for section in sections if section.title.startswith(start)).numbers
    assert (sum(number.role == role for number in numbers), len(numbers)) == (count, total)


def test_the_documents_quote_the_totals(generated):
    numbers = [number for chapter in generated.chapters if chapter.source for number in chapter.numbers]
    total, *counted = report.counts(numbers)
    by_outcome = dict(zip(OUTCOMES, counted, strict=True))
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    assert f"puts {total} published numbers" in readme
    assert f"{by_outcome['computed']} are computed by a component" in readme
    times = "are another number, used or counted elsewhere, times a known factor"
    assert f"{by_outcome['derived']} {times}" in readme
    assert f"{by_outcome['consistent']} can be computed from other numbers of the same source" in readme
    assert f"{by_outcome['used']} were used" in readme
    assert f"{by_outcome['inequality']} are bounds" in readme


@pytest.mark.parametrize(
    ("printed", "computed", "criterion", "reproduced"),
    [
        ("100", 102.0, "calculation", True),  # 2 %
        ("100", 102.1, "calculation", False),
        ("100", 105.0, "measurement", True),  # 5 %
        ("100", 105.1, "measurement", False),
        ("0.31", 0.32, "calculation", True),  # a unit of the last digit
        ("0.31", 0.321, "calculation", False),
        ("103", 104.0, "place", True),  # of places that unit alone
        ("103", 104.1, "place", False),
        ("-0.14", -0.138, "calculation", True),
        ("140", 139.9, "at least", False),
        ("140", 300.0, "at least", True),
        ("500", 111.0, "at most", True),
        ("500", 501.0, "at most", False),
    ],
)
def test_the_rule(printed, computed, criterion, reproduced):
    number = Published(printed, computed, 1, criterion)
    assert number.reproduced is reproduced
    assert (number.verdict == "") is reproduced


def test_a_miss_cannot_hide_and_a_used_number_is_not_counted():
    numbers = [Published("100", 100.0, 1, role="used"), Published("100", 90.0, 1, role="used")]
    numbers += [Published("100", 100.0, 1), Published("475", 418.7, 1, misprint=True)]
    assert report.counts(numbers) == ["4", "1", "0", "0", "0", "1", "1", "0", "1"]
    rows = tuple(Row((f"W{k}", number)) for k, number in enumerate(numbers))
    found = Section("Table", ("machine", ""), rows)
    mark = MARKS["used"]
    assert list(found.missed()) == [
        f"W1: published 100{mark}, computed 90.0",
        "W3: published 475, computed 418.7 (misprint, see Errata)",
    ]
    assert f"| W0 | 100{mark} | 100.0 | 0.0 |  |" in found.markdown()
    assert "| W3 | 475 | 418.7 | -11.9 | not reproduced: published 475," in found.markdown()


def test_a_section_reads_its_tables():
    given = {
        "title": "Safe speed of the {belt.LOOM}",
        "table": "safe_speed_by_length_factor",
        "where": {"machine": "WL680-3600|WL450-4000"},
        "columns": [
            {"head": "machine", "text": "{machine}"},
            {
                "each": {"mu": ["0.8"]},
                "head": "mu = {mu}",
                "printed": "{n_mu_{mu}}",
                "unit": "rev/min",
                "computes": "belt.safe->speed {machine} {mu}",
                "roles": {"WL450-4000": "used"},
            },
        ],
    }
    found = read(given, "belt")
    assert found.heads == ("machine", "mu = 0.8") and found.title == "Safe speed of the WL680-3600"
    assert [number.outcome for number in found.numbers] == ["computed", "other"]
    with pytest.raises(AttributeError, match="unknown"):
        calls.value("belt.unknown")


def test_every_erratum_says_what_fails():
    rows = calls.table("errata")
    assert len(rows) > 40
    for row in rows:
        assert row["where"] and row["printed"] and row["corrected"] and len(row["why"]) > 10


# Accuracy that the report promises


@pytest.mark.no_cover
@pytest.mark.parametrize("case", [row["case"] for row in calls.table("damper_cases")])
def test_damper_is_exact_from_144_steps_on(case):
    errors = [accuracy.damper_error(case, steps) for steps in accuracy.DAMPER_STEPS]
    # at 144 steps the quintic's own error is left; both solutions are exact to about 1e-12 of the peak
    assert max(errors[4:]) < 1e-10
    assert max(errors[5:]) < 1e-11
    assert errors[0] > 1e-8  # and with 9 steps they differ: the comparison is one


@pytest.mark.parametrize("loom", accuracy.LOOMS)
def test_looms_with_carriers_and_warp_follow_one_integration(loom):
    coarse, middle, fine = (accuracy.driven(loom, steps) for steps in accuracy.DRIVEN_STEPS)
    # 256 times less by the order; the jumps of the dobby's third derivative leave some of the coarse ones
    assert coarse.velocity / middle.velocity > 40.0
    assert coarse.velocity < 2e-6 and middle.velocity < 2e-8 and fine.velocity < 1e-9
    assert max(each.missing for each in (coarse, middle, fine)) < 1e-10
    assert fine.power == pytest.approx(fine.exact_power, rel=1e-9)


# The figures on verdicts of random scenes


def test_the_rows_on_verdicts_add_up():
    *rows, total = calls.table("verdicts")
    for name in ("verdicts", "false_holds", "false_fails", "wrong_from_1440", "undecided", "too_small"):
        for of_family in (True, False):
            counted = [int(row[name]) for row in rows if bool(row["claim"]) != of_family]
            assert sum(counted) == int(total[name])


@pytest.mark.parametrize("page", ["README.md", "docs/how_sure.md"])
def test_the_documents_say_what_the_figures_on_verdicts_say(page):
    text = " ".join((ROOT / page).read_text(encoding="utf-8").split())
    assert verdicts.sentence() in text
