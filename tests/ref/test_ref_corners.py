"""Corners of the rest test, of stiff slips and of what happens at one instant."""

import math
from dataclasses import dataclass, field
from random import Random

import pytest

from stickslip_ref import Change, FrictionLaw, Parameters, State, simulate, steady_cycle


@pytest.mark.parametrize(("steps", "holds"), [(-16, True), (-4, True), (4, True), (16, False)])
def test_the_slack_of_rest_is_relative_to_the_forces(steps: int, holds: bool) -> None:
    """A mass holds up to 8 * 2^-52 of |k z| + |F_ext| + F_s beyond F_s, wherever in a binade."""
    draw = Random(7)
    for _ in range(100):
        mu_s, F_ext = draw.uniform(0.3, 1.5), draw.uniform(-20.0, 20.0)
        p = Parameters(k=1.0, v=0.0, mu_s=mu_s, F_ext=F_ext)
        F_s = float(p.F_s)
        spring = F_s - F_ext
        beyond = steps * 2.0**-52 * (abs(spring) + abs(F_ext) + F_s)
        start = Parameters(k=1.0, v=0.0, mu_s=mu_s, F_ext=F_ext, z_start=spring + beyond)
        assert (simulate(start, 0.0, times=[]).events == ()) == holds, start


def test_of_changes_at_one_time_only_the_last_acts() -> None:
    """A push set and taken back at one instant, the start included, moves nothing."""
    for time in (0.0, 0.1):
        pulse = [Change(time, {"F_ext": 20.0, "k": 2e3}), Change(time, {"F_ext": 0.0, "k": 1e3})]
        run = simulate(Parameters(z_start=1e-3), 0.15, changes=pulse)
        assert run.events == ()
        assert run.W_k[-1] == 0.0


def test_a_pull_taken_off_at_the_instant_of_break_away_moves_nothing() -> None:
    """Whether the break-away was counted before the change or not, the mass stays where it is."""
    draw, broken = Random(8), 0
    for _ in range(300):
        cut = Change(draw.uniform(0.01, 0.24), {"v": draw.uniform(0.01, 0.05)})
        away = simulate(Parameters(), 1.0, changes=[cut], times=[], rtol=1e-6).events[0].time
        off = Change(away, {"F_ext": -3.0})
        run = simulate(Parameters(), away + 0.01, changes=[cut, off], rtol=1e-6)
        assert [event.kind for event in run.events] in ([], ["break-away", "re-stick"])
        assert (run.x[-1], run.mode[-1]) == (0.0, 0)
        broken += bool(run.events)
    assert broken > 0


@dataclass(frozen=True)
class _Law(FrictionLaw):
    """A friction law by its two forces, which counts how often it is asked for the second."""

    rest: float
    slip: float
    constant_in_slip: bool = True
    calls: list[float] = field(default_factory=list)

    def break_away_force(self, p: Parameters, age: float = 0.0, state: State = ()) -> float:
        return self.rest

    def slip_friction(self, p: Parameters, speed: float, state: State = ()) -> float:
        self.calls.append(speed)
        return self.slip


def test_what_stops_a_slip_does_not_throw_it_back() -> None:
    """A mass stopped by friction while it is pulled forward does not start backward."""
    p = Parameters(v=0.0, z_start=0.004, x_dot_start=0.01)
    run = simulate(p, 0.5, law=_Law(rest=3.0, slip=5.0))
    assert [event.kind for event in run.events] == ["re-stick"]


def test_a_stiff_slip_is_the_overdamped_solution_at_little_cost() -> None:
    """At zeta = 100 a slip from rest is two exponentials, and takes no stability-bound steps."""
    p = Parameters(c=200.0 * math.sqrt(1000.0), z_start=0.02, v=0.02)
    law = _Law(rest=4.905, slip=0.3 * 9.81, constant_in_slip=False)
    times = [0.001, 0.01, 0.1, 1.0, 3.0]
    run = simulate(p, 3.0, times=times, law=law)
    alpha, w2 = 0.5 * float(p.c), 1000.0
    r1 = alpha + math.sqrt(alpha * alpha - w2)
    r2 = w2 / r1
    rho, a = -0.02, 0.02 * 1000.0 - 0.3 * 9.81
    for t, x_dot in zip(times, run.x_dot, strict=True):
        fast, slow = -(a + r2 * rho) / (r1 - r2), (a + r1 * rho) / (r1 - r2)
        exact = 0.02 + fast * math.exp(-r1 * t) + slow * math.exp(-r2 * t)
        # The implicit method's tolerance of 1e-11 a step, over some hundred steps.
        assert x_dot == pytest.approx(exact, rel=1e-9)
    # An explicit method needs a dozen for each 3 / (2 zeta w): 25,000.
    assert len(law.calls) < 20_000


def test_a_large_constant_force_does_not_blur_a_small_gap() -> None:
    """A break-away knows its net force from the friction law, not from forces that cancel."""
    p = Parameters(mu_k=0.5 * (1.0 - 1e-3), F_ext=1e7, v=0.001, z_start=-1e4)
    run, exact = simulate(p, 6.0, times=[]), steady_cycle(p)
    # Integration to 3e-13, over a gap of 1e-3 and lambda of 0.3.
    assert run.cycles
    assert run.cycles[0].t_slip == pytest.approx(float(exact.t_slip), rel=3e-13 * 1e3)
    assert run.cycles[0].x_dot_peak == pytest.approx(float(exact.x_dot_peak), rel=3e-13 * 1e3)
