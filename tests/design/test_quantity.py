"""Units as drawings and data sheets write them."""

import math

import pytest

from stickslip_design.quantity import on_data_sheet
from stickslip_verification import spelled


@pytest.mark.parametrize(
    ("text", "si", "factor"),
    [
        ("kgcm²", "kg.m2", 1e-4),
        ("kg·cm^2", "kg.m2", 1e-4),
        ("kg m**2", "kg.m2", 1.0),
        ("Ncm", "N.m", 0.01),
        ("mNm", "N.m", 0.001),
        ("kN s/m", "N.s/m", 1000.0),
        ("N/(m/s)", "N.s/m", 1.0),
        ("(m/min)/mm", "1/s", 1000 / 60),
        ("m/(min mm)", "1/s", 1000 / 60),
        ("s^-1", "1/s", 1.0),
        ("/s", "1/s", 1.0),
        ("N/um", "N/m", 1e6),
        ("m/s²", "m/s2", 1.0),
        ("%", "1", 0.01),
        ("kHz", "rad/s", 2000 * math.pi),
        ("rpm", "rad/s", math.pi / 30),
        ("Nm/rpm", "N.m.s/rad", 30 / math.pi),
        ("Nms/rad", "N.m.s/rad", 1.0),
        ("counts/rev", "1/turn", 1.0),
        ("lines/turn", "1/turn", 4.0),
    ],
)
def test_a_unit_of_a_data_sheet_is_read(text: str, si: str, factor: float) -> None:
    unit, base = on_data_sheet(text), on_data_sheet(si)
    assert unit is not None
    assert base is not None
    assert unit.dimension == base.dimension
    # A factor is rounded once or twice.
    assert float(unit.factor / base.factor) == pytest.approx(factor, rel=4e-16)


@pytest.mark.parametrize("text", ["kg", "N.s/m", "m/s2", "mm/min", "kg.m/m.s", "N*s/m", "J", "1"])
def test_a_spelling_of_the_verification_means_the_same_on_a_data_sheet(text: str) -> None:
    assert on_data_sheet(text) == spelled(text, all_below=True)


@pytest.mark.parametrize(
    "text", ["", "()", "(m", "m)", "N//m", "m/s.", "x", "2", "mmm", "m1000000"]
)
def test_what_is_no_unit_is_not_understood(text: str) -> None:
    assert on_data_sheet(text) is None


def test_a_plain_rate_is_neither_rad_nor_hertz() -> None:
    dimensions = {unit.dimension for unit in map(on_data_sheet, ("1/s", "rad/s", "Hz")) if unit}
    assert len(dimensions) == 2
