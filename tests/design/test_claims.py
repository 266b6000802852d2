"""What designers are told: each number held against a derivation of its own, in plain doubles.

What a plot shows is rounded to six digits, so 1e-5 of the value is the bound for it.
"""

import math
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import pytest

from stickslip_design.claims import (
    Finding,
    critical,
    findings,
    fixed_step,
    gap,
    jump,
    slip_time,
    stick_time,
)
from stickslip_design.claims.finding import Series
from stickslip_design.claims.numbers import figure, pulled_at, threshold
from stickslip_design.claims.told import HERE, Claim, ClaimError, load_claim
from stickslip_verification import truth
from stickslip_verification.model import formulas

SIX_DIGITS = 1e-5
MODULES = (jump, gap, slip_time, stick_time, critical, fixed_step)


def told(module: ModuleType) -> Claim:
    """Return the claim of a module, as its file tells it."""
    return load_claim(HERE / f"{module.__name__.rpartition('.')[2]}.toml", module.GRID)


def found(name: str) -> Finding:
    """Return the finding of that id."""
    (finding,) = (each for each in findings() if each.id == name)
    return finding


def drawn(finding: Finding, panel: int, name: str) -> Series:
    """Return a series of a plot by its name."""
    (series,) = (each for each in finding.panels[panel].series if each.name == name)
    return series


def thresholds(finding: Finding, panel: int) -> list[tuple[float, float]]:
    """Return the single marked points of a panel."""
    return [
        (each.x[0], each.y[0])
        for each in finding.panels[panel].series
        if each.kind == "points" and len(each.x) == 1
    ]


def short_of_jump(lambda_: float) -> float:
    """Return what v t_slip is of the jump, from the closed form in lambda alone."""
    travel = math.pi - math.atan(lambda_)
    return travel / (lambda_ + travel)


def test_jump_thresholds_solve_the_closed_form() -> None:
    """The simplified jump is short by 10, 5 and 1 % just where (pi - atan l)/(l + ...) is that."""
    marked = thresholds(found("jump"), 0)
    assert [percent for _, percent in marked] == [10.0, 5.0, 1.0]
    for lambda_, percent in marked:
        assert 100 * short_of_jump(lambda_) == pytest.approx(percent, rel=SIX_DIGITS)


def test_jump_curve_is_the_same_for_every_block() -> None:
    """What the simplified jump leaves out depends on lambda alone, not on m, k and the gap."""
    curve = drawn(found("jump"), 0, "any undamped block")
    for lambda_, percent in zip(curve.x, curve.y, strict=True):
        assert percent == pytest.approx(100 * short_of_jump(lambda_), rel=SIX_DIGITS)
    other = {**truth.START_VALUES, "m": 37.0, "k": 2.5e6, "mu_s": 0.21, "mu_k": 0.2, "load": 50.0}
    assert float(jump.deviation(pulled_at(3.0, other))) == pytest.approx(
        short_of_jump(3.0),
        rel=1e-15,  # both are good to a rounding or two
        abs=4 * 2.0**-53,
    )


def test_jump_is_short_by_the_travel_of_half_a_period_for_slow_pull() -> None:
    """For slow pull the missing share is pi/(2 lambda), the travel v pi/w over 2 Delta."""
    # The next term is (1 - pi^2/4)/lambda^2, 1e-6 of the first here.
    share = jump.deviation(pulled_at(1e6, truth.START_VALUES))
    assert float(share) == pytest.approx(math.pi / 2e6, rel=2e-6)


def test_slip_time_thresholds_have_a_closed_form() -> None:
    """Half a period is short by p just at lambda = cot((pi/2) p/(1 - p))."""
    marked = thresholds(found("slip_time"), 0)
    for (lambda_, times), p in zip(marked, (0.10, 0.05, 0.01), strict=True):
        assert lambda_ == pytest.approx(1 / math.tan(math.pi / 2 * p / (1 - p)), rel=SIX_DIGITS)
        assert times == pytest.approx(1 / (1 - p), rel=SIX_DIGITS)


