"""The score of a curve: its figures, its resolution, its cause."""

import itertools
import json
import math
import sys

import numpy as np
import pytest

from stickslip_score import Curve, CurveError, Score, as_json, score
from stickslip_verification import truth
from stickslip_verification.truth import Step
from tests.score import curve_makers as makers
from tests.score.curve_makers import Made

QUANTITIES = ("period", "t_stick", "t_slip", "delta_x")
ROUNDING = 1e-11
"""Relative: the reference is right to 4e-14 of mu_s/(mu_s - mu_k) (docs/theory.md (17))."""


def scored(made: Made, p: makers.Parameters, columns: str = "x") -> Score:
    """Score the columns of a made motion."""
    given = {name: getattr(made, name) for name in columns.split()}
    return score(Curve.of(made.t, **given), p)


def drawn(seed: int, count: int) -> list[tuple[dict[str, float], float, float]]:
    """Draw parameters with their period and the end of some cycles [s]."""
    random = np.random.default_rng(seed)

    def between(low: float, high: float) -> float:
        return float(low * (high / low) ** random.random())

    found: list[tuple[dict[str, float], float, float]] = []
    while len(found) < count:
        mu_s = between(0.2, 0.8)
        p = {
            "k": between(500.0, 5e4),
            "v": between(1e-3, 0.1),
            "m": between(0.5, 50.0),
            "mu_s": mu_s,
            "mu_k": mu_s * between(0.3, 0.9),
        }
        cycle = truth.steady_cycle(p, digits=20)
        assert cycle is not None
        T, t_slip = float(cycle["T"]), float(cycle["t_slip"])
        load_up = mu_s * p["m"] * 9.81 / (p["k"] * p["v"])
        # A tool's curve shows slips; w h and v h / Delta at 1 ms are those of a sensible step.
        w, Delta = math.sqrt(p["k"] / p["m"]), float(cycle["Delta"])
        sensible = 1e-3 * w < 0.2 and 1e-3 * p["v"] < 0.1 * Delta
        if sensible and 30.0 * t_slip > T and load_up < 20.0 * T and load_up + 5.0 * T < 20.0:
            found.append((p, T, load_up + 5.3 * T))
    return found


DRAWS = drawn(seed=20, count=12)


def assert_resolved(result: Score) -> None:
    """Every figure of an exact curve is within its resolution of the exact value."""
    for name in QUANTITIES:
        compared = getattr(result, name)
        if compared.got is not None:
            assert compared.resolution is not None
            assert abs(compared.got - compared.exact) <= (
                compared.resolution + ROUNDING * abs(compared.exact)
            ), name


@pytest.mark.parametrize("columns", ["x", "F", "x x_dot F"])
@pytest.mark.parametrize("part", [0.002, 0.03, 0.11, 0.31, 0.57, 0.93, 1.3])
def test_the_exact_block_is_exact_at_any_sampling(columns: str, part: float) -> None:
    """Sampled every `part` of a period, evenly or not, to few digits or to all, it is told so."""
    random = np.random.default_rng(int(1000 * part))
    for p, T, end in DRAWS[:2]:
        h = part * T
        end = max(end, 14 * h)
        even = np.arange(0.0, end, h)
        uneven = np.concatenate([[0.0], np.sort(random.uniform(0.0, end, even.size))])
        for times in (even, uneven):
            made = makers.exact(p, times)
            for curve in (made, made.printed(6 if part > 0.01 else 9)):
                result = scored(curve, p, columns)
                assert result.cause == "exact", (p, result.explanation)
                assert_resolved(result)


def test_the_truth_itself_is_exact() -> None:
    """The high-precision solution of the suite, in doubles, has its own cycle to 1e-7."""
    run = truth.run({}, [Step(0.01)] * 150, digits=30)
    x = [float(sample["x"]) for sample in run.samples]
    result = score(Curve.of([float(t) for t in run.times], x=x), {})
    assert result.cause == "exact"
    assert result.cycles == 3
    assert_resolved(result)
    # 1e-9 of the range of x is held against no tool; over three cycles that bounds the period.
    assert result.period.resolution is not None
    assert result.period.resolution < 1e-7 * 0.3


