"""The time of break-away under growing static friction, as a root: found, exact, and soon."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator
from typing import Any

import mpmath
import pytest

from stickslip_fmu.laws.coulomb.dwell import Dwell, load_up

from .blocks import log_uniform

# A halving for each bit of a double, and some steps before.
MOST_STEPS = 64


class Counted(Dwell):
    """A growth that counts how often Newton's method asks for a tangent."""

    __slots__ = ("count",)

    def __init__(self, *values: float) -> None:
        super().__init__(*values)
        self.count = 0

    def tangent(self, age: float) -> tuple[float, float]:
        """Return the tangent, and count."""
        self.count += 1
        return super().tangent(age)


@pytest.fixture(autouse=True)
def _high_precision() -> Iterator[None]:
    # Newton's steps of the exact root start up to 1e300 times beyond it.
    with mpmath.workdps(330):
        yield


def random_load_up(generator: random.Random) -> tuple[float, float, Counted] | None:
    """Draw reach, pull and growth; near the pull at which the stick vanishes in half of them."""

    def some(low: float, high: float) -> float:
        extreme = generator.random() < 0.2
        return log_uniform(generator, *((1e-290, 1e290) if extreme else (low, high)))

    tau_s, t_0 = some(1e-6, 1e6), some(1e-6, 1e6)
    rise = generator.choice([0.0, 1.0, log_uniform(generator, 1e-12, 1e6)])
    strength = generator.choice([0.0, 0.1, log_uniform(generator, 1e-12, 1e6)])
    reach = generator.choice([0.0, 1e-5, some(1e-20, 1e3)])
    pull = log_uniform(generator, 1e-6, 1e6)
    if generator.random() < 0.5:
        off = generator.choice([-1.0, 1.0]) * log_uniform(generator, 1e-16, 1.0)
        pull = (rise / tau_s + generator.choice([0.0, strength / t_0])) * (1.0 + off)
    if not (rise + strength > 0.0 and 1e-250 < pull < 1e250):
        return None
    return reach, pull, Counted(rise, tau_s, strength, t_0)


def exact(reach: float, pull: float, dwell: Dwell) -> tuple[Any, Any]:
    """Return the root, and the rate at which the pull passes the growth there, by the pull."""
    a, v = mpmath.mpf(reach), mpmath.mpf(pull)
    rise, tau_s = mpmath.mpf(dwell.rise), mpmath.mpf(dwell.tau_s)
    strength, t_0 = mpmath.mpf(dwell.strength), mpmath.mpf(dwell.t_0)

    def lack(t: Any) -> Any:
        return a - rise * mpmath.expm1(-t / tau_s) + strength * mpmath.log1p(t / t_0) - v * t

    def slope(t: Any) -> Any:
        return rise / tau_s * mpmath.exp(-t / tau_s) + strength / (t_0 + t) - v

    if a == 0 and slope(mpmath.mpf(0)) <= 0:
        return mpmath.mpf(0), -slope(mpmath.mpf(0)) / v
    guess = (a + rise + strength) / v + strength / v * 2000
    while True:
        following = guess - lack(guess) / slope(guess)
        if not following < guess * (1 - mpmath.mpf(10) ** -30):
            return guess, -slope(guess) / v
        guess = following


def test_the_root_is_exact_wherever_it_lies(sized: Callable[[int], int]) -> None:
    """Its relative error is rounding, times the pull by the rate at which it passes the growth."""
    generator = random.Random(65)
    seen = 0
    while seen < sized(2_000):
        drawn = random_load_up(generator)
        if drawn is None:
            continue
        found = load_up(*drawn)
        root, passing = exact(*drawn)
        assert drawn[2].count <= MOST_STEPS
        assert found >= 0.0
        if not 1e-280 < root < 1e280:
            continue
        seen += 1
        # Beside a double root the data decide: 4 roundings of pull or rate are its whole value.
        assert abs(mpmath.mpf(found) - root) <= 1e-15 * root / max(passing, mpmath.mpf(1e-15))


def test_a_double_root_at_the_start_is_no_stick() -> None:
    """A pull just as fast as the growth at the start, or faster, breaks away at once."""
    for pull in (2.0, math.nextafter(2.0, 3.0), 1e9):
        assert load_up(0.0, pull, Dwell(1.0, 1.0, 0.5, 0.5)) == 0.0
    assert load_up(0.0, 1.999, Dwell(1.0, 1.0, 0.5, 0.5)) > 0.0


def test_the_slowest_roots_need_a_bounded_number_of_steps() -> None:
    """Towards the double root each step only halves the way, so 64 are enough for all digits."""
    for ulps in range(-40, 40):
        for dwell in (Counted(1.0, 1.0, 0.0, 1.0), Counted(0.0, 0.0, 1.0, 1.0)):
            assert load_up(0.0, 1.0 + ulps * 2.0**-52, dwell) >= 0.0
            assert dwell.count <= MOST_STEPS
    for power in range(-320, 0):
        for dwell in (Counted(1.0, 0.7, 0.0, 1.0), Counted(0.0, 0.0, 1.0, 0.7)):
            assert load_up(10.0**power, 1.0 / 0.7, dwell) > 0.0
            assert dwell.count <= MOST_STEPS


def test_without_growth_left_it_is_the_plain_load_up() -> None:
    """A stick so old that nothing grows any more breaks away after reach/pull."""
    old = Dwell(1.0, 0.1, 0.0, 1.0).extension(1e6, 1.0)
    assert load_up(0.3, 0.7, old) == 0.3 / 0.7


def test_a_pull_too_slow_for_any_time_never_breaks_away() -> None:
    """Where the time is beyond all numbers the stick has no end."""
    assert load_up(1.0, 5e-324, Dwell(0.0, 0.0, 1.0, 1.0)) == math.inf
    assert load_up(1.0, 1e-310, Dwell(1.0, 1.0, 0.0, 1.0)) == math.inf
