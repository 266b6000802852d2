"""Ranges as people write them: their ends, how they are spaced, and what is refused."""

import numpy as np
import pytest

from stickslip_design.quantity import QuantityError
from stickslip_design.ranges import Range, parse_range


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("0.1..50 mm/s log 400", "m/s", Range(1e-4, 0.05, 400, log=True)),
        ("1e3..1e5 N/m 50", "N/m", Range(1e3, 1e5, 50, log=False)),
        ("-2..2 lin 5", "N", Range(-2.0, 2.0, 5, log=False)),
        ("900 um/s .. 2mm/s 12", "m/s", Range(9e-4, 2e-3, 12, log=False)),
        ("9.81..20 m/s2 2", "m/s2", Range(9.81, 20.0, 2, log=False)),
    ],
)
def test_a_range_has_ends_in_si_and_a_count(text: str, unit: str, expected: Range) -> None:
    assert parse_range(text, unit) == expected


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("5", "is no range; expected such as '0.1..50 mm/s log 400'"),
        ("1..2..3 5", "is no range"),
        ("1..2 mm/s", "does not end with how many values"),
        ("1..2 mm/s 2.5", "does not end with how many values"),
        ("2..1 mm/s 5", "runs backwards"),
        ("2..2 mm/s 5", "is empty"),
        ("1..2 mm/s 1", "has 1 values; expected 2 to 1000000000"),
        ("0..2 mm/s log 5", "is logarithmic and begins at 0 or below"),
        ("1..inf mm/s 5", "is not a finite number"),
        ("1..2 kg 5", "is a mass; expected a velocity in m/s, such as 20mm/s"),
    ],
)
def test_what_is_no_range_is_refused_with_its_reason(text: str, reason: str) -> None:
    with pytest.raises(QuantityError) as refused:
        parse_range(text, "m/s")
    assert str(refused.value).startswith(reason)
    assert "\n" not in str(refused.value)


def test_values_are_evenly_spaced_and_hit_the_ends() -> None:
    even, by_ratio = (
        parse_range(text, "N").values() for text in ("0.1..0.7 N 7", "1e-3..1e3 N log 7")
    )
    assert (even[0], even[-1], by_ratio[0], by_ratio[-1]) == (0.1, 0.7, 1e-3, 1e3)
    # Some roundings.
    np.testing.assert_allclose(np.diff(even), 0.1, rtol=1e-14)
    np.testing.assert_allclose(by_ratio[1:] / by_ratio[:-1], 10.0, rtol=1e-14)
