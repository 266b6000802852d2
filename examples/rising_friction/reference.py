"""Rising kinetic friction in the reference: the friction at a speed; SciPy integrates."""

from collections.abc import Mapping
from types import MappingProxyType

from stickslip_ref import Bound, Coulomb, OwnParameter, Parameters, State


class Rising(Coulomb):
    """F_k = (mu_k + rise |x_dot|) N."""

    parameters: Mapping[str, OwnParameter] = MappingProxyType(
        {"rise": OwnParameter(0.01, Bound("s/m", 0.0))}
    )
    constant_in_slip = False

    def slip_friction(self, p: Parameters, speed: float, state: State = ()) -> float:
        """Return the kinetic friction [N]."""
        return float((p.mu_k_used + p.own["rise"] * speed) * p.N)


LAW = Rising()
