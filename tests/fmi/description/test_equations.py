"""Equations of the READMEs as MathML: what a browser draws says what the text says."""

import re
from xml.etree.ElementTree import Element, fromstring

import pytest
from live_fmus import COMPONENTS

from loomfmu.fmi import fmu_files
from loomfmu.fmi.description.equations import GREEK, NotTypeset, mathml, table

every_fmu = pytest.mark.parametrize("name", COMPONENTS)


def read(element: Element) -> str:
    """A formula as it would be read out, every fraction, root and power in brackets of its own."""
    parts = [read(child) + (child.tail or "") for child in element]
    if element.tag == "mfrac":
        return f"{{{parts[0]}}}/{{{parts[1]}}}"
    if element.tag in ("msup", "msub"):
        return f"{parts[0]}{'^' if element.tag == 'msup' else '_'}{{{parts[1]}}}"
    if element.tag == "msqrt":
        return f"sqrt{{{''.join(parts)}}}"
    if element.tag == "mspace":
        return " "
    return (element.text or "") + "".join(parts)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("F_cr = pi^2 EI / (mu l)^2", "F_{cr}={π^{2} EI}/{(μ l)^{2}}"),
        ("a / b c", "{a}/{b} c"),  # from left to right
        ("c a/b", "c {a}/{b}"),
        ("(a + b) (c - d) / (e f)", "{(a+b) (c\N{MINUS SIGN}d)}/{e f}"),
        ("((a) b) (c) / d", "{((a) b) (c)}/{d}"),
        ("sqrt((F_cr - F_z) / (m s''))", "sqrt{{F_{cr}\N{MINUS SIGN}F_{z}}/{m s^{\N{PRIME}\N{PRIME}}}}"),
        ("sin b cos(theta + p)", "sin b cos(θ+p)"),
        ("A n cos n p", "A n cos n p"),
        ("max |x| / max |y|", "{max |x|}/{max |y|}"),
        ("dw/dt = -k t", "{dw}/{dt}=\N{MINUS SIGN}k t"),
        ("S'(0) >= r1", "S^{\N{PRIME}}(0)≥r_{1}"),
        ("u^(n-m)", "u^{n\N{MINUS SIGN}m}"),
        ("2 K(k)", "2 K(k)"),
    ],
)
def test_a_formula_says_what_its_text_says(text: str, wanted: str) -> None:
    assert read(fromstring(mathml(text))) == wanted


@pytest.mark.parametrize("text", ["(a", "a)", "a /", "a ^", "[a)", '"a" = b', "a \\ b"])
def test_what_is_no_formula_is_refused(text: str) -> None:
    with pytest.raises(NotTypeset):
        mathml(text)


@every_fmu
def test_no_symbol_of_a_readme_is_lost(name: str) -> None:
    readme = (fmu_files.folder(COMPONENTS[name]) / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```\n(.*?)^```$", readme, re.MULTILINE | re.DOTALL)
    assert blocks
    symbols = str.maketrans(
        {"\N{MINUS SIGN}": "-", "≤": "<=", "≥": ">=", "±": "+-", "…": "..", "∑": "sum", "\N{PRIME}": "'"}
        | {letter: word for word, letter in GREEK.items()}
    )
    for block in blocks:
        shown = read(fromstring(table(block).replace("&emsp;", " "))).translate(symbols)
        # brackets, powers and lines of fractions apart, which are drawn, it has the same letters and signs
        assert sorted(re.sub(r"[\s()\[\]{}^_/]", "", shown.replace("sqrt", ""))) == sorted(
            re.sub(r"[\s()\[\]{}^_/]", "", block.replace("sqrt", ""))
        )


def test_remarks_sources_and_tables_of_numbers_stay_text() -> None:
    shown = table("(1)  x = a        half of it & all     (3.1)*\n     y = b\n")
    assert "<td>(1)</td>" in shown and "half of it &amp; all" in shown and "<td>(3.1)*</td>" in shown
    assert shown.count("<tr>") == 2
    assert table("x  1  2  3  4\ny  1  2  3  4\n").startswith("<pre><code>x  1")
