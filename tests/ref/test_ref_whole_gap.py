"""Slips without kinetic friction, which end exactly where equality sticks: docs/theory.md (4)."""

import math
from random import Random

import pytest

from stickslip_ref import Parameters, simulate


def test_without_kinetic_friction_every_slip_still_ends_in_stick() -> None:
    """With mu_k = 0 the slip relieves the spring to -F_s, where equality sticks, at any lambda."""
    draw = Random(21)
    for _ in range(60):
        k = 10.0 ** draw.uniform(1.0, 8.0)
        m = 10.0 ** draw.uniform(-2.0, 4.0)
        delta = 0.5 * m * 9.81 / k
        w = math.sqrt(k / m)
        lambda_ = 10.0 ** draw.uniform(-3.0, 3.0)
        p = Parameters(m=m, k=k, mu_k=0.0, v=w * delta / lambda_, z_start=delta)
        period = 2.0 * delta / float(p.v) + 2.0 * math.pi / w
        run = simulate(p, 3.2 * period, times=[3.2 * period])
        assert {event.kind for event in run.events} == {"break-away", "re-stick"}
        # Sensitivity of t_stick to the solver's 1e-9: docs/theory.md (17).
        for cycle in run.cycles[1:]:
            assert cycle.t_stick == pytest.approx(
                2.0 * delta / float(p.v), rel=1e-9 * (1.0 + lambda_**-2)
            )
