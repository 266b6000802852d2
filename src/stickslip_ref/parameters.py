"""The parameters of one stick-slip block, or of a whole field of them."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatOrArray = float | NDArray[np.float64]
"""A number, or an array of them."""

_TINY, _HUGE = float(np.finfo(float).tiny), float(np.finfo(float).max)
"""The least and the largest double with all its digits."""

CLAMP_GAP = 0.01
"""How far below mu_s a mu_k that exceeds it is put [-]."""


class FrictionClampWarning(UserWarning):
    """``mu_k`` exceeds ``mu_s``; the clamped ``mu_k_used`` is taken in its place."""


class Bound(NamedTuple):
    """Unit and lower bound of a parameter; every parameter is finite besides."""

    unit: str
    low: float = -np.inf
    strict: bool = False

    def __str__(self) -> str:
        if self.low == -np.inf:
            return "finite"
        return f"finite and {'>' if self.strict else '>='} {self.low:g}{self.suffix}"

    @property
    def suffix(self) -> str:
        """The unit as it follows a number, after a blank."""
        return f" {self.unit}" if self.unit else ""


_BOUNDS = {
    "m": Bound("kg", 0.0, strict=True),
    "g": Bound("m/s2", 0.0, strict=True),
    "k": Bound("N/m", 0.0, strict=True),
    "c": Bound("N.s/m", 0.0),
    "mu_s": Bound("", 0.0),
    "mu_k": Bound("", 0.0),
    "v": Bound("m/s"),
    "load": Bound("N"),
    "F_ext": Bound("N"),
    "x_start": Bound("m"),
    "x_dot_start": Bound("m/s"),
    "z_start": Bound("m"),
}


@dataclass(frozen=True)
class Parameters:
    """Parameters, inputs and initial state in SI units; docs/theory.md (1), (2).

    Every field is a number or an array, and the arrays broadcast against each other. They are
    checked where they are made and seen read-only from here; the arrays themselves are not copied.

    Parameters
    ----------
    m : float or array
        Mass [kg], > 0.
    g : float or array
        Gravity [m/s2], > 0.
    k : float or array
        Spring stiffness [N/m], > 0.
    c : float or array
        Viscous damping between mass and way [N.s/m], >= 0.
    mu_s, mu_k : float or array
        Static and kinetic friction coefficient [-], >= 0. A ``mu_k`` above ``mu_s`` is clamped,
        see `mu_k_used`.
    v : float or array
        Velocity of the pulled end [m/s].
    load : float or array
        Normal force on top of ``m g`` [N], >= ``-m g``.
    F_ext : float or array
        External force on the mass along the way [N].
    x_start, x_dot_start, z_start : float or array
        Position [m] and velocity [m/s] of the mass, extension of the spring [m] at the start.

    Attributes
    ----------
    own : mapping of str to float
        Values of the friction law's own parameters by name, SI. Empty but for what `simulate` hands
        to a friction law that has some.

    Raises
    ------
    ValueError
        If a field is no number, is out of range (the message names field, value and range), if
        the arrays do not broadcast, or if ``k / m`` or ``(c / m)^2`` leaves double precision.

    Warns
    -----
    FrictionClampWarning
        If ``mu_k > mu_s`` anywhere; the message names both.
    """

    m: FloatOrArray = 1.0
    g: FloatOrArray = 9.81
    k: FloatOrArray = 1000.0
    c: FloatOrArray = 0.0
    mu_s: FloatOrArray = 0.5
    mu_k: FloatOrArray = 0.3
    v: FloatOrArray = 0.02
    load: FloatOrArray = 0.0
    F_ext: FloatOrArray = 0.0
    x_start: FloatOrArray = 0.0
    x_dot_start: FloatOrArray = 0.0
    z_start: FloatOrArray = 0.0
    own: Mapping[str, float] = field(default_factory=dict, init=False, repr=False, hash=False)

    def __post_init__(self) -> None:
        for name, bound in _BOUNDS.items():
            object.__setattr__(self, name, checked(name, getattr(self, name), bound))
        shape = _common_shape(self)
        _check_load(self.m, self.g, self.load)
        _check_rates(self.k, self.m, self.c)
        object.__setattr__(self, "_shape", shape)
        object.__setattr__(self, "_mu_k_used", _clamped(self.mu_s, self.mu_k))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Parameters):
            return NotImplemented
        return self.own == other.own and all(
            np.array_equal(getattr(self, name), getattr(other, name)) for name in _BOUNDS
        )

    def with_own(self, own: Mapping[str, float]) -> Parameters:
        """Return these parameters with `own` set; nothing is checked anew."""
        result = copy(self)
        object.__setattr__(result, "own", dict(own))
        return result

    @property
    def shape(self) -> tuple[int, ...]:
        """Common shape of the fields; ``()`` where all are numbers."""
        shape: tuple[int, ...] = self.__dict__["_shape"]
        return shape

    @property
    def N(self) -> FloatOrArray:  # noqa: N802 - the symbol of the theory
        """Normal force ``m g + load`` [N]; docs/theory.md (1)."""
        return self.m * self.g + self.load

    @property
    def mu_k_used(self) -> FloatOrArray:
        """``mu_k``, but ``max(mu_s - 0.01, 0)`` where ``mu_k > mu_s`` [-]."""
        used: FloatOrArray = self.__dict__["_mu_k_used"]
        return used

    @property
    def F_s(self) -> FloatOrArray:  # noqa: N802 - the symbol of the theory
        """Break-away force ``mu_s N`` [N]; docs/theory.md (6)."""
        return self.mu_s * self.N

    @property
    def w(self) -> FloatOrArray:
        """Natural frequency ``sqrt(k / m)`` [rad/s]; docs/theory.md (2)."""
        return plain_number(np.sqrt(self.k / self.m))

    @property
    def zeta(self) -> FloatOrArray:
        """Damping ratio ``c / (2 m w)`` [-]; docs/theory.md (2)."""
        return self.c / (2.0 * self.m * self.w)

    @property
    def Delta(self) -> FloatOrArray:  # noqa: N802 - the symbol of the theory
        """Half the spring relief of an undamped slip, ``(mu_s - mu_k) N / k`` [m]; theory (2)."""
        return (self.mu_s - self.mu_k_used) * self.N / self.k

    @property
    def lambda_(self) -> FloatOrArray:
        """``w Delta / |v|`` [-]; docs/theory.md (2). Infinite (NaN where Delta = 0) at v = 0."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return plain_number(np.divide(self.w * self.Delta, np.abs(self.v)))


