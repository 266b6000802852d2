"""The simulation against the closed form, and against itself under the symmetries."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest

from stickslip_ref import Change, MeasuredCycle, Parameters, Trajectory, simulate, steady_cycle

Draw = Callable[..., Iterator[Parameters]]

INTEGRATION = 3e-13
"""Relative error of an integrated slip: 50 steps of rtol 3e-14, with room for another SciPy."""


def _cycles(p: Parameters, count: int) -> tuple[MeasuredCycle, ...]:
    """Simulate long enough for ``count`` cycles after the first load-up, and no more."""
    first = abs(float(p.F_s) / (float(p.k) * float(p.v)))
    T = float(steady_cycle(p).T)
    return simulate(p, first + (count + 0.3) * T, times=[]).cycles


def _assert_closed_form(p: Parameters, cycles: tuple[MeasuredCycle, ...], tangency: float) -> None:
    """Compare with the closed form, times the conditioning of docs/theory.md (17)."""
    exact = steady_cycle(p)
    lambda_ = float(exact.lambda_)
    gap = float(p.mu_s / (p.mu_s - p.mu_k))
    conditioning = {
        "T": 1.0,
        "delta_x": 1.0,
        "x_dot_peak": 1.0,
        "t_slip": 1.0 + 1.0 / lambda_,
        "t_stick": 1.0 + 1.0 / lambda_**2,
        "spring_drop": 1.0 + 1.0 / lambda_**2,
    }
    for cycle in cycles:
        for name, factor in conditioning.items():
            error = abs(getattr(cycle, name) / getattr(exact, name) - 1.0)
            assert error < INTEGRATION * gap * factor * tangency, (name, p)
        assert cycle.delta_x == pytest.approx(p.v * cycle.T, rel=INTEGRATION * gap)


@pytest.mark.parametrize(
    ("count", "seed", "lambda_range"),
    [(500, 20240, None), (100, 20241, (1e-3, 1e-1))],
    ids=["machines of all sizes", "grazing re-sticks"],
)
def test_no_cycle_is_missed_and_each_is_the_closed_form(
    undamped_points: Draw,
    sized: Callable[[int], int],
    count: int,
    seed: int,
    lambda_range: tuple[float, float] | None,
) -> None:
    """From lambda = 1e-3 on every re-stick is found, however shallow, and is where it belongs."""
    for p in undamped_points(sized(count), seed, lambda_range):
        cycles = _cycles(p, 2)
        assert len(cycles) == 2, p
        _assert_closed_form(p, cycles, tangency=1.0)


def test_damped_slips_end_if_and_only_if_the_cycle_exists(
    damped_points: Callable[[int, int], Iterator[tuple[Parameters, float]]],
) -> None:
    """Above lambda_c each slip ends as the closed form says, below none ends."""
    ends = 0
    for p, d in damped_points(100, 20242):
        if d > 0.0:
            cycles = _cycles(p, 1)
            assert len(cycles) == 1, (p, d)
            _assert_closed_form(p, cycles, tangency=1.0 + 1.0 / math.sqrt(d))
            ends += 1
        else:
            first = float(p.F_s) / (float(p.k) * float(p.v))
            run = simulate(p, first + 30.0 / float(p.w), times=[])
            assert [event.kind for event in run.events] == ["break-away"], (p, d)
    assert ends > 30


def test_first_load_up_and_steady_state_of_the_default_block() -> None:
    """The default block breaks away first at mu_s m g / (k v) and then every T."""
    p = Parameters()
    run, exact = simulate(p, 10.0), steady_cycle(p)
    breaks = [event.time for event in run.events if event.kind == "break-away"]
    assert len(run.cycles) == 30
    expected = 0.24525 + float(exact.T) * np.arange(len(breaks))
    # Times add up: thirty cycles of INTEGRATION each, of a run of 10 s.
    np.testing.assert_allclose(breaks, expected, rtol=0.0, atol=30 * INTEGRATION)


def test_a_long_run_repeats_itself() -> None:
    """The two hundredth cycle is the second: nothing drifts from cycle to cycle."""
    cycles = simulate(Parameters(), 64.0, times=[]).cycles
    assert len(cycles) > 200
    assert cycles[200].t_stick == pytest.approx(cycles[1].t_stick, rel=2e-15 * 200)
    assert cycles[200].t_slip == pytest.approx(cycles[1].t_slip, rel=2e-15 * 200)


def test_a_sticking_mass_does_not_move_by_a_bit() -> None:
    """In stick x is one number and x_dot is zero, at every sample."""
    run = simulate(Parameters(), 3.0)
    for n in range(int(run.n_slips[-1]) + 1):
        stuck = run.sticking & (run.n_slips == n)
        assert np.unique(run.x[stuck]).size <= 1
    assert np.all(run.x_dot[run.sticking] == 0.0)


def test_the_mirror_mirrors_the_motion() -> None:
    """Pull, force and start negated, the motion is negated, equal as numbers."""
    p = Parameters(c=0.3, F_ext=0.7, x_start=0.1, x_dot_start=0.4, z_start=0.002)
    q = replace(p, v=-0.02, F_ext=-0.7, x_start=-0.1, x_dot_start=-0.4, z_start=-0.002)
    times = np.linspace(0.0, 3.0, 301)
    change, mirrored = Change(1.0, {"F_ext": -5.0}), Change(1.0, {"F_ext": 5.0})
    a = simulate(p, 3.0, times=times, changes=[change])
    b = simulate(q, 3.0, times=times, changes=[mirrored])
    for name in ("x", "x_dot", "x_pull", "z", "F", "F_friction", "mode", "delta_x", "x_dot_peak"):
        np.testing.assert_array_equal(getattr(a, name), -getattr(b, name))
    for name in ("W_pull", "Q_friction", "t_stick", "t_slip", "T", "n_slips", "t_event"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))


def test_mass_stiffness_damping_and_forces_scale_together() -> None:
    """m, k, c, load and F_ext times 4 leave the motion as it is, bit for bit."""
    p = Parameters(c=0.3, load=2.0, F_ext=0.7)
    q = replace(p, m=4.0, k=4000.0, c=1.2, load=8.0, F_ext=2.8)
    _assert_same_motion(simulate(p, 3.0), simulate(q, 3.0))


def test_time_scales_with_stiffness_and_gravity() -> None:
    """k, g, load, F_ext times 4, v, c, x_dot times 2: the same positions in half the time."""
    p = Parameters(c=0.3, load=2.0, F_ext=0.7, x_dot_start=0.1)
    q = replace(p, k=4000.0, g=4 * 9.81, load=8.0, F_ext=2.8, v=0.04, c=0.6, x_dot_start=0.2)
    slow, fast = simulate(p, 3.0), simulate(q, 1.5)
    _assert_same_motion(slow, fast)
    np.testing.assert_array_equal(slow.t, 2.0 * fast.t)


def _assert_same_motion(a: Trajectory, b: Trajectory) -> None:
    for name in ("x", "z", "x_pull", "mode", "delta_x", "spring_drop", "n_slips"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=name)


def test_without_a_gap_the_mass_touches_rest_once_a_period() -> None:
    """With mu_s = mu_k and no damping, t_stick is 0 and t_slip 2 pi / w, cycle after cycle."""
    p = Parameters(mu_s=0.3)
    cycles = simulate(p, 2.0, times=[]).cycles
    assert len(cycles) == 9
    for cycle in cycles:
        assert cycle.t_stick == 0.0
        # The turn of a velocity is where its slope is zero: known as well as the slope is.
        assert cycle.t_slip == pytest.approx(2.0 * math.pi / p.w, rel=INTEGRATION)


@pytest.mark.parametrize(
    "values", [{"mu_s": 0.3, "c": 4.0}, {"c": 200.0}, {"c": 1e4}, {"c": 9.0, "v": 1.0}]
)
def test_a_slip_without_end_settles_to_the_pull(values: dict[str, float]) -> None:
    """Where no cycle exists the mass breaks away once and ends up sliding at v."""
    p = Parameters(**values)
    run = simulate(p, 30.0)
    assert [event.kind for event in run.events] == ["break-away"]
    assert run.n_slips[-1] == 0
    # The slowest of these, zeta = 158, decays by exp(-w t / (2 zeta)) = exp(-3).
    assert run.x_dot[-1] == pytest.approx(p.v, rel=1e-12 if p.zeta < 10.0 else 0.06)


def test_steady_sliding_persists_without_damping() -> None:
    """A velocity disturbance below v neither decays nor ends the slip when c = 0."""
    z_slide = 0.3 * 9.81 / 1000.0
    run = simulate(Parameters(x_dot_start=0.015, z_start=z_slide), 20.0)
    assert run.events == ()
    late = run.x_dot[run.t > 15.0]
    # A sampled sinusoid misses its peak by (w h)^2 / 8 of its amplitude at steps h = 20 ms: 5 %.
    assert np.ptp(late) == pytest.approx(0.01, rel=0.05)


def test_a_disturbance_above_the_pull_ends_in_the_cycle() -> None:
    """A sliding mass disturbed by more than v sticks, and is in the steady cycle from then on."""
    p = Parameters(x_dot_start=0.05, z_start=0.3 * 9.81 / 1000.0)
    run = simulate(p, 2.0)
    period = float(steady_cycle(p).T)
    assert period == pytest.approx(run.cycles[-1].T, rel=INTEGRATION * 2.5)


def test_samples_are_where_they_are_asked_for() -> None:
    """The state at given times is that of the default grid's motion."""
    times = [0.0, 0.1, 0.3, 0.3, 0.36, 1.0]
    run = simulate(Parameters(), 1.0, times=times)
    np.testing.assert_array_equal(run.t, times)
    fine = simulate(Parameters(), 1.0)
    # Linear interpolation on 32 intervals of a slip: (w h)^2 / 8 of the jump, h = 3.7 ms.
    np.testing.assert_allclose(run.x, np.interp(times, fine.t, fine.x), atol=2e-3 * 6.3e-3)
    assert np.all(np.diff(fine.t) > 0.0)
    assert {event.time for event in fine.events} <= set(fine.t)


