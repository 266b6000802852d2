"""The score of curves at parameters without a cycle: one break-away, then sliding for ever."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stickslip_score import Curve, Score, score
from stickslip_verification import truth
from stickslip_verification.truth import Step
from tests.score import curve_makers as makers
from tests.score.curve_makers import Floats, Made

DRAG = {"c": 500.0, "v": 0.1}
"""zeta = 7.9, and c v is 25 times the gap of the forces: the spring rises after break-away too."""

BREAK_AWAY = 0.5 * 9.81 / (1000.0 * 0.1)
"""[s] of DRAG, from a relaxed spring."""


def scored(made: Made, p: makers.Parameters, columns: str = "x F") -> Score:
    """Score the columns of a made motion."""
    given = {name: getattr(made, name) for name in columns.split()}
    return score(Curve.of(made.t, **given), p)


def drawn(seed: int, count: int) -> list[dict[str, float]]:
    """Draw blocks without a cycle: over-damped, above the critical velocity, without a gap."""
    random = np.random.default_rng(seed)

    def between(low: float, high: float) -> float:
        return float(low * (high / low) ** random.random())

    found = []
    for kind in range(count):
        p = {"m": between(0.5, 50.0), "k": between(500.0, 5e4), "mu_s": between(0.2, 0.8)}
        p["mu_k"] = p["mu_s"] * (1.0 if kind % 3 == 2 else between(0.3, 0.9))
        zeta = between(0.05, 0.9) if kind % 3 == 1 else between(1.0, 50.0)
        p["c"] = 2.0 * zeta * math.sqrt(p["k"] * p["m"])
        # lambda_c > sqrt(4 pi zeta), its first order (docs/theory.md), is 0.8 at the least here.
        lambda_ = between(1e-2, 0.7 if kind % 3 == 1 else 1e2)
        gap = max(p["mu_s"] - p["mu_k"], 0.1 * p["mu_s"]) * p["m"] * 9.81 / p["k"]
        p["v"] = math.sqrt(p["k"] / p["m"]) * gap / lambda_
        assert truth.steady_cycle(p, digits=20) is None
        found.append(p)
    return found


def around_break_away(p: dict[str, float], random: np.random.Generator) -> tuple[Floats, Floats]:
    """Give even times, and uneven ones with the break-away among them, over rest and slide [s]."""
    begin = p["mu_s"] * p["m"] * 9.81 / (p["k"] * p["v"])
    w = math.sqrt(p["k"] / p["m"])
    end = begin + max(p["c"] / p["k"], 1.0 / w) * float(random.uniform(0.1, 8.0))
    even = np.linspace(0.0, end, 80)
    return even, np.unique([0.0, begin, *random.uniform(0.0, end, 80)])


def test_sliding_without_end_is_exact_at_any_sampling() -> None:
    """An exact curve is told so where the spring turns after break-away and where it does not."""
    random = np.random.default_rng(5)
    for p in drawn(seed=4, count=9):
        for times in around_break_away(p, random):
            made = makers.exact(p, times)
            for curve, columns in ((made, "x"), (made, "F"), (made.printed(9), "x x_dot F")):
                result = scored(curve, p, columns)
                assert result.cause == "exact", (p, columns, result.explanation)
                assert result.cycles == 0
                assert not any("velocity column" in finding for finding in result.findings)


def test_slow_sliding_under_strong_damping_is_no_creep() -> None:
    """The mass is slower than v/2 for 0.3 s after break-away, six times as long as it rested."""
    run = truth.run(DRAG, [Step(0.005)] * 100, digits=30)
    x = [float(sample["x"]) for sample in run.samples]
    F = [float(sample["F"]) for sample in run.samples]
    x_dot = [float(sample["x_dot"]) for sample in run.samples]
    result = score(Curve.of([float(t) for t in run.times], x=x, x_dot=x_dot, F=F), DRAG)
    assert result.cause == "exact"
    assert not any("velocity column" in finding for finding in result.findings)


def test_a_curve_that_begins_in_the_slide_is_exact() -> None:
    """What is left of a slide after its first part is still an arc of the block."""
    made = makers.exact(DRAG, np.linspace(0.0, 2.0, 400))
    for first in (12, 60, 300):
        assert scored(Made(*(column[first:] for column in made)), DRAG).cause == "exact"


def test_a_slide_under_another_force_is_told_by_its_spring() -> None:
    """Once sliding, x does not tell mu_k, but the spring force to which it tends does."""
    times = np.linspace(0.0, 2.0, 400)
    made = makers.exact({**DRAG, "mu_k": 0.4}, times)
    cut = Made(*(column[100:] for column in made))
    assert scored(cut, DRAG, "x").cause == "exact"
    result = scored(cut, DRAG)
    assert result.cause == "other"
    assert "another force acts" in result.explanation


def test_one_coefficient_is_told_by_how_the_slide_begins() -> None:
    """Without the gap nothing throws the mass forward at break-away."""
    times = np.linspace(0.0, 0.5, 400)
    for one in ({"mu_s": 0.3}, {"mu_k": 0.5}):
        for columns in ("x", "x F"):
            result = scored(makers.exact({**DRAG, **one}, times), DRAG, columns)
            assert result.cause == "single_coefficient", result.explanation


def test_another_gap_is_told_with_its_size() -> None:
    """A slide thrown off by a gap of 0.25 N/(m g) instead of 0.2 is that of another block."""
    made = makers.exact({**DRAG, "mu_s": 0.55}, np.linspace(0.0, 0.5, 4000))
    result = scored(made, DRAG, "x")
    assert result.cause == "other"
    assert "(mu_s - mu_k) N 25 % larger" in result.explanation


@pytest.mark.parametrize("columns", ["x", "F"])
def test_smoothed_friction_creeps_before_it_slides(columns: str) -> None:
    """Friction smoothed with tanh moves before break-away and is told by it, damped or not."""
    made = damped_tanh(DRAG, np.linspace(0.0, 0.5, 500), 1e-3)
    result = scored(made, DRAG, columns)
    assert result.cause == "regularised", result.explanation
    assert "stick phase creeps at" in result.explanation


@pytest.mark.parametrize("h", [1e-3, 1e-4])
def test_fixed_steps_are_told_by_the_slide(h: float) -> None:
    """A break-away that waits for the end of a step, and Euler's steps after it, are no exact."""
    result = scored(damped_euler(DRAG, 0.5, h), DRAG)
    assert result.cause == "fixed_step", result.explanation