def test_a_wrong_coefficient_is_told_from_the_exact_one() -> None:
    """A slip that is 1 % too long in mu_s is outside the resolution and named as another gap."""
    for p, _, end in DRAWS[:6]:
        wrong = {**p, "mu_s": 1.01 * p["mu_s"]}
        result = scored(makers.exact(wrong, np.linspace(0.0, end, 400)).printed(9), p)
        assert result.cause == "other"
        share = p["mu_s"] / (p["mu_s"] - p["mu_k"])
        assert f"{share:.3g} % larger" in result.explanation
        assert result.delta_x.error is not None
        assert result.delta_x.resolution is not None
        assert result.delta_x.error > result.delta_x.resolution > 0.0


def test_a_wrong_mass_or_speed_or_stiffness_is_named() -> None:
    """A clean curve of another block is `other`, and the sentence says of which."""
    times = np.linspace(0.0, 4.0, 2000)
    for wrong, columns, said in (
        ({"m": 1.02}, "x", "k/m is 1.96 % smaller"),
        ({"v": 0.0204}, "x", "advances at 20.4 mm/s"),
        ({"k": 1020.0}, "x F", "F is not k (v t - x)"),
        ({"k": 1020.0}, "F", "rises at 20.4 N/s, where k v is 20 N/s"),
        ({"mu_s": 0.6, "mu_k": 0.4}, "F", "5.886 N instead of 4.905 N"),
    ):
        result = scored(makers.exact(wrong, times), {}, columns)
        assert result.cause == "other"
        assert said in result.explanation


@pytest.mark.parametrize("h", [1e-3, 1e-4])
@pytest.mark.parametrize("maker", ["verlet", "semi_implicit_euler", "runge_kutta"])
def test_fixed_steps_are_told(maker: str, h: float) -> None:
    """Events that wait for the end of a step are seen, whole or printed every few steps."""
    for p, T, end in DRAWS[:2] if h < 1e-3 else DRAWS[:5]:
        made = getattr(makers, maker)(p, min(end, 60000 * h), h)
        for curve in (made, made.every(max(1, round(T / 200 / h))).printed(9)):
            result = scored(curve, p)
            assert result.cause == "fixed_step", (p, result.explanation)


def test_a_mean_over_cycles_resolves_more_than_a_sample() -> None:
    """Verlet at 1 ms is late by less than a step, and the period tells so beyond its resolution."""
    result = scored(makers.verlet({}, 10.0, 1e-3), {})
    assert result.cycles > 25
    assert result.period.error is not None
    assert result.period.resolution is not None
    assert result.period.resolution < 1e-4
    assert result.period.error > 5.0 * result.period.resolution


@pytest.mark.parametrize("v_reg", [1e-4, 1e-3, 1e-2])
@pytest.mark.parametrize("peak", [True, False])
def test_regularised_friction_creeps(v_reg: float, peak: bool) -> None:
    """Friction smoothed by tanh is told by its creep, with or without a static peak."""
    for p, T, end in DRAWS[:2]:
        times = np.arange(0.0, end, T / 500)
        result = scored(makers.tanh_friction(p, times, v_reg, peak=peak), p, "x F")
        assert result.cause == "regularised", (p, result.explanation)
        assert "creeps at" in result.explanation
        if not peak:
            assert "static peak is lost" in result.explanation


def test_one_coefficient_never_rests() -> None:
    """With mu_s = mu_k the mass swings about the speed of the pulled end; Verlet shows the same."""
    for p, _, end in DRAWS[1:3]:
        for one in ({**p, "mu_k": p["mu_s"]}, {**p, "mu_s": p["mu_k"]}):
            for made in (
                makers.exact(one, np.linspace(0.0, end, 700)).printed(6),
                makers.verlet(one, end, 1e-3),
            ):
                result = scored(made, p)
                assert result.cause == "single_coefficient", (p, result.explanation)


def test_one_coefficient_is_exact_where_it_is_asked_for() -> None:
    """At mu_s = mu_k the exact cycle has no stick and takes 2 pi / w."""
    p = {"mu_k": 0.5}
    result = scored(makers.exact(p, np.linspace(0.0, 3.0, 900)), p)
    assert result.cause == "exact"
    assert result.period.exact == pytest.approx(2.0 * math.pi / math.sqrt(1000.0))


