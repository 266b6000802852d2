"""The servo loop around an axis: limits, stability, hunting, starts from rest, open loops."""

import math
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg
from numpy.typing import NDArray
from scipy import signal
from threadpoolctl import threadpool_info, threadpool_limits

from stickslip_design.axis import Axis, Filter, Friction
from stickslip_design.loop import native
from stickslip_design.loop import system as matrices
from stickslip_design.loop.courses import jolted
from stickslip_design.loop.critical import jumps_of, rigid_critical_feed
from stickslip_design.loop.jumps import limit_of_jumps
from stickslip_design.loop.motion import Point, Watched, walk
from stickslip_design.loop.rest import hunting, limit_from_rest
from stickslip_design.loop.stability import gain_limits, is_stable, open_loop, swing
from stickslip_design.loop.system import Mode, System
from stickslip_native.named import HOME
from tests.design.axes import SERVO, driven, random_axis
from tests.native.test_native_libraries import STRICT
from tests.needs import needs

FAST = {"bandwidth": 600.0, "T_n": 4.0 / 600.0}


def rubbing(law: str = "coulomb", **own: float) -> Friction:
    return Friction(mu_s=0.20, mu_k=0.15, law=law, own=own)


@pytest.mark.parametrize(
    ("axis", "feed"),
    [
        (SERVO, 1.550e-3),
        (driven(**FAST), 4.198e-3),
        (driven(T_s=1e-3), 1.40e-3),
        (driven(dead_time=0.25e-3, **FAST), 4.47e-3),
    ],
)
def test_jumps_end_at_the_feed_where_the_loop_solved_as_one_ends_them(
    axis: Axis, feed: float
) -> None:
    # That loop was raised slowly, over 120 s.
    assert limit_of_jumps(axis).feed == pytest.approx(feed, rel=0.01)


@pytest.mark.parametrize(
    ("axis", "jump", "period"),
    [
        (SERVO, 18.4e-6, 36.9e-3),
        (driven(on_table=False), 17.5e-6, 34.9e-3),
        (replace(SERVO, c=16e3), 17.4e-6, 34.7e-3),
    ],
)
def test_the_jump_at_half_a_millimetre_a_second_is_that_of_the_two_fmus(
    axis: Axis, jump: float, period: float
) -> None:
    found = jumps_of(axis, 5e-4)
    assert found is not None
    # Of runs of the two FMUs of docs/feed-axis.md, to their digits.
    assert found.way == pytest.approx(jump, abs=0.08e-6)
    assert 1.0 / found.rate == pytest.approx(period, abs=0.2e-3)


def test_above_the_limit_there_is_no_jump_and_just_below_it_the_table_hardly_stops() -> None:
    limit = limit_of_jumps(SERVO)
    assert limit.jump is not None
    assert -0.1 * limit.feed < limit.jump.least < 0.0
    assert jumps_of(SERVO, 1.01 * limit.feed) is None
    assert jumps_of(SERVO, 0.99 * limit.feed) is not None
    assert limit_of_jumps(replace(SERVO, friction=Friction(mu_s=0.15, mu_k=0.15))).feed == 0.0


CURVE = {"n_points": 3.0, "mu_1": 0.2, "u_2": 2e-3, "mu_2": 0.15, "u_3": 0.05, "mu_3": 0.16}


@pytest.mark.gate
@pytest.mark.parametrize(
    ("friction", "tolerance"),
    [
        (rubbing(), 0.005),
        (rubbing(tau_s=0.1), 0.005),
        (rubbing(B=0.01, t_0=1e-3), 0.005),
        # Lines in place of a smooth fall miss its limit by less than 1 %.
        (rubbing("stribeck", shape=1.0, v_s=1e-3, delta=2.0), 0.01),
        (rubbing("stribeck", shape=2.0, v_s=1e-3), 0.01),
        (rubbing("stribeck", shape=3.0, **CURVE), 0.01),
    ],
)
def test_a_drive_of_ten_million_tons_leaves_the_limit_of_a_rigid_one(
    friction: Friction, tolerance: float
) -> None:
    axis = replace(driven(inertia=1e10, on_table=False), friction=friction)
    assert limit_of_jumps(axis).feed == pytest.approx(rigid_critical_feed(axis), rel=tolerance)


@pytest.mark.parametrize(
    ("axis", "jump", "period"),
    [
        (SERVO, 13.6e-6, 0.85),
        (driven(K_v=50.0), 14.4e-6, 0.40),
        (replace(SERVO, c=16e3), 12.7e-6, 0.92),
    ],
)
def test_hunting_is_that_of_the_two_fmus_and_a_band_of_half_a_jump_ends_it(
    axis: Axis, jump: float, period: float
) -> None:
    found = hunting(axis)
    assert found is not None
    # Of runs of the two FMUs of docs/feed-axis.md, to their digits.
    assert found.jump == pytest.approx(jump, abs=0.06e-6)
    assert found.period == pytest.approx(period, rel=0.02)
    assert found.dead_band == pytest.approx(0.5 * jump, rel=0.03)


def falling(v_s: float) -> Axis:
    return replace(SERVO, friction=rubbing("stribeck", shape=1.0, v_s=v_s, delta=1.0))


