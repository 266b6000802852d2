"""The cycle meter and the energy account."""

import numpy as np
import pytest

from stickslip_ref import Change, FrictionLaw, Parameters, State, Trajectory, simulate

RICH = [
    Change(0.1, {"F_ext": 7.0}),
    Change(0.16, {"F_ext": -9.0, "c": 1.5}),
    Change(0.31, {"F_ext": 0.0, "k": 1700.0}),
    Change(0.6, {"v": -0.05, "load": 4.0}),
    Change(0.9, {"k": 600.0, "mu_s": 0.6, "mu_k": 0.15}),
    Change(1.3, {"v": 0.1, "c": 0.0}),
]
"""Inputs and tunable parameters of both signs, in stick and in slip."""


def _meter(run: Trajectory, sample: int) -> dict[str, float]:
    names = ("t_stick", "t_slip", "T", "f", "delta_x", "spring_drop", "x_dot_peak", "n_slips")
    return {name: float(getattr(run, name)[sample]) for name in names}


def test_the_meter_is_written_at_its_events() -> None:
    """t_stick, T and f are read at a break-away, the rest at the end of a slip; T at the second."""
    events = simulate(Parameters(), 1.0).events
    run = simulate(Parameters(), 1.0, times=[0.0] + [event.time + 1e-9 for event in events])
    start, broken, stuck, again = (_meter(run, sample) for sample in range(4))
    assert set(start.values()) == {0.0}
    assert broken == start | {"t_stick": broken["t_stick"]}
    assert broken["t_stick"] == pytest.approx(0.24525, rel=1e-15)
    assert stuck["n_slips"] == 1
    assert (stuck["T"], stuck["t_stick"]) == (0.0, broken["t_stick"])
    assert again["T"] == again["t_slip"] + again["t_stick"]
    assert again["f"] == 1.0 / again["T"]
    assert again["t_slip"] == stuck["t_slip"]
    np.testing.assert_array_equal(run.t_event[1:], [event.time for event in events])


def test_a_start_in_motion_counts_as_a_slip_and_not_as_a_break_away() -> None:
    """The slip of a mass that moves at the start is measured; T waits for two break-aways."""
    run = simulate(Parameters(x_dot_start=0.1), 0.2)
    assert run.events[0].kind == "re-stick"
    assert run.n_slips[-1] == 1
    assert run.t_slip[-1] == run.events[0].time
    assert run.delta_x[-1] == pytest.approx(run.events[0].x, rel=1e-12)
    assert run.x_dot_peak[-1] >= 0.1
    later = simulate(Parameters(x_dot_start=0.1), 1.0)
    breaks = [event.time for event in later.events if event.kind == "break-away"]
    assert later.cycles[0].t_break_away == breaks[0]
    assert np.all(later.T[later.t < breaks[1]] == 0.0)


def test_a_mass_at_rest_beyond_the_limit_breaks_away_after_no_time() -> None:
    """Its first stick has length 0, and the period counts from there."""
    run = simulate(Parameters(z_start=0.02), 3.0)
    assert (run.events[0].time, run.events[0].kind) == (0.0, "break-away")
    breaks = [event.time for event in run.events if event.kind == "break-away"]
    assert breaks[1] == pytest.approx(run.cycles[0].T, rel=1e-14)


def test_a_reversal_completes_a_slip_and_is_no_break_away() -> None:
    """At a reversal the slip is counted and measured; t_stick and T stay as they are."""
    run = simulate(Parameters(z_start=0.02), 3.0)
    reversal = next(i for i, event in enumerate(run.events) if event.kind == "reversal")
    assert reversal == 1
    before, after = np.searchsorted(run.t, run.events[1].time) + np.array([-1, 0])
    assert run.n_slips[after] == run.n_slips[before] + 1
    assert run.t_stick[after] == run.t_stick[before]
    assert run.T[after] == run.T[before] == 0.0
    first = run.cycles[0]
    # The cycle holds slips in both directions, so it is longer than its last slip and stick.
    assert first.t_slip + first.t_stick < first.T


def test_slips_are_signed() -> None:
    """A slip backward has negative displacement, relief and extreme velocity."""
    run = simulate(Parameters(v=-0.02), 1.0)
    assert max(run.delta_x[-1], run.spring_drop[-1], run.x_dot_peak[-1]) < 0.0
    assert min(run.t_slip[-1], run.t_stick[-1], run.T[-1]) > 0.0


