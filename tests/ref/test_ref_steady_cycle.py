"""The steady cycle in closed form."""

import math
from collections.abc import Callable, Iterator
from typing import Any

import mpmath
import numpy as np
import pytest

from stickslip_ref import Parameters, critical_lambda, simplified, steady_cycle

EPS = float(np.finfo(float).eps)
QUANTITIES = ("spring_drop", "delta_x", "t_slip", "t_stick", "T", "f", "x_dot_peak")


def _undamped_truth(p: Parameters) -> dict[str, Any]:
    m, g, k, v = (mpmath.mpf(each) for each in (p.m, p.g, p.k, p.v))
    gap = mpmath.mpf(p.mu_s) - mpmath.mpf(p.mu_k)
    w = mpmath.sqrt(k / m)
    Delta = gap * m * g / k
    lambda_ = w * Delta / v
    t_slip = 2 / w * (mpmath.pi - mpmath.atan(lambda_))
    T = 2 * Delta / v + t_slip
    return {
        "spring_drop": 2 * Delta,
        "delta_x": v * T,
        "t_slip": t_slip,
        "t_stick": 2 * Delta / v,
        "T": T,
        "f": 1 / T,
        "x_dot_peak": v * (1 + mpmath.sqrt(1 + lambda_**2)),
    }


def _damped_truth(p: Parameters) -> dict[str, Any]:
    m, g, k, c, v = (mpmath.mpf(each) for each in (p.m, p.g, p.k, p.c, p.v))
    w = mpmath.sqrt(k / m)
    zeta = c / (2 * m * w)
    nu = mpmath.sqrt(1 - zeta**2)
    lambda_ = (mpmath.mpf(p.mu_s) - mpmath.mpf(p.mu_k)) * m * g * w / k / v

    def x_dot(tau: Any) -> Any:
        wave = (lambda_ - zeta) / nu * mpmath.sin(nu * tau) - mpmath.cos(nu * tau)
        return 1 + mpmath.exp(-zeta * tau) * wave

    angle = mpmath.atan2(lambda_ * nu, 1 - zeta * lambda_)
    tau_max, tau_min = (mpmath.pi - angle) / nu, (2 * mpmath.pi - angle) / nu
    tau = mpmath.findroot(x_dot, (tau_max, tau_min), solver="anderson", tol=1e-60, maxsteps=500)
    drop = (lambda_ - mpmath.diff(x_dot, tau)) * v / w
    T = drop / v + tau / w
    return {
        "spring_drop": drop,
        "delta_x": v * T,
        "t_slip": tau / w,
        "t_stick": drop / v,
        "T": T,
        "f": 1 / T,
        "x_dot_peak": v * x_dot(tau_max),
    }


@pytest.mark.parametrize("power", range(-7, 8))
def test_every_lambda_is_exact_to_rounding(power: int) -> None:
    """The cycle is as exact for lambda = 1e-7 as for 1e7: no formula cancels."""
    v = float(Parameters(v=1.0).lambda_) / 10.0**power
    p = Parameters(v=v)
    cycle = steady_cycle(p)
    # A dozen roundings, times mu_s / (mu_s - mu_k) = 2.5 for the gap.
    tolerance = 12 * 2.5 * EPS
    for name, truth in _undamped_truth(p).items():
        assert abs(getattr(cycle, name) / float(truth) - 1.0) < tolerance, name


def test_damped_cycles_are_exact_to_rounding(
    damped_points: Callable[[int, int], Iterator[tuple[Parameters, float]]],
) -> None:
    """A damped cycle is the first root of its velocity, wherever lambda stands above lambda_c."""
    seen = 0
    with mpmath.workdps(50):
        for p, d in damped_points(150, 11):
            cycle = steady_cycle(p)
            assert cycle.exists == (d > 0.0)
            if not cycle.exists:
                continue
            seen += 1
            # Rounding times the conditioning of the gap and of the nearly tangent root.
            conditioning = p.mu_s / (p.mu_s - p.mu_k) * (1.0 + 1.0 / math.sqrt(d))
            for name, truth in _damped_truth(p).items():
                error = abs(getattr(cycle, name) / float(truth) - 1.0)
                assert error < 20 * EPS * conditioning, (name, p, d)
    assert seen > 40


@pytest.mark.parametrize("v", [1e-5, 0.02, 5.0])
def test_a_slip_relieves_the_spring_by_two_delta_at_any_speed(v: float) -> None:
    """The relief of the spring in an undamped slip is 2 Delta, fast or slow."""
    cycle = steady_cycle(Parameters(v=v))
    assert cycle.spring_drop == pytest.approx(2.0 * 0.2 * 9.81 / 1000.0, rel=4 * EPS)


def test_light_damping_joins_the_undamped_cycle() -> None:
    """As damping vanishes, the damped cycle becomes the undamped one."""
    undamped, light = steady_cycle(Parameters()), steady_cycle(Parameters(c=1e-13))
    for name in QUANTITIES:
        # zeta = 1.6e-15 shifts the cycle by a few zeta times 2 pi.
        assert getattr(light, name) == pytest.approx(getattr(undamped, name), rel=1e-13)


