"""The score of a curve: its figures, their resolution, its cause."""

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from stickslip_score import Curve, CurveError, as_json, score
from stickslip_verification import truth
from tests.score import curve_makers as makers
from tests.score.curve_makers import QUANTITIES, ratios, scored, stepped

DRAG = {"c": 500.0, "v": 0.1}
"""zeta = 7.9, and c v is 25 times the gap of the forces: it slides for ever after break-away."""


# Parameters, the period and the end of some cycles [s].
DRAWS: list[tuple[dict[str, float], float, float]] = [
    ({"k": 1820.0, "v": 8.36e-3, "m": 0.876, "mu_s": 0.413, "mu_k": 0.194}, 0.324, 1.95),
    ({"k": 9540.0, "v": 3.48e-3, "m": 2.01, "mu_s": 0.221, "mu_k": 0.0704}, 0.230, 1.35),
    ({"k": 4310.0, "v": 17.2e-3, "m": 6.33, "mu_s": 0.241, "mu_k": 0.156}, 0.300, 1.79),
    ({"k": 8410.0, "v": 8.61e-3, "m": 1.96, "mu_s": 0.714, "mu_k": 0.235}, 0.307, 1.82),
    ({"k": 974.0, "v": 5.72e-3, "m": 1.65, "mu_s": 0.470, "mu_k": 0.302}, 1.11, 7.25),
]


@pytest.mark.parametrize(("draw", "part"), list(enumerate((0.002, 0.03, 0.31, 0.93, 1.3))))
def test_the_exact_block_is_exact_at_any_sampling(draw: int, part: float) -> None:
    # `part` of a period, evenly or not, to few digits or to all.
    random = np.random.default_rng(int(1000 * part))
    columns = ("x", "F", "x x_dot F")[draw % 3]
    p, T, end = DRAWS[draw]
    even = np.arange(0.0, max(end, 14 * part * T), part * T)
    uneven = np.concatenate([[0.0], np.sort(random.uniform(0.0, even[-1], even.size))])
    for times in (even, uneven):
        made = makers.exact(p, times)
        for curve in (made, made.printed(6 if part > 0.01 else 9)):
            result = scored(curve, p, columns)
            assert result.cause == "exact", (p, result.explanation)
            assert np.all(ratios(result) <= 1.0)


# Parameters, the end [s] and the samples of an exact curve, its first sample.
CYCLING: list[tuple[dict[str, float], float, int, int]] = [
    ({"v": -0.02}, 2.0, 300, 0),
    ({"c": 0.5, "v": 0.01}, 4.0, 900, 0),
    # One coefficient: no stick, 2 pi / w.
    ({"mu_k": 0.5}, 3.0, 900, 0),
]
ALONE: list[tuple[dict[str, float], float, int, int]] = [
    # Until before its first break-away, and before its second one.
    ({}, 0.2, 50, 0),
    ({}, 0.5, 400, 0),
    # Sliding without end: above the critical velocity, over-damped, without a gap.
    ({"c": 5.0, "v": 0.2}, 3.0, 900, 0),
    ({"c": 3000.0, "v": 0.01, "m": 20.0}, 30.0, 80, 0),
    ({"c": 100.0, "mu_k": 0.5}, 2.0, 80, 0),
    # At rest before it slides; from within the slide.
    (DRAG, 0.0485, 200, 0),
    *((DRAG, 2.0, 400, first) for first in (0, 12, 300)),
]


@pytest.mark.parametrize("columns", ["x", "x F"])
@pytest.mark.parametrize(("p", "end", "count", "first"), CYCLING + ALONE)
def test_every_kind_of_exact_motion_is_exact(
    p: dict[str, float], end: float, count: int, first: int, columns: str
) -> None:
    made = makers.exact(p, np.linspace(0.0, end, count)).rows(slice(first, None))
    result = scored(made, p, columns)
    cycles = (p, end, count, first) in CYCLING
    assert result.cause == "exact", result.explanation
    assert (result.cycles > 3, result.period.got is not None) == (cycles, cycles)
    assert np.all(ratios(result) <= 1.0)
    assert not any("velocity column" in finding for finding in result.findings)
    if truth.steady_cycle({**p, "v": abs(p.get("v", 0.02))}, digits=20) is None:
        assert "no steady cycle exists at these parameters" in result.findings