def test_the_meter_measures_what_the_samples_show() -> None:
    """Every slip's displacement, relief and extreme velocity are those of the motion itself."""
    run = simulate(Parameters(), 2.0, changes=RICH)
    ends = [i for i, event in enumerate(run.events) if event.kind != "break-away"]
    assert len(ends) > 6
    for i in ends:
        begin, end = run.events[i - 1] if i else None, run.events[i]
        sample = int(np.searchsorted(run.t, end.time))
        if begin is None:
            continue
        # Differences of positions up to 0.1 m, rounded and integrated.
        assert run.delta_x[sample] == pytest.approx(end.x - begin.x, abs=1e-14)
        assert run.spring_drop[sample] == pytest.approx(begin.z - end.z, abs=1e-14)
        assert run.t_slip[sample] == pytest.approx(end.time - begin.time, abs=1e-14)
        inside = (run.t >= begin.time) & (run.t <= end.time)
        fastest = float(np.max(np.abs(run.x_dot[inside])))
        # Samples stand at most 1/32 of a slip apart: (pi / 64)^2 / 2 below the peak.
        assert fastest <= abs(run.x_dot_peak[sample]) * (1.0 + 1e-12)
        assert fastest == pytest.approx(abs(run.x_dot_peak[sample]), rel=5e-3)


def test_a_change_of_input_ends_no_slip() -> None:
    """A slip through a change of pull is one slip, with one duration and one displacement."""
    run = simulate(Parameters(), 1.0, changes=[Change(0.28, {"v": 0.03}), Change(0.3, {"v": 0.01})])
    assert run.events[1].kind == "re-stick"
    end = int(np.searchsorted(run.t, run.events[1].time))
    assert run.n_slips[end] == 1
    assert run.t_slip[end] == pytest.approx(run.events[1].time - run.events[0].time, rel=1e-13)
    assert run.delta_x[end] == pytest.approx(run.events[1].x, rel=1e-13)


def _imbalance(run: Trajectory, k: np.ndarray, m: float) -> float:
    stored = 0.5 * k * run.z**2 + 0.5 * m * run.x_dot**2
    given = run.W_pull + run.W_k + run.W_ext - run.Q_friction
    scale = max(np.abs(run.W_pull).max(), run.Q_friction.max(), stored.max())
    return float(np.abs(given - (stored - stored[0])).max() / scale)


@pytest.mark.parametrize("c", [0.0, 0.5, 20.0, 400.0, 4000.0])
def test_energy_is_accounted_for(c: float) -> None:
    """Work of the pull becomes stored energy and heat, with any damping."""
    run = simulate(Parameters(c=c, F_ext=1.0), 3.0)
    # Each term is integrated to rtol over some twenty slips; Radau to 1e-11 from zeta = 30 on.
    assert _imbalance(run, np.full_like(run.t, 1000.0), 1.0) < (1e-12 if c < 1000.0 else 1e-8)


def test_energy_is_accounted_for_through_changes() -> None:
    """Changes of stiffness and external forces put energy in; the account still closes."""
    run = simulate(Parameters(x_dot_start=0.3, z_start=-0.004), 2.0, changes=RICH)
    # A sample at a change shows what was before it.
    k = np.select([run.t <= 0.31, run.t <= 0.9], [1000.0, 1700.0], 600.0)
    assert np.any(run.W_k != 0.0)
    assert _imbalance(run, k, 1.0) < 1e-12  # as above


def test_heat_only_grows() -> None:
    """Friction never gives energy back."""
    run = simulate(Parameters(x_dot_start=-0.3), 2.0, changes=RICH)
    # The integrated heat of a slip is right to 1e-13 of itself.
    assert np.all(np.diff(run.Q_friction) >= -1e-13 * run.Q_friction[-1])


class _Weakening(FrictionLaw):
    """Dry friction that falls from mu_s N to mu_k N over a sliding speed of 0.1 m/s."""

    def break_away_force(self, p: Parameters, age: float = 0.0, state: State = ()) -> float:
        return float(p.F_s)

    def slip_friction(self, p: Parameters, speed: float, state: State = ()) -> float:
        return float(p.N * (p.mu_k + (p.mu_s - p.mu_k) / (1.0 + speed / 0.1)))


def test_another_friction_law_needs_nothing_but_itself() -> None:
    """A law that weakens with speed stick-slips with a smaller jump, and its heat is counted."""
    run = simulate(Parameters(), 2.0, law=_Weakening())
    coulomb = simulate(Parameters(), 2.0)
    assert 0.0 < run.delta_x[-1] < coulomb.delta_x[-1]
    assert _imbalance(run, np.full_like(run.t, 1000.0), 1.0) < 1e-12
    sliding = run.mode == 1
    law = [_Weakening().slip_friction(Parameters(), abs(u)) for u in run.x_dot[sliding]]
    np.testing.assert_allclose(-run.F_friction[sliding], law, rtol=1e-12)
