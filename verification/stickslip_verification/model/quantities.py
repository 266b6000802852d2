"""What a check can look at, and closed forms to hold it against.

A formula takes all twelve values at the start of a case (SI units, as `complete` in
`truth.parameters` gives them) and gives an mpmath number, under its equation number of
docs/theory.md. They are written from the derivation and share nothing with the block or the
reference. `|v|` gives durations, the sign of `v` gives directions.

The quantities stand in ``quantities.toml``.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from mpmath import mp, mpf
from pydantic.dataclasses import dataclass as model

from .. import truth
from .data_file import WRITTEN, DataError, DataFile, Ordinal, Text, Written, listed
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

Columns = Mapping[str, Series]


@model(frozen=True, config=WRITTEN)
class Quantity(Written):
    """One thing a check can compare with a truth: an output, or what is made of those it ``needs``.

    ``equation`` is the number in docs/theory.md of what the exact motion takes it from. ``type``
    and ``variability`` are those of an output in FMI 2.0; a case can name the outputs of a
    ``group`` together. A ``directed`` one changes its sign in the mirror image of a run. ``means``
    and ``look`` are what `suite.cases.Meaning` says.
    """

    name: Text
    unit: Text
    equation: Ordinal
    meaning: Text
    means: Text
    look: Text
    needs: tuple[Text, ...] = ()
    type: Literal["Real", "Integer", "Boolean"] = "Real"
    variability: Literal["continuous", "discrete"] = "continuous"
    group: str = ""
    directed: bool = False

    @property
    def discrete(self) -> bool:
        """Whether it is an integer or a Boolean."""
        return self.type != "Real"

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the outputs that it is made from."""
        return self.needs or (self.name,)

    def compute(self, columns: Columns, start: Parameters) -> Series:
        """Make samples of it from its columns and the values at the start of the case."""
        return _DERIVED[self.name](columns, start) if self.needs else columns[self.name]


def _divided(above: Series | float, below: Series) -> Series:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.divide(above, below)


_DERIVED: Mapping[str, Callable[[Columns, Parameters], Series]] = {
    "jump_beyond_simplified": lambda of, start: of["delta_x"] - float(spring_relief(start)),
    "slip_beyond_half_period": lambda of, start: of["t_slip"] - float(half_period(start)),
    "slip_short_of_full_period": lambda of, start: 2.0 * float(half_period(start)) - of["t_slip"],
    "load_up_over_stick": lambda of, start: _divided(float(first_load_up(start)), of["t_stick"]),
    "heat_per_travel": lambda of, start: _divided(
        of["Q_friction"], np.abs(of["x"] - start["x_start"])
    ),
    "period_beyond_phases": lambda of, _: of["T"] - of["t_stick"] - of["t_slip"],
}


@model(frozen=True, config=WRITTEN)
class _Tables(Written):
    quantities: Annotated[tuple[Quantity, ...], listed("name")]
    cycle: Mapping[str, tuple[str, ...]]


_TABLES: _Tables = DataFile(Path(__file__).with_suffix(".toml"), DataError).read(_Tables)

QUANTITIES: dict[str, Quantity] = {each.name: each for each in _TABLES.quantities}
OUTPUTS = tuple(each for each in _TABLES.quantities if not each.needs)
OUTPUT_NAMES: tuple[str, ...] = tuple(each.name for each in OUTPUTS)
GROUPS: Mapping[str, tuple[str, ...]] = {
    group: tuple(each.name for each in OUTPUTS if each.group == group)
    for group in dict.fromkeys(each.group for each in OUTPUTS if each.group)
}
"""Outputs that a case can name together; the others follow from these by an invariant each."""

CYCLE = _TABLES.cycle
"""Formulas of outputs in the steady cycle: without damping, and with it where there is one."""