# What is asked for, what the block of the curve has instead, its end [s], columns, the sentence.
OTHERS: list[tuple[Mapping[str, float], Mapping[str, float], float, str, str]] = [
    ({}, {"m": 1.02}, 4.0, "x", "k/m is 1.96 % smaller"),
    ({}, {"c": 0.1}, 4.0, "x", "c = 0.1 N s/m instead of 0"),
    ({}, {"v": 0.0204}, 4.0, "x", "advances at 20.4 mm/s"),
    ({}, {"v": 0.03}, 4.0, "x F", "advances at 30 mm/s"),
    ({"v": 0.2}, {"v": 0.02}, 4.0, "x F", "advances at 20 mm/s"),
    ({}, {"k": 1020.0}, 4.0, "x F", "F is not k (v t - x)"),
    ({}, {"k": 1020.0}, 4.0, "F", "rises at 20.4 N/s, where k v is 20 N/s"),
    ({}, {"mu_s": 0.6, "mu_k": 0.4}, 4.0, "F", "5.886 N instead of 4.905 N"),
    (DRAG, {"mu_s": 0.55}, 0.5, "x", "(mu_s - mu_k) N 25 % larger"),
    (DRAG, {"mu_s": 0.6}, 0.0564, "x F", "although the spring force reaches 5.64 N"),
]


@pytest.mark.parametrize(("p", "wrong", "end", "columns", "words"), OTHERS)
def test_another_block_is_named(
    p: dict[str, float], wrong: dict[str, float], end: float, columns: str, words: str
) -> None:
    result = scored(makers.exact({**p, **wrong}, np.linspace(0.0, end, 2000)), p, columns)
    assert result.cause == "other"
    assert words in result.explanation


def test_an_exact_curve_resolves_its_period_to_a_ten_millionth() -> None:
    # 1e-9 of the range of x is held against no tool; over three cycles that bounds the period.
    result = scored(makers.exact({}, np.linspace(0.0, 1.5, 151)), {})
    assert (result.cause, result.cycles) == ("exact", 3)
    assert result.period.resolution is not None
    assert result.period.resolution < 1e-7 * 0.3


def test_a_slide_tells_its_force_by_the_spring_and_not_by_x() -> None:
    made = makers.exact({**DRAG, "mu_k": 0.4}, np.linspace(0.0, 2.0, 400)).rows(slice(100, None))
    assert scored(made, DRAG, "x").cause == "exact"
    assert "another force acts" in scored(made, DRAG, "x F").explanation


@pytest.mark.parametrize(("draw", "h"), [(0, 1e-3), (1, 1e-3), (2, 1e-4)])
def test_fixed_steps_are_told_whole_or_printed_every_few_steps(draw: int, h: float) -> None:
    p, T, end = DRAWS[draw]
    made = stepped(p, end, h)
    every = max(1, round(T / 200 / h))
    for curve in (made, made.rows(slice(None, None, every)).printed(9)):
        result = scored(curve, p)
        assert result.cause == "fixed_step", (p, result.explanation)


@pytest.mark.parametrize("draw", [0, 1, 2])
@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-6, 1e-8])
def test_a_solver_that_finds_its_events_is_off_by_its_tolerance(draw: int, rtol: float) -> None:
    p, T, end = DRAWS[draw]
    result = scored(makers.adaptive(p, np.arange(0.0, end, T / 400), rtol), p, "x F")
    assert result.cause == "solver_tolerance", result.explanation
    # An error of a step adds up over a slip, and is far below the tolerance where steps are short.
    assert 0.01 < float(result.explanation.split(":")[0][18:]) / rtol < 100.0


