"""Units as drawings and data sheets write them."""

import math

import pytest

from stickslip_units import on_data_sheet


@pytest.mark.parametrize(
    ("text", "si", "factor"),
    [
        ("kgcm²", "kg.m2", 1e-4),
        ("kg·cm^2", "kg.m2", 1e-4),
        ("Ncm", "N.m", 0.01),
        ("N/(m/s)", "N.s/m", 1.0),
        ("(m/min)/mm", "1/s", 1000 / 60),
        ("s^-1", "1/s", 1.0),
        ("%", "1", 0.01),
        ("kHz", "rad/s", 2000 * math.pi),
        ("Nm/rpm", "N.m.s/rad", 30 / math.pi),
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


@pytest.mark.parametrize("text", ["", "(m", "N//m", "m/s.", "x", "2", "mmm", "m1000000"])
def test_what_is_no_unit_is_not_understood(text: str) -> None:
    assert on_data_sheet(text) is None


def test_a_plain_rate_is_neither_rad_nor_hertz() -> None:
    dimensions = {unit.dimension for unit in map(on_data_sheet, ("1/s", "rad/s", "Hz")) if unit}
    assert len(dimensions) == 2
