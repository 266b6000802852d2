"""What suppresses the cycle, held against the exact solution in high precision."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from random import Random
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf

from stickslip_design.cures import Cure, cures
from stickslip_ref import Parameters, coulomb_limit, steady_cycle
from stickslip_verification import truth

NAMES = ("m", "g", "load", "k", "c", "mu_s", "mu_k", "v")
NEAR = 1e-9
"""Relative distance to a limit of the cycle at which its two sides are told apart: rounding of the
parameters moves the limit by 1e-16 times at most 1e3, the gap of the coefficients."""


def blocks(count: int = 40) -> Iterator[Parameters]:
    """Draw blocks with a cycle: undamped, damped up to zeta = 0.9, with load, lift and without."""
    draw = Random("cures")
    while count:
        mu_s = draw.uniform(0.02, 1.5)
        m, g, k = (math.exp(draw.uniform(*ends)) for ends in ((-5, 5), (0, 3.4), (2, 9)))
        zeta = draw.choice([0.0, math.exp(draw.uniform(-9, -0.1))])
        block = Parameters(
            m=m,
            g=g,
            load=m * g * draw.choice([0.0, 0.0, -0.9, -0.3, 1.0, 3.0, 30.0]),
            k=k,
            c=2.0 * zeta * math.sqrt(k * m),
            mu_s=mu_s,
            mu_k=mu_s * (1.0 - math.exp(draw.uniform(-6.9, 0.0))),
            v=math.exp(draw.uniform(-9, -1)),
        )
        if steady_cycle(block).exists:
            count -= 1
            yield block


def exact_jump(p: Parameters) -> float | None:
    """Return the jump [m] in high precision, None without a cycle."""
    cycle = truth.steady_cycle({name: float(getattr(p, name)) for name in NAMES})
    return None if cycle is None else float(cycle["delta_x"])


def at(p: Parameters, cure: Cure, value: float) -> Parameters:
    """Return the block with a cure's parameter set."""
    changes: dict[str, Any] = {cure.parameter: value}
    return replace(p, **changes)


def beside(p: Parameters, cure: Cure, by: float) -> Parameters:
    """Return the block with a cure's parameter a little beyond its limit, or before it."""
    assert cure.end is not None
    base = {"gap": float(p.mu_s), "normal force": -float(p.m) * float(p.g)}.get(cure.name, 0.0)
    further = 1.0 if cure.name in ("stiffer", "damping", "faster") else -1.0
    return at(p, cure, base + (cure.end - base) * (1.0 + further * by))


def test_a_halving_value_halves_the_jump() -> None:
    """With the value that is said to halve the jump, the exact jump is half, in each case."""
    halving = 0
    for p in blocks():
        whole = exact_jump(p)
        assert whole is not None
        found = cures(p)
        assert found.jump == pytest.approx(whole, rel=1e-12)
        for cure in found.cures:
            assert (cure.halve is None) is (cure.least > 0.5)
            if cure.halve is not None:
                halving += 1
                assert exact_jump(at(p, cure, cure.halve)) == pytest.approx(0.5 * whole, rel=1e-11)
    assert halving > 100


def test_the_cycle_ends_at_its_limit() -> None:
    """Just before a limit the exact solution has a cycle, just beyond it has none."""
    limits = 0
    for p in blocks():
        for cure in cures(p).cures:
            if cure.end is not None:
                limits += 1
                assert exact_jump(beside(p, cure, -NEAR)) is not None, cure
                assert exact_jump(beside(p, cure, NEAR)) is None, cure
    assert limits > 100