def test_a_mass_that_rests_beyond_break_away_is_told_by_the_force() -> None:
    """The spring may pass the break-away force only by what a slip hides in the digits."""
    made = makers.exact({**DRAG, "mu_s": 0.6}, np.linspace(0.0, 1.15 * BREAK_AWAY, 200))
    result = scored(made, DRAG)
    assert result.cause == "other"
    assert "the mass rests although the spring force reaches 5.64 N" in result.explanation
    at_rest = makers.exact(DRAG, np.linspace(0.0, 0.99 * BREAK_AWAY, 200))
    assert scored(at_rest, DRAG).cause == "exact"


def damped_tanh(p: makers.Parameters, times: Floats, v_reg: float) -> Made:
    """Integrate damping and friction smoothed with tanh(x_dot/v_reg), without a static peak."""
    q = makers.with_defaults(p)
    k, m, v, N = q["k"], q["m"], q["v"], q["m"] * q["g"]

    def rate(time: float, state: Floats) -> tuple[float, float]:
        x, u = state
        friction = q["mu_k"] * N * math.tanh(u / v_reg) + q["c"] * u
        return u, (k * (v * time - x) - friction) / m

    x, u = solve_ivp(rate, (0.0, times[-1]), [0.0, 0.0], "LSODA", times, rtol=1e-8, atol=1e-11).y
    return Made(times, x, u, k * (v * times - x))


def damped_euler(p: makers.Parameters, duration: float, h: float) -> Made:
    """Step by semi-implicit Euler with damping; the break-away waits for the end of a step."""
    q = makers.with_defaults(p)
    N = q["m"] * q["g"]
    t: Floats = h * np.arange(round(duration / h) + 1, dtype=np.float64)
    x, u = np.zeros(t.size), np.zeros(t.size)
    for n in range(t.size - 1):
        force = q["k"] * (q["v"] * t[n] - x[n])
        if u[n] > 0.0 or force > q["mu_s"] * N:
            u[n + 1] = u[n] + h * (force - q["mu_k"] * N - q["c"] * u[n]) / q["m"]
        x[n + 1] = x[n] + h * u[n + 1]
    return Made(t, x, u, q["k"] * (q["v"] * t - x))
