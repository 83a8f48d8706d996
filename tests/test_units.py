"""Units: what people write, read exactly once, or refused in one line."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from loomfmu.errors import LoomfmuError
from loomfmu.units import ALIASES, UNITS, UnitError, parse, show, udunits, unit

SI = [name for name, known in UNITS.items() if known.factor == 1.0]


@pytest.mark.parametrize(
    ("quantity", "target", "value"),
    [
        ("685 rpm", "rad/s", 685 * 2 * math.pi / 60),
        ("685rpm", "rad/s", 685 * 2 * math.pi / 60),
        ("685 r/min", "rad/s", 685 * 2 * math.pi / 60),
        ("400 picks/min", "rad/s", 400 * 2 * math.pi / 60),
        ("90 deg", "rad", math.pi / 2),
        ("90°", "rad", math.pi / 2),
        ("2 rev", "rad", 4 * math.pi),
        ("0.5mm", "m", 0.0005),
        (".5 cm", "m", 0.005),
        ("-3e-2 m", "m", -0.03),
        ("+110.5 g", "kg", 0.1105),
        ("200 gf", "N", 0.2 * 9.80665),
        ("15 cN", "N", 0.15),
        ("30 tex", "kg/m", 30e-6),
        ("5.96 N/mm", "N/m", 5960.0),
        ("1.5 %", "1", 0.015),
        ("0.8", "1", 0.8),
        ("0.8 1", "1", 0.8),
        ("12", "m", 12.0),
        (" 2. ms ", "s", 0.002),
        (3, "m", 3.0),
        (0.25, "N.m2", 0.25),
    ],
)
def test_quantities(quantity, target, value):
    assert parse(quantity, target) == pytest.approx(value, rel=1e-15)  # one product, rounded


@pytest.mark.parametrize(
    ("quantity", "target", "told"),
    [
        ("fast", "rad/s", "'fast' is not a quantity"),
        ("", "m", "'' is not a quantity"),
        ("1 2 m", "m", "'1 2 m' is not a quantity"),
        ("nan m", "m", "'nan m' is not a quantity"),
        ("1e m", "m", "'1e m' is not a quantity"),
        (True, "1", "True is not a quantity"),
        (None, "m", "None is not a quantity"),
        ([1.0], "m", "[1.0] is not a quantity"),
        ("0,5 mm", "m", "'0,5 mm' has a decimal comma: write \"0.5 mm\""),
        ("-,5", "m", 'write "-.5"'),
        (10**400, "m", ".. is too large"),
        ("5 rmp", "rad/s", "did you mean 'rpm'?"),
        ("5 parsec", "m", "unknown unit 'parsec'; known: m, mm, cm"),
        ("5 Nn", "N", "unknown unit 'Nn'; did you mean 'N'?"),
        ("5 rads", "rad", "unknown unit 'rads'; did you mean 'rad'?"),
        ("1" * 1_000_000 + " x y", "m", "... is not a quantity"),  # for ever, were anything tried twice
        ("5 kg", "m", "'5 kg' is in kg, which does not fit m"),
        ("5 rad", "1", "'5 rad' is in rad, which does not fit a number without a unit"),
        ("5 mm", "rad/s", "which does not fit rad/s"),
        ("5 m", "furlong", "unknown unit 'furlong'"),
    ],
)
def test_what_is_no_quantity_is_refused_in_one_line(quantity, target, told):
    with pytest.raises(UnitError) as refusal:
        parse(quantity, target)
    assert told in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert isinstance(refusal.value, LoomfmuError)


@given(st.floats(-1e9, 1e9), st.sampled_from(sorted(UNITS)))
def test_what_is_shown_reads_back(value, name):
    (si,) = [known for known in SI if UNITS[known].dimension == UNITS[name].dimension][:1]
    shown = show(value, name)
    # shown with seven digits
    assert parse(shown, si) == pytest.approx(value, rel=5e-7, abs=1e-300)


def test_every_dimension_has_an_si_unit_and_aliases_lead_to_units():
    dimensions = {known.dimension for known in UNITS.values()}
    assert dimensions == {UNITS[name].dimension for name in SI}
    assert all(known.factor > 0.0 for known in UNITS.values())
    assert all(unit(alias) is UNITS[name] for alias, name in ALIASES.items())


@pytest.mark.parametrize(
    ("name", "spelling"),
    [
        ("1", "1"),
        ("rad", "rad"),
        ("rad/s", "rad s-1"),
        ("rad/s2", "rad s-2"),
        ("1/s", "s-1"),
        ("1/s2", "s-2"),
        ("N.m2", "N m2"),
        ("kg.m2", "kg m2"),
        ("N.s/m", "N s m-1"),
        ("rev/min", "rev min-1"),
        ("N.m.s/rad", "N m s rad-1"),
        ("J/K", "J K-1"),
        ("N.m/A", "N m A-1"),
    ],
)
def test_spelling_for_climate_and_forecast_readers(name, spelling):
    assert udunits(name) == spelling


def test_show_leaves_the_unit_one_out():
    assert show(0.8, "1") == "0.8"
    assert show(0.015, "%") == "1.5 %"
    assert show(1e-3, "mm") == "1 mm"