def test_the_jump_is_monotone_up_to_the_limit() -> None:
    """On each way the cycle exists up to the limit, and the jump falls to what is said, or grows.

    A second crossing before the limit, or a smaller jump on the way, would show.
    """
    for p in blocks(20):
        found = cures(p)
        for cure in found.cures:
            jumps = [abs(float(steady_cycle(each).delta_x)) for each in on_the_way(p, cure)]
            jumps = [found.jump, *jumps]
            assert all(math.isfinite(jump) for jump in jumps), cure
            grows = cure.name in ("softer", "faster")
            steps = np.diff(jumps if grows else jumps[::-1])
            assert (steps >= -1e-12 * found.jump).all(), cure
            if grows:
                assert cure.least == 1.0
            else:
                assert jumps[-1] == pytest.approx(
                    cure.least * found.jump, rel=2e-3, abs=1e-3 * found.jump
                )


def on_the_way(p: Parameters, cure: Cure, steps: int = 40) -> Iterator[Parameters]:
    """Yield the block on the way from now to the limit, or far towards the end of the range."""
    weight = float(p.m) * float(p.g)
    base = {"gap": float(p.mu_s), "normal force": -weight}.get(cure.name, 0.0)
    if cure.name == "damping" or (cure.end is not None and cure.now != base):
        assert cure.end is not None
        last = cure.end - 1e-9 * (cure.end - base)
        if cure.name in ("softer", "lighter", "gap", "normal force"):
            last = base + (cure.end - base) * (1.0 + 1e-9)
    else:
        far = {"stiffer": 1e9, "softer": 1e-9, "slower": 1e-9, "faster": 1e9, "lighter": 1e-9}
        last = base + (cure.now - base) * far.get(cure.name, 1e-9)
        if cure.name == "lighter":
            last = max(last, -float(p.load) / float(p.g) * (1.0 + 1e-9))
    for step in range(1, steps + 1):
        part = step / steps
        if cure.now == 0.0 or cure.name in ("gap", "normal force"):
            value = cure.now + (last - cure.now) * part
        else:
            value = cure.now * (last / cure.now) ** part
        yield at(p, cure, value)


def test_without_damping_neither_speed_nor_stiffness_ends_the_cycle() -> None:
    """At c = 0 the only cure with a limit is damping; the rest leave a cycle at any value."""
    for p in blocks():
        if p.c == 0.0:
            assert [each.name for each in cures(p).cures if each.end is not None] == ["damping"]
            for changes in ({"v": 1e6}, {"k": 1e15}, {"k": 1e-15}, {"mu_k": p.mu_s}):
                assert steady_cycle(replace(p, **changes)).exists


def test_damping_never_halves_the_jump() -> None:
    """More damping ends the cycle before the jump is half, from any block."""
    for p in blocks():
        (damping,) = (each for each in cures(p).cures if each.name == "damping")
        assert damping.halve is None
        assert damping.least > 0.5


def test_slower_helps_down_to_the_limit_of_a_slow_pull() -> None:
    """Without damping the jump never falls below 2 Delta: half of it is reached only from above."""
    start = Parameters()
    slower = cures(start).cures[3]
    assert slower.halve is None
    assert slower.least == pytest.approx(2.0 * float(start.Delta) / cures(start).jump, rel=1e-14)
    fast = cures(Parameters(v=0.2)).cures[3]
    assert fast.halve is not None
    assert 0.0 < fast.halve < 0.2


def test_the_first_limit_is_given_where_load_brings_the_cycle_back() -> None:
    """With load, v_c over the mass may have a minimum: the cycle ends there, and begins again."""
    p = Parameters(m=100.0, g=10.0, load=300.0, k=1e6, c=60.0, mu_s=0.3, mu_k=0.2)
    masses = np.geomspace(1.0, 100.0, 400)
    v_c = np.asarray(coulomb_limit(replace(p, m=masses)))
    lowest = int(np.argmin(v_c))
    assert 0 < lowest < 399
    p = replace(p, v=1.0001 * float(v_c[lowest]))
    (lighter,) = (each for each in cures(p).cures if each.name == "lighter")
    assert lighter.end is not None
    assert lighter.end == pytest.approx(float(masses[lowest]), rel=0.05)
    assert exact_jump(replace(p, m=lighter.end * (1.0 + NEAR))) is not None
    assert exact_jump(replace(p, m=lighter.end * (1.0 - NEAR))) is None
    assert exact_jump(replace(p, m=0.3 * lighter.end)) is not None


