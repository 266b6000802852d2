"""The truth's march by Taylor series, and what a friction law of the truth brings to it.

The march is held against closed forms: Coulomb's, which the truth solves in another way, and those
of other laws, derived here. Fifty digits are promised. A tolerance of 1e-45 leaves five for what a
shallow end of a slip amplifies; where the end is shallower, the tolerance says so.
"""

import random
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import pytest

from stickslip_verification import truth
from stickslip_verification.truth import (
    Coulomb,
    FrictionLaw,
    Kind,
    Number,
    Numbers,
    Parameter,
    Series,
    Step,
)
from stickslip_verification.truth.parameters import high_precision
from stickslip_verification.truth.zeros import polynomial_zeros
from tests.verification.test_truth_against_taylor import _draw

MP = high_precision(50)
TOLERANCE = MP.mpf("1e-45")

Real = Any


NO_LAW = SimpleNamespace(truth="math:pi")
"""A record that leads to no friction law."""


class _Marched(FrictionLaw):
    """Coulomb's law, told as a general one."""

    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        return Series(speed.context, [n.F_k])


class _Stribeck(FrictionLaw):
    """Kinetic friction from mu_s N at rest down to mu_k N, by an exponential of speed/v_s."""

    parameters = (Parameter("v_s", "m/s", 0.05, Kind.TUNABLE, low=0.0, strict=True),)

    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        friction: Series = (speed / -n.own["v_s"]).exp() * n.gap + n.F_k
        return friction


class _Quadratic(FrictionLaw):
    """Kinetic friction mu_k N plus a drag of 2 kg/m times the square of the speed."""

    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        friction: Series = speed**2 * 2 + n.F_k
        return friction


class _Ageing(Coulomb):
    """Static friction mu_s N plus 0.5 N times ln(1 + age/0.01 s)."""

    def ages(self, n: Numbers) -> bool:
        return True

    def hold(self, n: Numbers, age: Series, state: Sequence[Number]) -> Series:
        hold: Series = (age * 100 + 1).log() / 2 + n.F_s
        return hold

    def gap(self, n: Numbers, hold: Number, sliding: Number) -> Number:
        return hold - sliding


