"""The friction law: when a mass at rest breaks away, and what drags on it while it slips.

A law is one object with the interface of `FrictionLaw`. Another law is another object: the
simulation asks nothing else of it. docs/theory.md (1), (4).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from .parameters import Parameters

REST_SLACK = 8.0 * 2.0**-52
"""Rounding slack of the rest test, relative to the sum of the forces it compares; theory (4)."""


class FrictionLaw(Protocol):
    """What the simulation asks of a friction law; every force is a magnitude in newtons."""

    @property
    def constant_in_slip(self) -> bool:
        """Whether `slip_friction` is the same at every speed."""
        ...

    def break_away_force(self, p: Parameters) -> float:
        """Return the largest force [N] that friction holds at rest."""
        ...

    def slip_friction(self, p: Parameters, speed: float) -> float:
        """Return the dry friction [N] on a mass that slips at ``speed`` [m/s] >= 0."""
        ...


@dataclass(frozen=True)
class Coulomb:
    """Coulomb's law: ``mu_s N`` holds at rest, ``mu_k N`` drags in slip; docs/theory.md (1)."""

    constant_in_slip: bool = True

    def break_away_force(self, p: Parameters) -> float:
        """Return ``mu_s N`` [N]; docs/theory.md (6)."""
        return float(p.F_s)

    def slip_friction(self, p: Parameters, speed: float) -> float:
        """Return ``mu_k N`` [N] at any speed."""
        return float(p.mu_k_used * p.N)


COULOMB = Coulomb()


def breaks_away(spring_force: float, F_ext: float, F_s: float, uncertainty: float = 0.0) -> bool:
    """Tell whether a mass at rest is pulled by more than friction holds; docs/theory.md (4).

    Parameters
    ----------
    spring_force, F_ext : float
        Spring force ``k z`` and external force [N].
    F_s : float
        Break-away force [N].
    uncertainty : float
        What is not known of the spring force [N], where it comes from an integration.

    Notes
    -----
    Equality sticks, and "more" means by more than rounding: ``8 * 2**-52`` of
    ``|k z| + |F_ext| + F_s``.
    """
    slack = REST_SLACK * (abs(spring_force) + abs(F_ext) + F_s)
    return abs(spring_force + F_ext) - F_s > slack + uncertainty
