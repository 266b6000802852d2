"""Coulomb's friction law; docs/theory.md (1)."""

from __future__ import annotations

from ..parameters import Parameters
from .law import NO_STATE, FrictionLaw, State


class Coulomb(FrictionLaw):
    """Coulomb's law: ``mu_s N`` holds at rest, ``mu_k N`` drags in slip; docs/theory.md (1)."""

    constant_in_slip = True

    def break_away_force(self, p: Parameters, age: float = 0.0, state: State = NO_STATE) -> float:
        """Return ``mu_s N`` [N] at any age of the stick; docs/theory.md (6)."""
        return float(p.F_s)

    def slip_friction(self, p: Parameters, speed: float, state: State = NO_STATE) -> float:
        """Return ``mu_k N`` [N] at any speed."""
        return float(p.mu_k_used * p.N)


COULOMB = Coulomb()
