"""Rising kinetic friction in the truth: the series of the friction from that of the speed."""

from collections.abc import Sequence

from stickslip_verification.truth import FrictionLaw, Kind, Numbers, Parameter, Series


class Rising(FrictionLaw):
    """F_k = (mu_k + rise |x_dot|) N."""

    parameters = (Parameter("rise", "s/m", 0.01, Kind.TUNABLE, low=0.0),)

    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        """Return the kinetic friction [N]."""
        friction: Series = n.F_k + speed * (n.own["rise"] * n.N)
        return friction


LAW = Rising()
