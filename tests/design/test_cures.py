"""What suppresses the cycle, held against the exact solution in high precision."""

import math
from collections.abc import Iterator
from dataclasses import replace
from random import Random
from typing import Any

import numpy as np
import pytest

from stickslip_design.cures import Cure, cures
from stickslip_ref import Parameters, coulomb_limit, steady_cycle
from stickslip_verification import truth

NAMES = ("m", "g", "load", "k", "c", "mu_s", "mu_k", "v")
NEAR = 1e-9
"""Relative distance to a limit of the cycle at which its two sides are told apart: rounding of the
parameters moves the limit by 1e-16 times at most 1e3, the gap of the coefficients."""


def blocks(count: int) -> Iterator[Parameters]:
    """Draw blocks with a cycle, undamped or damped, with load, lift and without, either way."""
    draw = Random("cures")
    while count:
        mu_s = draw.uniform(0.02, 1.5)
        m, g, k = (math.exp(draw.uniform(*ends)) for ends in ((-5, 5), (0, 3.4), (2, 9)))
        zeta = draw.choice([0.0, math.exp(draw.uniform(-9, -0.1))])
        block = Parameters(
            m=m, g=g, load=m * g * draw.choice([0.0, 0.0, -0.9, -0.3, 1.0, 3.0, 30.0]), k=k,
            c=2.0 * zeta * math.sqrt(k * m), mu_s=mu_s,
            mu_k=mu_s * (1.0 - math.exp(draw.uniform(-6.9, 0.0))),
            v=draw.choice([1.0, 1.0, -1.0]) * math.exp(draw.uniform(-9, -1)),
        )  # fmt: skip
        if steady_cycle(block).exists:
            count -= 1
            yield block


def exact_jump(p: Parameters) -> float | None:
    """Return the jump [m] in high precision, None without a cycle."""
    cycle = truth.steady_cycle({name: float(getattr(p, name)) for name in NAMES})
    return None if cycle is None else abs(float(cycle["delta_x"]))


def at(p: Parameters, cure: Cure, value: Any) -> Parameters:
    return replace(p, **{cure.parameter: value})


def beside(p: Parameters, cure: Cure, by: float) -> float:
    """Return a cure's limit, moved by a part of its distance to where nothing presses."""
    assert cure.end is not None
    base = {"gap": float(p.mu_s), "normal force": -float(p.m) * float(p.g)}.get(cure.name, 0.0)
    further = 1.0 if cure.name in ("stiffer", "damping", "faster") else -1.0
    return base + (cure.end - base) * (1.0 + further * by)


def test_a_halving_value_halves_the_jump_and_a_limit_ends_the_cycle() -> None:
    halving = limits = 0
    for p in blocks(16):
        jump = exact_jump(p)
        assert jump is not None
        found = cures(p)
        # Roundings times the conditioning of the parameters drawn.
        assert found.jump == pytest.approx(jump, rel=1e-12)
        for cure in found.cures:
            assert (cure.halve is None) is (cure.least > 0.5)
            if cure.halve is not None:
                halving += 1
                assert exact_jump(at(p, cure, cure.halve)) == pytest.approx(0.5 * jump, rel=1e-11)
            if cure.end is not None:
                limits += 1
                assert exact_jump(at(p, cure, beside(p, cure, -NEAR))) is not None, cure
                assert exact_jump(at(p, cure, beside(p, cure, NEAR))) is None, cure
            if p.c == 0.0:
                assert (cure.end is not None) is (cure.name == "damping")
            if cure.name == "damping":
                assert cure.least > 0.5
    assert min(halving, limits) > 30


def test_on_the_way_to_a_cure_the_jump_falls_all_the_time() -> None:
    for p in blocks(20):
        jump = cures(p).jump
        for cure in cures(p).cures:
            sign = 1.0 if cure.name in ("softer", "faster") else -1.0
            goal = cure.halve if cure.end is None else beside(p, cure, -NEAR)
            if goal is None:
                continue
            # A second limit or halving value before the one given would show.
            jumps = np.abs(steady_cycle(at(p, cure, np.linspace(cure.now, goal, 40))).delta_x)
            assert np.isfinite(jumps).all(), cure
            # Roundings of the jump.
            assert (sign * np.diff(jumps) >= -1e-12 * jump).all(), cure
            assert np.min(jumps) >= cure.least * jump * (1.0 - 1e-12), cure


def test_where_load_brings_the_cycle_back_the_first_limit_is_given() -> None:
    p = Parameters(m=100.0, g=10.0, load=300.0, k=1e6, c=60.0, mu_s=0.3, mu_k=0.2)
    masses = np.geomspace(1.0, 100.0, 400)
    v_c = np.asarray(coulomb_limit(replace(p, m=masses)))
    lowest = int(np.argmin(v_c))
    assert 0 < lowest < 399
    p = replace(p, v=1.0001 * float(v_c[lowest]))
    (lighter,) = (each for each in cures(p).cures if each.name == "lighter")
    assert lighter.end is not None
    # Near its minimum the limit is flat.
    assert lighter.end == pytest.approx(float(masses[lowest]), rel=0.05)
    for factor, exists in ((1.0 + NEAR, True), (1.0 - NEAR, False), (0.3, True)):
        assert (exact_jump(replace(p, m=factor * lighter.end)) is not None) == exists


@pytest.mark.parametrize("p", [Parameters(c=20.0, v=1.0), Parameters(c=1e4), Parameters(v=0.0)])
def test_a_block_without_cycle_needs_no_cure(p: Parameters) -> None:
    assert cures(p).cures == ()
    assert math.isnan(cures(p).jump)
