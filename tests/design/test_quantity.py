"""Units as drawings and data sheets write them."""

import math

import pytest

from stickslip_design.quantity import on_data_sheet
from stickslip_verification import spelled


@pytest.mark.parametrize(
    ("text", "si", "factor"),
    [
        ("kg cm2", "kg.m2", 1e-4),
        ("kgcm²", "kg.m2", 1e-4),
        ("kg·cm^2", "kg.m2", 1e-4),
        ("kg m**2", "kg.m2", 1.0),
        ("Nm", "N.m", 1.0),
        ("Ncm", "N.m", 0.01),
        ("Nmm", "N.m", 0.001),
        ("kNm", "N.m", 1000.0),
        ("mNm", "N.m", 0.001),
        ("kN s/m", "N.s/m", 1000.0),
        ("Ns/mm", "N.s/m", 1000.0),
        ("N/(m/s)", "N.s/m", 1.0),
        ("m/min/mm", "1/s", 1000 / 60),
        ("(m/min)/mm", "1/s", 1000 / 60),
        ("m/(min mm)", "1/s", 1000 / 60),
        ("/s", "1/s", 1.0),
        ("s^-1", "1/s", 1.0),
        ("1/min", "1/s", 1 / 60),
        ("N/um", "N/m", 1e6),
        ("m/s²", "m/s2", 1.0),
        ("%", "1", 0.01),
        ("Hz", "rad/s", 2 * math.pi),
        ("kHz", "rad/s", 2000 * math.pi),
        ("rpm", "rad/s", math.pi / 30),
        ("Nm/rpm", "N.m.s/rad", 30 / math.pi),
        ("Nms/rad", "N.m.s/rad", 1.0),
        ("Nm/(rad/s)", "N.m.s/rad", 1.0),
        ("counts/rev", "1/turn", 1.0),
        ("lines/turn", "1/turn", 4.0),
    ],
)
def test_a_unit_of_a_data_sheet_is_read(text: str, si: str, factor: float) -> None:
    """Blanks and brackets, and what turns; a factor is rounded once or twice."""
    unit, base = on_data_sheet(text), on_data_sheet(si)
    assert unit is not None
    assert base is not None
    assert unit.dimension == base.dimension
    assert float(unit.factor / base.factor) == pytest.approx(factor, rel=4e-16)


@pytest.mark.parametrize("text", ["kg", "N.s/m", "m/s2", "mm/min", "kg.m/m.s", "N*s/m", "J", "1"])
def test_what_the_command_reads_means_the_same_here(text: str) -> None:
    """A spelling that the verification understands is the same unit on a data sheet."""
    assert on_data_sheet(text) == spelled(text, all_below=True)


@pytest.mark.parametrize(
    "text",
    ["", "()", "(m", "m)", "N/", "N//m", "m/s.", "x", "2", "kg cm2)", "Nmx", "mmm", "m10000000"],
)
def test_what_is_no_unit_is_not_understood(text: str) -> None:
    """So is what could be read in two ways."""
    assert on_data_sheet(text) is None


def test_turns_and_plain_rates_are_kept_apart() -> None:
    """1/s could be rad/s or Hz, so it is neither."""
    dimensions = {unit.dimension for unit in map(on_data_sheet, ("1/s", "rad/s", "Hz")) if unit}
    assert len(dimensions) == 2
