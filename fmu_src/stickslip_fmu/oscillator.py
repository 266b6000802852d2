"""The free motion of the mass on its spring, with any damping: docs/theory.md (3)."""

import math
from typing import Tuple

# Above this damping ratio the two exponentials are far enough apart to be integrated one by
# one; below it they may coincide, and the integrals are taken from sine and cosine instead.
_FAR_APART = 2.0


class Oscillator:
    """Rates of ``u_ddot + 2 a u_dot + w^2 u = 0`` and its two basic solutions.

    With ``E = exp(-a tau)`` and ``C, S`` the cosine and the sine over its frequency (for
    ``a > w`` the hyperbolic ones), every solution is

    ``u = u0 E C + (u_dot0 + a u0) E S``.

    Parameters
    ----------
    k, m, c
        Stiffness [N/m], mass [kg] and viscous damping [N.s/m].
    """

    __slots__ = ("a", "b", "basis", "c", "k", "m", "overdamped", "w", "w2")

    def __init__(self, k: float, m: float, c: float) -> None:
        self.k = k
        self.m = m
        self.c = c
        self.w2 = k / m
        self.w = math.sqrt(self.w2)
        self.a = 0.5 * c / m
        self.overdamped = self.a >= self.w
        # Frequency of the damped motion, or half the distance of the two decay rates.
        self.b = math.sqrt(abs((self.w - self.a) * (self.w + self.a)))
        self.basis = self._decaying if self.overdamped else self._swinging

    def _swinging(self, tau: float) -> Tuple[float, float]:
        """Return ``1 - E C`` and ``E S`` at time `tau`, for a < w.

        The first is built without cancellation: near a whole turn both terms are small, and
        there a slip that grazes standstill is decided.
        """
        half = 0.5 * self.b * tau
        sine = math.sin(half)
        decay = math.exp(-self.a * tau)
        return (
            2.0 * decay * sine * sine - math.expm1(-self.a * tau),
            2.0 * decay * sine * math.cos(half) / self.b,
        )

    def _decaying(self, tau: float) -> Tuple[float, float]:
        """Return ``1 - E C`` and ``E S`` at time `tau`, for a >= w."""
        fast = self.a + self.b
        slow = self.w2 / fast
        apart = -2.0 * self.b * tau
        rise = -math.expm1(apart) / (2.0 * self.b) if self.b > 0.0 else tau
        return (
            -0.5 * (math.expm1(-slow * tau) + math.expm1(-fast * tau)),
            math.exp(-slow * tau) * rise,
        )

    def squared(self, tau: float, u_dot: float, u_ddot: float) -> float:
        """Return the integral of ``u_dot^2`` from 0 to `tau`: docs/theory.md (15).

        Parameters
        ----------
        tau
            Length of the interval [s].
        u_dot, u_ddot
            First and second derivative of u at its start.
        """
        a, b, w2 = self.a, self.b, self.w2
        if a > _FAR_APART * self.w:
            fast = a + b
            slow = w2 / fast
            of_slow = (u_ddot + fast * u_dot) / (2.0 * b)
            of_fast = -(u_ddot + slow * u_dot) / (2.0 * b)
            return (
                -of_slow * of_slow * math.expm1(-2.0 * slow * tau) / (2.0 * slow)
                - of_fast * of_fast * math.expm1(-2.0 * fast * tau) / (2.0 * fast)
                - of_slow * of_fast * math.expm1(-2.0 * a * tau) / a
            )
        fall, sine = self.basis(tau)
        ones = -math.expm1(-2.0 * a * tau) / (2.0 * a) if a > 0.0 else tau
        sines = (ones - (1.0 - fall) * sine - a * sine * sine) / (2.0 * w2)
        mixed = a * sines + 0.5 * sine * sine
        cosines = ones - (w2 - a * a) * sines
        of_sine = u_ddot + a * u_dot
        return u_dot * u_dot * cosines + 2.0 * u_dot * of_sine * mixed + of_sine * of_sine * sines
