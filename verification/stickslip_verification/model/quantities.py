"""What a check can look at, and closed forms to hold it against.

A formula takes all twelve values at the start of a case (SI units, as `complete` in
`truth.parameters` gives them) and gives an mpmath number, under its equation number of
docs/theory.md. They are written from the derivation and share nothing with the block or the
reference. `|v|` gives durations, the sign of `v` gives directions.

The outputs are the suite's own list, not a copy handed over by a side, so that a side with a
missing output or another unit is seen.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpmath import mp, mpf

from .. import truth
from .verdict import Series

DIGITS = 50  # working precision of every formula; far beyond what a double can tell apart

Parameters = Mapping[str, float]
Number = Any  # an mpmath number; mpmath carries no type information


class _Symbols:
    def __init__(self, p: Parameters) -> None:
        self.p = p

    def __getattr__(self, name: str) -> Number:
        return mpf(self.p[name])

    @property
    def sign(self) -> int:
        return (self.p["v"] > 0) - (self.p["v"] < 0)

    @property
    def normal(self) -> Number:
        return self.m * self.g + self.load

    @property
    def w(self) -> Number:
        return mp.sqrt(self.k / self.m)

    @property
    def gap(self) -> Number:
        return (self.mu_s - self.mu_k) * self.normal / self.k

    @property
    def lambda_(self) -> Number:
        return self.w * self.gap / abs(self.v)


@dataclass(frozen=True)
class Formula:
    """A closed form, ``of`` symbols, called with all twelve values at the start.

    ``equation`` is its number in docs/theory.md. ``sensitivity`` is the power of 1/lambda by which
    an error of the state enters an integration, (17); None where it is not of that kind.
    """

    unit: str
    equation: int
    of: Callable[[_Symbols], Number]
    sensitivity: int | None = None

    def __call__(self, p: Parameters) -> Number:
        """Return its value in high precision."""
        with mp.workdps(DIGITS):
            return +self.of(_Symbols(p))


def _damped(unit: str, name: str, sensitivity: int) -> Formula:
    def of_cycle(s: _Symbols) -> Number:
        cycle = truth.steady_cycle(s.p, digits=DIGITS)
        if cycle is None:
            raise ValueError("no steady cycle exists at these parameters")
        return cycle[name]

    return Formula(unit, 13, of_cycle, sensitivity)


break_away_force = Formula("N", 6, lambda s: s.mu_s * s.normal)
first_load_up = Formula("s", 6, lambda s: s.mu_s * s.normal / (s.k * abs(s.v)), 0)
"""Stick time of a spring that starts relaxed."""
spring_relief = Formula("m", 7, lambda s: 2 * s.gap * s.sign, 2)
t_slip = Formula("s", 8, lambda s: 2 * (mp.pi - mp.atan(s.lambda_)) / s.w, 1)
t_stick = Formula("s", 9, lambda s: 2 * s.gap / abs(s.v), 2)
delta_x = Formula("m", 10, lambda s: spring_relief(s.p) + s.v * t_slip(s.p), 0)
period = Formula("s", 10, lambda s: t_stick(s.p) + t_slip(s.p), 0)
frequency = Formula("Hz", 10, lambda s: 1 / period(s.p), 0)
peak_velocity = Formula("m/s", 11, lambda s: s.v * (1 + mp.sqrt(1 + s.lambda_**2)), 0)
slip_travel_of_the_end = Formula("m", 12, lambda s: s.v * t_slip(s.p))
"""What the simplified jump leaves out."""
half_period = Formula("s", 12, lambda s: mp.pi / s.w)  # half a period of the free oscillation
slow_slip_excess = Formula("s", 12, lambda s: 2 / (s.w * s.lambda_))
"""``t_slip - pi/w`` for v -> 0 at first order."""
fast_slip_deficit = Formula("s", 12, lambda s: 2 * s.lambda_ / s.w)
"""``2 pi/w - t_slip`` for v -> infinity at first order."""
load_up_over_stick = Formula("1", 12, lambda s: s.mu_s / (2 * (s.mu_s - s.mu_k)), 2)
"""Simplified stick time over the real one."""
sliding_extension = Formula(
    "m", 3, lambda s: (s.sign * s.mu_k * s.normal - s.F_ext + s.c * s.v) / s.k
)
"""Spring extension in steady sliding."""
pulling_velocity = Formula("m/s", 3, lambda s: s.v)
sliding_friction = Formula("N", 15, lambda s: s.mu_k * s.normal)
"""Dry friction while slipping: heat per travel at c = 0."""
equal_by_the_meter = Formula("s", 16, lambda s: mpf(0))
"""Zero: where the meter's rules make two outputs equal."""
damped_t_slip = _damped("s", "t_slip", 1)
damped_t_stick = _damped("s", "t_stick", 2)
damped_spring_drop = _damped("m", "spring_drop", 2)
damped_delta_x = _damped("m", "delta_x", 0)
damped_period = _damped("s", "T", 0)

FORMULAS = {name: formula for name, formula in globals().items() if isinstance(formula, Formula)}
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


Columns = Mapping[str, Series]


