"""The marching script of a claim: what kind of method it is, and what it gets wrong."""

import math
from dataclasses import replace

import numpy as np
import pytest

from stickslip_design.claims import findings, fixed_step
from stickslip_design.claims.told import HERE, Claim, geometric, load_claim
from stickslip_design.claims.verlet import Marched, march
from stickslip_verification import truth
from stickslip_verification.model import formulas

H = 1e-3


@pytest.fixture(scope="module")
def claim() -> Claim:
    """Return the claim with a grid of the faster pulls, which take few steps."""
    told = load_claim(HERE / "fixed_step.toml", fixed_step.GRID)
    return replace(told, grid={**told.grid, "v": geometric(0.01, 0.1, 25)})


def march_one(k: float, v: float, h: float, mu_k: float = 0.3, cycles: int = 3) -> Marched:
    """March one block for some cycles."""
    block = {**truth.START_VALUES, "mu_k": mu_k}
    long = np.array([100.0])
    return march(np.array([k]), np.array([v]), h=h, block=block, cycles=cycles, longest=long)


def test_script_finds_the_cycle_with_a_small_step() -> None:
    """With a step of 20 us every quantity of the cycle is within a few steps of the exact one."""
    h, v = 2e-5, 0.0503
    p = {**truth.START_VALUES, "v": v}
    run = march_one(1000.0, v, h)
    assert 0 <= run.break_away[0] - float(formulas.first_load_up(p)) <= h
    # A break-away that is seen late by d <= h finds the gap larger by k v d: the slip is shorter by
    # 2 d/(1 + lambda^2), the stick longer by 2 d. The end is seen late by at most h more.
    assert run.t_slip[0] == pytest.approx([float(formulas.t_slip(p))] * 3, abs=3 * h)
    assert run.t_stick[0] == pytest.approx([float(formulas.t_stick(p))] * 3, abs=3 * h)
    assert run.T[0] == pytest.approx([float(formulas.period(p))] * 3, abs=3 * h)
    assert run.delta_x[0] == pytest.approx([float(formulas.delta_x(p))] * 3, abs=3 * h * v)


def test_script_reads_a_cycle_as_the_meter_does() -> None:
    """Period is stick and slip, and the jump is the way of the pulled end but for lateness."""
    run = march_one(4000.0, 0.03, H)
    assert pytest.approx(run.t_slip + run.t_stick, rel=1e-12) == run.T
    # The spring is left at a break-away at most a step's pull beyond break-away force.
    assert run.delta_x == pytest.approx(0.03 * run.T, abs=0.03 * H * (1 + 1e-9))


def test_first_break_away_is_late_by_less_than_a_step(claim: Claim) -> None:
    """A script sees the first break-away at the next step end: never early, never a step late."""
    k, v = (each.ravel() for each in np.meshgrid(claim.grid["k"], claim.grid["v"]))
    run = march(k, v, h=H, block=claim.parameters, cycles=1, longest=np.full(k.size, 5.0))
    late = run.break_away - 0.5 * 9.81 / (k * v)
    rounding = 1e-12
    assert np.all((late > -rounding) & (late <= H + rounding))


def test_error_of_the_script_is_first_order(claim: Claim) -> None:
    """Half the step, half the median error: events at step ends undo what Verlet's order gains."""
    coarse = fixed_step.errors(claim, h=H, mu_k=0.3).largest
    fine = fixed_step.errors(claim, h=H / 2, mu_k=0.3).largest
    for name in coarse:
        ratio = float(np.median(fine[name]) / np.median(coarse[name]))
        # Nearer to a half than to one (order zero) or to a quarter (order two), in ratios.
        assert math.sqrt(0.5 * 0.25) < ratio < math.sqrt(0.5 * 1.0), name


def test_script_passes_over_a_stick_only_where_it_is_shallow(claim: Claim) -> None:
    """A stick is missed where the velocity would be below zero for less than a step."""
    wrong = fixed_step.errors(claim, h=H, mu_k=0.48)
    assert wrong.missed.any()
    for k, v in zip(wrong.k[wrong.missed], wrong.v[wrong.missed], strict=True):
        p = {**claim.parameters, "mu_k": 0.48, "k": float(k), "v": float(v)}
        whole_period = 2 * formulas.half_period(p)
        # Unhindered, the slip would go on to the mirror image of its start, a period after it.
        assert whole_period - formulas.t_slip(p) < H


def test_script_neither_misses_nor_makes_up_a_stick_at_the_gap_as_it_comes(claim: Claim) -> None:
    """With a gap of 0.2 a millisecond finds every stick, and only those there are."""
    right = fixed_step.errors(claim, h=H, mu_k=0.3)
    assert not right.missed.any()
    assert not right.made_up.any()


def test_what_never_came_counts_as_an_infinite_error() -> None:
    """A cycle that the script gives up on is no number."""
    run = march_one(1000.0, 0.02, H, cycles=3)
    short = march(
        np.array([1000.0]),
        np.array([0.02]),
        h=H,
        block=truth.START_VALUES,
        cycles=3,
        longest=np.array([float(run.break_away[0] + 1.5 * run.T[0, 0])]),
    )
    assert np.isfinite(short.T[0, 0])
    assert np.isnan(short.T[0, 2])


def test_table_of_the_claim_is_what_the_errors_are() -> None:
    """The largest error in the slip time on the whole grid stands in the table."""
    told = load_claim(HERE / "fixed_step.toml", fixed_step.GRID)
    (finding,) = (each for each in findings() if each.id == "fixed_step")
    (row,) = (row for row in finding.rows if row[0] == "slip time")
    largest = fixed_step.errors(told, h=H, mu_k=0.3).largest["t_slip"].max()
    assert row[2] == f"{100 * largest:.1f} %"


def test_script_makes_up_sticks_with_a_quarter_of_the_period_as_step() -> None:
    """A step of 15 ms, a quarter of the shortest free period, ends some slips too early."""
    told = load_claim(HERE / "fixed_step.toml", fixed_step.GRID)
    wrong = fixed_step.errors(told, h=0.015, mu_k=0.3)
    assert wrong.made_up.any()
    assert wrong.missed.any()


def test_stick_without_length_counts_as_missed() -> None:
    """With a gap of 0.01 the stiff block at 100 mm/s is beyond break-away when its stop is seen."""
    run = march_one(4641.6, 0.1, H, mu_k=0.49, cycles=5)
    assert run.skipped[0] > 0
    assert (run.t_stick[0] == 0.0).sum() == run.skipped[0]