def test_slip_time_lies_between_half_a_period_and_a_whole_one() -> None:
    """At lambda = 1 a slip takes three quarters of the period, and always between 1/2 and 1."""
    curve = drawn(found("slip_time"), 0, "exact")
    assert all(1 < times < 2 for times in curve.y)
    assert float(slip_time.deviation(pulled_at(1, truth.START_VALUES))) == pytest.approx(1 / 3)


@pytest.mark.parametrize("v", [0.0003, 0.02, 1.0])
@pytest.mark.parametrize("mu_k", [0.0, 0.125, 0.3, 0.45])
def test_stick_formula_is_the_first_load_up_at_any_speed(mu_k: float, v: float) -> None:
    """The exact motion sticks first for mu_s m g/(k v), later for 2 (mu_s - mu_k) m g/(k v)."""
    sticks = stick_time.run({**truth.START_VALUES, "mu_k": mu_k, "v": v})
    assert abs(sticks.first - 1) < 1e-40  # fifty digits less ten for the arcs
    assert float(sticks.in_cycle) == pytest.approx(0.5 / (2 * (0.5 - mu_k)), rel=1e-14)


def test_stick_formula_is_right_by_chance_at_half_the_static_friction() -> None:
    """The formula is right in the cycle at mu_k = mu_s/2 alone: too short below, too long above."""
    curve = drawn(found("stick_time"), 0, "stick in the cycle")
    for ratio, factor in zip(curve.x, curve.y, strict=True):
        assert factor == pytest.approx(1 / (2 * (1 - ratio)), rel=100 * SIX_DIGITS)
        assert (factor > 1) == (ratio > 0.5)


def test_twice_the_gap_makes_between_once_and_twice_the_jump() -> None:
    """The jump grows by (2 l + pi - atan 2 l)/(l + pi - atan l), the relief by exactly 2."""
    p = truth.START_VALUES
    w_gap = (p["mu_s"] - p["mu_k"]) * p["g"] * math.sqrt(p["m"] / 1000.0)
    curve = drawn(found("gap"), 0, "k = 1000 N/m")
    for v, factor in zip(curve.x, curve.y, strict=True):
        lambda_ = 1000 * w_gap / v
        closed = (2 * lambda_ + math.pi - math.atan(2 * lambda_)) / (
            lambda_ + math.pi - math.atan(lambda_)
        )
        assert factor == pytest.approx(closed, rel=SIX_DIGITS)
    relief = formulas.spring_relief(gap.doubled(p)) / formulas.spring_relief(p)
    assert float(relief) == 2.0


def test_twice_the_gap_at_the_ends_of_the_speeds() -> None:
    """Twice the gap is twice the jump for slow pull and hardly any more for fast pull."""
    factors = [float(row[3]) for row in found("gap").rows]
    assert factors == sorted(factors, reverse=True)
    assert float(gap.growth({**truth.START_VALUES, "v": 1e-6})) == pytest.approx(2, abs=1e-4)
    assert float(gap.growth({**truth.START_VALUES, "v": 1e3})) == pytest.approx(1, abs=1e-4)


def critical_lambda(zeta: float) -> float:
    """Return the root of docs/theory.md (13) by bisection in doubles."""
    nu = math.sqrt(1 - zeta**2)
    low, high = 2 * zeta, 1 + math.exp(2 * math.pi * zeta / nu)
    for _ in range(80):
        L = math.sqrt(low * high)
        turn = 2 * math.pi - math.atan2(nu * L, 1 - zeta * L)
        if math.log(1 - 2 * zeta * L + L * L) > 2 * zeta / nu * turn:
            high = L
        else:
            low = L
    return math.sqrt(low * high)


def test_familiar_critical_velocity_is_high_by_what_the_theory_says() -> None:
    """It is 3 % high at zeta = 0.01 and 31 % at 0.1, and high at every damping."""
    p = truth.START_VALUES
    assert round(100 * critical.excess(p, 0.01)) == 3
    assert round(100 * critical.excess(p, 0.1)) == 31
    curve = drawn(found("critical"), 1, "any damped block")
    for zeta, percent in zip(curve.x, curve.y, strict=True):
        closed = 100 * (critical_lambda(zeta) / math.sqrt(4 * math.pi * zeta) - 1)
        # 1e-9 %: the closed form in doubles takes 1 from a number near 1.
        assert percent == pytest.approx(closed, rel=SIX_DIGITS, abs=1e-9)
        assert percent > 0