# Friction that falls slowly; nothing winds up: position on the motor, or no integral.
@pytest.mark.parametrize("axis", [falling(2e-3), driven(on_table=False), driven(T_n=0.0)])
def test_hunting_ends_where_friction_falls_slowly_or_nothing_winds_up(axis: Axis) -> None:
    assert hunting(axis) is None


def test_a_start_from_rest_ends_evenly_below_the_limit() -> None:
    # Where the loop solved as one jumps on after 4 s at the lower and not at the higher feed.
    highest = limit_of_jumps(SERVO).feed
    for acceleration, low, high in ((1.0, 0.985e-3, 0.995e-3), (0.01, 1.29e-3, 1.31e-3)):
        assert low < limit_from_rest(SERVO, acceleration, highest) < high


def test_at_the_limits_of_its_gains_the_swing_of_the_sliding_table_has_no_damping() -> None:
    limits = gain_limits(SERVO)
    assert limits == pytest.approx((72.18, 716.3), rel=1e-3)
    faster = driven(bandwidth=limits.bandwidth, T_n=4.0 / limits.bandwidth)
    for axis in (driven(K_v=limits.K_v), faster):
        assert swing(axis).damping == pytest.approx(0.0, abs=1e-6)  # of the search
    assert is_stable(driven(K_v=0.999 * limits.K_v))
    assert not is_stable(driven(K_v=1.001 * limits.K_v))
    plain = driven(velocity_feedforward=0.0)
    margin = open_loop(plain, "position").gain_margin
    assert margin == pytest.approx(gain_limits(plain).K_v / 25.0, rel=1e-9)  # of both searches


@pytest.mark.parametrize("T_s", [250e-6, 1e-3])
@pytest.mark.parametrize(
    ("each", "above", "below"),
    [
        (Filter("low pass", 150.0), [1.0], [1.0, 1.0]),
        (Filter("low pass", 150.0, 0.7), [1.0], [1.0, 1.4, 1.0]),
        (Filter("notch", 90.0, 0.5, 0.1), [1.0, 0.1, 1.0], [1.0, 1.0, 1.0]),
    ],
)
def test_filters_are_those_of_scipy_bilinear_with_the_frequency_kept(
    each: Filter, above: list[float], below: list[float], T_s: float
) -> None:
    # Polynomials in s / w.
    b, a = signal.bilinear(above, below, fs=0.5 / math.tan(math.pi * each.frequency * T_s))
    b0, b1, b2, a1, a2 = each.coefficients(T_s)
    _, expected = signal.freqz(b, a, 64)
    _, found = signal.freqz([b0, b1, b2], [1.0, a1, a2], 64)
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-12)  # roundings near the notch


@pytest.mark.parametrize("lag", [0.0, 1e-3])
def test_about_a_target_backward_is_the_mirror_of_forward(lag: float) -> None:
    system = System(driven(dry=300.0, lag=lag))
    walks = []
    for side in (1, -1):
        state = system.at_rest()
        state[system.layout.command] = side * 1e-4
        turns = walk(system, Mode(0, 0), Point(state, 0.0), Watched(1.0)).turns(1000)
        walks.append([(each.time, *side * np.array(each.mode)) for each in turns])
        assert len(turns) > 2
    assert walks[1] == pytest.approx(np.array(walks[0]), abs=1e-9)  # events located to rounding


def in_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take the way without a compiler."""
    monkeypatch.setattr(native, "library", lambda: None)


@needs("cc")
def test_the_loop_in_c_compiles_without_a_warning() -> None:
    subprocess.run(
        ["cc", *STRICT, f"-I{HOME}/face", Path(native.__file__).with_name("walk.c")], check=True
    )


@needs("cc")
@pytest.mark.gate
@pytest.mark.parametrize("seed", range(12))
def test_without_a_compiler_the_answers_are_the_same(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    def answers() -> list[float]:
        axis = random_axis(seed)
        if not is_stable(axis):
            return [math.nan]
        limit = limit_of_jumps(axis).feed
        feed = 0.7 * (limit or 1e-3)
        kinds = [*map(("even", "swings", "sticks").index, jolted(axis, feed))]
        start = limit_from_rest(axis, 0.1, limit)
        cycles = *(jumps_of(axis, feed) or ()), *(hunting(axis) or ())
        return [limit, start, *swing(axis), *cycles, *kinds]

    in_c = answers()
    in_python(monkeypatch)
    # Events lie on the same cubics; by small steps to an end that is sought rounding grows.
    assert answers() == pytest.approx(in_c, rel=1e-6, nan_ok=True)


def threads() -> set[int]:
    return {each["num_threads"] for each in threadpool_info() if each["user_api"] == "blas"}


def test_small_matrices_of_a_loop_take_one_thread_and_the_callers_number_comes_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen: set[int] = set()

    def noting(matrix: NDArray[np.float64]) -> object:
        seen.update(threads())
        return scipy.linalg.expm(matrix)

    in_python(monkeypatch)
    monkeypatch.setattr(matrices, "expm", noting)
    with threadpool_limits(limits=2, user_api="blas"):
        swing(replace(SERVO))
        assert (seen, threads()) == ({1}, {2})
