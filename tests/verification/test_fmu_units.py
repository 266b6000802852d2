"""Units: what a number of a foreign FMU is in SI."""

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stickslip_verification.drive.fmu.names import UNITS
from stickslip_verification.model.units import Conversion, Dimension, conversion, defined, spelled

LENGTH: Dimension = (0, 1, 0, 0, 0, 0, 0, 0)
PLAIN: Dimension = (0, 0, 0, 0, 0, 0, 0, 0)


@pytest.mark.parametrize(
    ("text", "factor", "si"),
    [
        ("mm", "0.001", "m"),
        ("cm", "0.01", "m"),
        ("um", "1e-6", "m"),
        ("\u00b5m", "1e-6", "m"),
        ("mm/s", "0.001", "m/s"),
        ("mm/min", "1/60000", "m/s"),
        ("mm/s2", "0.001", "m/s2"),
        ("mm/s^2", "0.001", "m/s2"),
        ("m.s-2", "1", "m/s2"),
        ("m/s²", "1", "m/s2"),
        ("N·s/m", "1", "N.s/m"),
        ("-", "1", "1"),
        ("kN", "1000", "N"),
        ("kN/m", "1000", "N/m"),
        ("N/mm", "1000", "N/m"),
        ("N/um", "1000000", "N/m"),
        ("kg.m/s2", "1", "N"),
        ("N.s/m", "1", "N.s/m"),
        ("N.s/mm", "1000", "N.s/m"),
        ("kg/s", "1", "N.s/m"),
        ("ms", "0.001", "s"),
        ("us", "1e-6", "s"),
        ("min", "60", "s"),
        ("day", "86400", "s"),
        ("mm/year", "1/31557600000", "m/s"),
        ("TN/m", "1e12", "N/m"),
        ("kHz", "1000", "Hz"),
        ("1/s", "1", "Hz"),
        ("g", "0.001", "kg"),
        ("t", "1000", "kg"),
        ("kJ", "1000", "J"),
        ("mJ", "0.001", "J"),
        ("N.m", "1", "J"),
        ("%", "0.01", "1"),
        ("", "1", "1"),
    ],
)
def test_a_plain_spelling_is_understood(text: str, factor: str, si: str) -> None:
    """A unit as engineers write it has the factor and the dimension that they mean."""
    unit, meant = spelled(text), spelled(si)
    assert unit is not None
    assert meant is not None
    assert unit.factor == Fraction(factor)
    assert unit.dimension == meant.dimension


@pytest.mark.parametrize(
    "text",
    [
        "furlong",
        "m/s/s",
        "N/m.s",
        "mm.",
        "/s",
        "kkg",
        "rad/s",
        "degC",
        "m/",
        "in",
        "m m",
        "-1",
        "kday",
        "years",
    ],
)
def test_what_could_be_read_in_two_ways_is_not_understood(text: str) -> None:
    """An unknown or ambiguous spelling is no unit rather than a guess."""
    assert spelled(text) is None


def test_every_unit_of_the_suite_is_coherent_si() -> None:
    """The suite's own units need no conversion at all."""
    for name, text in UNITS.items():
        unit = spelled(text)
        assert unit is not None, name
        assert conversion(unit, 1).leaves_alone, name


@given(st.integers(-(10**9), 10**9))
def test_a_thousandth_is_a_division(number: int) -> None:
    """A whole number of millimetres in metres is the double nearest to the true quotient."""
    unit = spelled("mm")
    assert unit is not None
    change = conversion(unit, 1)
    assert change.to_si(float(number)) == float(Fraction(number, 1000))


@given(
    st.floats(-1e100, 1e100).filter(lambda value: value == 0.0 or abs(value) > 1e-100),
    st.sampled_from(["mm", "um", "kN", "N/mm", "min", "t", "%"]),
    st.sampled_from([1, -1]),
)
def test_there_and_back_is_the_same_number(value: float, text: str, sign: int) -> None:
    """A number that is converted and converted back has moved by two roundings at most.

    Each way multiplies by a whole number and divides by a whole number, of which one is 1: one
    rounding each way, of half an ulp.
    """
    unit = spelled(text)
    assert unit is not None
    change = conversion(unit, sign)
    assert abs(change.to_si(change.from_si(value)) - value) <= math.ulp(value)


def test_a_definition_may_have_an_offset() -> None:
    """A position that is counted from a datum 0.25 m away is moved as well as scaled."""
    unit = defined(0.001, 0.25, LENGTH)
    assert unit is not None
    change = conversion(unit, 1)
    assert change.to_si(100.0) == 0.35
    assert change.from_si(0.35) == pytest.approx(100.0, rel=1e-15)


def test_what_points_the_other_way_is_mirrored_with_its_offset() -> None:
    """The sign turns the value in SI, the datum included."""
    unit = defined(0.001, 0.25, LENGTH)
    assert unit is not None
    assert conversion(unit, -1).to_si(100.0) == -0.35


@pytest.mark.parametrize("factor", [0.0, math.nan, math.inf])
def test_a_factor_that_is_no_number_defines_no_unit(factor: float) -> None:
    """A unit that is zero or no finite number of SI units is none."""
    assert defined(factor, 0.0, PLAIN) is None


@pytest.mark.parametrize("factor", [1e-300, 6.02214076e23, 0.017453292519943295])
def test_factors_of_any_size_can_be_used(factor: float) -> None:
    """A factor that is no ratio of small whole numbers scales with one rounding."""
    unit = defined(factor, 0.0, PLAIN)
    assert unit is not None
    change = conversion(unit, 1)
    assert change.to_si(2.0) == pytest.approx(2.0 * factor, rel=2.3e-16)


@given(st.floats(allow_nan=False))
def test_si_is_left_alone(value: float) -> None:
    """A number in SI passes both ways without a change of a bit, the sign of zero included."""
    change = Conversion()
    assert change.leaves_alone
    assert math.copysign(1.0, change.to_si(value)) == math.copysign(1.0, value)
    assert change.to_si(value) == value == change.from_si(value)
