"""What a check can look at, and closed forms to hold it against; both stand in ``quantities.toml``.

A formula takes all twelve values at the start of a case (SI units, as `complete` in
`truth.parameters` gives them) and gives an mpmath number, under its equation number of
docs/theory.md. They are written from the derivation and share nothing with the block or the
reference. `|v|` gives durations, the sign of `v` gives directions.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from mpmath import mp, mpf
from pydantic.dataclasses import dataclass as model

from .. import truth
from .data_file import WRITTEN, Count, DataError, DataFile, Ordinal, Text, Written, listed
from .verdict import Series

DIGITS = 50  # working precision of every formula; far beyond what a double can tell apart

Parameters = Mapping[str, float]
Number = Any  # an mpmath number; mpmath carries no type information


class _Symbols(dict[str, Number]):
    """The numbers of an expression by name: values at the start, symbols, and other formulas."""

    def __init__(self, p: Parameters) -> None:
        super().__init__({name: mpf(value) for name, value in p.items()})
        self.p = p

    def __missing__(self, name: str) -> Number:
        symbol = _TABLES.symbols.get(name)
        return FORMULAS[name](self.p) if symbol is None else eval(symbol, _FUNCTIONS, self)

    def cycle(self, name: str) -> Number:
        """Return a number of the damped steady cycle."""
        cycle = truth.steady_cycle(self.p, digits=DIGITS)
        if cycle is None:
            raise ValueError("no steady cycle exists at these parameters")
        return cycle[name]


_FUNCTIONS = {"pi": mp.pi, "sqrt": mp.sqrt, "atan": mp.atan}


@model(frozen=True, config=WRITTEN)
class Formula(Written):
    """A closed form, called with all twelve values at the start.

    ``equation`` is its number in docs/theory.md. ``sensitivity`` is the power of 1/lambda by which
    an error of the state enters an integration, (17); None where it is not of that kind.
    """

    name: Text
    unit: Text
    equation: Ordinal
    expression: Text
    sensitivity: Count | None = None

    def __call__(self, p: Parameters) -> Number:
        """Return its value in high precision."""
        with mp.workdps(DIGITS):
            symbols = _Symbols(p)
            return +eval(self.expression, {**_FUNCTIONS, "cycle": symbols.cycle}, symbols)


Columns = Mapping[str, Series]


@model(frozen=True, config=WRITTEN)
class Quantity(Written):
    """One thing a check can compare with a truth: an output, or an ``expression`` of some.

    It ``needs`` these outputs, and values of ``formulas``.

    ``equation`` is the number in docs/theory.md of what the exact motion takes it from. ``type``
    and ``variability`` are those of an output in FMI 2.0; a case can name the outputs of a
    ``group`` together. A ``directed`` one changes its sign in the mirror image of a run; an ``own``
    one is an output of some friction laws alone. ``means`` and ``look`` are what
    `suite.cases.Meaning` says.
    """

    name: Text
    unit: Text
    equation: Ordinal
    meaning: Text
    means: Text
    look: Text
    needs: tuple[Text, ...] = ()
    formulas: tuple[Text, ...] = ()
    expression: str = ""
    type: Literal["Real", "Integer", "Boolean"] = "Real"
    variability: Literal["continuous", "discrete"] = "continuous"
    group: str = ""
    directed: bool = False
    own: bool = False

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
        if not self.needs:
            return columns[self.name]
        formulas = {name: float(FORMULAS[name](start)) for name in self.formulas}
        names = {**start, **formulas, **{name: columns[name] for name in self.needs}}
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(eval(self.expression, {}, names))


@model(frozen=True, config=WRITTEN)
class _Tables(Written):
    symbols: Mapping[str, Text]
    formulas: Annotated[tuple[Formula, ...], listed("name")]
    quantities: Annotated[tuple[Quantity, ...], listed("name")]
    cycle: Mapping[str, tuple[str, ...]]
    asymptotic: Mapping[str, Text]


_TABLES: _Tables = DataFile(Path(__file__).with_suffix(".toml"), DataError).read(_Tables)

FORMULAS: dict[str, Formula] = {each.name: each for each in _TABLES.formulas}
"""What a check can name as ``formula``."""
QUANTITIES: dict[str, Quantity] = {each.name: each for each in _TABLES.quantities}
OUTPUTS = tuple(each for each in _TABLES.quantities if not (each.needs or each.own))
OUTPUT_NAMES: tuple[str, ...] = tuple(each.name for each in OUTPUTS)
GROUPS: Mapping[str, tuple[str, ...]] = {
    group: tuple(each.name for each in OUTPUTS if each.group == group)
    for group in dict.fromkeys(each.group for each in OUTPUTS if each.group)
}
"""Outputs that a case can name together; the others follow from these by an invariant each."""

ASYMPTOTIC, CYCLE = _TABLES.asymptotic, _TABLES.cycle
"""Meaning of an error that does not fall at one rate; formulas of outputs in the steady cycle,
without damping, and with it where there is one."""