class _Wearing(FrictionLaw):
    """Kinetic friction that falls by 100 N/m along the way; the way is forgotten in 0.1 s."""

    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        friction: Series = state[0] * -100 + n.F_k
        return friction

    def state_start(self, n: Numbers) -> tuple[Number, ...]:
        return (0 * n.F_k,)

    def rates(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Sequence[Series]:
        return (speed,)

    def rested(self, n: Numbers, duration: Number, state: tuple[Number, ...]) -> tuple[Number, ...]:
        return (state[0] * MP.exp(-10 * duration),)


class _Lagging(FrictionLaw):
    """A drag of 20 N.s/m on a velocity that lags by 1/16 s; the mass never sticks."""

    sticks = False

    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        return state[0] * 20

    def state_start(self, n: Numbers) -> tuple[Number, ...]:
        return (0 * n.F_k,)

    def rates(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Sequence[Series]:
        return ((speed - state[0]) * 16,)


def _assert_equal(one: truth.Run, other: truth.Run, tolerance: Real = TOLERANCE) -> None:
    """Assert equal events, and equal outputs to the tolerance of the scale of their kind."""
    assert [(e.kind, e.mode) for e in one.events] == [(e.kind, e.mode) for e in other.events]
    for name in one.initial:
        alike = ("x", "x_pull", "z") if name in ("x", "x_pull", "z") else (name,)
        largest = max(abs(sample[each]) for sample in one.samples for each in alike)
        for a, b in zip(one.samples, other.samples, strict=True):
            assert abs(a[name] - b[name]) <= tolerance * largest, (name, a[name], b[name])


@pytest.mark.parametrize("seed", range(16))
def test_march_is_the_closed_form_on_any_sequence(seed: int) -> None:
    """Damping under and over the critical, changes of everything, reversals: 45 digits."""
    values, steps = _draw(random.Random(1000 + seed))
    _assert_equal(truth.run(values, steps), truth.run(values, steps, law=_Marched()))


def _lambda(value: float) -> dict[str, float]:
    """Return the coefficients of an undamped cycle of this lambda at the default k, m, v."""
    return {"mu_k": 0.3, "mu_s": 0.3 + value * 0.02 * 1000.0**0.5 / 9.81}


@pytest.mark.parametrize(
    ("values", "tolerance"),
    [
        ({}, "1e-45"),
        # t_stick is known to the working precision (1e-70) over lambda^2.
        (_lambda(1e-3), "1e-45"),
        (_lambda(1e-7), "1e-45"),
        (_lambda(1e-9), "1e-45"),
        ({"mu_s": 0.3, "mu_k": 0.3}, "1e-45"),
        ({"mu_s": 0.3, "mu_k": 0.3, "c": 1.0}, "1e-45"),
        ({"mu_s": 0.0, "mu_k": 0.0}, "1e-45"),
        ({"mu_k": 0.0, "F_ext": 3.0}, "1e-45"),
        ({"load": -9.81}, "1e-45"),
        ({"v": 0.0, "x_dot_start": 3.0, "mu_s": 0.1, "mu_k": 0.05}, "1e-45"),
        ({"v": -0.02, "x_dot_start": 0.3}, "1e-45"),
        # Critical damping exactly, m = 1, k = 1024, c = 64.
        ({"k": 1024.0, "c": 64.0, "z_start": 0.02}, "1e-45"),
        ({"k": 1024.0, "c": 64.0, "v": 0.0, "x_dot_start": 1.0}, "1e-45"),
        ({"v": 0.0, "x_dot_start": 3.0, "c": 1000.0}, "1e-45"),
    ],
)
def test_march_is_the_closed_form_at_the_corners(
    values: Mapping[str, float], tolerance: str
) -> None:
    """Shallow and grazing ends, no gap, no friction, critical damping, a mass that creeps."""
    steps = [Step(0.37)] * 4
    one, other = truth.run(values, steps), truth.run(values, steps, law=_Marched())
    _assert_equal(one, other, MP.mpf(tolerance))


@pytest.mark.parametrize("distance", [1e-3, 1e-6, 1e-9, -1e-9, -1e-6, -1e-3])
def test_march_knows_on_which_side_of_lambda_c_it_is(distance: float) -> None:
    """Within 1e-9 of lambda_c the least speed of a slip is 1e-10 of v; no stop is lost or made."""
    w = MP.sqrt(1000)
    Delta = (MP.mpf(0.5) - MP.mpf(0.3)) * MP.mpf(9.81) / 1000
    c = 2 * 0.1 * float(w)
    critical = truth.critical_lambda(MP.mpf(c) / (2 * w))
    values = {"c": c, "v": float(w * Delta / (critical * (1 + MP.mpf(distance))))}
    steps = [Step(0.25)] * 4
    one, other = truth.run(values, steps), truth.run(values, steps, law=_Marched())
    assert any(event.kind == "re-stick" for event in one.events) == (distance > 0)
    _assert_equal(one, other)


def test_quadratic_drag_against_its_closed_form() -> None:
    """With v = 0 the square of the speed is linear in itself along the way: y' = a - b x - d y.

    m y'/2 = k (z_start - x) - mu_k N - q y with y = x_dot^2 gives, d = 2 q/m, b = 2 k/m,
    a = 2 (k z_start - mu_k N)/m, y = (a + b/d)/d (1 - exp(-d x)) - b x/d.
    """
    values = {"v": 0.0, "z_start": 0.03125, "mu_k": 0.25}
    run = truth.run(values, [Step(0.0625), Step(1.0)], law=_Quadratic())
    N, k, q = MP.mpf(9.81), MP.mpf(1000), MP.mpf(2)
    d, b, a = 2 * q, 2 * k, 2 * (k * MP.mpf(0.03125) - N / 4)

    def square(x: Real) -> Real:
        return (a + b / d) / d * (1 - MP.exp(-d * x)) - b * x / d

    first = run.samples[0]
    assert first["mode"] == 1
    assert abs(first["x_dot"] ** 2 / square(first["x"]) - 1) < TOLERANCE
    stop = MP.findroot(square, (MP.mpf("0.04"), MP.mpf("0.07")), solver="anderson")
    assert abs(run.events[1].x / stop - 1) < TOLERANCE
    top = MP.findroot(
        lambda x: (a + b / d) * MP.exp(-d * x) - b / d, (MP.zero, stop), solver="anderson"
    )
    peak = truth.run(values, [Step(float(run.events[1].time) + 1e-9)], law=_Quadratic())
    assert abs(peak.samples[0]["x_dot_peak"] ** 2 / square(top) - 1) < TOLERANCE


def test_stribeck_march_agrees_with_itself_in_more_digits() -> None:
    """The digits of a run are those of one in more digits, whose pieces are others."""
    values = {"v_s": 0.01, "c": 2.0}
    steps = [Step(0.3), Step(0.2, {"v": 0.04, "F_ext": 1.0}), Step(0.3, {"v_s": 0.1, "k": 700.0})]
    few = truth.run(values, steps, digits=25, law=_Stribeck())
    many = truth.run(values, steps, digits=45, law=_Stribeck())
    assert len(few.events) > 4
    _assert_equal(few, many, MP.mpf("1e-24"))


def test_energy_of_a_stribeck_run_balances() -> None:
    """W_pull + W_k + work of F_ext - Q is the change of the stored energy, to 45 digits."""
    steps = [Step(0.3), Step(0.21, {"k": 700.0}), Step(0.4, {"v": -0.03})]
    run = truth.run({"F_ext": 0.5, "x_dot_start": 0.1}, steps, law=_Stribeck())
    for sample, k in zip(run.samples, (1000, 700, 700), strict=True):
        stored = (k * sample["z"] ** 2 + sample["x_dot"] ** 2 - MP.mpf(0.1) ** 2) / 2
        given = sample["W_pull"] + sample["W_k"] + sample["x"] / 2 - sample["Q_friction"]
        assert abs(given - stored) < TOLERANCE * sample["Q_friction"]


def test_a_stick_lasts_until_the_pull_has_outrun_the_age() -> None:
    """At break-away k z is the static friction at that age, of a first and of a later stick."""
    run = truth.run({"v": 0.01}, [Step(0.1), Step(0.2, {"c": 0.1}), Step(2.4)], law=_Ageing())
    sticks = [(None, run.events[0]), (run.events[1], run.events[2])]
    for begin, end in sticks:
        age = end.time - (begin.time if begin else 0)
        F_s = MP.mpf(0.5) * MP.mpf(9.81) + MP.log(1 + 100 * age) / 2
        assert end.kind == "break-away"
        assert abs(1000 * end.z / F_s - 1) < TOLERANCE
        assert end.mode == 1
    held = truth.run({"v": 0.01}, [Step(0.25)], law=_Ageing()).samples[0]
    F_s = MP.mpf(0.5) * MP.mpf(9.81) + MP.log(26) / 2
    assert abs(held["F_s"] / F_s - 1) < TOLERANCE


def test_own_state_follows_slip_and_stick() -> None:
    """Friction that falls along the way softens the spring; at rest the law's state recovers."""
    run = truth.run({}, [Step(0.3)], law=_Wearing())
    t = run.times[0] - run.events[0].time
    gap = (MP.mpf(0.5) - MP.mpf(0.3)) * MP.mpf(9.81)
    softened = MP.mpf(900)
    w = MP.sqrt(softened)
    v = MP.mpf(0.02)
    way = (gap * (1 - MP.cos(w * t)) + 1000 * v * (t - MP.sin(w * t) / w)) / softened
    assert abs(run.samples[0]["x"] / way - 1) < TOLERANCE
    friction = MP.mpf(0.3) * MP.mpf(9.81) - 100 * way
    assert abs(run.samples[0]["F_friction"] / friction + 1) < TOLERANCE
    later = truth.run({}, [Step(0.7)], law=_Wearing())
    first, stop, second = later.events[:3]
    after = truth.run({}, [Step(float(second.time) + 2.0**-40)], law=_Wearing()).samples[0]
    left = 100 * (stop.x - first.x) * MP.exp(-10 * (second.time - stop.time))
    assert left > 0.02
    # In 2^-40 s the mass moves by less than 1e-24 m.
    assert abs(after["F_friction"] + MP.mpf(0.3) * MP.mpf(9.81) - left) < 1e-20


def test_a_law_without_a_stick_is_marched_whole() -> None:
    """A linear drag with a lag is a linear system; the velocity changes its sign in it."""
    steps = [Step(0.125)] * 4 + [Step(0.125, {"F_ext": 1.0}), Step(0.5)]
    run = truth.run({"x_dot_start": -0.0625}, steps, law=_Lagging())
    state = MP.matrix([0, MP.mpf(-0.0625), 0, 1])
    signs = set()
    for step, sample, number in zip(steps, run.samples, range(6), strict=True):
        F_ext = 1 if number >= 4 else 0
        system = MP.matrix(
            [[0, -1, 0, MP.mpf(0.02)], [1000, 0, -20, F_ext], [0, 16, -16, 0], [0, 0, 0, 0]]
        )
        state = MP.expm(system * step.h) * state
        for name, value in (("z", state[0]), ("x_dot", state[1]), ("F_friction", -20 * state[2])):
            assert abs(sample[name] - value) < TOLERANCE
        signs.add(sample["mode"])
    assert signs == {-1, 1}
    assert not run.events


@pytest.mark.parametrize(
    "roots", [[], [0.6], [0.3, 0.300001], [0.1, 0.2, 0.3, 0.4, 0.6], [0.999], [0.6, 1.5]]
)
def test_zeros_of_a_polynomial_are_isolated(roots: Sequence[float]) -> None:
    """Every zero in (0, 1) is found, close pairs too, and none outside."""
    terms = [MP.one]
    for root in roots:
        terms = [
            -MP.mpf(root) * a + b for a, b in zip([*terms, MP.zero], [MP.zero, *terms], strict=True)
        ]
    # Two complex zeros close to the axis do not count.
    factor = [MP.mpf("0.7") ** 2 + MP.mpf("1e-20"), MP.mpf("-1.4"), MP.one]
    product = (Series(MP, terms) * Series(MP, factor)).term
    found = polynomial_zeros(MP, [product(n) for n in range(len(terms) + 2)], MP.one)
    inside = [MP.mpf(root) for root in roots if root < 1]
    assert len(found) == len(inside)
    assert all(abs(a - b) < TOLERANCE for a, b in zip(found, inside, strict=True))


def test_series_arithmetic_is_that_of_the_functions() -> None:
    """Coefficients of an expression with every operation are its derivatives over n!."""

    def function(x: Any) -> Any:
        exp = x.exp() if isinstance(x, Series) else MP.exp(x)
        inner = 3 - x * x / 4
        log = inner.log() if isinstance(x, Series) else MP.log(inner)
        return (2 / (1 + exp) - log * x) / (x + 5) ** MP.mpf("1.5") + (-x) ** 3

    series = function(Series.variable(MP, MP.mpf("0.7")))
    expected = MP.taylor(function, MP.mpf("0.7"), 12)
    for n, value in enumerate(expected):
        # mpmath differentiates numerically, at a precision that it raises itself.
        assert abs(series.term(n) - value) < MP.mpf("1e-40")


@pytest.mark.parametrize("make", [lambda x: x.log(), lambda x: x**0.5, lambda x: 1 / x])
def test_what_has_no_taylor_series_is_refused(make: Any) -> None:
    """A logarithm, root or quotient at zero is no analytic function of speed."""
    with pytest.raises(ValueError, match="no Taylor series at the value 0"):
        make(Series.variable(MP, MP.zero))


def test_a_friction_with_a_kink_is_refused() -> None:
    """The equation of motion is checked at every piece's end with the law's own value there."""

    class Kinked(FrictionLaw):
        def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
            friction: Series = speed * (5 if speed.term(0) < 0.01 else 2) + n.F_k
            return friction

    with pytest.raises(ValueError, match="no analytic function of speed near"):
        truth.run({}, [Step(0.5)], law=Kinked())


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"v_s": 0.0}, r"v_s = 0.0 is outside v_s > 0"),
        ({"v_s": float("nan")}, r"v_s = nan is not a finite number"),
        ({"slope": 1.0}, r"no parameter named slope; there are .*'z_start', 'v_s'"),
    ],
)
def test_own_parameters_are_rows_like_the_others(
    parameters: Mapping[str, float], message: str
) -> None:
    """An unknown name and a value out of range are told as those of the twelve."""
    with pytest.raises(ValueError, match=message):
        truth.run(parameters, [Step(0.1)], law=_Stribeck())


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("falling", r"'falling' is no friction law: 'coulomb', 'stribeck', or module:NAME such as"),
        ("no_such_module:LAW", r"'no_such_module:LAW' was not found \(No module named"),
        ("math:LAW", r"'math:LAW' was not found \(module 'math' has no attribute 'LAW'\)"),
        ("math:pi", r"'math:pi' has no attribute 'truth'"),
        (f"{__name__}:NO_LAW", r"'math:pi' is a float; the .* an object of a subclass of"),
    ],
)
def test_a_law_that_is_not_found_is_told_with_an_example(name: str, message: str) -> None:
    """The error for a dotted name says what was wrong and shows a good one."""
    with pytest.raises(ValueError, match=message):
        truth.run({}, [Step(0.1)], law=name)


def test_coulombs_law_has_a_name_too() -> None:
    """The law that comes along is called coulomb."""
    assert truth.friction_law("coulomb") is truth.COULOMB
