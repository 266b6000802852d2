"""Inputs and tunable parameters that change during a run, and what they do to the block."""

import math
import warnings

import numpy as np
import pytest

from stickslip_ref import Change, FrictionClampWarning, Parameters, Trajectory, simulate

SLIDE = 1e-12
"""Error of event times [s]: integration 3e-13, times the conditioning of the gap."""


def _kinds(run: Trajectory) -> list[tuple[str, int]]:
    return [(event.kind, event.mode) for event in run.events]


def test_a_pull_that_stops_leaves_the_mass_at_rest() -> None:
    """When the pulled end stops in stick, nothing happens any more."""
    run = simulate(Parameters(), 5.0, changes=[Change(0.2, {"v": 0.0})])
    assert run.events == ()
    assert run.z[-1] == pytest.approx(0.004, rel=1e-15)


def test_a_pull_that_stops_in_slip_arrests_the_mass() -> None:
    """When the pulled end stops in slip, the mass swings out and sticks for good."""
    stop = 0.30
    run = simulate(Parameters(), 5.0, changes=[Change(stop, {"v": 0.0})], times=[stop])
    assert _kinds(run) == [("break-away", 1), ("re-stick", 0)]
    # With the end fixed the rest of the slip is a sinusoid about z_inf = mu_k N / k: its velocity
    # x_dot cos(w t) + w (z - z_inf) sin(w t) is zero where the tangent says.
    w = math.sqrt(1000.0)
    z, x_dot = float(run.z[0]) - 0.3 * 9.81 / 1000.0, float(run.x_dot[0])
    rest = math.atan2(x_dot, -w * z) / w
    assert run.events[1].time == pytest.approx(stop + rest, abs=SLIDE)


def test_a_reversed_pull_breaks_away_backward() -> None:
    """Pulled back in stick, the spring goes from what it holds to -F_s, then slips backward."""
    run = simulate(Parameters(), 2.0, changes=[Change(0.1, {"v": -0.02})])
    first = run.events[0]
    assert (first.kind, first.mode) == ("break-away", -1)
    assert first.time == pytest.approx(0.1 + (4.905 + 2.0) / (1000.0 * 0.02), abs=1e-15)
    assert first.z == -4.905 / 1000.0


def test_a_load_pulse_releases_the_mass() -> None:
    """Taking the load off at a spring force above the lower F_s breaks the mass away at once."""
    changes = [Change(0.2, {"load": -5.0}), Change(0.21, {"load": 0.0})]
    run = simulate(Parameters(load=10.0), 2.0, changes=changes)
    assert (run.events[0].time, run.events[0].kind) == (0.2, "break-away")
    assert run.F[np.searchsorted(run.t, 0.2)] == pytest.approx(4.0)


def test_a_force_pulse_within_the_limit_moves_nothing() -> None:
    """A push that stays below F_s together with the spring leaves x as it is."""
    changes = [Change(0.1, {"F_ext": 2.5}), Change(0.11, {"F_ext": 0.0})]
    run = simulate(Parameters(), 0.24, changes=changes)
    assert run.events == ()
    assert np.all(run.x == 0.0)


def test_a_strong_force_pulse_reverses_the_slip() -> None:
    """Pushed beyond F_s and left, the mass swings back and forth without sticking at first."""
    changes = [Change(0.1, {"F_ext": 20.0}), Change(0.15, {"F_ext": 0.0})]
    run = simulate(Parameters(), 1.0, changes=changes)
    assert _kinds(run)[:3] == [("break-away", 1), ("reversal", -1), ("reversal", 1)]
    assert run.events[0].time == 0.1


def test_equality_sticks() -> None:
    """A spring force of exactly F_s holds, one ulp of slack and all; more does not."""
    F_s = float(Parameters().F_s)
    held = Parameters(v=0.0, z_start=F_s / 1000.0 * (1.0 + 1e-15))
    assert simulate(held, 1.0).events == ()
    pulled = Parameters(v=0.0, z_start=F_s / 1000.0 * (1.0 + 1e-14))
    assert simulate(pulled, 1.0).events[0].time == 0.0


def test_lowering_friction_breaks_away_and_raising_it_holds() -> None:
    """mu_s is tunable: the rest test is made anew at every change."""
    lowered = simulate(Parameters(), 0.2, changes=[Change(0.1, {"mu_s": 0.1, "mu_k": 0.1})])
    assert (lowered.events[0].time, lowered.events[0].kind) == (0.1, "break-away")
    raised = simulate(Parameters(), 0.4, changes=[Change(0.1, {"mu_s": 0.9})])
    assert raised.events == ()


def test_a_change_of_stiffness_keeps_the_spring_length() -> None:
    """Twice the stiffness at the same z is twice the force, and the energy it took is counted."""
    run = simulate(Parameters(), 0.1, changes=[Change(0.05, {"k": 2000.0})])
    assert run.z[-1] == pytest.approx(0.002, rel=1e-14)
    assert run.F[-1] == pytest.approx(4.0, rel=1e-14)
    assert run.W_k[-1] == pytest.approx(0.5 * 1000.0 * 0.001**2, rel=1e-14)


def test_a_sample_at_a_change_shows_what_was_before() -> None:
    """At the time of a change the outputs are those of the step that ends there."""
    run = simulate(
        Parameters(), 0.2, changes=[Change(0.1, {"load": 9.81})], times=[0.1, 0.1 + 1e-9]
    )
    np.testing.assert_allclose(run.F_s, [4.905, 9.81], rtol=1e-15)


