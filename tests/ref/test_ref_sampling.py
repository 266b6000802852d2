"""Samples of a simulation: every wanted time gets one, and it shows the right side of a change."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest

from stickslip_ref import Change, Parameters, simulate
from stickslip_ref.friction import breaks_away


def test_every_wanted_time_gets_its_sample() -> None:
    """Whatever the stop time and the changes, there are as many samples as times wanted."""
    draw = Random(31)
    for _ in range(150):
        stop = draw.uniform(0.05, 1.5)
        p = Parameters(c=draw.choice([0.0, 3.0, 100.0]), v=draw.uniform(0.005, 0.05))
        at = sorted(draw.uniform(0.0, stop) for _ in range(draw.randint(0, 3)))
        changes = [Change(time, {"v": draw.uniform(-0.05, 0.05)}) for time in at]
        times = np.union1d(np.linspace(0.0, stop, 37), at)
        run = simulate(p, stop, changes=changes, times=times)
        assert run.t.tolist() == times.tolist()
        assert all(np.all(np.isfinite(each)) for each in (run.x, run.z, run.x_dot, run.F))


def test_a_sample_at_a_change_shows_the_state_before_it() -> None:
    """At the time of a change of k the spring force is still that of the old spring."""
    draw = Random(32)
    for _ in range(80):
        p = Parameters(c=draw.choice([0.0, 3.0, 100.0]), v=draw.uniform(0.005, 0.05))
        time = draw.uniform(0.01, 0.9)
        changed = simulate(p, 1.0, changes=[Change(time, {"k": 1500.0})], times=[time, 1.0])
        plain = simulate(p, 1.0, times=[time, 1.0])
        # The same integration up to there, but for where its last step ends.
        assert changed.F[0] == pytest.approx(plain.F[0], rel=1e-11)
        assert changed.W_k[0] == 0.0


def test_the_rest_test_forgives_rounding_and_no_more() -> None:
    """A force beyond F_s by 4 units in the last place of what is compared rests, by 16 slips."""
    unit = 2.0**-52
    assert not breaks_away(0.5 + 4.0 * unit, 0.0, 0.5)
    assert breaks_away(0.5 + 16.0 * unit, 0.0, 0.5)
    assert breaks_away(-0.5 - 16.0 * unit, 0.0, 0.5)


@pytest.mark.parametrize(("k", "m"), [(1e308, 1e-308), (1e-300, 1e300)])
def test_rates_beyond_double_precision_are_refused(k: float, m: float) -> None:
    """Values whose rates are no double-precision numbers are refused by name."""
    with pytest.raises(ValueError, match=r"k = .* m = .* out of range together"):
        Parameters(k=k, m=m)


def test_heavy_damping_is_followed() -> None:
    """Damped by zeta = 100, a mass that slips under a constant force creeps to its balance.

    Solved by two exponentials; the implicit method works at 1e-11 a step.
    """
    zeta, w = 100.0, float(Parameters().w)
    p = Parameters(c=2.0 * zeta * w, v=0.0, mu_s=0.2, mu_k=0.1, z_start=0.02)
    root = (zeta**2 - 1.0) ** 0.5
    slow, fast = w / (zeta + root), w * (zeta + root)
    run = simulate(p, 2.0, times=[0.5, 2.0])
    balance = 0.1 * 9.81 / 1000.0
    for time, z in zip((0.5, 2.0), run.z, strict=True):
        decay = (fast * np.exp(-slow * time) - slow * np.exp(-fast * time)) / (fast - slow)
        assert z == pytest.approx(balance + (0.02 - balance) * decay, rel=1e-9)
