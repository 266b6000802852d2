"""The parameters of a run: checked as doubles, then held exactly in high precision.

A simulator computes with doubles. The exact solution is that of these very binary numbers, not of
the decimals they were typed as. docs/theory.md, the model and (2).
"""

import functools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, TypeAlias

import mpmath

Number: TypeAlias = Any  # a real number of a high-precision context (mpmath ships no types)
Context: TypeAlias = Any  # a context of mpmath with its own precision


class Kind(StrEnum):
    """When a parameter may be set: before a run only, or between two steps as well."""

    FIXED = "fixed"
    TUNABLE = "tunable"
    INPUT = "input"


@dataclass(frozen=True)
class Parameter:
    """A parameter or input of the model, or a parameter of a friction law's own."""

    name: str
    unit: str  # SI, "1" where it has none
    start: float
    kind: Kind
    low: float | None = None  # its lower bound
    strict: bool = False  # whether the bound itself is excluded
    directed: bool = False  # whether it changes its sign in the mirror image of a run
    chosen: bool = False  # whether it is a choice, and no datum that may be a little off

    def check(self, value: float) -> None:
        """Raise a ValueError with name, value and range if `value` is no finite number in range."""
        if not math.isfinite(value):
            raise ValueError(f"{self.name} = {value} is not a finite number")
        if self.low is None or value > self.low or (value == self.low and not self.strict):
            return
        sense = f"{self.name} {'>' if self.strict else '>='} {self.low:g}"
        raise ValueError(f"{self.name} = {value!r} is outside {sense}")


PARAMETERS = (
    Parameter("m", "kg", 1.0, Kind.FIXED, low=0.0, strict=True),
    Parameter("g", "m/s2", 9.81, Kind.FIXED, low=0.0, strict=True),
    Parameter("k", "N/m", 1000.0, Kind.TUNABLE, low=0.0, strict=True),
    Parameter("c", "N.s/m", 0.0, Kind.TUNABLE, low=0.0),
    Parameter("mu_s", "1", 0.5, Kind.TUNABLE, low=0.0),
    Parameter("mu_k", "1", 0.3, Kind.TUNABLE, low=0.0),
    Parameter("v", "m/s", 0.02, Kind.INPUT, directed=True),
    Parameter("load", "N", 0.0, Kind.INPUT),
    Parameter("F_ext", "N", 0.0, Kind.INPUT, directed=True),
    Parameter("x_start", "m", 0.0, Kind.FIXED, directed=True),
    Parameter("x_dot_start", "m/s", 0.0, Kind.FIXED, directed=True),
    Parameter("z_start", "m", 0.0, Kind.FIXED, directed=True),
)
"""The twelve parameters and inputs of the model: the one declaration of them in the verification.

A load also has to be >= -m g, which `complete` checks."""

START_VALUES: Mapping[str, float] = {each.name: each.start for each in PARAMETERS}
"""Values taken where none is given, SI."""


def changeable(own: Iterable[Parameter] = ()) -> frozenset[str]:
    """Return the names of inputs and tunable parameters, the friction law's `own` among them."""
    table = (*PARAMETERS, *own)
    return frozenset(each.name for each in table if each.kind is not Kind.FIXED)


CHANGEABLE = changeable()
"""Inputs and tunable parameters of the model: what may change between two steps."""

# Twenty digits beyond those asked for: a slip a hair from critical damping (zeta - 1 down to 1e-32)
# loses sixteen in the amplitudes of its two exponentials.
_GUARD_DIGITS = 20


@functools.cache
def high_precision(digits: int) -> Context:
    """Return the context that carries `digits` decimal digits and the guard digits.

    `ValueError` if they are below 20, where the truth would be no better than a simulator.
    """
    if digits < 20:
        raise ValueError(f"digits = {digits} is outside 20 ..")
    context = mpmath.mp.clone()
    context.dps = digits + _GUARD_DIGITS
    return context


def complete(given: Mapping[str, float], own: Sequence[Parameter] = ()) -> dict[str, float]:
    """Return all parameters as doubles, SI, those not given at their start values.

    The friction law's `own` follow the twelve. `ValueError`, with the parameter, its value and its
    range, for an unknown name, NaN or infinity; m, g or k not positive; c, mu_s or mu_k negative;
    load below -m g; an own parameter out of its range.
    """
    table = {each.name: each for each in (*PARAMETERS, *own)}
    unknown = sorted(set(given) - set(table))
    if unknown:
        raise ValueError(f"no parameter named {', '.join(unknown)}; there are {list(table)}")
    values = {name: float(given.get(name, each.start)) for name, each in table.items()}
    for name, value in values.items():
        table[name].check(value)
    weight = values["m"] * values["g"]
    if values["load"] + weight < 0.0:
        raise ValueError(f"load = {values['load']!r} is outside load >= -m g = {-weight!r}")
    return values


def used_mu_k(mu_s: float, mu_k: float) -> float:
    """Return the kinetic coefficient after the clamp, in doubles because an output shows it."""
    return max(mu_s - 0.01, 0.0) if mu_k > mu_s else mu_k


@dataclass(frozen=True)
class Numbers:
    """The parameters of one arc as exact numbers [SI], with the forces that follow from them."""

    m: Number
    k: Number
    c: Number
    v: Number
    F_ext: Number
    mu_k: Number  # after the clamp
    N: Number  # normal force
    F_s: Number  # mu_s N
    F_k: Number  # mu_k N
    gap: Number  # F_s - F_k, zero exactly where the two coefficients are equal or N is zero
    own: Mapping[str, Number] = field(default_factory=dict)  # the friction law's own parameters


def exact(context: Context, values: Mapping[str, float]) -> Numbers:
    """Return `values` (all of them, as from `complete`) as exact numbers of `context`."""
    numbers = {name: context.mpf(value) for name, value in values.items()}
    mu_s = numbers["mu_s"]
    mu_k = context.mpf(used_mu_k(values["mu_s"], values["mu_k"]))
    weight = numbers["m"] * numbers["g"]
    N = weight + numbers["load"]
    # load = -m g can be said in doubles only to a rounding of the product: it means N = 0.
    rounding = weight * context.ldexp(1, -53)
    if rounding >= N:
        N = context.zero
    return Numbers(
        **{name: numbers[name] for name in ("m", "k", "c", "v", "F_ext")},
        mu_k=mu_k,
        N=N,
        F_s=mu_s * N,
        F_k=mu_k * N,
        gap=(mu_s - mu_k) * N,
        own={name: number for name, number in numbers.items() if name not in START_VALUES},
    )


def sign(number: Number) -> int:
    """Return -1, 0 or +1."""
    return int(number > 0) - int(number < 0)
