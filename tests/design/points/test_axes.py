"""Many variants of an axis at once, against the same variants one by one."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray

from stickslip_design.axis import AxisError, axis_file_of, example
from stickslip_design.loop.critical import critical_feed, jumps_of
from stickslip_design.points.axes import axis_points
from stickslip_design.points.columns import Regime
from stickslip_ref import Parameters, critical_velocity

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


def between(low: float, high: float, count: int = 40) -> NDArray[np.float64]:
    return np.random.default_rng(round(1e6 * high)).uniform(low, high, count)


@pytest.mark.parametrize(
    ("text", "changes", "feed"),
    [
        (ZETA, {"axis.mass": between(450.0, 550.0), "axis.stiffness[1]": between(3e7, 6e7),
                "axis.zeta": between(0.0, 0.03), "axis.load": between(-2e3, 2e3),
                "friction.mu_s": between(0.1, 0.3), "friction.mu_k": between(0.05, 0.25)}, 2e-3),
        (FORCES, {"axis.mass": between(450.0, 550.0), "axis.c": between(0.0, 8e3),
                  "friction.F_s": between(0.06, 0.12), "friction.F_k": between(0.6, 1.1),
                  "drive.pitch": between(8e-3, 12e-3)}, 2e-3),
        (GROWING, {"friction.tau_s": between(0.01, 0.1, 2)}, 2e-4),
        pytest.param(FALLING, {"friction.v_s": between(8e-3, 9e-3, 2)}, 5e-3,
                     marks=pytest.mark.gate),
        (example(), {"axis.mass": between(490.0, 510.0, 2)}, 1e-3),
    ],
)  # fmt: skip
def test_many_variants_are_judged_as_each_is_alone(
    text: str, changes: dict[str, NDArray[np.float64]], feed: float
) -> None:
    file = axis_file_of(text)
    found = axis_points(file, changes, [feed])
    for place, numbers in enumerate(zip(*changes.values(), strict=True)):
        axis = file.changed(dict(zip(changes, map(float, numbers), strict=True))).axis()
        limit = critical_feed(axis)
        jumps = jumps_of(axis, feed) if feed <= limit else None
        one = [found["critical_feed"][place], found["jump"][place, 0], found["rate"][place, 0]]
        # Rounding: the same operations on arrays and numbers, iterated to 2e-15.
        assert_allclose(one, [limit, *(jumps or (0.0, 0.0))], rtol=1e-12)
    assert_array_equal(found["regime"] == Regime.STICKS, found["jump"] > 0.0)


def test_where_friction_falls_a_little_the_table_swings_above_its_jumps() -> None:
    feeds = [1e-4, 5e-3, 1.15e-2, 1.0]
    changes = {"friction.mu_s": np.array([0.202]), "friction.mu_k": np.array([0.1888])}
    found = axis_points(axis_file_of(FALLING.replace("-1 kN", "0 N")), changes, feeds)
    assert found["regime"].tolist() == [[Regime.EVEN, Regime.STICKS, Regime.SWINGS, Regime.EVEN]]
    assert (found["jump"] > 0.0).tolist() == [[False, True, False, False]]


def test_an_unstable_loop_swings_and_its_jump_is_unknown() -> None:
    found = axis_points(axis_file_of(example()), {"drive.K_v": np.array([25.0, 300.0])}, [1e-3])
    assert found["stable"].tolist() == [True, False]
    assert found["regime"].tolist() == [[Regime.STICKS], [Regime.SWINGS]]
    assert math.isinf(found["critical_feed"][1])
    assert math.isnan(found["jump"][1, 0])


@pytest.mark.parametrize("text", [FALLING, GROWING, example()])
def test_regimes_alone_are_those_of_the_full_judgement(text: str) -> None:
    file, feeds = axis_file_of(text), [1e-4, 1e-3, 5e-3, 0.03]
    changes = {"axis.mass": np.array([500.0])}
    full = axis_points(file, changes, feeds)
    alone = axis_points(file, changes, feeds, regimes_only=True)
    assert len(set(full["regime"][0].tolist())) == 2
    assert_array_equal(alone["regime"], full["regime"])


def test_a_variant_that_cannot_be_computed_is_unknown_and_costs_no_other_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def failing(p: Parameters, *arguments: Any) -> object:
        if p.m == 600.0:
            raise RuntimeError("a slip cannot be followed")
        return critical_velocity(p, *arguments)

    monkeypatch.setattr("stickslip_design.points.axes.critical_velocity", failing)
    file, mass = axis_file_of(GROWING), np.array([500.0, 600.0])
    found = axis_points(file, {"axis.mass": mass}, [2e-4])
    assert found["regime"].tolist() == [[Regime.STICKS], [Regime.UNKNOWN]]
    assert all(np.isnan(found[name][1]).all() for name in ("critical_feed", "jump", "rate"))
    for name, column in axis_points(file, {"axis.mass": mass[:1]}, [2e-4]).items():
        assert found[name][0] == column[0], name


@pytest.mark.parametrize(
    ("changes", "feed", "message"),
    [
        ({"axis.mas": [1.0]}, 1.0, r"axis\.mas is no number that the file states.*axis\.mass"),
        ({"axis.mass": [500.0, -1.0]}, 1.0, r"axis\.mass = -1 kg is out of range; expected above"),
        ({"axis.load": [0.0, -1e5]}, 1.0, "lifts the table off"),
        ({"axis.mass": [500.0]}, math.nan, "a feed is a finite speed above 0"),
        ({"axis.mass": [500.0, 1.0], "axis.load": [1.0]}, 1.0, "one length"),
    ],
)
def test_a_bad_number_or_feed_is_refused_by_name(changes: Any, feed: Any, message: str) -> None:
    arrays = {name: np.array(values) for name, values in changes.items()}
    with pytest.raises((AxisError, ValueError), match=message):
        axis_points(axis_file_of(ZETA), arrays, [feed])
