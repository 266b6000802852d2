"""Closed forms of the model, in high precision, each under its equation number of docs/theory.md.

Every function takes all twelve values at the start of a case (SI units, as `complete` in
`truth.parameters` gives them) and gives an mpmath number. They are written from the derivation
and share nothing with the block or the reference. `|v|` gives durations, the sign of `v` gives
directions.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from mpmath import mp, mpf

from stickslip_verification import truth

DIGITS = 50
"""Working precision of every formula; far beyond what a double can tell apart."""

Parameters = Mapping[str, float]
Number = Any
"""An mpmath number; mpmath carries no type information."""


def _precise(formula: Callable[[Parameters], Number]) -> Callable[[Parameters], Number]:
    def evaluate(p: Parameters) -> Number:
        with mp.workdps(DIGITS):
            return +formula(p)

    evaluate.__doc__ = formula.__doc__
    evaluate.__name__ = formula.__name__
    return evaluate


def _sign(value: float) -> int:
    return (value > 0) - (value < 0)


def _normal_force(p: Parameters) -> Number:
    return mpf(p["m"]) * mpf(p["g"]) + mpf(p["load"])


def _w(p: Parameters) -> Number:
    return mp.sqrt(mpf(p["k"]) / mpf(p["m"]))


def _gap(p: Parameters) -> Number:
    return (mpf(p["mu_s"]) - mpf(p["mu_k"])) * _normal_force(p) / mpf(p["k"])


def _lambda(p: Parameters) -> Number:
    return _w(p) * _gap(p) / abs(mpf(p["v"]))


@_precise
def break_away_force(p: Parameters) -> Number:
    """``F_s = mu_s N`` [N]; equation (6)."""
    return mpf(p["mu_s"]) * _normal_force(p)


@_precise
def first_load_up(p: Parameters) -> Number:
    """Stick time of a spring that starts relaxed, ``mu_s N/(k |v|)`` [s]; equation (6)."""
    return mpf(p["mu_s"]) * _normal_force(p) / (mpf(p["k"]) * abs(mpf(p["v"])))


@_precise
def spring_relief(p: Parameters) -> Number:
    """Fall of the spring in a slip, ``2 Delta`` with the sign of v [m]; equation (7)."""
    return 2 * _gap(p) * _sign(p["v"])


@_precise
def t_slip(p: Parameters) -> Number:
    """Slip time ``(2/w)(pi - atan lambda)`` [s]; equation (8)."""
    return 2 * (mp.pi - mp.atan(_lambda(p))) / _w(p)


@_precise
def t_stick(p: Parameters) -> Number:
    """Stick time of the steady cycle, ``2 Delta/|v|`` [s]; equation (9)."""
    return 2 * _gap(p) / abs(mpf(p["v"]))


@_precise
def delta_x(p: Parameters) -> Number:
    """Jump of the mass, ``2 Delta + v t_slip`` with the sign of v [m]; equation (10)."""
    return spring_relief(p) + mpf(p["v"]) * t_slip(p)


@_precise
def period(p: Parameters) -> Number:
    """Period ``T = t_stick + t_slip`` [s]; equation (10)."""
    return t_stick(p) + t_slip(p)


@_precise
def frequency(p: Parameters) -> Number:
    """Frequency ``1/T`` [Hz]; equation (10)."""
    return 1 / period(p)


@_precise
def peak_velocity(p: Parameters) -> Number:
    """Peak velocity ``v (1 + sqrt(1 + lambda^2))`` [m/s]; equation (11)."""
    return mpf(p["v"]) * (1 + mp.sqrt(1 + _lambda(p) ** 2))


@_precise
def half_period(p: Parameters) -> Number:
    """Half a period of the free oscillation, ``pi/w`` [s]; equation (12)."""
    return mp.pi / _w(p)


@_precise
def slip_travel_of_the_end(p: Parameters) -> Number:
    """``v t_slip`` [m]: what the simplified jump leaves out; equation (12)."""
    return mpf(p["v"]) * t_slip(p)


@_precise
def slow_slip_excess(p: Parameters) -> Number:
    """``t_slip - pi/w`` for v -> 0 at first order, ``2/(w lambda)`` [s]; equation (12)."""
    return 2 / (_w(p) * _lambda(p))


@_precise
def fast_slip_deficit(p: Parameters) -> Number:
    """``2 pi/w - t_slip`` for v -> infinity at first order, ``2 lambda/w`` [s]; equation (12)."""
    return 2 * _lambda(p) / _w(p)


@_precise
def load_up_over_stick(p: Parameters) -> Number:
    """Simplified stick time over the real one, ``mu_s/(2 (mu_s - mu_k))``; equation (12)."""
    return mpf(p["mu_s"]) / (2 * (mpf(p["mu_s"]) - mpf(p["mu_k"])))


@_precise
def sliding_extension(p: Parameters) -> Number:
    """Spring extension in steady sliding, ``(s mu_k N - F_ext + c v)/k`` [m]; equation (3)."""
    drag = _sign(p["v"]) * mpf(p["mu_k"]) * _normal_force(p)
    return (drag - mpf(p["F_ext"]) + mpf(p["c"]) * mpf(p["v"])) / mpf(p["k"])


@_precise
def pulling_velocity(p: Parameters) -> Number:
    """Velocity of the mass in steady sliding, v [m/s]; equation (3)."""
    return mpf(p["v"])


@_precise
def sliding_friction(p: Parameters) -> Number:
    """Dry friction while slipping, ``mu_k N`` [N]: heat per travel at c = 0; equation (15)."""
    return mpf(p["mu_k"]) * _normal_force(p)


@_precise
def nothing(p: Parameters) -> Number:
    """Zero: where the meter's rules make two outputs equal; equation (16)."""
    return mpf(0)


