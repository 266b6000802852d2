"""Coulomb's friction law, and its static friction that grows at rest; docs/theory.md (1), (19)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from ..parameters import Bound, Parameters
from .law import NO_STATE, FrictionLaw, OwnParameter, State


class Coulomb(FrictionLaw):
    """Coulomb's law: ``mu_s N`` holds at rest, ``mu_k N`` drags in slip; docs/theory.md (1).

    At rest ``mu_s`` may grow with the age of the stick, docs/theory.md (19). Parameters without
    the values of that growth in ``own`` mean none.
    """

    parameters: Mapping[str, OwnParameter] = MappingProxyType(
        {
            "tau_s": OwnParameter(0.0, Bound("s", 0.0)),
            "B": OwnParameter(0.0, Bound("", 0.0)),
            "t_0": OwnParameter(1.0, Bound("s", 0.0, strict=True)),
            "age_start": OwnParameter(0.0, Bound("s", 0.0), tunable=False),
        }
    )
    constant_in_slip = True

    def ages(self, p: Parameters) -> bool:
        """Return whether ``mu_s`` grows at rest."""
        return dwells(p)

    def age_start(self, p: Parameters) -> float:
        """Return the age [s] of the first stick of a run that begins at rest."""
        return p.own.get("age_start", 0.0)

    def break_away_force(self, p: Parameters, age: float = 0.0, state: State = NO_STATE) -> float:
        """Return ``mu_s N`` [N], at the age of the stick where it grows; theory (6), (19)."""
        if not dwells(p):
            return float(p.F_s)
        return float(p.mu_k_used * p.N) + grown(p, age)

    def excess(self, p: Parameters, age: float = 0.0, state: State = NO_STATE) -> float:
        """Return ``(mu_s - mu_k) N`` [N], at the age of the stick where it grows."""
        return grown(p, age) if dwells(p) else super().excess(p, age, state)

    def slip_friction(self, p: Parameters, speed: float, state: State = NO_STATE) -> float:
        """Return ``mu_k N`` [N] at any speed."""
        return float(p.mu_k_used * p.N)


def dwells(p: Parameters) -> bool:
    """Tell whether static friction grows with the age of the stick; docs/theory.md (19)."""
    gap = p.own.get("tau_s") and np.any(np.greater(p.mu_s, p.mu_k_used))
    return bool(gap or p.own.get("B"))


def grown(p: Parameters, age: float) -> float:
    """Return what a stick of this age [s] holds beyond ``mu_k N`` [N]; docs/theory.md (19)."""
    tau_s, B, t_0 = (p.own.get(name, start) for name, start in (("tau_s", 0), ("B", 0), ("t_0", 1)))
    share = -math.expm1(-age / tau_s) if tau_s else 1.0
    coefficient = float(p.mu_s - p.mu_k_used) * share + B * math.log1p(age / t_0)
    return float(coefficient * p.N)


COULOMB = Coulomb()
