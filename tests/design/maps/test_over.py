"""Ranges of parameters as people type them."""

import numpy as np
import pytest

from stickslip_design.maps.over import Dimension, OverError, dimensions, split
from stickslip_design.maps.sources import block_quantities

KNOWN = block_quantities("coulomb")
K = "1..2 kN/m"


def of_v(span: str | list[float]) -> Dimension:
    """Return the dimension of v."""
    return dimensions({"v": span, "k": K}, KNOWN)[0]


@pytest.mark.parametrize(
    ("span", "ends", "count", "shown", "log"),
    [
        ("0.1..50 mm/s log 400", (1e-4, 0.05), 400, "mm/s", True),
        ("0.1..50mm/s 400 log", (1e-4, 0.05), 400, "mm/s", True),
        ("0.1 mm/s..50 mm/s lin", (1e-4, 0.05), 200, "mm/s", False),
        ("0.1mm/s .. 50 7", (1e-4, 0.05), 7, "mm/s", False),
        ("100um/s..50 mm/s", (1e-4, 0.05), 200, "mm/s", False),
        ("1e-4..0.05 log", (1e-4, 0.05), 200, "", True),
        ("-2..3", (-2.0, 3.0), 200, "", False),
    ],
)
def test_a_range_is_read_as_it_is_typed(
    span: str, ends: tuple[float, float], count: int, shown: str, log: bool
) -> None:
    """Units stand at either end or at both; spacing and number in any order, or not at all."""
    found = of_v(span)
    assert (found.values[0], found.values[-1], len(found.values)) == (*ends, count)
    assert (found.shown, found.log, found.unit) == (shown, log, "m/s")
    steps = np.diff(np.log(found.values) if log else found.values)
    np.testing.assert_allclose(steps, steps[0], rtol=1e-9)


def test_a_list_of_values_is_drawn_as_it_is_spaced() -> None:
    """By equal ratios logarithmically, else linearly."""
    assert of_v(np.geomspace(1e-3, 1.0, 5).tolist()).log
    assert not of_v([0.1, 0.2, 0.4, 0.5]).log
    assert of_v([0.1, 0.2, 0.4, 0.5]).values == (0.1, 0.2, 0.4, 0.5)


@pytest.mark.parametrize(
    ("span", "reason"),
    [
        ("50..1 mm/s", "'v=50..1 mm/s' is reversed"),
        ("1..1 mm/s", "'v=1..1 mm/s' is empty"),
        ("1..2 mm/s 1", "'v=1..2 mm/s 1' has 1 values"),
        ("1..2 mm/s 99999999", "has 99999999 values"),
        ("0..2 mm/s log", "'v=0..2 mm/s log' is logarithmic: both ends must be above 0"),
        ("-1..2 log", "is logarithmic"),
        ("1..2 kg", "'v=1..2 kg' is a mass; expected a velocity"),
        ("1..2 parsec", "has the unknown unit 'parsec'"),
        ("nan..2", "'v=nan..2' is not a finite number"),
        ("1..2 mm/s log lin", "has two words for its spacing"),
        ("1..2 mm/s 3 4", "has two words for its count"),
        ("1..1.0000000000000004 m/s 10", "has not so many numbers between its ends"),
        ("1 mm/s", "'v=1 mm/s' is no range; expected NAME=LOW..HIGH"),
        ("..2", "is no range"),
        ([1.0], "the range of v has 1 values"),
        ([1.0, 0.5], "the range of v does not rise"),
        ([1.0, np.inf], "a value is not finite"),
    ],
)
def test_a_range_that_is_none_is_refused(span: str | list[float], reason: str) -> None:
    """The message repeats what was typed and says what is wrong."""
    with pytest.raises(OverError) as caught:
        of_v(span)
    assert reason in str(caught.value)


@pytest.mark.parametrize(
    ("over", "reason"),
    [
        ({"v": K.replace("kN/m", "m/s")}, "a map is over two parameters or more, not 1"),
        ({}, "not 0"),
        ({"mu_z": "0..1", "k": K}, "'mu_z' is no parameter that can be mapped over; nearest: mu_"),
        ({"x_start": "0..1", "k": K}, "'x_start' is no parameter that can be mapped over"),
        ({"v": "0..1", "k": "-1..1 N/m"}, "k = -1.0 N/m is out of range"),
        ({"mu_s": "-0.1..1", "k": K}, "mu_s = -0.1 is out of range"),
    ],
)
def test_what_cannot_be_mapped_over_is_refused(over: dict[str, str], reason: str) -> None:
    """With the nearest names, or the value that is out of range."""
    with pytest.raises(OverError) as caught:
        dimensions(over, KNOWN)
    assert reason in str(caught.value)


def test_whole_numbers_stay_whole() -> None:
    """Between the ends too."""
    known = block_quantities("stribeck")
    assert dimensions({"shape": "1..3 3", "k": K}, known)[0].values == (1.0, 2.0, 3.0)
    with pytest.raises(OverError, match=r"shape takes whole numbers, not 1\.5"):
        dimensions({"shape": "1..3 5", "k": K}, known)


def test_a_parameter_is_given_once() -> None:
    """Both ranges are told."""
    assert split(["v = 1..2 mm/s", "k=1..2"]) == {"v": "1..2 mm/s", "k": "1..2"}
    with pytest.raises(OverError, match=r"v is given twice: '1\.\.2' and '1\.\.3'"):
        split(["v=1..2", "v=1..3"])
    with pytest.raises(OverError, match="'v' is no range"):
        split(["v"])