def test_backward_pull_mirrors_the_cycle() -> None:
    """Pulled the other way, lengths and velocities change sign and durations do not."""
    forward, backward = steady_cycle(Parameters(c=0.1)), steady_cycle(Parameters(c=0.1, v=-0.02))
    for name in ("spring_drop", "delta_x", "x_dot_peak"):
        assert getattr(backward, name) == -getattr(forward, name)
    for name in ("t_slip", "t_stick", "T", "f", "F_s", "Delta", "lambda_"):
        assert getattr(backward, name) == getattr(forward, name)


def test_load_is_weight_and_a_constant_force_changes_nothing() -> None:
    """A load acts through the normal force; a constant external force shifts the spring alone."""
    loaded = steady_cycle(Parameters(load=9.81, F_ext=3.0))
    heavier = steady_cycle(Parameters(g=2 * 9.81))
    assert loaded == heavier


def test_without_a_gap_the_cycle_is_all_slip() -> None:
    """With mu_s = mu_k the undamped mass only touches rest, once in 2 pi / w."""
    p = Parameters(mu_s=0.3)
    cycle = steady_cycle(p)
    assert cycle.exists
    assert cycle.t_stick == 0.0
    assert cycle.t_slip == pytest.approx(2.0 * math.pi / p.w, rel=2 * EPS)
    assert not steady_cycle(Parameters(mu_s=0.3, c=1e-6)).exists


@pytest.mark.parametrize("values", [{"v": 0.0}, {"c": 1e3}, {"c": 30.0, "v": 1.0}])
def test_where_there_is_no_cycle_there_are_no_numbers(values: dict[str, float]) -> None:
    """Without pull, over-damped or pulled too fast there is no cycle: NaN and not a guess."""
    cycle = steady_cycle(Parameters(**values))
    assert cycle.exists is False
    assert all(math.isnan(getattr(cycle, name)) for name in QUANTITIES)
    assert cycle.F_s == pytest.approx(4.905)


def test_existence_turns_at_the_critical_lambda() -> None:
    """The cycle exists from lambda_c on, and not a rounding error's width below."""
    for zeta in (1e-4, 0.01, 0.1, 0.5, 0.9):
        still = Parameters(v=1.0)
        c = 2.0 * still.w * zeta
        edge = float(still.lambda_) / float(critical_lambda(zeta))
        for nudge, exists in ((-1e-12, True), (1e-12, False)):
            assert steady_cycle(Parameters(c=c, v=edge * (1.0 + nudge))).exists is exists


def test_fields_broadcast() -> None:
    """Speeds along one axis and stiffnesses along another give every pair, as single points do."""
    v, k = np.array([-0.1, 0.0, 0.02, 3.0]), np.array([[100.0], [1e6]])
    for c in (0.0, 0.5):
        field = steady_cycle(Parameters(v=v, k=k, c=c))
        columns = simplified(Parameters(v=v, k=k, c=c))
        for i, j in np.ndindex(2, 4):
            point = Parameters(v=float(v[j]), k=float(k[i, 0]), c=c)
            for whole, single in ((field, steady_cycle(point)), (columns, simplified(point))):
                for name, value in vars(single).items():
                    # Vectorised and single elementary functions differ by a rounding error.
                    np.testing.assert_allclose(getattr(whole, name)[i, j], value, rtol=8 * EPS)


def test_blocks_join_without_a_seam() -> None:
    """A field larger than a block of evaluation has no trace of the blocks."""
    v = np.full(40_000, 0.02)
    cycle = steady_cycle(Parameters(v=v))
    for name in QUANTITIES:
        assert np.ptp(getattr(cycle, name)) == 0.0, name
    assert steady_cycle(Parameters(v=np.empty(0))).T.shape == (0,)  # type: ignore[union-attr]  # an array in, an array out


def test_the_simplified_column_is_what_designers_write() -> None:
    """At the default parameters the simplified jump is 3.924 mm, the real one 6.305 mm."""
    p = Parameters()
    simple, exact = simplified(p), steady_cycle(p)
    assert simple.delta_x == pytest.approx(3.924e-3, rel=4 * EPS)
    assert exact.delta_x == pytest.approx(6.305e-3, abs=5e-7)  # to the digits written
    assert simple.t_slip == pytest.approx(math.pi / p.w, rel=4 * EPS)
    assert simple.t_stick == pytest.approx(4.905 / (1000.0 * 0.02), rel=4 * EPS)
    assert simple.t_stick + simple.t_slip == simple.T


def test_slip_time_runs_from_half_a_period_to_a_whole_one() -> None:
    """t_slip is pi / w for slow pull, to first order in 1 / lambda, and 2 pi / w for fast pull."""
    slow, fast = Parameters(v=1e-6), Parameters(v=1e6)
    excess = steady_cycle(slow).t_slip * slow.w / math.pi - 1.0
    # The second-order term of atan, (1 / lambda)^3, is below 1e-13.
    assert excess == pytest.approx(2.0 / (math.pi * slow.lambda_), rel=1e-8)
    assert steady_cycle(fast).t_slip * fast.w == pytest.approx(2.0 * math.pi, rel=1e-7)


def test_the_slowest_pull_does_not_overflow() -> None:
    """lambda^2 may leave the range of floats; the peak velocity w Delta does not."""
    cycle = steady_cycle(Parameters(v=np.array([1e-300, 0.02])))
    np.testing.assert_allclose(cycle.x_dot_peak, [math.sqrt(1000.0) * 1.962e-3, 0.0851877596])
