"""Rules of thumb of designers: each number held against a derivation of its own."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from docs import rules_of_thumb as claims

import stickslip_ref
from stickslip_ref import Parameters

OTHER = Parameters(m=37.0, k=2.5e6, mu_s=0.21, mu_k=0.2, load=50.0)
H = 1e-3


def travel(lambda_: float) -> float:
    """Return w t_slip; docs/theory.md (8)."""
    return 2.0 * (math.pi - math.atan(lambda_))


def way(lambda_: float) -> float:
    """Return the jump in parts of v/w; docs/theory.md (10)."""
    return 2.0 * lambda_ + travel(lambda_)


@pytest.mark.parametrize("block", [Parameters(), OTHER])
@pytest.mark.parametrize(
    ("rule", "closed"),
    [
        (claims.short_jump, lambda L: travel(L) / way(L)),
        (claims.lasting, lambda L: travel(L) / math.pi),
        (claims.growth, lambda L: way(2.0 * L) / way(L)),
    ],
)
def test_what_a_rule_leaves_out_depends_on_lambda_alone(
    monkeypatch: pytest.MonkeyPatch,
    rule: Callable[[float], float],
    closed: Callable[[float], float],
    block: Parameters,
) -> None:
    monkeypatch.setattr(claims, "BLOCK", block)
    for lambda_ in (0.05, 1.0, 40.0):
        # Differences of numbers near 1, in doubles.
        assert float(rule(lambda_)) == pytest.approx(closed(lambda_), rel=1e-13), lambda_


@pytest.mark.parametrize("v", [0.0003, 0.02, 1.0])
@pytest.mark.parametrize("mu_k", [0.0, 0.125, 0.3, 0.45])
def test_the_stick_formula_is_the_first_load_up_at_any_speed(mu_k: float, v: float) -> None:
    first, in_cycle = claims.sticks(mu_k / 0.5, v)
    assert abs(first - 1) < 1e-40  # fifty digits less ten for the arcs
    assert float(in_cycle) == pytest.approx(0.5 / (2 * (0.5 - mu_k)), rel=1e-14)


@pytest.mark.parametrize(("zeta", "percent"), [(1e-5, None), (0.01, 3), (0.1, 31), (0.5, None)])
def test_the_familiar_critical_velocity_is_high_as_the_reference_has_it(
    zeta: float, percent: int | None
) -> None:
    found = float(claims.excess(zeta))
    closed = float(stickslip_ref.critical_lambda(zeta)) / math.sqrt(4 * math.pi * zeta) - 1
    # The closed form in doubles takes 1 from a number near 1.
    assert found == pytest.approx(closed, rel=1e-9, abs=1e-12)
    assert percent is None or round(100 * found) == percent


def test_a_marching_script_is_first_order() -> None:
    # The faster pulls take few steps.
    k, v = (
        each.ravel()
        for each in np.meshgrid(np.geomspace(1e3, 1e4, 10), np.geomspace(0.01, 0.1, 25))
    )
    p = replace(Parameters(), k=k, v=v)
    # With the gap as it comes it finds every stick, and only those there are.
    coarse, fine = (claims.errors(p, h) for h in (H, H / 2))
    assert not coarse["missed"].any()
    assert not coarse["invented"].any()
    for name in claims.QUANTITIES:
        ratio = float(np.median(fine[name]) / np.median(coarse[name]))
        # Nearer to a half than to one (order zero) or to a quarter (order two), in ratios.
        assert math.sqrt(0.5 * 0.25) < ratio < math.sqrt(0.5 * 1.0), name
