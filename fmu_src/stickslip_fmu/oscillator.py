"""The mass on its spring, with any damping: its two responses. docs/theory.md (3)."""

import math
from typing import Tuple

# Above this damping ratio the two rates of decay are far enough apart to be taken one by one.
_FAR_APART = 2.0

# Below this multiple of the shortest time the step response is summed as a power series: its
# closed form is a difference of terms that are larger by the inverse of that multiple.
_BEGINNING = 0.25
_NEGLIGIBLE = 2.0**-60


class Oscillator:
    """Rates and responses of ``m y_ddot + c y_dot + k y = 0``.

    ``impulse`` K starts at 0 with slope 1, ``step`` is ``G = w^2`` times its integral; every
    motion is a sum of the two:

    ``E = exp(-a tau)``, ``K = E sin(b tau)/b``, ``G = 1 - E cos(b tau) - a K``

    for ``a < w``, with the hyperbolic functions beyond.

    Parameters
    ----------
    k, m, c
        Stiffness [N/m], mass [kg] and viscous damping [N.s/m].

    Attributes
    ----------
    w, w2
        Undamped angular frequency [rad/s] and its square.
    a
        Rate of decay c/(2m) [1/s].
    b
        Damped angular frequency, or half the distance of the two rates of decay [1/s].
    fast, slow
        The two rates of decay where a >= w; else a and a.
    overdamped
        Whether a >= w.
    """

    __slots__ = (
        "_beginning",
        "_later",
        "a",
        "b",
        "c",
        "fast",
        "k",
        "m",
        "overdamped",
        "slow",
        "w",
        "w2",
    )

    def __init__(self, k: float, m: float, c: float) -> None:
        self.k = k
        self.m = m
        self.c = c
        self.w2 = k / m
        self.w = math.sqrt(self.w2)
        self.a = self.fast = self.slow = 0.5 * c / m
        self.b = math.sqrt(abs((self.w - self.a) * (self.w + self.a)))
        self.overdamped = self.a >= self.w
        self._later = self._undamped if c == 0.0 else self._swinging
        if self.overdamped:
            self.fast = self.a + self.b
            self.slow = self.w2 / self.fast
            far_apart = self.a > _FAR_APART * self.w
            self._later = self._decaying_apart if far_apart else self._decaying
        self._beginning = _BEGINNING / max(self.w, self.fast)

    def responses(self, tau: float) -> Tuple[float, float]:
        """Return G [1] and K [s] at `tau` [s], each to its last digits."""
        return self._first(tau) if tau < self._beginning else self._later(tau)

    def integrals(self, tau: float) -> Tuple[float, float]:
        """Return the integrals of G^2 [s] and K^2 [s^3] from 0 to `tau`: docs/theory.md (15).

        Both lose digits where G is small all the way, that is for a short `tau`.
        """
        a, w2 = self.a, self.w2
        step, impulse = self.responses(tau)
        decay = -math.expm1(-2.0 * a * tau) / (2.0 * a) if a > 0.0 else tau
        of_impulse = (decay - impulse * (1.0 - step)) / (2.0 * w2)
        of_step = tau - impulse * (1.0 + step) - a / w2 * step * (2.0 + step) + w2 * of_impulse
        return of_step, of_impulse

    def _first(self, tau: float) -> Tuple[float, float]:
        """Return G and K as power series, whose terms follow from the equation of motion."""
        damping = 2.0 * self.a * tau
        spring = self.w2 * tau * tau
        before, term = 0.0, 0.5 * spring
        step = term
        slope = 2.0 * term
        power = 2
        while abs(term) + spring * abs(before) > _NEGLIGIBLE * step:
            following = -(damping * power * term + spring * before) / (power * (power + 1))
            before, term = term, following
            power += 1
            step += term
            slope += power * term
        return step, slope / spring * tau if spring > 0.0 else tau

    def _undamped(self, tau: float) -> Tuple[float, float]:
        """Return G and K for a = 0."""
        half = 0.5 * self.w * tau
        sine = math.sin(half)
        return 2.0 * sine * sine, 2.0 * sine * math.cos(half) / self.w

    def _swinging(self, tau: float) -> Tuple[float, float]:
        """Return G and K for a < w.

        The cosine is taken from the half angle: near a whole turn G is small, and there a
        slip that grazes standstill is decided.
        """
        half = 0.5 * self.b * tau
        sine = math.sin(half)
        decay = math.exp(-self.a * tau)
        impulse = 2.0 * decay * sine * math.cos(half) / self.b
        return (
            2.0 * decay * sine * sine - math.expm1(-self.a * tau) - self.a * impulse,
            impulse,
        )

    def _decaying(self, tau: float) -> Tuple[float, float]:
        """Return G and K where the two rates of decay are close, or one."""
        impulse = self._impulse(tau)
        fallen = -0.5 * (math.expm1(-self.slow * tau) + math.expm1(-self.fast * tau))
        return fallen - self.a * impulse, impulse

    def _decaying_apart(self, tau: float) -> Tuple[float, float]:
        """Return G and K where the two rates of decay are far apart."""
        slowly, fast = math.expm1(-self.slow * tau), math.expm1(-self.fast * tau)
        return (self.slow * fast - self.fast * slowly) / (2.0 * self.b), self._impulse(tau)

    def _impulse(self, tau: float) -> float:
        """Return K for a >= w."""
        apart = 2.0 * self.b
        rise = -math.expm1(-apart * tau) / apart if apart > 0.0 else tau
        return math.exp(-self.slow * tau) * rise