def test_the_start_time_dates_the_events_and_nothing_else() -> None:
    """The same run a thousand seconds later is the same run."""
    early, late = simulate(Parameters(), 2.0), simulate(Parameters(), 1002.0, start_time=1000.0)
    np.testing.assert_array_equal(early.x, late.x)
    np.testing.assert_array_equal(early.t_stick, late.t_stick)
    np.testing.assert_allclose(early.t + 1000.0, late.t, atol=2e-13)  # an ulp of 1000
    assert late.t_event[0] == 1000.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"stop_time": -1.0}, "stop_time = -1.0 s is out of range"),
        ({"stop_time": math.nan}, "stop_time = nan s is out of range"),
        ({"rtol": 1e-17}, "rtol = 1e-17 is out of range"),
        ({"times": [0.5, 0.2]}, r"times\[1\] = 0.2 s is less"),
        ({"times": [0.5, 2.0]}, "must lie within the run, 0.0 to 1.0 s"),
        ({"p": Parameters(k=np.array([1.0, 2.0]))}, r"the fields broadcast to \(2,\)"),
    ],
)
def test_bad_runs_are_refused(arguments: dict[str, object], message: str) -> None:
    """A run that makes no sense is refused with what is wrong and what would be right."""
    with pytest.raises(ValueError, match=message):
        simulate(**({"p": Parameters(), "stop_time": 1.0} | arguments))  # type: ignore[arg-type]  # wrong types are the point


def test_too_many_events_end_the_run_with_their_number() -> None:
    """A run that would not end in reasonable time says how many events it has had."""
    with pytest.raises(RuntimeError, match=r"11 events by t = .* more than max_events = 10"):
        simulate(Parameters(), 10.0, max_events=10)
