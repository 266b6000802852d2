"""The mass on its spring, with any damping, also a negative one. docs/theory.md (3)."""

import math
from typing import Any, Iterator, Tuple

from fmi.model import ModelError

from ...settings import Settings

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

    for ``abs(a) < w``, with the hyperbolic functions beyond. The damping may be negative, as of a
    friction that falls with speed: the motion grows.

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
        The two rates of decay ``a + b`` and ``a - b`` where abs(a) >= w; else a and a.
    overdamped
        Whether abs(a) >= w.
    quickest
        The largest of all rates [1/s].

    Raises
    ------
    ModelError
        If a rate is not a double-precision number other than zero.
    """

    def __init__(self, k: float, m: float, c: float) -> None:
        self.k = k
        self.m = m
        self.c = c
        self.w2 = k / m
        self.w = math.sqrt(self.w2)
        self.a = self.fast = self.slow = 0.5 * c / m
        self.b = math.sqrt(abs((self.w - self.a) * (self.w + self.a)))
        self.overdamped = abs(self.a) >= self.w
        self._far_apart = abs(self.a) > _FAR_APART * self.w
        self._later = self._undamped if c == 0.0 else self._swinging
        if self.overdamped:
            # The larger of the two has all its digits as a sum; their product is w^2.
            if self.a > 0.0:
                self.fast = self.a + self.b
                self.slow = self.w2 / self.fast
            else:
                self.slow = self.a - self.b
                self.fast = self.w2 / self.slow if self.slow < 0.0 else 0.0
            self._later = self._decaying
        self.quickest = max(self.w, self.fast, -self.slow)
        still = self.slow == 0.0 or self.fast == 0.0
        if not (self.w2 > 0.0 and self.quickest < math.inf and (c == 0.0 or not still)):
            raise ModelError(
                f"k = {k!r} N/m, m = {m!r} kg, c = {c!r} N.s/m are out of range together: "
                "their rates leave the range of double-precision numbers"
            )
        self._beginning = _BEGINNING / self.quickest

    def responses(self, tau: float) -> Tuple[float, float, float]:
        """Return G [1], K [s] and the slope of K [1] at `tau` [s]."""
        return self._first(tau) if tau < self._beginning else self._later(tau)

    def step_integral(self, tau: float, step: float, impulse: float) -> float:
        """Return H, the integral of G from 0 to `tau` [s], where G and K are given.

        The integral of K is G/w^2.
        """
        if tau < self._beginning:
            return tau * math.fsum(term / (power + 1) for power, term in self._terms(tau))
        if self._far_apart:
            slow, fast = _lag(self.slow, tau), _lag(self.fast, tau)
            return (self.fast * slow - self.slow * fast) / (2.0 * self.b)
        return tau - impulse - 2.0 * self.a / self.w2 * step

    def squares(self, tau: float) -> Tuple[float, float]:
        """Return the integrals of (1 - G)^2 [s] and K^2 [s^3] up to `tau`: docs/theory.md (15).

        For a other than 0. Both lose digits where G is small all the way, for a short `tau`.
        """
        a, w2 = self.a, self.w2
        step, impulse, _ = self.responses(tau)
        rest = 1.0 - step
        decay = -math.expm1(-2.0 * a * tau) / (2.0 * a)
        of_impulse = (decay - impulse * rest) / (2.0 * w2)
        of_rest = impulse * rest + a / w2 * step * (1.0 + rest) + w2 * of_impulse
        return of_rest, of_impulse

    def _first(self, tau: float) -> Tuple[float, float, float]:
        """Return the responses from the power series of G, for K = G'/w^2."""
        step = slope = 0.0
        for power, term in self._terms(tau):
            step += term
            slope += power * term
        spring = self.w2 * tau * tau
        impulse = slope / spring * tau if spring > 0.0 else tau
        return step, impulse, 1.0 - step - 2.0 * self.a * impulse

    def _terms(self, tau: float) -> Iterator[Tuple[int, float]]:
        """Give the terms of the power series of G; each follows from the equation of motion."""
        damping = 2.0 * self.a * tau
        spring = self.w2 * tau * tau
        before, term = 0.0, 0.5 * spring
        negligible = _NEGLIGIBLE * term
        power = 2
        while abs(term) + spring * abs(before) > negligible:
            yield power, term
            following = -(damping * power * term + spring * before) / (power * (power + 1))
            before, term = term, following
            power += 1

    def _undamped(self, tau: float) -> Tuple[float, float, float]:
        """Return the responses for a = 0.

        Here and in `_swinging` the cosine is taken from the half angle: near a whole turn G is
        small, and there a slip that grazes standstill is decided.
        """
        half = 0.5 * self.w * tau
        sine = math.sin(half)
        step = 2.0 * sine * sine
        return step, 2.0 * sine * math.cos(half) / self.w, 1.0 - step

    def _swinging(self, tau: float) -> Tuple[float, float, float]:
        """Return the responses for 0 < abs(a) < w."""
        half = 0.5 * self.b * tau
        sine = math.sin(half)
        decay = math.exp(-self.a * tau)
        twice = 2.0 * decay * sine
        impulse = twice * math.cos(half) / self.b
        along = self.a * impulse
        fallen = twice * sine
        return fallen - math.expm1(-self.a * tau) - along, impulse, decay - fallen - along

    def _decaying(self, tau: float) -> Tuple[float, float, float]:
        """Return the responses for abs(a) >= w."""
        slow, fast, apart = self.slow, self.fast, 2.0 * self.b
        rise = -math.expm1(-apart * tau) / apart if apart > 0.0 else tau
        impulse = math.exp(-slow * tau) * rise
        slope = math.exp(-fast * tau) - slow * impulse
        slowly, quickly = math.expm1(-slow * tau), math.expm1(-fast * tau)
        if self._far_apart:
            return (slow * quickly - fast * slowly) / apart, impulse, slope
        return -0.5 * (slowly + quickly) - self.a * impulse, impulse, slope


def oscillator_of(settings: Settings, before: Any) -> Oscillator:
    """Return mass, spring and damping of the settings, those of the friction before where alike."""
    constants = settings.k, settings.m, settings.c
    shared = getattr(before, "oscillator", None)
    if isinstance(shared, Oscillator) and (shared.k, shared.m, shared.c) == constants:
        return shared
    return Oscillator(*constants)


def _lag(rate: float, tau: float) -> float:
    """Return the integral of ``1 - exp(-rate t)`` from 0 to `tau`."""
    x = rate * tau
    if abs(x) > _BEGINNING:
        return tau + math.expm1(-x) / rate
    total = 0.0
    term, power = 0.5 * x, 2
    while abs(term) > _NEGLIGIBLE * abs(total):
        total += term
        power += 1
        term *= -x / power
    return tau * total
