"""A wrong record fails the check that should see it; the exact one fails none."""

import math

import numpy as np
import pytest

from stickslip_verification.judge.checks import (
    EXACT_CONTRACT,
    PHYSICS_CONTRACT,
    STRICT_CONTRACT,
    judge,
)
from stickslip_verification.model.run import Run

from .records import (
    Draft,
    Fault,
    believed,
    copied,
    exact_of,
    failures,
    named,
    planted,
    scaled,
    value,
    without,
)

DEFAULT = named("default")
EXACT = exact_of("default").record


def lagging(draft: Draft) -> None:
    """Show every output one step late."""
    for name in draft.outputs:
        draft.lag(name)


def creeping(draft: Draft) -> None:
    """Let the mass creep by a nanometre a second while it sticks."""
    x = draft.outputs["x"]
    x += np.where(draft.outputs["mode"] == 0, 1e-11 * np.arange(len(x)), 0.0)


def inverted(draft: Draft) -> None:
    """Say slip for stick."""
    draft.outputs["sticking"] = 1.0 - draft.outputs["sticking"]


def short(draft: Draft) -> None:
    """Lose the last sample of the period."""
    draft.outputs["T"] = draft.outputs["T"][:-1]


def one_more(draft: Draft) -> None:
    """Count one slip too many from the middle on."""
    draft.outputs["n_slips"][500:] += 1


def half_period(draft: Draft) -> None:
    """Use the designers' pi/w for the slip time."""
    t_slip = draft.outputs["t_slip"]
    t_slip[t_slip > 0] = math.pi / math.sqrt(1000.0)


@pytest.mark.parametrize("case", ["default", "tuned", "reversals"])
def test_the_exact_motion_passes(case: str) -> None:
    """A side that gives the exact motion, rounded to double, fails no check."""
    assert failures(case, exact_of(case).record) == {}


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
        (value("W_k", 1e-9, -1), "W_k-course"),
        (scaled("t_event", 1.0 + 1e-9), "t_event-course"),
        (inverted, "sticking-course"),
        (one_more, "n_slips-course"),
        (half_period, "t_slip-exact"),
        (copied("delta_x", "spring_drop"), "simplified-jump-leaves-out"),
        (scaled("t_stick", 1.0 + 1e-11), "simplified-stick-too-long-by"),
        (scaled("spring_drop", 1000.0), "spring_drop-exact"),
        (scaled("x_dot_peak", 1.0 + 1e-11), "x_dot_peak-exact"),
        (scaled("mu_k_used", 0.999), "mu_k_used-course"),
    ],
)
def test_a_planted_fault_is_seen(fault: Fault, check: str) -> None:
    """Each fault fails the check made for it, with the values that show it."""
    result = failures("default", planted(EXACT, fault))[check]
    assert result.failure is None
    assert result.error is not None
    assert result.error > result.tolerance


@pytest.mark.parametrize(
    ("wrong", "check"),
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
def test_a_wrong_constant_is_seen(wrong: dict[str, float], check: str) -> None:
    """A side that calculates with another constant fails the check which names it."""
    assert check in failures("default", believed("default", *wrong.items()))


@pytest.mark.parametrize(
    ("fault", "check", "reason"),
    [
        (without("f"), "f-exact", "no output f"),
        (short, "T-exact", "999 samples of T at 1000 points"),
        (value("x", math.nan, 7), "x-course", "x is nan at t = 0.08 s"),
        (value("x", math.inf, 7), "x-course", "x is inf at t = 0.08 s"),
    ],
)
def test_what_cannot_be_compared_fails_with_its_reason(
    fault: Fault, check: str, reason: str
) -> None:
    """A missing output, a missing sample, NaN and infinity are failures, and say what is wrong."""
    result = failures("default", planted(EXACT, fault))[check]
    assert result.failure == reason
    assert result.got is None
    assert result.error is None
    assert result.expected is not None


def test_a_nan_anywhere_fails_even_where_the_end_is_judged() -> None:
    """NaN at the one place a check looks at is a failure of that check alone."""
    failed = failures("one-step", planted(exact_of("one-step").record, value("T", math.nan, -1)))
    assert set(failed) == {"T-course"}


def test_a_foreign_fmu_is_held_to_a_numerical_solution() -> None:
    """An error of 1e-10 fails the exact block and a strict foreign one, not a foreign one."""
    record = planted(EXACT, scaled("F", 1.0 + 1e-10))
    check = next(check for check in DEFAULT.checks if check.id == "F-course")
    passed = {
        contract: judge(DEFAULT, check, contract, exact_of("default"), record).passed
        for contract in (EXACT_CONTRACT, STRICT_CONTRACT, PHYSICS_CONTRACT)
    }
    assert passed == {EXACT_CONTRACT: False, STRICT_CONTRACT: False, PHYSICS_CONTRACT: True}


def test_an_output_that_a_foreign_fmu_lacks_is_no_failure_and_no_pass() -> None:
    """Without the output the check is not applicable to a foreign FMU, and a failure of ours."""
    record = planted(EXACT, without("f"))
    check = next(check for check in DEFAULT.checks if check.id == "f-exact")
    foreign = judge(DEFAULT, check, PHYSICS_CONTRACT, exact_of("default"), record)
    assert foreign.verdict == "not applicable"
    assert foreign.not_applicable == "it has no output f"
    assert not foreign.passed
    assert judge(DEFAULT, check, EXACT_CONTRACT, exact_of("default"), record).verdict == "fail"


def test_a_convention_does_not_decide_for_a_foreign_fmu() -> None:
    """A block that clamps otherwise than ours is noted, and fails only if judged strictly."""
    case = named("clamp")
    record = planted(exact_of("clamp").record, scaled("mu_k_used", 0.9))
    check = next(check for check in case.checks if check.id == "mu_k_used-course")

    def verdict(contract: object) -> str:
        assert contract in (EXACT_CONTRACT, STRICT_CONTRACT, PHYSICS_CONTRACT)
        return judge(case, check, contract, exact_of("clamp"), record).verdict

    assert [
        verdict(contract) for contract in (EXACT_CONTRACT, STRICT_CONTRACT, PHYSICS_CONTRACT)
    ] == ["fail", "fail", "noted"]


def test_too_few_samples_fail_where_they_end() -> None:
    """A record that stops early fails every check that looks beyond its end."""
    early = Run(EXACT.times[:10], {n: s[:10] for n, s in EXACT.outputs.items()}, EXACT.initial)
    assert set(failures("default", early)) == {check.id for check in DEFAULT.checks}


def test_no_mass_moves_the_other_way_unseen() -> None:
    """The mirror image of the motion fails the reversed pull's checks: direction is judged."""
    failed = failures("reversed-pull", believed("reversed-pull", ("v", 0.02)))
    assert {"delta_x-exact", "spring_drop-exact", "x_dot_peak-exact"} <= set(failed)
    assert "t_slip-exact" not in failed


def test_a_missing_clamp_is_seen() -> None:
    """A side that does not clamp mu_k above mu_s shows it."""
    unclamped = planted(exact_of("clamp").record, scaled("mu_k_used", 0.6 / 0.49))
    assert "mu_k_used-course" in failures("clamp", unclamped)
