"""Two shapes of friction over speed.

With ``q = u/v_s`` the friction of slip is ``N [mu_k + (mu_s - mu_k) e(q)]``, and e falls from 1:
``exp(-q^delta)`` is Stribeck's shape, ``1/(1 + q)`` the hyperbolic one.
"""

import math

from .series import MOST_WHOLE, expansion_of

# -ln of the part of friction that is nothing beside the whole: 2^-52.
_GONE = 36.05
# Beyond it the exponential is 0.
_MOST = 700.0


class Stribeck:
    """The shape ``exp(-q^delta)``.

    Parameters
    ----------
    delta
        Exponent, at least 1.

    Attributes
    ----------
    delta
        Exponent.
    analytic
        Whether the series hold at q = 0.
    flat_from
        Ratio q from which on e is 0 to rounding.
    breadth
        Ratio q over which the slope changes, at least.
    expand
        The series, see `series.expansion_of`.
    """

    def __init__(self, delta: float) -> None:
        self.delta = delta
        self.analytic = delta <= MOST_WHOLE and delta == math.floor(delta)
        self.flat_from = math.pow(_GONE, 1.0 / delta)
        self.breadth = 1.0 / delta
        self.expand = expansion_of(str(int(delta)) if self.analytic else "power")

    def inner(self, q: float) -> float:
        """Return q^delta, infinity beyond the range."""
        if self.delta == 1.0:
            return q
        if self.delta == 2.0:
            return q * q
        if q > 1.0 and self.delta * math.log(q) > _MOST:
            return math.inf
        return math.pow(q, self.delta)

    def left(self, q: float) -> float:
        """Return e(q)."""
        return math.exp(-self.inner(q))

    def fallen(self, q: float) -> float:
        """Return 1 - e(q)."""
        return -math.expm1(-self.inner(q))

    def steepness(self, q: float) -> float:
        """Return -e'(q)."""
        if q <= 0.0:
            return 1.0 if self.delta == 1.0 else 0.0
        inner = self.inner(q)
        return self.delta * (inner / q) * math.exp(-inner) if inner < _MOST else 0.0


class Hyperbolic:
    """The shape ``1/(1 + q)``; attributes and methods are those of `Stribeck`."""

    delta = 1.0
    analytic = True
    flat_from = math.inf
    breadth = 1.0
    expand = staticmethod(expansion_of("hyperbolic"))

    def inner(self, q: float) -> float:
        """Return q."""
        return q

    def left(self, q: float) -> float:
        """Return e(q)."""
        return 1.0 / (1.0 + q)

    def fallen(self, q: float) -> float:
        """Return 1 - e(q)."""
        return q / (1.0 + q)

    def steepness(self, q: float) -> float:
        """Return -e'(q)."""
        return 1.0 / (1.0 + q) / (1.0 + q)
