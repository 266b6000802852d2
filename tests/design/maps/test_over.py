"""Ranges of parameters as people type them."""

from typing import Any

import numpy as np
import pytest

from stickslip_design.maps.sources import OverError, block_quantities, dimensions

KNOWN = block_quantities("stribeck")
K = {"k": "1..2 kN/m"}


@pytest.mark.parametrize(
    ("span", "ends", "count", "shown", "log"),
    [
        ("0.1..50 mm/s log 400", (1e-4, 0.05), 400, "mm/s", True),
        ("0.1 mm/s..50 mm/s lin", (1e-4, 0.05), 200, "mm/s", False),
        ("0.1mm/s .. 50 7", (1e-4, 0.05), 7, "mm/s", False),
        ("100um/s..50 mm/s", (1e-4, 0.05), 200, "mm/s", False),
        ("-2..3", (-2.0, 3.0), 200, "", False),
        (np.geomspace(1e-3, 1.0, 5).tolist(), (1e-3, 1.0), 5, "", True),
        ([0.1, 0.2, 0.3, 0.4], (0.1, 0.4), 4, "", False),
    ],
)
def test_a_range_is_read_as_it_is_typed_and_a_list_is_spaced_as_it_is(
    span: str | list[float], ends: tuple[float, float], count: int, shown: str, log: bool
) -> None:
    found = dimensions({"v": span, **K}, KNOWN)[0]
    assert (found.values[0], found.values[-1], len(found.values)) == (*ends, count)
    assert (found.shown, found.log, found.quantity.unit) == (shown, log, "m/s")
    steps = np.diff(np.log(found.values) if log else found.values)
    np.testing.assert_allclose(steps, steps[0], rtol=1e-9)  # roundings of 400 values


@pytest.mark.parametrize(
    ("over", "reason"),
    [
        ({"v": "50..1 mm/s", **K}, "'v=50..1 mm/s' is reversed"),
        ({"v": "1..2 mm/s 1", **K}, "'v=1..2 mm/s 1' has 1 values"),
        ({"v": "0..2 mm/s log", **K}, "is logarithmic and begins at 0 or below"),
        ({"v": "1..2 kg", **K}, "'v=1..2 kg' is a mass; expected a velocity"),
        ({"v": "1..2 mm/s log lin", **K}, "has two words for its spacing"),
        ({"v": "1..1.0000000000000004 m/s 10", **K}, "does not rise from value to value"),
        ({"v": "1 mm/s", **K}, "'v=1 mm/s' is no range; expected such as"),
        ({"v": [1.0, 0.5], **K}, "the range of v does not rise"),
        ({"v": {}, **K}, "the range of v is {}; expected a text or rising numbers"),
        (3, "a map is over parameters by name, not 3; expected a dictionary such as {'v': "),
        (K, "a map is over two parameters or more, not 1"),
        ({"mu_z": "0..1", **K}, "'mu_z' is no parameter that can be mapped over; nearest: mu_"),
        ({"v": "0..1", "k": "-1..1 N/m"}, "k = -1.0 N/m is out of range"),
        ({"shape": "1..3 5", **K}, "shape takes whole numbers, not 1.5"),
    ],
)
def test_what_cannot_be_mapped_over_is_refused_with_what_was_typed(over: Any, reason: str) -> None:
    with pytest.raises(OverError) as refused:
        dimensions(over, KNOWN)
    assert reason in str(refused.value)
