"""Rules of thumb of designers: each number held against a derivation of its own."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import stickslip_ref
from stickslip_design.claims import critical, fixed_step, gap, jump, slip_time, stick_time
from stickslip_design.claims.numbers import pulled_at
from stickslip_design.claims.told import HERE, geometric, load_claim
from stickslip_verification import truth

START = truth.START_VALUES
OTHER = {**START, "m": 37.0, "k": 2.5e6, "mu_s": 0.21, "mu_k": 0.2, "load": 50.0}
H = 1e-3


def travel(lambda_: float) -> float:
    """Return w t_slip; docs/theory.md (8)."""
    return 2.0 * (math.pi - math.atan(lambda_))


def way(lambda_: float) -> float:
    """Return the jump in parts of v/w; docs/theory.md (10)."""
    return 2.0 * lambda_ + travel(lambda_)


@pytest.mark.parametrize("block", [START, OTHER])
@pytest.mark.parametrize(
    ("deviation", "closed"),
    [
        (jump.deviation, lambda L: travel(L) / way(L)),
        (slip_time.deviation, lambda L: 1.0 - math.pi / travel(L)),
        (gap.growth, lambda L: way(2.0 * L) / way(L)),
    ],
)
def test_what_a_rule_leaves_out_depends_on_lambda_alone(
    deviation: Callable[..., Any], closed: Callable[[float], float], block: dict[str, float]
) -> None:
    for lambda_ in (0.05, 1.0, 40.0):
        # Differences of numbers near 1, in doubles.
        found = float(deviation(pulled_at(lambda_, block)))
        assert found == pytest.approx(closed(lambda_), rel=1e-13), lambda_


@pytest.mark.parametrize("v", [0.0003, 0.02, 1.0])
@pytest.mark.parametrize("mu_k", [0.0, 0.125, 0.3, 0.45])
def test_the_stick_formula_is_the_first_load_up_at_any_speed(mu_k: float, v: float) -> None:
    sticks = stick_time.run({**START, "mu_k": mu_k, "v": v})
    assert abs(sticks.first - 1) < 1e-40  # fifty digits less ten for the arcs
    assert float(sticks.in_cycle) == pytest.approx(0.5 / (2 * (0.5 - mu_k)), rel=1e-14)


@pytest.mark.parametrize(("zeta", "percent"), [(1e-5, None), (0.01, 3), (0.1, 31), (0.5, None)])
def test_the_familiar_critical_velocity_is_high_as_the_reference_has_it(
    zeta: float, percent: int | None
) -> None:
    found = float(critical.excess(START, zeta))
    closed = float(stickslip_ref.critical_lambda(zeta)) / math.sqrt(4 * math.pi * zeta) - 1
    # The closed form in doubles takes 1 from a number near 1.
    assert found == pytest.approx(closed, rel=1e-9, abs=1e-12)
    assert percent is None or round(100 * found) == percent


def test_a_marching_script_is_first_order() -> None:
    claim = load_claim(HERE / "fixed_step.toml", fixed_step.GRID)
    # The faster pulls take few steps.
    claim = replace(claim, grid={**claim.grid, "v": geometric(0.01, 0.1, 25)})
    # With the gap as it comes it finds every stick, and only those there are.
    coarse, fine = (fixed_step.errors(claim, h=h, mu_k=0.3) for h in (H, H / 2))
    assert not coarse.missed.any()
    assert not coarse.made_up.any()
    for name, errors in coarse.largest.items():
        ratio = float(np.median(fine.largest[name]) / np.median(errors))
        # Nearer to a half than to one (order zero) or to a quarter (order two), in ratios.
        assert math.sqrt(0.5 * 0.25) < ratio < math.sqrt(0.5 * 1.0), name