def test_the_way_back_of_a_critical_velocity_is_at_its_maximum() -> None:
    """Stiffer and softer meet where v_c is largest over the stiffness: zeta = 0.1814."""
    p = Parameters(c=5.0)
    with mp.workdps(40):
        highest = mp.findroot(
            lambda zeta: mp.diff(
                lambda z: mp.log(2 * z / truth.critical_lambda(z, digits=60)), zeta
            ),
            (mpf("0.18"), mpf("0.19")),
        )
        part = 2 * highest / truth.critical_lambda(highest)
    v = float(part) * float(p.F_s) * 0.4 / 5.0
    p = replace(p, k=(5.0 / (2.0 * float(highest))) ** 2, v=v * (1.0 - 1e-6))
    stiffer, softer = cures(p).cures[:2]
    assert stiffer.end is not None
    assert softer.end is not None
    assert float(softer.end) < float(p.k) < float(stiffer.end) < 1.01 * softer.end


def test_the_cures_scale_with_force_and_time() -> None:
    """Docs/theory.md (18): the values scale as their parameters do, the jump stays."""
    for p in blocks(20):
        here = cures(p)
        force = cures(replace(p, m=4.0 * p.m, k=4.0 * p.k, c=4.0 * p.c, load=4.0 * p.load))
        time = cures(
            replace(p, k=4.0 * p.k, g=4.0 * p.g, load=4.0 * p.load, v=2.0 * p.v, c=2.0 * p.c)
        )
        of_force = {"v": 1.0, "mu_k": 1.0}
        of_time = {"k": 4.0, "load": 4.0, "v": 2.0, "c": 2.0}
        for a, b, d in zip(here.cures, force.cures, time.cures, strict=True):
            for value in ("halve", "end"):
                x, y, z = (getattr(each, value) for each in (a, b, d))
                if x is None:
                    assert y is None
                    assert z is None
                else:
                    assert y == pytest.approx(of_force.get(a.parameter, 4.0) * x, rel=1e-9)
                    assert z == pytest.approx(of_time.get(a.parameter, 1.0) * x, rel=1e-9)


def test_a_pull_the_other_way_is_the_mirror_image() -> None:
    """With -v the values are the same, but the speeds have the sign of v."""
    for p in blocks(10):
        for a, b in zip(cures(p).cures, cures(replace(p, v=-p.v)).cures, strict=True):
            sign = -1.0 if a.parameter == "v" else 1.0
            assert b.least == a.least
            for value in ("now", "halve", "end"):
                x, y = getattr(a, value), getattr(b, value)
                assert y == (None if x is None else sign * x)


def test_a_block_without_cycle_needs_no_cure() -> None:
    """Above the critical velocity, over-damped or at rest there is nothing to suppress."""
    for p in (Parameters(c=20.0, v=1.0), Parameters(c=1e4), Parameters(v=0.0)):
        assert cures(p).cures == ()
        assert math.isnan(cures(p).jump)
    assert cures(Parameters(c=1e4)).v_c == 0.0


def test_a_block_without_gap_swings_and_touches_rest() -> None:
    """At c = 0 and mu_k = mu_s any damping ends the cycle, and four times the stiffness halves."""
    found = {each.name: each for each in cures(Parameters(mu_k=0.5)).cures}
    assert found["damping"].end == 0.0
    assert found["stiffer"].halve == pytest.approx(4000.0, rel=1e-14)
    assert found["lighter"].halve == pytest.approx(0.25, rel=1e-14)
    assert found["slower"].halve == pytest.approx(0.01, rel=1e-14)
    assert found["gap"].halve is None


def test_arrays_are_refused() -> None:
    """Cures are those of one block; the message names the shape."""
    with pytest.raises(ValueError, match=r"one block, not parameters of shape \(2,\)"):
        cures(Parameters(v=np.array([0.01, 0.02])))