def _damped(name: str) -> Callable[[Parameters], Number]:
    def of_cycle(p: Parameters) -> Number:
        cycle = truth.steady_cycle(p, digits=DIGITS)
        if cycle is None:
            raise ValueError("no steady cycle exists at these parameters")
        return cycle[name]

    of_cycle.__doc__ = f"``{name}`` of the steady cycle with damping; equation (13)."
    return of_cycle


@dataclass(frozen=True)
class Formula:
    """A named closed form.

    Attributes
    ----------
    unit, equation
        Its unit and its equation number in docs/theory.md.
    evaluate
        From all twelve values at the start to its value.
    sensitivity
        Power of 1/lambda by which an error of the state enters an integration, (17); None where
        it is not of that kind.
    """

    unit: str
    equation: int
    evaluate: Callable[[Parameters], Number]
    sensitivity: int | None = None


FORMULAS: dict[str, Formula] = {
    "break_away_force": Formula("N", 6, break_away_force),
    "first_load_up": Formula("s", 6, first_load_up, 0),
    "spring_relief": Formula("m", 7, spring_relief, 2),
    "t_slip": Formula("s", 8, t_slip, 1),
    "t_stick": Formula("s", 9, t_stick, 2),
    "delta_x": Formula("m", 10, delta_x, 0),
    "period": Formula("s", 10, period, 0),
    "frequency": Formula("Hz", 10, frequency, 0),
    "peak_velocity": Formula("m/s", 11, peak_velocity, 0),
    "slip_travel_of_the_end": Formula("m", 12, slip_travel_of_the_end),
    "half_period": Formula("s", 12, half_period),
    "slow_slip_excess": Formula("s", 12, slow_slip_excess),
    "fast_slip_deficit": Formula("s", 12, fast_slip_deficit),
    "load_up_over_stick": Formula("1", 12, load_up_over_stick, 2),
    "sliding_extension": Formula("m", 3, sliding_extension),
    "pulling_velocity": Formula("m/s", 3, pulling_velocity),
    "sliding_friction": Formula("N", 15, sliding_friction),
    "equal_by_the_meter": Formula("s", 16, nothing),
    "damped_t_slip": Formula("s", 13, _damped("t_slip"), 1),
    "damped_t_stick": Formula("s", 13, _damped("t_stick"), 2),
    "damped_spring_drop": Formula("m", 13, _damped("spring_drop"), 2),
    "damped_delta_x": Formula("m", 13, _damped("delta_x"), 0),
    "damped_period": Formula("s", 13, _damped("T"), 0),
}
"""What a check can name as ``formula``."""

CYCLE: Mapping[str, tuple[str, str | None]] = {
    "t_stick": ("t_stick", "damped_t_stick"),
    "t_slip": ("t_slip", "damped_t_slip"),
    "T": ("period", "damped_period"),
    "f": ("frequency", None),
    "delta_x": ("delta_x", "damped_delta_x"),
    "spring_drop": ("spring_relief", "damped_spring_drop"),
    "x_dot_peak": ("peak_velocity", None),
}
"""Formula of each output in the steady cycle, without and with damping."""