def test_a_backward_pull_is_the_mirror_image() -> None:
    """The jump has the sign of v, all else is as forward."""
    forward = scored(makers.exact({}, np.linspace(0.0, 2.0, 300)), {})
    backward = scored(makers.exact({"v": -0.02}, np.linspace(0.0, 2.0, 300)), {"v": -0.02})
    assert backward.cause == "exact"
    assert backward.delta_x.got == pytest.approx(-float(forward.delta_x.got or 0.0), rel=1e-9)
    assert backward.period.got == pytest.approx(forward.period.got, rel=1e-9)


@pytest.mark.parametrize("c", [0.5, 2.0])
def test_the_damped_cycle_is_exact(c: float) -> None:
    """With damping the exact cycle is that of its root, and the curve is on it."""
    p = {"c": c, "v": 0.01}
    result = scored(makers.exact(p, np.linspace(0.0, 4.0, 900)), p)
    assert result.cause == "exact"
    assert result.cycles > 3
    assert_resolved(result)


def test_above_the_critical_velocity_sliding_is_exact() -> None:
    """Where no cycle exists the exact curve shows none, and nothing is compared."""
    p = {"c": 5.0, "v": 0.2}
    assert truth.steady_cycle(p, digits=20) is None
    result = scored(makers.exact(p, np.linspace(0.0, 3.0, 900)), p)
    assert result.cause == "exact"
    assert result.period.exact is None
    assert result.period.error is None
    assert "no steady cycle exists at these parameters" in result.findings


def test_the_first_load_up_is_no_cycle() -> None:
    """A curve that ends before its second break-away has no period and no time in stick."""
    result = scored(makers.exact({}, np.linspace(0.0, 0.5, 400)), {})
    assert result.cycles == 0
    assert result.period.got is None
    assert result.t_stick.got is None
    assert result.t_slip.got is not None
    assert any("no complete cycle" in finding for finding in result.findings)


def test_a_curve_that_only_loads_is_not_judged_wrong() -> None:
    """Before the first break-away there is nothing to measure and nothing to blame."""
    result = scored(makers.exact({}, np.linspace(0.0, 0.2, 50)), {}, "x F")
    assert result.cause == "exact"
    assert "no break-away" in result.explanation


def test_the_machine_gets_what_the_person_gets() -> None:
    """The JSON holds the four quantities with four figures each, and the cause."""
    document = json.loads(json.dumps(as_json(scored(makers.verlet({}, 3.0, 1e-3), {}))))
    for name in QUANTITIES:
        assert set(document[name]) == {"got", "exact", "error", "resolution"}
        assert document[name]["error"] == document[name]["got"] - document[name]["exact"]
    assert document["cause"] == "fixed_step"
    assert document["unit"]["delta_x"] == "m"


def test_no_function_is_called_for_each_sample() -> None:
    """A curve of 100,000 samples takes as many calls as one of 10,000, on the law or off it."""
    few, many = (makers.verlet({}, 10.0, h) for h in (1e-3, 1e-4))
    for digits in (None, 6):
        xs = [made.x if digits is None else made.x.round(digits) for made in (few, few, many)]
        # The first time also loads what is needed.
        _, ten_thousand, hundred_thousand = (
            calls_of_score(Curve.of(made.t, x=x))
            for made, x in zip((few, few, many), xs, strict=True)
        )
        assert hundred_thousand < 1.2 * ten_thousand


def calls_of_score(curve: Curve) -> int:
    """Return how many functions are called while a curve is scored."""
    counted = itertools.count()
    sys.setprofile(lambda *_: next(counted))
    try:
        score(curve, {})
    finally:
        sys.setprofile(None)
    return next(counted)


def test_wrong_use_is_refused_with_its_reason() -> None:
    """A pull that stands, a parameter out of range and bad samples are each named."""
    t = np.arange(10.0)
    with pytest.raises(CurveError, match="v = 0"):
        score(Curve.of(t, x=t), {"v": 0.0})
    with pytest.raises(ValueError, match="k = -1"):
        score(Curve.of(t, x=t), {"k": -1.0})
    with pytest.raises(CurveError, match="at least 5"):
        Curve.of(t[:3], x=t[:3])
    with pytest.raises(CurveError, match="neither x nor F"):
        Curve.of(t)
    with pytest.raises(CurveError, match="does not increase in sample 3"):
        Curve.of([0.0, 1.0, 1.0, 2.0, 3.0], x=t[:5])
    with pytest.raises(CurveError, match="x is nan in sample 2"):
        Curve.of(t[:5], x=[0.0, math.nan, 1.0, 1.0, 1.0])
