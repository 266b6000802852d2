"""A wrong record fails the check that should see it; the exact one fails none."""

import math

import numpy as np
import pytest

from stickslip_verification.cases import Case
from stickslip_verification.run import judge_case

from .standing_in import Columns, Crashing, Fault, StandIn, failures, named

DEFAULT = named("default")


def scaled(name: str, factor: float) -> Fault:
    """Multiply one output."""

    def fault(columns: Columns) -> None:
        columns[name] = columns[name] * factor

    return fault


def replaced(name: str, value: float, at: int = -1) -> Fault:
    """Put one value in one place."""

    def fault(columns: Columns) -> None:
        columns[name][at] = value

    return fault


def lagging(columns: Columns) -> None:
    """Show every output one step late."""
    for samples in columns.values():
        samples[1:] = samples[:-1].copy()


def creeping(columns: Columns) -> None:
    """Let the mass creep by a nanometre a second while it sticks."""
    columns["x"] += np.where(columns["mode"] == 0, 1e-11 * np.arange(len(columns["x"])), 0.0)


def inverted(columns: Columns) -> None:
    """Say slip for stick."""
    columns["sticking"] = 1.0 - columns["sticking"]


def dropped(columns: Columns) -> None:
    """Leave out the frequency."""
    del columns["f"]


def short(columns: Columns) -> None:
    """Lose the last sample of the period."""
    columns["T"] = columns["T"][:-1]


def one_more(columns: Columns) -> None:
    """Count one slip too many from the middle on."""
    columns["n_slips"][500:] += 1


def half_period(columns: Columns) -> None:
    """Use the designers' pi/w for the slip time."""
    columns["t_slip"] = np.where(columns["t_slip"] > 0, math.pi / math.sqrt(1000.0), 0.0)


def simplified_jump(columns: Columns) -> None:
    """Use the spring's relief for the jump."""
    columns["delta_x"] = columns["spring_drop"].copy()


@pytest.mark.parametrize("case", [named("default"), named("tuned"), named("reversals")])
def test_the_exact_motion_passes(case: Case) -> None:
    """A side that gives the exact motion, rounded to double, fails no check."""
    assert failures(case, StandIn()) == {}


@pytest.mark.parametrize(
    ("fault", "check"),
    [
        (lagging, "x-course"),
        (lagging, "t_event-course"),
        (creeping, "x-course"),
        (scaled("F_friction", -1.0), "F_friction-course"),
        (scaled("F", 1.0 + 1e-10), "F-course"),
        (scaled("W_pull", 1.01), "W_pull-course"),
        (scaled("Q_friction", 1.01), "Q_friction-course"),
        (replaced("W_k", 1e-9), "W_k-course"),
        (scaled("t_event", 1.0 + 1e-9), "t_event-course"),
        (inverted, "sticking-course"),
        (one_more, "n_slips-course"),
        (half_period, "t_slip-exact"),
        (simplified_jump, "simplified-jump-leaves-out"),
        (scaled("t_stick", 1.0 + 1e-11), "simplified-stick-too-long-by"),
        (scaled("spring_drop", 1000.0), "spring_drop-exact"),
        (scaled("x_dot_peak", 1.0 + 1e-11), "x_dot_peak-exact"),
        (scaled("mu_k_used", 0.999), "mu_k_used-course"),
    ],
)
def test_a_planted_fault_is_seen(fault: Fault, check: str) -> None:
    """Each fault fails the check made for it, with the values that show it."""
    result = failures(DEFAULT, StandIn(fault))[check]
    assert result.failure is None
    assert result.error is not None
    assert result.error > result.tolerance


@pytest.mark.parametrize(
    ("believed", "check"),
    [
        ({"mu_s": 0.5005}, "first-load-up"),
        ({"mu_s": 0.5005}, "break-away-force"),
        ({"mu_k": 0.3003}, "spring_drop-exact"),
        ({"k": 1001.0}, "t_slip-exact"),
        ({"g": 9.80665}, "break-away-force"),
        ({"c": 1e-6}, "x_dot-course"),
        ({"v": 0.02002}, "x_pull-course"),
    ],
)
def test_a_wrong_constant_is_seen(believed: dict[str, float], check: str) -> None:
    """A side that calculates with another constant fails the check which names it."""
    assert check in failures(DEFAULT, StandIn(believed=believed))


@pytest.mark.parametrize(
    ("fault", "check", "reason"),
    [
        (dropped, "f-exact", "no output f"),
        (short, "T-exact", "999 samples of T at 1000 points"),
        (replaced("x", math.nan, 7), "x-course", "x is nan at t = 0.08 s"),
        (replaced("x", math.inf, 7), "x-course", "x is inf at t = 0.08 s"),
    ],
)
def test_what_cannot_be_compared_fails_with_its_reason(
    fault: Fault, check: str, reason: str
) -> None:
    """A missing output, a missing sample, NaN and infinity are failures, and say what is wrong."""
    result = failures(DEFAULT, StandIn(fault))[check]
    assert result.failure == reason
    assert result.got is None
    assert result.error is None
    assert result.expected is not None


def test_a_nan_anywhere_fails_even_where_the_end_is_judged() -> None:
    """NaN at the one place a check looks at is a failure of that check alone."""
    failed = failures(named("one-step"), StandIn(replaced("T", math.nan)))
    assert set(failed) == {"T-course"}


def test_a_crash_is_a_failed_check() -> None:
    """A side that raises fails all checks of the case with its reason, and the other side runs."""
    results = judge_case(DEFAULT, [Crashing(), StandIn(name="reference")])
    crashed = [result for result in results if result.side == "fmu"]
    assert len(crashed) == len(DEFAULT.checks)
    assert not any(result.passed for result in crashed)
    reason = "RuntimeError: no idea what to do with default"
    assert {result.failure for result in crashed} == {reason}
    assert all(result.passed for result in results if result.side == "reference")


def test_no_mass_moves_the_other_way_unseen() -> None:
    """The mirror image of the motion fails the reversed pull's checks: direction is judged."""
    failed = failures(named("reversed-pull"), StandIn(believed={"v": 0.02}))
    assert {"delta_x-exact", "spring_drop-exact", "x_dot_peak-exact"} <= set(failed)
    assert "t_slip-exact" not in failed


def test_a_missing_clamp_is_seen() -> None:
    """A side that does not clamp mu_k above mu_s shows it."""
    assert "mu_k_used-course" in failures(named("clamp"), StandIn(scaled("mu_k_used", 0.6 / 0.49)))