def plain_number(value: Any) -> FloatOrArray:
    """Return a NumPy result, as a plain float where it has no shape."""
    return float(value) if np.ndim(value) == 0 else value


def checked(name: str, value: object, bound: Bound) -> FloatOrArray:
    """Return the value as a float or a read-only float array, or raise a ValueError naming it."""
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "iuf":
            raise TypeError
        array = array.astype(np.float64, copy=False)
    except (TypeError, ValueError):
        raise ValueError(f"{name} = {value!r} is not a number; it must be {bound}") from None
    if array.size and not _within(array, bound):
        good = np.isfinite(array) & (array > bound.low if bound.strict else array >= bound.low)
        where = np.unravel_index(int(np.argmin(good)), array.shape)
        index = f"[{', '.join(str(i) for i in where)}]" if array.ndim else ""
        raise ValueError(
            f"{name}{index} = {float(array[where])!r}{bound.suffix} is out of range; "
            f"it must be {bound}"
        )
    if array.ndim == 0:
        return float(array)
    view = array.view()
    view.flags.writeable = False
    return view


def _within(array: NDArray[np.float64], bound: Bound) -> bool:
    # Two reductions without a temporary; a NaN passes through both and fails the comparison.
    low, high = float(array.min()), float(array.max())
    return (low > bound.low if bound.strict or bound.low == -np.inf else low >= bound.low) and (
        high < np.inf
    )


def _common_shape(p: Parameters) -> tuple[int, ...]:
    shapes = {name: np.shape(getattr(p, name)) for name in _BOUNDS}
    try:
        return np.broadcast_shapes(*shapes.values())
    except ValueError:
        given = ", ".join(f"{name} {shape}" for name, shape in shapes.items() if shape)
        raise ValueError(f"the shapes of the parameters do not broadcast: {given}") from None


def _check_load(m: FloatOrArray, g: FloatOrArray, load: FloatOrArray) -> None:
    N = np.asarray(m * g + load)
    if N.size == 0 or (N.min() >= 0.0 and N.max() < np.inf):
        return
    where = int(np.argmin((N >= 0.0) & np.isfinite(N)))
    m_, g_, load_ = (float(np.broadcast_to(a, N.shape).flat[where]) for a in (m, g, load))
    raise ValueError(
        f"load = {load_!r} N is out of range; "
        f"it must be >= -m g = {-m_ * g_!r} N, with a finite m g + load"
    )


def _check_rates(k: FloatOrArray, m: FloatOrArray, c: FloatOrArray) -> None:
    """Refuse a w^2 or (2 zeta w)^2 that overflows, or a w^2 too small for all of its digits."""
    if not (np.size(k) and np.size(m) and np.size(c)):
        return
    # The extremes of the quotients, without a temporary as large as the field.
    if _in_range(np.max(k), np.min(m), np.max(c)) and _in_range(np.min(k), np.max(m), 0.0):
        return
    good = _in_range(k, m, c)
    if np.all(good):
        return
    where = int(np.argmin(good))
    k_, m_, c_ = (float(np.broadcast_to(a, np.shape(good)).flat[where]) for a in (k, m, c))
    raise ValueError(
        f"k = {k_!r} N/m, m = {m_!r} kg and c = {c_!r} N.s/m are out of range together; "
        "k / m must be within 2.23e-308 to 1.79e+308 1/s2, (c / m)^2 at most 1.79e+308 1/s2"
    )


def _in_range(k: FloatOrArray, m: FloatOrArray, c: FloatOrArray) -> NDArray[np.bool_]:
    with np.errstate(over="ignore", under="ignore"):
        stiffness, damping = np.divide(k, m), np.square(np.divide(c, m))
    return np.asarray((stiffness >= _TINY) & (stiffness <= _HUGE) & (damping <= _HUGE))


def _clamped(mu_s: FloatOrArray, mu_k: FloatOrArray) -> FloatOrArray:
    """Return mu_k where it does not exceed mu_s, its clamp elsewhere, and warn of the latter."""
    above = np.greater(mu_k, mu_s)
    if not above.any():
        return mu_k
    used = np.where(above, np.maximum(np.subtract(mu_s, CLAMP_GAP), 0.0), mu_k)
    first = int(np.argmax(above))
    s, k_, u = (float(np.broadcast_to(a, above.shape).flat[first]) for a in (mu_s, mu_k, used))
    more = f" (and at {above.sum() - 1} more points)" if above.sum() > 1 else ""
    # Seen from the caller of Parameters(...): this, __post_init__, the generated __init__.
    warnings.warn(
        f"mu_k = {k_!r} exceeds mu_s = {s!r}; mu_k is clamped to max(mu_s - {CLAMP_GAP}, 0) = "
        f"{u!r}{more}",
        FrictionClampWarning,
        stacklevel=4,
    )
    return plain_number(used)
