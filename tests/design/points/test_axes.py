"""Many variants of an axis at once, against the same variants one by one."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray

from stickslip_design.axis import AxisError, AxisFile, axis_file_of, example
from stickslip_design.critical import critical_feed, jumps_of
from stickslip_design.points.axes import EVEN, STICKS, SWINGS, axis_points

ZETA = """
[axis]
mass = "500 kg"
stiffness = ["40 N/um", "55 N/um"]
zeta = "1.4 %"
load = "-1 kN"
[friction]
mu_s = 0.20
mu_k = 0.15
"""
FORCES = """
[axis]
mass = "500 kg"
stiffness = "40 N/um"
c = "4 kN s/m"
[friction]
F_s = "9 %"
F_k = "0.8 N m"
[drive]
kind = "rigid"
pitch = "10 mm"
rated_torque = "11 N m"
"""
FALLING = ZETA.replace("[friction]", '[friction]\nlaw = "stribeck"\nv_s = "10 mm/s"')
GROWING = ZETA.replace("[friction]", '[friction]\ntau_s = "20 ms"')

Changes = Mapping[str, NDArray[np.float64]]


def between(low: float, high: float, count: int = 40) -> NDArray[np.float64]:
    """Return numbers of a range, in no order."""
    return np.random.default_rng(round(1e6 * high)).uniform(low, high, count)


def one_by_one(file: AxisFile, changes: Changes, feed: float) -> list[tuple[float, float, float]]:
    """Return critical feed, jump and rate of each variant by the functions for one axis."""
    rows = []
    for numbers in zip(*changes.values(), strict=True):
        axis = file.changed(dict(zip(changes, map(float, numbers), strict=True))).axis()
        limit = critical_feed(axis)
        jumps = jumps_of(axis, feed) if feed <= limit else None
        rows.append((limit, *(jumps or (0.0, 0.0))))
    return rows


@pytest.mark.parametrize(
    ("text", "changes", "feed"),
    [
        pytest.param(
            ZETA,
            {
                "axis.mass": between(450.0, 550.0),
                "axis.stiffness[1]": between(3e7, 6e7),
                "axis.zeta": between(0.0, 0.03),
                "axis.load": between(-2e3, 2e3),
                "friction.mu_s": between(0.1, 0.3),
                "friction.mu_k": between(0.05, 0.25),
            },
            2e-3,
            id="zeta",
        ),
        pytest.param(
            FORCES,
            {
                "axis.mass": between(450.0, 550.0),
                "axis.c": between(0.0, 8e3),
                "friction.F_s": between(0.06, 0.12),
                "friction.F_k": between(0.6, 1.1),
                "drive.pitch": between(8e-3, 12e-3),
            },
            2e-3,
            id="forces",
        ),
        pytest.param(GROWING, {"friction.tau_s": between(0.01, 0.1, 3)}, 2e-4, id="growing"),
        pytest.param(FALLING, {"friction.v_s": between(8e-3, 9e-3, 2)}, 5e-3, id="falling"),
        pytest.param(example(), {"axis.mass": between(490.0, 510.0, 2)}, 1e-3, id="loop"),
    ],
)
def test_many_variants_answer_as_each_does_alone(text: str, changes: Changes, feed: float) -> None:
    """Zeta and forces that the file states are held; mu_k above mu_s is taken as mu_s."""
    file = axis_file_of(text)
    found = axis_points(file, changes, feed)
    expected = np.array(one_by_one(file, changes, feed)).T
    # Rounding: the same operations on arrays and numbers, iterated to 2e-15.
    for name, column in zip(("critical_feed", "jump", "rate"), expected, strict=True):
        assert_allclose(found[name], column, rtol=1e-12, err_msg=name)
    assert_array_equal(found["regime"] == STICKS, found["jump"] > 0.0)


def test_kinetic_friction_above_static_is_counted_as_clamped() -> None:
    """A point is clamped where mu_k comes above mu_s, and where both are equal it is not."""
    changes = {
        "friction.mu_s": np.array([0.2, 0.2, 0.2]),
        "friction.mu_k": np.array([0.19, 0.2, 0.21]),
    }
    found = axis_points(axis_file_of(ZETA), changes, 1e-3)
    assert found["clamped"].tolist() == [False, False, True]
    assert found["critical_feed"][1:].tolist() == [0.0, 0.0]
    assert found["jump"][1:].tolist() == [0.0, 0.0]


def test_falling_friction_has_three_regimes() -> None:
    """A short fall of the friction makes the table swing without rest above its jumps."""
    feeds = np.array([[1e-4, 5e-3, 1.15e-2, 1.0]])
    changes = {"friction.mu_s": np.array([0.202]), "friction.mu_k": np.array([0.1888])}
    found = axis_points(axis_file_of(FALLING.replace("-1 kN", "0 N")), changes, feeds)
    assert found["regime"].tolist() == [[EVEN, STICKS, SWINGS, EVEN]]
    assert (found["jump"] > 0.0).tolist() == [[False, True, False, False]]


def test_unstable_loop_swings_and_its_jump_is_unknown() -> None:
    """With a position gain of 300 1/s the loop of the example swings up."""
    found = axis_points(axis_file_of(example()), {"drive.K_v": np.array([25.0, 300.0])}, 1e-3)
    assert found["stable"].tolist() == [True, False]
    assert found["regime"].tolist() == [STICKS, SWINGS]
    assert math.isinf(found["critical_feed"][1])
    assert math.isnan(found["jump"][1])


def test_feeds_are_one_or_of_each_point_or_several_of_each() -> None:
    """The three ways to give feeds answer alike, and without a feed there is the limit alone."""
    file, changes = axis_file_of(ZETA), {"axis.mass": np.array([450.0, 550.0])}
    several = axis_points(file, changes, np.array([[1e-3, 2e-3], [1e-3, 3e-3]]))
    assert several["jump"].shape == (2, 2)
    assert_array_equal(several["jump"][:, 0], axis_points(file, changes, 1e-3)["jump"])
    own = axis_points(file, changes, np.array([2e-3, 3e-3]))
    assert_array_equal(several["jump"][:, 1], own["jump"])
    limit = axis_points(file, changes)
    assert set(limit) == {"critical_feed", "stable", "clamped"}
    assert_array_equal(limit["critical_feed"], own["critical_feed"])


@pytest.mark.parametrize("text", [FALLING, GROWING, example()], ids=["falling", "growing", "loop"])
def test_regimes_alone_are_those_of_the_whole_answer(text: str) -> None:
    """What is searched beside a feed, or up to it, is found as in the whole range."""
    file, feeds = axis_file_of(text), np.array([[1e-4, 1e-3, 5e-3, 0.03]])
    changes = {"axis.mass": np.array([500.0])}
    whole = axis_points(file, changes, feeds)
    alone = axis_points(file, changes, feeds, regimes_only=True)
    assert len(set(whole["regime"][0].tolist())) == 2
    assert_array_equal(alone["regime"], whole["regime"])
    assert np.isnan(alone["critical_feed"]).all()


def test_loop_that_hunts_along_the_way_sticks() -> None:
    """With ten times the static friction no even row of jumps forms at 1.5 mm/s, but above it."""
    changes = {"friction.mu_s": np.array([2.0])}
    for regimes_only in (False, True):
        found = axis_points(axis_file_of(example()), changes, 1.5e-3, regimes_only=regimes_only)
        assert found["regime"].tolist() == [STICKS]
        assert math.isnan(found["jump"][0])


@pytest.mark.parametrize(
    ("changes", "feed", "message"),
    [
        ({"axis.mas": [1.0]}, 1.0, r"axis\.mas is no number that the file states.*axis\.mass"),
        ({"axis.name": [1.0]}, 1.0, "is no number"),
        ({"axis.mass": [500.0, -1.0]}, 1.0, r"axis\.mass = -1 kg is out of range; expected above"),
        ({"axis.mass": [math.nan]}, 1.0, "axis.mass = nan kg is out of range"),
        ({"axis.load": [0.0, -1e5]}, 1.0, "lifts the table off"),
        ({"axis.mass": [500.0]}, 0.0, "a feed is a finite speed above 0"),
        ({"axis.mass": [500.0]}, math.nan, "a feed is a finite speed above 0"),
        ({"axis.mass": [500.0]}, [1.0, 2.0], "one length"),
        ({"axis.mass": [500.0, 1.0], "axis.load": [1.0]}, 1.0, "one length"),
    ],
)
def test_bad_numbers_are_refused_by_name(changes: Any, feed: Any, message: str) -> None:
    """The message names the number, its value and its range, or the feed."""
    arrays = {name: np.array(values) for name, values in changes.items()}
    with pytest.raises((AxisError, ValueError), match=message):
        axis_points(axis_file_of(ZETA), arrays, feed)
