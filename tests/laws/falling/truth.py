"""Falling kinetic friction, for the truth."""

from __future__ import annotations

from collections.abc import Sequence

from stickslip_verification.truth import FrictionLaw, Kind, Number, Numbers, Parameter, Series


class Falling(FrictionLaw):
    """Kinetic friction ``(mu_k - slope |x_dot|) N`` while that is >= 0; static ``mu_s N``."""

    parameters = (Parameter("slope", "s/m", 0.1, Kind.TUNABLE, low=0.0),)

    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        """Return ``(mu_k - slope speed) N`` [N]."""
        force: Series = n.F_k - speed * (n.own["slope"] * n.N)
        return force

    def speed_limit(self, n: Numbers) -> Number | None:
        """Return ``mu_k / slope`` [m/s], where the kinetic friction reaches 0."""
        return n.mu_k / n.own["slope"] if n.own["slope"] else None


LAW = Falling()
