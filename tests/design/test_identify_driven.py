"""Facts about what an excitation and steady runs tell."""

import numpy as np
import pytest

from stickslip_design.identify.model import Identified, Record
from stickslip_design.identify.study import identify

T = np.arange(0.0, 12.0, 1e-3)
W, SIZE = 2.0 * np.pi * np.array([0.21, 0.9, 2.3]), np.array([40e-3, 5e-3, 1e-3])
X = np.sin(np.outer(T, W)) @ SIZE
V, A = np.cos(np.outer(T, W)) @ (SIZE * W), -np.sin(np.outer(T, W)) @ (SIZE * W**2)
NOISE = np.random.default_rng(36).normal(0.0, 1.0, T.size)
ROUGH = np.where(V > 0.0, 300.0, 420.0)
FORCE = 80.0 * A + ROUGH * V + 25.0 * np.sign(V) + 7.0 + NOISE
TRUTH = {
    "axis.mass": 80.0, "c forward": 300.0, "c backward": 420.0, "friction.F_k": 25.0,
    "axis.force_along": -7.0,
}  # fmt: skip


def contains(found: Identified, truth: dict[str, float]) -> bool:
    numbers = [(found.number(name), value) for name, value in truth.items()]
    return all(number.low <= value <= number.high for number, value in numbers)


def test_mass_and_friction_by_direction_are_those_of_the_record() -> None:
    found = identify(Record(t=T, position=X, force=FORCE))
    assert found.kind == "excitation"
    assert found.explained
    assert contains(found, TRUTH)
    assert found.number("axis.mass").width < 0.01


def test_the_mirrored_record_tells_the_mirrored_axis() -> None:
    there = identify(Record(t=T, position=X, force=FORCE))
    back = identify(Record(t=T, position=-X, force=-FORCE))
    names = {"c forward": "c backward", "axis.mass": "axis.mass", "friction.F_k": "friction.F_k"}
    # Rounding times the condition of the normal equations.
    for one, other in names.items():
        assert back.number(other).value == pytest.approx(there.number(one).value, rel=1e-7)
    along = there.number("axis.force_along").value
    assert back.number("axis.force_along").value == pytest.approx(-along, rel=1e-6)


def test_a_force_that_is_late_by_a_sample_is_seen_and_moves_no_number() -> None:
    late = identify(Record(t=T[1:], position=X[1:], force=FORCE[:-1]))
    assert late.explained
    assert contains(late, TRUTH)


def test_one_frequency_tells_no_delay_from_viscous_friction() -> None:
    w, t = 3.0, T
    x, v, a = 0.02 * np.sin(w * t), 0.06 * np.cos(w * t), -0.18 * np.sin(w * t)
    force = 500.0 * a + 300.0 * v + 70.0 * np.sign(v) + NOISE
    shifted = identify(Record(t=t[1:], position=x[1:], force=force[:-1]))
    assert contains(shifted, {"axis.mass": 500.0, "axis.c": 300.0, "friction.F_k": 70.0})
    # m w^2 times the time of a sample.
    assert shifted.number("axis.c").high - shifted.number("axis.c").low > 2.0 * 500.0 * w**2 * 1e-3


def test_steady_runs_tell_friction_over_the_speed_and_no_mass() -> None:
    speeds = np.outer([1e-3, 3e-3, 8e-3, 2e-2, 5e-2], [1.0, -1.0]).ravel()
    v = np.repeat(speeds, 2000)
    t, x = np.linspace(0.0, 1e-3 * (v.size - 1), v.size), np.cumsum(v) * 1e-3
    noise = np.random.default_rng(1).normal(0.0, 1.0, v.size)
    fall = 30.0 * np.exp(-((np.abs(v) / 4e-3) ** 2))
    found = identify(Record(t=t, position=x, force=(90.0 + fall) * np.sign(v) + 800.0 * v + noise))
    assert found.kind == "steady runs"
    assert found.friction is not None
    assert "falls" in found.friction.name
    assert contains(found, {"friction.F_k": 90.0, "axis.c": 800.0, "axis.force_along": 0.0})
    assert "axis.mass" in dict(found.missing)


def test_motion_in_one_direction_tells_no_constant_force() -> None:
    way = V + 0.2
    force = 80.0 * A + 300.0 * way + 25.0 + 7.0 + NOISE
    found = identify(Record(t=T, position=X + 0.2 * T, force=force))
    assert contains(found, {"axis.mass": 80.0, "axis.c": 300.0, "friction.F_k": 32.0})
    assert "axis.force_along" in dict(found.missing)


def test_a_force_that_is_clipped_tells_nothing_where_it_is() -> None:
    limit = np.quantile(np.abs(FORCE), 0.9)
    clipped = FORCE.clip(-limit, limit)
    found = identify(Record(t=T, position=X, force=clipped))
    assert found.explained
    assert contains(found, TRUTH)
    assert any("the force is clipped" in note for note in found.notes)
    # Measured behind the limit, with noise, it is no number that stands.
    noisy = identify(Record(t=T, position=X, force=clipped + NOISE[::-1]))
    assert any("and no noise" in fault for fault in noisy.faults)


def test_a_sample_that_is_disturbed_is_said() -> None:
    force = FORCE + 1e6 * (np.arange(T.size) == 5000)
    found = identify(Record(t=T, position=X, force=force))
    assert any("the force at 5 s is" in fault for fault in found.faults)
