"""The steady cycle at random settings and steps: shallow, damped up to its end, and a million."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from random import Random
from typing import Any

import pytest
from mpmath import mp, mpf

import stickslip_ref
from stickslip_verification import truth
from tests.conftest import Sized
from tests.facts.sides import BLOCK, QUICK, REFERENCE, Row, Setting, Side, each_side
from tests.fmu.blocks import Segment, log_uniform, make_block, outputs

CYCLE = ("t_stick", "t_slip", "T", "delta_x", "spring_drop")
EXACT = 1e-12
INTEGRATED = 1e-9
"""A thousand roundings, and what a careful integration keeps; both times mu_s/(mu_s - mu_k)."""
SHALLOWEST = 1e-3
"""Below this lambda the re-stick is too shallow for any integration in double precision."""
DECIDABLE = 1e-9
"""|lambda/lambda_c - 1| below which rounding decides whether there is a cycle."""
WATCHED = 3.5
"""Length of a run in periods: the second slip ends within three from any start."""

Values = dict[str, float]


def oscillator(draw: Random) -> Values:
    mu_s, k, m = (log_uniform(draw, *ends) for ends in ((0.01, 1.5), (10.0, 1e8), (1e-2, 1e4)))
    mu_k = mu_s * (1.0 - log_uniform(draw, 1e-3, 1.0))
    return {"k": k, "m": m, "g": 9.81, "mu_s": mu_s, "mu_k": mu_k}


def w_of(p: Values) -> float:
    return math.sqrt(p["k"] / p["m"])


def gap_of(p: Values) -> float:
    return (p["mu_s"] - p["mu_k"]) * p["m"] * p["g"] / p["k"]


def pulled(p: Values, v: float) -> Values:
    return {**p, "v": v, "z_start": 0.5 * (p["mu_s"] + p["mu_k"]) * p["m"] * p["g"] / p["k"]}


def undamped(count: int) -> Iterator[tuple[Values, Random]]:
    for n in range(count):
        draw = Random(f"steady {n}")
        p = oscillator(draw)
        speed = log_uniform(draw, 1e-6, 10.0)
        if n % 6 == 0:
            speed = w_of(p) * gap_of(p) / log_uniform(draw, 1e-3, 1e-1)
        yield pulled(p, speed), draw


def damped(count: int) -> Iterator[tuple[Values, float, Random]]:
    for n in range(count):
        draw = Random(f"damped {n}")
        p, zeta = oscillator(draw), log_uniform(draw, 1e-4, 3.0)
        p["c"] = 2.0 * zeta * math.sqrt(p["k"] * p["m"])
        critical = float(truth.critical_lambda(zeta, digits=20)) if zeta < 0.99 else math.inf
        lambda_ = log_uniform(draw, 1e-2, 1e6)
        if math.isfinite(critical):
            lambda_ = critical * (1.0 + draw.choice((1.0, -1.0)) * log_uniform(draw, 2e-9, 0.9))
        p = pulled(p, w_of(p) * gap_of(p) / lambda_)
        yield p, distance(p), draw


def distance(p: Values) -> float:
    with mp.workdps(50):
        k, m, c = mpf(p["k"]), mpf(p["m"]), mpf(p["c"])
        zeta = c / (2 * mp.sqrt(k * m))
        if zeta >= 1:
            return -1.0
        gap = (mpf(p["mu_s"]) - mpf(p["mu_k"])) * m * mpf(p["g"]) / k
        return float(mp.sqrt(k / m) * gap / mpf(p["v"]) / truth.critical_lambda(zeta) - 1)


def watched(side: Side, p: Values, period: float, draw: Random) -> tuple[Row, float]:
    steps: list[float] = []
    while math.fsum(steps) < WATCHED * period:
        steps.append(period * (WATCHED if side is REFERENCE else log_uniform(draw, 1e-3, 20.0)))
    return side.rows(Setting(p, [Segment(h) for h in steps]))[-1], math.fsum(steps)


def assert_cycles(
    row: Row, end: float, exact: Mapping[str, Any], bound: Mapping[str, float], p: Values
) -> None:
    for name in CYCLE:
        assert abs(float(row[name]) / float(exact[name]) - 1.0) <= bound[name], (name, p)
    assert abs(row["delta_x"] / (p["v"] * row["T"]) - 1.0) <= bound["T"], p
    first = (p["mu_s"] * p["m"] * p["g"] / p["k"] - p["z_start"]) / p["v"]
    turns = (end - first - float(exact["t_slip"])) / float(exact["T"]) + 1.0
    if abs(turns - round(turns)) > 1e-6:
        assert row["n_slips"] == math.floor(turns), p


def bounds(p: Values, part: float, slip: float, others: float) -> dict[str, float]:
    """Return the bound by quantity, theory (17): of T and delta_x, t_slip, and the others."""
    basic = part * p["mu_s"] / (p["mu_s"] - p["mu_k"])
    factors = {"T": 1.0, "delta_x": 1.0, "t_slip": slip}
    return {name: basic * factors.get(name, others) for name in CYCLE}


def assert_formulas(p: Values, exact: Mapping[str, Any] | None, bound: Mapping[str, float]) -> None:
    values = {name: value for name, value in p.items() if name != "z_start"}
    cycle = stickslip_ref.steady_cycle(stickslip_ref.Parameters(**values))
    assert cycle.exists == (exact is not None), p
    for name, value in (exact or {}).items():
        if name in CYCLE:
            assert abs(float(getattr(cycle, name)) / float(value) - 1.0) <= bound[name], (name, p)


@pytest.mark.parametrize("side", each_side(QUICK))
def test_the_cycle_is_exact_at_any_steps(side: Side, sized: Sized) -> None:
    for p, draw in undamped(sized(6000 if side is BLOCK else 600)):
        lambda_ = w_of(p) * gap_of(p) / p["v"]
        if side is REFERENCE and lambda_ < SHALLOWEST:
            continue
        exact = truth.steady_cycle(p)
        assert exact is not None
        bound = bounds(p, EXACT, 1.0, 1.0)
        assert_formulas(p, exact, bound)
        if side is REFERENCE:
            bound = bounds(p, INTEGRATED, 1.0 + 1.0 / lambda_, 1.0 + lambda_**-2)
        assert_cycles(*watched(side, p, float(exact["T"]), draw), exact, bound, p)


def test_a_damped_block_cycles_where_the_cycle_exists_and_nowhere_else(sized: Sized) -> None:
    for p, d, draw in damped(sized(1000)):
        if abs(d) <= DECIDABLE:
            continue
        exact = truth.steady_cycle(p)
        if exact is None:
            assert_formulas(p, None, {})
            period = 2.0 * math.pi / w_of(p) + 0.5 * gap_of(p) / p["v"]
            row, _ = watched(BLOCK, p, period, draw)
            assert (row["n_slips"], row["mode"]) == (0, 1), (d, p)
            continue
        # The end of a slip that all but grazes is as uncertain as the root of d.
        bound = bounds(p, EXACT, *(2 * [1.0 + 1.0 / math.sqrt(d)]))
        assert_formulas(p, exact, bound)
        assert_cycles(*watched(BLOCK, p, float(exact["T"]), draw), exact, bound, p)


def test_the_millionth_cycle_is_the_second_bit_for_bit(sized: Sized) -> None:
    block, draw, time = make_block(), Random("million"), 0.0
    wanted: dict[int, Row] = {}
    for count, longest in ((2, 0.5), (sized(1_000_000), 2000.0)):
        while block.meter.n_slips < count:
            step = 0.3 * log_uniform(draw, 0.01, longest)
            block.advance(time, step)
            time += step
        wanted[count] = outputs(block)
    second, last = wanted.values()
    names = ("t_slip", "t_stick", "spring_drop")
    assert [last[name] for name in names] == [second[name] for name in names]
