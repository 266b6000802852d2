"""Falling kinetic friction, for the reference."""

from __future__ import annotations

import math
from collections.abc import Mapping

from stickslip_ref import Bound, Coulomb, OwnParameter, Parameters, State


class Falling(Coulomb):
    """Kinetic friction ``(mu_k - slope |x_dot|) N`` while that is >= 0; static ``mu_s N``."""

    parameters: Mapping[str, OwnParameter] = {"slope": OwnParameter(0.1, Bound("s/m", 0.0))}
    constant_in_slip = False

    def slip_friction(self, p: Parameters, speed: float, state: State = ()) -> float:
        """Return ``(mu_k - slope speed) N`` [N], beyond the limit of the law too."""
        return float((p.mu_k_used - p.own["slope"] * speed) * p.N)

    def speed_limit(self, p: Parameters) -> float:
        """Return ``mu_k / slope`` [m/s], where the kinetic friction reaches 0."""
        slope = p.own["slope"]
        return float(p.mu_k_used) / slope if slope else math.inf


LAW = Falling()