def test_error_of_the_familiar_critical_velocity_is_first_order() -> None:
    """For light damping its relative error is in proportion to the damping ratio."""
    p = truth.START_VALUES
    # The next order is about sqrt(zeta) of the first, 1e-2 here.
    ratio = critical.excess(p, 1e-4) / critical.excess(p, 1e-5)
    assert float(ratio) == pytest.approx(10, rel=1e-2)


@pytest.mark.parametrize("zeta", [0.01, 0.1, 0.5])
def test_exact_critical_velocity_parts_cycle_from_none(zeta: float) -> None:
    """A thousandth below the exact critical velocity there is a cycle, a thousandth above none."""
    p = truth.START_VALUES
    c = 2 * zeta * math.sqrt(p["k"] * p["m"])
    v_c = float(critical.exact(p, zeta))
    assert truth.steady_cycle({**p, "c": c, "v": 0.999 * v_c}) is not None
    assert truth.steady_cycle({**p, "c": c, "v": 1.001 * v_c}) is None


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__.split(".")[-1])
@pytest.mark.parametrize("nudge", [-1e-12, 1e-12])
def test_figures_lie_far_from_ties(module: ModuleType, nudge: float) -> None:
    """What is written stands a thousand roundings off any change of digit, so machines agree."""
    claim = told(module)
    block = {**claim.parameters, "g": claim.parameters["g"] * (1 + nudge)}
    one, other = found(claim.id), module.examine(replace(claim, parameters=block))
    assert (one.verdict, one.sentence, one.rows) == (other.verdict, other.sentence, other.rows)


def test_threshold_is_where_the_level_is_passed() -> None:
    """A monotone deviation is solved to a double, and one that never gets there is told."""
    assert float(threshold(lambda x: 1 / x, 0.25, 0.1, 100)) == pytest.approx(4, rel=1e-15)
    assert float(threshold(lambda x: x * x, 9, 0.1, 100)) == pytest.approx(3, rel=1e-15)
    with pytest.raises(ValueError, match=r"no deviation of 0\.25 between 0\.1 and 1"):
        threshold(lambda x: 1 / x, 0.25, 0.1, 1)


@pytest.mark.parametrize(
    ("value", "shown"),
    [(14.6512, "14.7"), (0.64401, "0.644"), (9.999, "10.0"), (156.4, "156"), (0.0, "0.00")],
)
def test_figure_shows_three_digits(value: float, shown: str) -> None:
    """A figure has three significant digits at any size, rounded up to a new one where need be."""
    assert figure(value) == shown


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('id = "jump"', 'id = "leap"', "id: 'leap' is not the name of the file"),
        ('title = "The jump"', 'title = ""', "title: a text is wanted"),
        ("mu_s = 0.5", "mu_s = -0.5", "parameters: mu_s = -0.5 is outside mu_s >= 0"),
        ("mu_s = 0.5", "mus = 0.5", "parameters: no parameter named mus"),
        ("mu_s = 0.5", 'mu_s = "0.5"', "parameters.mu_s: '0.5' is not a finite number"),
        ("within =", "inside =", "grid: it holds"),
        ("points = 91", "points = 1", "grid.v: points = 1 is outside points >= 2"),
        ("from = 0.0001", "from = 1.0", "grid.v: 0 < from < to is wanted"),
        ("[0.10, 0.05, 0.01]", "[]", "grid.within: an empty list"),
        ("[grid]", "[grid", "line 13: "),
        ("[grid]", "[grids]", "grids: no such field"),
    ],
)
def test_broken_claim_is_told_with_its_place(
    old: str, new: str, message: str, tmp_path: Path
) -> None:
    """A fault in a claim's file is told with the file, the field and the reason."""
    text = (HERE / "jump.toml").read_text(encoding="utf-8")
    assert old in text
    file = tmp_path / "jump.toml"
    file.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(ClaimError) as caught:
        load_claim(file, jump.GRID)
    assert str(caught.value).startswith(f"{file}: {message}")
