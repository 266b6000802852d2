"""Ranges as people write them: their ends, how they are spaced, and what is refused."""

import math

import numpy as np
import pytest

from stickslip_design.quantity import QuantityError
from stickslip_design.ranges import Range, parse_range


@pytest.mark.parametrize(
    ("text", "unit", "found"),
    [
        ("0.1..50 mm/s log 400", "m/s", Range(1e-4, 0.05, 400, log=True)),
        ("1e3..1e5 N/m 50", "N/m", Range(1e3, 1e5, 50, log=False)),
        ("-2..2 lin 5", "N", Range(-2.0, 2.0, 5, log=False)),
        ("900 um/s .. 2mm/s 12", "m/s", Range(9e-4, 2e-3, 12, log=False)),
        ("9.81..20 m/s2 2", "m/s2", Range(9.81, 20.0, 2, log=False)),
        ("1..2 kg/m.s 3", "kg/m.s", Range(1.0, 2.0, 3, log=False)),
    ],
)
def test_a_range_has_ends_in_si_and_a_count(text: str, unit: str, found: Range) -> None:
    """The unit behind the high end counts for both, unless the low one has its own."""
    assert parse_range(text, unit) == found


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("5", "is no range; expected such as '0.1..50 mm/s log 400'"),
        ("1..2..3 5", "is no range"),
        ("1...5 5", "is no range"),
        ("1..2 mm/s", "does not end with how many values"),
        ("1..2 mm/s 5 log", "does not end with how many values"),
        ("1..2 mm/s 2.5", "does not end with how many values"),
        ("2..1 mm/s 5", "runs backwards"),
        ("2..2 mm/s 5", "is empty"),
        ("1..2 mm/s 1", "has 1 values; expected 2 to 1000000000"),
        ("1..2 mm/s -3", "has -3 values"),
        ("0..2 mm/s log 5", "is logarithmic and begins at 0 or below"),
        ("nan..2 mm/s 5", "is not a finite number"),
        ("1..inf mm/s 5", "is not a finite number"),
        ("1..2 kg 5", "is a mass; expected a velocity in m/s, such as 20mm/s"),
        ("1..2 mm/s log log 5", "has the unknown unit"),
    ],
)
def test_what_is_no_range_is_refused_with_its_reason(text: str, reason: str) -> None:
    """On one line."""
    with pytest.raises(QuantityError) as refused:
        parse_range(text, "m/s")
    assert str(refused.value).startswith(reason)
    assert "\n" not in str(refused.value)


def test_values_are_evenly_spaced_and_hit_the_ends() -> None:
    """By distance, or by ratio."""
    even = parse_range("0.1..0.7 N 7", "N").values()
    assert even[0] == 0.1
    assert even[-1] == 0.7
    np.testing.assert_allclose(np.diff(even), 0.1, rtol=1e-14)
    by_ratio = parse_range("1e-3..1e3 N log 7", "N").values()
    assert by_ratio[0] == 1e-3
    assert by_ratio[-1] == 1e3
    np.testing.assert_allclose(by_ratio[1:] / by_ratio[:-1], 10.0, rtol=1e-14)


def test_a_caller_reads_the_ends_in_its_own_way() -> None:
    """As with units of what turns, which a plain quantity does not have."""

    def in_turns(text: str, unit: str) -> float:
        assert unit == "rad"
        return 2.0 * math.pi * float(text.removesuffix(" turn"))

    found = parse_range("1..2 turn 3", "rad", read=in_turns)
    assert found == Range(2.0 * math.pi, 4.0 * math.pi, 3, log=False)