@dataclass(frozen=True)
class Quantity:
    """One thing a check can compare with a truth, made from the outputs that it ``needs``.

    ``equation`` is the number in docs/theory.md of what the exact motion takes it from. ``compute``
    makes samples of it from the columns of those outputs and the values at the start of the case.
    A ``discrete`` one is an integer or a Boolean; a ``directed`` one changes its sign in the mirror
    image of a run.
    """

    name: str
    unit: str
    equation: int
    meaning: str
    needs: tuple[str, ...]
    compute: Callable[[Columns, Parameters], Series]
    discrete: bool = False
    directed: bool = False


def _output(name: str, unit: str, equation: int, meaning: str, *traits: str) -> Quantity:
    kind = dict.fromkeys(traits, True)
    return Quantity(name, unit, equation, meaning, (name,), lambda of, _: of[name], **kind)


OUTPUTS: tuple[Quantity, ...] = (
    _output("x", "m", 3, "position of the mass", "directed"),
    _output("x_dot", "m/s", 3, "velocity of the mass", "directed"),
    _output("x_pull", "m", 1, "position of the pulled end", "directed"),
    _output("z", "m", 3, "spring extension", "directed"),
    _output("F", "N", 1, "spring force", "directed"),
    _output("F_friction", "N", 1, "friction and damping force on the mass", "directed"),
    _output("F_s", "N", 6, "break-away force"),
    _output("sticking", "1", 4, "whether the mass sticks", "discrete"),
    _output(
        "mode", "1", 4, "-1 slips backward, 0 sticks, +1 slips forward", "discrete", "directed"
    ),
    _output("delta_x", "m", 16, "displacement in the last completed slip", "directed"),
    _output(
        "spring_drop", "m", 16, "relief of the spring over the last completed slip", "directed"
    ),
    _output("t_stick", "s", 16, "length of the last completed stick"),
    _output("t_slip", "s", 16, "length of the last completed slip"),
    _output("T", "s", 16, "time between the last two break-aways"),
    _output("f", "Hz", 16, "reciprocal of T"),
    _output("x_dot_peak", "m/s", 16, "extreme velocity of the last completed slip", "directed"),
    _output("n_slips", "1", 16, "number of completed slips", "discrete"),
    _output("t_event", "s", 5, "time of the last transition"),
    _output("W_pull", "J", 15, "work done by the pulling end"),
    _output("W_k", "J", 15, "energy put in by changing the stiffness"),
    _output("Q_friction", "J", 15, "heat made by friction and damping"),
    _output("mu_k_used", "1", 1, "kinetic friction coefficient after the clamp"),
)

OUTPUT_NAMES: tuple[str, ...] = tuple(quantity.name for quantity in OUTPUTS)

GROUPS: Mapping[str, tuple[str, ...]] = {
    "state": ("x", "x_dot", "z"),
    "forces": ("F", "F_friction"),
    "events": ("mode", "n_slips", "t_event"),
    "meter": ("delta_x", "spring_drop", "t_stick", "t_slip", "T", "x_dot_peak"),
    "energy": ("W_pull", "W_k", "Q_friction"),
}
"""Outputs that a case can name together; the others follow from these by an invariant each."""


def _divided(above: Series | float, below: Series) -> Series:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.divide(above, below)


DERIVED: tuple[Quantity, ...] = (
    Quantity(
        "jump_beyond_simplified",
        "m",
        12,
        "delta_x less the designers' 2 (mu_s - mu_k) N/k: the error of that formula",
        ("delta_x",),
        lambda columns, start: columns["delta_x"] - float(spring_relief(start)),
    ),
    Quantity(
        "slip_beyond_half_period",
        "s",
        12,
        "t_slip less the designers' pi/w: the error of that formula",
        ("t_slip",),
        lambda columns, start: columns["t_slip"] - float(half_period(start)),
    ),
    Quantity(
        "slip_short_of_full_period",
        "s",
        12,
        "2 pi/w less t_slip, which goes to 0 as the pull gets fast",
        ("t_slip",),
        lambda columns, start: 2.0 * float(half_period(start)) - columns["t_slip"],
    ),
    Quantity(
        "load_up_over_stick",
        "1",
        12,
        "the designers' mu_s N/(k v) over t_stick: by how much that formula is too long",
        ("t_stick",),
        lambda columns, start: _divided(float(first_load_up(start)), columns["t_stick"]),
    ),
    Quantity(
        "heat_per_travel",
        "N",
        15,
        "Q_friction over the way the mass has gone since the start, always in one direction",
        ("Q_friction", "x"),
        lambda columns, start: _divided(
            columns["Q_friction"], np.abs(columns["x"] - start["x_start"])
        ),
    ),
    Quantity(
        "period_beyond_phases",
        "s",
        16,
        "T less t_stick and t_slip, once both belong to the same cycle",
        ("T", "t_stick", "t_slip"),
        lambda columns, _: columns["T"] - columns["t_stick"] - columns["t_slip"],
    ),
)

QUANTITIES: dict[str, Quantity] = {q.name: q for q in (*OUTPUTS, *DERIVED)}
