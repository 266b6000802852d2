"""What only the truth says: ties to the last bit, how near a run came to another course."""

from __future__ import annotations

import pytest

from stickslip_verification import truth
from stickslip_verification.truth import Step, run
from stickslip_verification.truth.parameters import high_precision
from tests.facts.closed import Exact, cycle

MP = high_precision(50)
CLOSE = 1e-40
"""Ten of fifty digits are left to the conditioning of a run of some dozen arcs."""

BINARY = {"m": 1.0, "g": 8.0, "k": 1024.0, "mu_s": 0.5, "mu_k": 0.25, "v": 0.5}
"""Every force and time of interest is a binary fraction: m g = 8 N, w = 32 rad/s."""


def test_a_grazing_stop_is_decided_by_equality() -> None:
    # k z = mu_k m g: no acceleration at the start, so x_dot = v (1 + cos w t).
    grazing = {**BINARY, "z_start": 2.0 / 1024.0, "x_dot_start": 1.0}
    result = run(grazing, [Step(1.0)])
    assert result.events[0].kind == "re-stick"
    assert abs(result.events[0].time * 32 / MP.pi - 1) < CLOSE
    assert result.margin == 0
    above = run({**grazing, "x_dot_start": 1.0 - 2.0**-52}, [Step(100.0)])
    assert not above.events
    # The least speed over the pull and the swing: 2^-52 / (1 - 2^-52).
    assert abs(above.margin * MP.mpf(2) ** 52 - 1) < 1e-15


def test_a_change_that_is_not_in_the_slip_leaves_its_grazing_stop() -> None:
    p = {**BINARY, "mu_k": 0.5}
    plain, meddled = run(p, [Step(0.3)]), run(p, [Step(0.1), Step(0.2, {"mu_s": 0.625})])
    assert plain.events[1] == meddled.events[1]
    # What was changed on the way is no structure any more: a near miss.
    assert plain.margin > 0.1
    assert meddled.margin == 0


def test_the_margin_is_how_near_a_force_came_to_break_away() -> None:
    held = run({**BINARY, "v": 0.0}, [Step(0.1, {"F_ext": 4.0 - 4e-10})])
    assert held.samples[0]["sticking"]
    # 4e-10 N of 2 F_s.
    assert abs(held.margin / MP.mpf(0.5e-10) - 1) < 1e-5


@pytest.mark.parametrize("zeta", [1.0 - 2.0**-53, 1.0 + 2.0**-52])
def test_motion_is_continuous_across_critical_damping(zeta: float) -> None:
    steps = [Step(2.0**-7 + 0.01), Step(600.0, {"v": -(2.0**-9)})]
    near, at = (run({**BINARY, "c": 64.0 * each}, steps).samples for each in (zeta, 1.0))
    # The motion is analytic in zeta, with derivatives of order one.
    assert abs(near[0]["x"] / at[0]["x"] - 1) < 4 * abs(zeta - 1)
    assert near[1]["n_slips"] == at[1]["n_slips"] > 0


def test_thousands_of_arcs_keep_their_digits() -> None:
    result = run({}, [Step(400.0)])
    assert result.samples[-1]["n_slips"] > 1250
    assert abs(result.samples[-1]["T"] / cycle(Exact({}))["T"] - 1) < CLOSE


def test_setting_a_value_that_is_there_changes_no_digit() -> None:
    same = {name: truth.START_VALUES[name] for name in ("v", "load", "F_ext", "k", "c", "mu_s")}
    assert run({}, [Step(0.1)] * 9) == run({}, [Step(0.1, same)] * 9)


def test_no_gap_at_age_0_is_exactly_none() -> None:
    # With mu_k that no double is, a fresh stop still holds exactly mu_k N.
    result = run({"tau_s": 0.1, "mu_s": 0.7, "mu_k": 0.1, "v": 0.5}, [Step(0.01)] * 100)
    assert result.margin > 1e-6
    assert result.initial["F_s"] == run({"mu_s": 0.1, "mu_k": 0.1}, [Step(1.0)]).initial["F_s"]


def test_an_unknown_name_is_refused_with_those_there_are() -> None:
    with pytest.raises(
        ValueError, match=r"no parameter named mass; there are .*'z_start', 'tau_s'"
    ):
        run({"mass": 1.0}, [])
