"""Quantities as people type them."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stickslip_units import KINDS, QuantityError, typed

UNITS = ("kg", "m", "s", "m/s", "m/s2", "N", "N/m", "N.s/m", "1")


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("20mm/s", "m/s", 0.02),
        ("1 kN/m", "N/m", 1000.0),
        ("0.5 N/µm", "N/m", 5e5),
        ("500g", "kg", 0.5),
        ("2 t", "kg", 2000.0),
        ("2 min", "s", 120.0),
        ("1.2 m/min", "m/s", 0.02),
        ("31.5576 mm/year", "m/s", 1e-9),
        ("1 day", "s", 86400.0),
        ("-3 mm", "m", -0.003),
        ("+.5e-1cm", "m", 5e-4),
        ("2 N*s/m", "N.s/m", 2.0),
        ("2 kg/s", "N.s/m", 2.0),
        ("9.81 m/s^2", "m/s2", 9.81),
        ("9.81m/s²", "m/s2", 9.81),
        ("9.81 m/s/s", "m/s2", 9.81),
        ("2 N.s / m", "N.s/m", 2.0),
        ("3 kg.m/m.s", "N.s/m", 3.0),
        ("50 %", "1", 0.5),
        (" 7 ", "1", 7.0),
    ],
)
def test_a_quantity_is_the_nearest_double_in_si(text: str, unit: str, value: float) -> None:
    assert typed(text, unit) == value


@given(st.floats(-1e300, 1e300), st.sampled_from(UNITS))
def test_a_plain_number_is_si(value: float, unit: str) -> None:
    assert typed(repr(value), unit) == value


@given(st.integers(), st.sampled_from([("mm", "e-3"), ("um", "e-6"), ("km", "e3")]))
def test_a_prefix_is_a_power_of_ten_written_out(number: int, prefix: tuple[str, str]) -> None:
    unit, power = prefix
    assert typed(f"{number}{unit}", "m") == float(f"{number}{power}")


@pytest.mark.parametrize(
    ("text", "unit", "reason"),
    [
        ("5 N", "m/s", "is a force; expected a velocity in m/s"),
        ("20mm/s", "m", "is a velocity; expected a length in m"),
        ("3 kN.m", "N", "has the unit 'kN.m'; expected a force in N"),
        ("5 mm", "1", "is a length; expected a plain number"),
        ("5 parsec", "m", "has the unknown unit 'parsec'"),
        ("5 kmin", "s", "has the unknown unit 'kmin'"),
        ("1-2", "1", "has the unknown unit '-2'"),
        ("5 m m", "m", "has the unknown unit 'm m'"),
        ("5 m10000000", "m", "has the unknown unit 'm10000000'"),
        ("1,5", "1", "has a comma where the decimal point is expected"),
        ("", "kg", "is not a finite number"),
        ("nan", "N/m", "is not a finite number; expected a stiffness in N/m"),
        ("inf", "N/m", "is not a finite number"),
        ("1e400", "m", "is larger than a double can hold"),
        ("1e999999999 mm", "m", "is larger than a double can hold"),
    ],
)
def test_what_is_no_such_quantity_is_refused(text: str, unit: str, reason: str) -> None:
    with pytest.raises(QuantityError) as refusal:
        typed(text, unit, "(above 0)")
    message = str(refusal.value)
    assert message.startswith(reason)
    assert message.endswith(f"(above 0), such as {KINDS[unit].example}")
    assert "\n" not in message


def test_a_number_too_small_for_a_double_is_zero() -> None:
    assert typed("1e-999999999mm", "m") == 0.0


@given(st.text(max_size=20), st.sampled_from(UNITS))
def test_no_text_gives_anything_but_a_number_or_a_refusal(text: str, unit: str) -> None:
    try:
        value = typed(text, unit)
    except QuantityError:
        return
    assert math.isfinite(value)


@pytest.mark.parametrize("unit", UNITS)
def test_an_example_in_a_message_is_right(unit: str) -> None:
    assert typed(KINDS[unit].example, unit) > 0.0
