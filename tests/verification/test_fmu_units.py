"""Units: what a number of a foreign FMU is in SI."""

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stickslip_units import Dimension, Unit, conversion, defined, spelled
from stickslip_verification.drive.description import UNITS

LENGTH: Dimension = (0, 1, 0, 0, 0, 0, 0, 0)
SPELLINGS = """
mm 0.001 m, cm 0.01 m, um 1e-6 m, µm 1e-6 m, mm/s 0.001 m/s, mm/min 1/60000 m/s, mm/s2 0.001 m/s2
mm/s^2 0.001 m/s2, m.s-2 1 m/s2, m/s² 1 m/s2, N·s/m 1 N.s/m, - 1 1, kN 1000 N, kN/m 1000 N/m
N/mm 1000 N/m, N/um 1000000 N/m, kg.m/s2 1 N, N.s/m 1 N.s/m, N.s/mm 1000 N.s/m, kg/s 1 N.s/m
ms 0.001 s, us 1e-6 s, min 60 s, day 86400 s, mm/year 1/31557600000 m/s, TN/m 1e12 N/m, kHz 1000 Hz
1/s 1 Hz, g 0.001 kg, t 1000 kg, kJ 1000 J, mJ 0.001 J, N.m 1 J, % 0.01 1
"""
AMBIGUOUS = "furlong m/s/s N/m.s mm. /s kkg rad/s degC m/ in -1 kday years"


def unit_of(text: str) -> Unit:
    unit = spelled(text)
    assert unit is not None, text
    return unit


@pytest.mark.parametrize("entry", SPELLINGS.strip().replace("\n", ", ").split(", "))
def test_a_unit_as_engineers_write_it_has_the_size_that_they_mean(entry: str) -> None:
    text, factor, si = entry.split()
    assert unit_of(text).factor == Fraction(factor)
    assert unit_of(text).dimension == unit_of(si).dimension


@pytest.mark.parametrize("text", [*AMBIGUOUS.split(), "m m"])
def test_what_could_be_read_in_two_ways_is_not_understood(text: str) -> None:
    assert spelled(text) is None


def test_the_units_of_the_suite_need_no_conversion() -> None:
    for text in (*UNITS.values(), ""):
        assert conversion(unit_of(text), 1).leaves_alone, text


@given(
    st.floats(-1e100, 1e100).filter(lambda value: value == 0.0 or abs(value) > 1e-100),
    st.sampled_from(["mm", "um", "kN", "N/mm", "min", "t", "%"]),
    st.sampled_from([1, -1]),
)
def test_there_and_back_is_the_same_number(value: float, text: str, sign: int) -> None:
    change = conversion(unit_of(text), sign)
    # One rounding each way, of half an ulp.
    assert abs(change.to_si(change.from_si(value)) - value) <= math.ulp(value)


@pytest.mark.parametrize(("sign", "metres"), [(1, 0.35), (-1, -0.35)])
def test_a_datum_is_moved_scaled_and_mirrored(sign: int, metres: float) -> None:
    unit = defined(0.001, 0.25, LENGTH)
    assert unit is not None
    change = conversion(unit, sign)
    assert change.to_si(100.0) == metres
    assert change.from_si(metres) == pytest.approx(100.0, rel=1e-15)  # two roundings


@pytest.mark.parametrize("factor", [1e-300, 6.02214076e23, 0.017453292519943295, 0.0, math.inf])
def test_a_factor_of_any_size_scales_with_one_rounding(factor: float) -> None:
    unit = defined(factor, 0.0, LENGTH)
    if 0.0 < factor < math.inf:
        assert unit is not None
        assert conversion(unit, 1).to_si(2.0) == pytest.approx(2.0 * factor, rel=2.3e-16)
    else:
        assert unit is None