@pytest.mark.parametrize("h", [1e-3, 1e-4])
def test_fixed_steps_are_told_by_a_slide_and_by_chatter(h: float) -> None:
    made = stepped(DRAG, 0.5, h)
    assert scored(made, DRAG, "x F").cause == "fixed_step"
    for columns in ("x", "F"):
        result = scored(makers.euler_with_the_sign({}, 1.5, h), {}, columns)
        assert result.cause == "fixed_step"
        assert "chatters in stick" in result.explanation


def test_a_mean_over_cycles_resolves_more_than_a_step_and_a_program_gets_its_figures() -> None:
    # Verlet at 1 ms is late by less than a step.
    result = scored(stepped({}, 10.0, 1e-3), {})
    document = json.loads(json.dumps(as_json(result)))
    assert result.cycles > 25
    assert document["cause"] == "fixed_step"
    for name in QUANTITIES:
        figures = document[name]
        assert set(figures) == {"got", "exact", "error", "resolution"}
        assert figures["error"] == figures["got"] - figures["exact"]
    assert document["period"]["resolution"] < 1e-4
    assert document["period"]["error"] > 5.0 * document["period"]["resolution"]


@pytest.mark.parametrize(("draw", "v_reg"), list(enumerate((1e-4, 1e-3, 1e-2))))
@pytest.mark.parametrize("peak", [True, False])
def test_smoothed_friction_creeps(draw: int, v_reg: float, peak: bool) -> None:
    p, T, end = DRAWS[draw]
    made = makers.tanh_friction(p, np.arange(0.0, end, T / 500), v_reg, peak=peak)
    result = scored(made, p, "x F")
    assert result.cause == "regularised", result.explanation
    assert "creeps at" in result.explanation
    assert peak or "static peak is lost" in result.explanation
    # So does what slides for ever, before it does.
    made = makers.tanh_friction(DRAG, np.linspace(0.0, 0.5, 500), 1e-3, peak=False)
    assert "stick phase creeps at" in scored(made, DRAG, "xF"[draw % 2]).explanation


@pytest.mark.parametrize("one", ["mu_s", "mu_k"])
def test_one_coefficient_never_rests_and_throws_no_mass_forward(one: str) -> None:
    for p, _, end in (DRAWS[1], (DRAG | {"mu_s": 0.5, "mu_k": 0.3}, 0.0, 0.5)):
        alone = {**p, one: p["mu_k"] if one == "mu_s" else p["mu_s"]}
        curves = [makers.exact(alone, np.linspace(0.0, end, 700)).printed(6)]
        if p.get("c") is None:
            curves.append(stepped(alone, end, 1e-3))
        for made in curves:
            result = scored(made, p)
            assert result.cause == "single_coefficient", (p, result.explanation)


T = np.arange(10.0)


@pytest.mark.parametrize(
    ("t", "columns", "p", "words"),
    [
        (T, {"x": T}, {"v": 0.0}, "v = 0"),
        (T, {"x": T}, {"k": -1.0}, "k = -1"),
        (T, {}, {}, "neither x nor F"),
        (T[:5], {"x": [0.0, math.nan, 1.0, 1.0, 1.0]}, {}, "x is nan in sample 2"),
        # Numbers a power of 1000 off are not guessed.
        (1.0, {"x": 1e3}, {}, "x in mm"),
        (1e3, {"x": 1.0}, {}, "t in ms"),
        (1.0, {"F": 1e-3}, {}, "F in kN"),
    ],
)
def test_wrong_use_is_refused_with_its_reason(
    t: Any, columns: dict[str, Any], p: dict[str, float], words: str
) -> None:
    if isinstance(t, float):
        made = makers.exact({}, np.linspace(0.0, 2.0, 2001))
        t, columns = t * made.t, {n: size * getattr(made, n) for n, size in columns.items()}
    with pytest.raises((CurveError, ValueError), match=words):
        score(Curve.of(t, **columns), p)