def test_changes_at_the_start_act_from_the_start() -> None:
    """What is set at the start time is what the run starts with."""
    a = simulate(Parameters(), 1.0, changes=[Change(0.0, {"k": 2000.0, "v": 0.03})])
    b = simulate(Parameters(k=2000.0, v=0.03), 1.0)
    np.testing.assert_array_equal(a.x, b.x)
    np.testing.assert_array_equal(a.W_k, 0.0)


def test_a_change_at_the_end_or_later_comes_too_late() -> None:
    """What is set at the stop time would act from there on: the run is that without it."""
    late = [Change(1.0, {"v": 5.0}), Change(2.0, {"k": 1.0})]
    changed, plain = (simulate(Parameters(), 1.0, changes=each) for each in (late, ()))
    np.testing.assert_array_equal(changed.x, plain.x)
    assert changed.events == plain.events


def test_setting_what_is_set_changes_nothing_but_rounding() -> None:
    """Cutting a run where nothing changes gives the same motion."""
    times = np.linspace(0.0, 2.0, 101)
    whole = simulate(Parameters(c=0.2), 2.0, times=times)
    cuts = [Change(float(t), {"v": 0.02}) for t in np.linspace(0.013, 1.9, 40)]
    cut = simulate(Parameters(c=0.2), 2.0, times=times, changes=cuts)
    assert _kinds(cut) == _kinds(whole)
    np.testing.assert_allclose(cut.x, whole.x, rtol=0.0, atol=1e-12 * 0.04)
    np.testing.assert_allclose(cut.t_slip, whole.t_slip, rtol=1e-11)


@pytest.mark.parametrize("values", [{"mu_s": 0.0, "mu_k": 0.0}, {"load": -9.81}])
@pytest.mark.parametrize("c", [0.0, 2.0])
def test_without_friction_nothing_chatters(values: dict[str, float], c: float) -> None:
    """With mu_s = 0 or no normal force the mass swings behind the pull, a slip per period."""
    run = simulate(Parameters(c=c, **values), 2.0)
    period = 2.0 * math.pi / math.sqrt(1000.0)
    if c:
        assert _kinds(run) == [("break-away", 1)]
        assert run.x_dot[-1] == pytest.approx(0.02, rel=0.2)  # exp(-w zeta t) = exp(-2)
    else:
        assert set(_kinds(run)) == {("break-away", 1), ("re-stick", 0)}
        assert run.n_slips[-1] == int(2.0 / period)
    backward = simulate(Parameters(c=c, v=-0.02, **values), 2.0)
    np.testing.assert_array_equal(backward.x, -run.x)


def test_without_friction_and_pull_nothing_moves() -> None:
    """No friction, no force, no pull: the mass stays."""
    assert simulate(Parameters(mu_s=0.0, mu_k=0.0, v=0.0), 5.0).events == ()


def test_a_frictionless_mass_swings_down_to_nothing() -> None:
    """A damped swing without friction reverses at every half period and does not end early."""
    p = Parameters(mu_s=0.0, mu_k=0.0, v=0.0, c=6.0, z_start=0.1)
    run = simulate(p, 5.0, times=[])
    half = math.pi / (float(p.w) * math.sqrt(1.0 - float(p.zeta) ** 2))
    assert len(run.events) == 1 + int(5.0 / half)
    assert {kind for kind, _ in _kinds(run)[1:]} == {"reversal"}


def test_a_start_in_motion_is_a_slip() -> None:
    """A mass that moves at the start slips; stopped beyond F_s it turns, else it sticks."""
    run = simulate(Parameters(x_dot_start=-1.0), 0.5)
    assert run.mode[0] == -1
    assert run.events[0].kind == "reversal"
    gentle = simulate(Parameters(x_dot_start=-0.1), 0.5)
    assert gentle.events[0].kind == "re-stick"


def test_overdamped_motion_against_the_pull_crosses_zero() -> None:
    """Over-damped, a mass moving against the pull turns once and then follows for ever."""
    p = Parameters(c=500.0, mu_s=0.0, mu_k=0.0, x_dot_start=-1.0)
    run = simulate(p, 2.0)
    assert _kinds(run) == [("reversal", 1)]


def test_the_clamp_warns_where_the_friction_changes() -> None:
    """A change that takes mu_k above mu_s warns once, not again at every later change."""
    changes = [Change(0.1, {"mu_k": 0.7}), Change(0.2, {"v": 0.03}), Change(0.3, {"load": 1.0})]
    with pytest.warns(FrictionClampWarning, match=r"mu_k = 0\.7 exceeds mu_s = 0\.5") as caught:
        run = simulate(Parameters(), 0.5, changes=changes)
    assert len(caught) == 1
    assert run.mu_k_used[-1] == 0.49


@pytest.mark.parametrize(
    ("time", "values", "message"),
    [
        (0.1, {"m": 2.0}, "m = 2.0 cannot change during a run"),
        (0.1, {"v": math.nan}, "v = nan at 0.1 s must be a finite number"),
        (math.inf, {"v": 1.0}, "time = inf s"),
        (-0.1, {"v": 1.0}, "a change at -0.1 s lies before the start"),
        (0.1, {"k": -1.0}, "k = -1.0 N/m is out of range"),
        (0.1, {"load": -20.0}, "load = -20.0 N is out of range"),
    ],
)
def test_bad_changes_are_refused(time: float, values: dict[str, float], message: str) -> None:
    """What cannot change, or cannot have the value, is refused by name and value."""
    with warnings.catch_warnings(), pytest.raises(ValueError, match=message):
        simulate(Parameters(), 1.0, changes=[Change(time, values)])
