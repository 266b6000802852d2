"""Friction laws of one's own, in reference and truth: what each answer does to the motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from types import SimpleNamespace

import pytest

import stickslip_ref as ref
from stickslip_fmu.laws import named as block
from stickslip_ref import Parameters
from stickslip_verification import truth
from stickslip_verification.truth import Number, Numbers, Series
from tests.facts.closed import MP, Real
from tests.facts.sides import REFERENCE, TRUTH, Row, Setting, Side
from tests.fmu.blocks import Segment


class Wearing(ref.Coulomb):
    """Kinetic friction that falls by 100 N/m along the way; at rest it recovers in 0.1 s."""

    constant_in_slip = False

    def slip_friction(self, p: Parameters, speed: float, state: ref.State = ()) -> float:
        return float(p.mu_k_used * p.N) - 100.0 * state[0]

    def state_start(self, p: Parameters) -> ref.State:
        return (0.0,)

    def state_scale(self, p: Parameters) -> ref.State:
        return (1e-3,)

    def rates(self, p: Parameters, speed: float, state: ref.State) -> ref.State:
        return (speed,)

    def rested(self, p: Parameters, duration: float, state: ref.State) -> ref.State:
        return (state[0] * math.exp(-duration / 0.1),)


class ExactWearing(truth.FrictionLaw):
    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        friction: Series = state[0] * -100 + n.F_k
        return friction

    def state_start(self, n: Numbers) -> tuple[Number, ...]:
        return (0 * n.F_k,)

    def rates(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Sequence[Series]:
        return (speed,)

    def rested(self, n: Numbers, duration: Number, state: tuple[Number, ...]) -> tuple[Number, ...]:
        return (state[0] * MP.exp(-10 * duration),)


class Lagging(ref.FrictionLaw):
    """A drag of 20 N.s/m on a velocity that lags by 1/16 s; the mass never sticks."""

    sticks = False

    def break_away_force(self, p: Parameters, age: float = 0.0, state: ref.State = ()) -> float:
        return 0.0

    def slip_friction(self, p: Parameters, speed: float, state: ref.State = ()) -> float:
        return 20.0 * state[0]

    def state_start(self, p: Parameters) -> ref.State:
        return (0.0,)

    def state_scale(self, p: Parameters) -> ref.State:
        return (0.01,)

    def rates(self, p: Parameters, speed: float, state: ref.State) -> ref.State:
        return ((speed - state[0]) * 16.0,)


class ExactLagging(truth.FrictionLaw):
    sticks = False

    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        return state[0] * 20

    def state_start(self, n: Numbers) -> tuple[Number, ...]:
        return (0 * n.F_k,)

    def rates(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Sequence[Series]:
        return ((speed - state[0]) * 16,)


_WEARING, _EXACT_WEARING, _LAGGING, _EXACT_LAGGING = (
    each() for each in (Wearing, ExactWearing, Lagging, ExactLagging)
)
WEARING = SimpleNamespace(reference=f"{__name__}:_WEARING", truth=f"{__name__}:_EXACT_WEARING")
LAGGING = SimpleNamespace(reference=f"{__name__}:_LAGGING", truth=f"{__name__}:_EXACT_LAGGING")
NO_LAW = SimpleNamespace(block="math:pi", reference="math:pi", truth="math:pi")
NAMESAKE = SimpleNamespace(block="stickslip_fmu.laws.coulomb.law:COULOMB")
SIDES = pytest.mark.parametrize(
    ("side", "error"), [(REFERENCE, 1e-11), (TRUTH, 1e-40)], ids=["reference", "truth"]
)
"""What runs a law, and its relative error: of an integration, of 50 digits."""


def rows(side: Side, law: str, steps: Sequence[float], **values: float) -> Sequence[Row]:
    return side.rows(Setting(values, [Segment(h) for h in steps], f"{__name__}:{law}"))


def close(one: Real, other: Real, tolerance: float) -> bool:
    return bool(abs(one - other) <= tolerance * abs(other))


@SIDES
def test_own_state_follows_slip_and_recovers_at_rest(side: Side, error: float) -> None:
    early, now = rows(side, "WEARING", [0.28125, 0.03125])
    # m y_ddot = gap + k v t - (k - loss) y for the way y since break-away.
    N, v = MP.mpf(9.81), MP.mpf(0.02)
    gap = (MP.mpf(0.5) - MP.mpf(0.3)) * N
    w = MP.sqrt(900)
    for row, time in ((early, 0.28125), (now, 0.3125)):
        t = time - MP.mpf(0.5) * N / (1000 * v)
        y = (gap * (1 - MP.cos(w * t)) + 1000 * v * (t - MP.sin(w * t) / w)) / 900
        # The slip is young: its way goes with the square of its age.
        assert close(row["x"], y, 30 * error)
        assert close(row["F_friction"], 100 * y - MP.mpf(0.3) * N, 30 * error)
    (third,) = rows(side, "WEARING", [0.625])
    left = 100 * third["delta_x"] * MP.exp(-10 * third["t_stick"])
    (after,) = rows(side, "WEARING", [float(third["t_event"]) + 2.0**-40])
    assert left > 0.02
    # In 2^-40 s the mass moves by less than 1e-24 m.
    assert close(after["F_friction"], left - MP.mpf(0.3) * N, max(error, 1e-20))


@SIDES
def test_a_law_without_a_stick_is_followed_whole(side: Side, error: float) -> None:
    found = rows(side, "LAGGING", [0.0625] * 16, x_dot_start=-0.0625, F_ext=1.0)
    system = MP.matrix([[0, -1, 0, MP.mpf(0.02)], [1000, 0, -20, 1], [0, 16, -16, 0], [0, 0, 0, 0]])
    for n, row in enumerate(found, 1):
        time = MP.mpf(n) / 16
        z, x_dot, lagged, _ = MP.expm(system * time) * MP.matrix([0, MP.mpf(-0.0625), 0, 1])
        # Against the amplitudes of a motion that passes zero.
        assert abs(row["z"] - z) <= 0.01 * error
        assert abs(row["x_dot"] - x_dot) <= 10 * error
        assert abs(row["F_friction"] + 20 * lagged) <= 10 * error
        assert row["mode"] == MP.sign(x_dot)
        # The meter reads the extremes of the spring, where the mass is as fast as the pull.
        reached = MP.expm(system * row["t_event"]) * MP.matrix([0, MP.mpf(-0.0625), 0, 1])
        assert abs(reached[1] - MP.mpf(0.02)) <= 10 * error
    assert {row["mode"] for row in found} == {-1, 1}


FINDERS: dict[str, Callable[[str], object]] = {
    "block": block.friction_law,
    "reference": ref.friction_law,
    "truth": truth.friction_law,
}


@pytest.mark.parametrize("side", FINDERS)
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("falling", "'falling' is no friction law: 'coulomb', 'stribeck', .*module:NAME"),
        ("no_such_module:LAW", r"'no_such_module:LAW' was not found \(No module named"),
        ("math:LAW", r"'math:LAW' was not found \(module 'math' has no attribute 'LAW'\)"),
        ("math:pi", "'math:pi' has no attribute '{side}'"),
        (f"{__name__}:NO_LAW", "'math:pi' is a float; the .* friction law"),
    ],
)
def test_a_name_that_leads_to_no_law_is_refused_with_an_example(
    side: str, name: str, words: str
) -> None:
    with pytest.raises(ValueError, match=words.replace("{side}", side)):
        FINDERS[side](name)
