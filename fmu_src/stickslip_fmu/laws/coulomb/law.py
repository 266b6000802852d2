"""Coulomb's friction law as the block asks for it."""

from typing import Optional, Tuple

from fmi.table import ABOVE_ZERO, Quantity

from ...interface import Own, calculated, parameter
from ...numerics.finite import finite
from ...settings import Settings
from ..law import Arc, Friction
from ..sticking import StickArc, Sticking
from .arcs import SlipArc
from .coefficients import clamp_warning, friction_forces, kinetic_coefficient
from .dwell import AgeingStickArc, Dwell
from .oscillator import oscillator_of

_AGE = Quantity("Age", "Real", "Time", "s", 1.0)


class CoulombFriction(Sticking):
    """Coulomb friction under given settings.

    Parameters
    ----------
    settings
        The settings that hold.
    before
        The friction until now; where mass, spring and damping stay, it shares its oscillator.

    Attributes
    ----------
    mu_k_used
        Kinetic coefficient after the clamp.
    dwell
        Growth of the break-away force with the age of a stick; None where it does not grow.
    oscillator
        Mass, spring and damping.

    Raises
    ------
    ModelError
        If a force or a rate is beyond the range of double-precision numbers.
    """

    def __init__(self, settings: Settings, before: Optional[Friction]) -> None:
        super().__init__(settings)
        normal = settings.normal_force()
        self.mu_k_used = kinetic_coefficient(settings.mu_s, settings.mu_k)
        forces = friction_forces(settings.mu_s, self.mu_k_used, normal)
        self.F_s, self.kinetic, self.gap = forces
        finite(self.F_s)
        self.age_start = settings.age_start
        rise, tau_s = 0.0, settings.tau_s
        if tau_s > 0.0:
            rise, self.F_s, self.gap = self.gap, self.kinetic, 0.0
        strength = finite(settings.B * normal)
        self.varies = rise > 0.0 or strength > 0.0
        self.dwell = Dwell(rise, tau_s, strength, settings.t_0) if self.varies else None
        self.oscillator = oscillator_of(settings, before)

    def growth(self, age: float) -> float:
        """Return what a stick of this age has gained in break-away force [N]."""
        return 0.0 if self.dwell is None else self.dwell.growth(age)

    def stick(self, z: float, way: Optional[float] = None, age: float = 0.0) -> StickArc:
        """Return the stick that starts so."""
        if self.dwell is None:
            return super().stick(z, way, age)
        settings = self.settings
        return AgeingStickArc(
            settings.k, settings.v, z, self.F_s, settings.F_ext, self.dwell, way, age
        )

    def slip_terms(self) -> Tuple[float, ...]:
        """Return what the equation of slip is made of, beside mass and direction: (3)."""
        settings = self.settings
        return settings.k, settings.c, settings.v, settings.F_ext, self.kinetic

    def slip(self, mode: int, z: float, x_dot: float, net: float) -> Arc:
        """Return the slip that starts so."""
        return SlipArc(self.oscillator, self.settings.v, z, x_dot, mode, net, self.kinetic)


_MU = "FrictionCoefficient"
_CLAMPED = "Kinetic friction coefficient; above mu_s it is clamped, see mu_k_used"
_USED = "Kinetic friction coefficient after the clamp"
_USED_AT, _BOTH = "state.friction.mu_k_used", ("mu_s", "mu_k")
_GROWS = "Time constant of the growth from mu_k to mu_s in stick; 0 for none"
_STRENGTH = "Growth of static friction in stick with ln(1 + t/t_0), t the age of the stick"
_OLD = "Age of the first stick when the run starts at rest"
_ROWS = (
    parameter(4, "mu_s", _MU, "tunable", 0.5, "Static friction coefficient", 0.0),
    parameter(5, "mu_k", _MU, "tunable", 0.3, _CLAMPED, 0.0),
    calculated(33, "mu_k_used", _MU, _USED, _BOTH, "discrete", minimum=0.0, path=_USED_AT),
    parameter(34, "tau_s", _AGE, "tunable", 0.0, _GROWS, 0.0),
    parameter(35, "B", _MU, "tunable", 0.0, _STRENGTH, 0.0),
    parameter(36, "t_0", _AGE, "tunable", 1.0, "Time scale of that logarithm", ABOVE_ZERO),
    parameter(37, "age_start", _AGE, "fixed", 0.0, _OLD, 0.0),
)


class Coulomb:
    """Coulomb's friction law."""

    interface = Own(
        model="StickSlip",
        description=(
            "A mass pulled over dry friction through a spring: sticks, breaks away, slips, sticks "
            "again. Solved exactly from event to event, so no result depends on the communication "
            "step."
        ),
        rows=_ROWS,
        at_rest=("mu_s", "mu_k", "tau_s", "B", "t_0", "age_start"),
        in_slip=(),
        break_away="Break-away force mu_s N, of a stick of this age where tau_s or B is not 0",
        ages=True,
    )

    def warning(self, settings: Settings) -> Optional[str]:
        """Return that the kinetic coefficient is clamped; None if it is not."""
        return clamp_warning(settings.mu_s, settings.mu_k)

    def under(self, settings: Settings, before: Optional[Friction] = None) -> Friction:
        """Return the law under these settings."""
        return CoulombFriction(settings, before)


COULOMB = Coulomb()
