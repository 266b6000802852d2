"""Coulomb's friction law as the block asks for it."""

from typing import Optional, Tuple

from ...interface import Own, calculated, parameter
from ...numerics.finite import finite
from ...settings import Settings
from ..law import Arc, Friction
from ..sticking import Sticking
from .arcs import SlipArc
from .coefficients import clamp_warning, friction_forces, kinetic_coefficient
from .oscillator import Oscillator


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
    oscillator
        Mass, spring and damping.

    Raises
    ------
    ModelError
        If a force or a rate is beyond the range of double-precision numbers.
    """

    __slots__ = ("mu_k_used", "oscillator")

    def __init__(self, settings: Settings, before: Optional[Friction]) -> None:
        super().__init__(settings)
        normal = settings.normal_force()
        self.mu_k_used = kinetic_coefficient(settings.mu_s, settings.mu_k)
        forces = friction_forces(settings.mu_s, self.mu_k_used, normal)
        self.F_s, self.kinetic, self.gap = forces
        finite(self.F_s)
        k, m, c = settings.k, settings.m, settings.c
        self.oscillator: Oscillator
        if isinstance(before, CoulombFriction) and (k, m, c) == before.oscillator.constants:
            self.oscillator = before.oscillator
        else:
            self.oscillator = Oscillator(k, m, c)

    def slip_terms(self) -> Tuple[float, ...]:
        """Return what the equation of slip is made of, beside mass and direction: (3)."""
        settings = self.settings
        return settings.k, settings.c, settings.v, settings.F_ext, self.kinetic

    def slip(self, mode: int, z: float, x_dot: float, net: float) -> Arc:
        """Return the slip that starts so."""
        return SlipArc(self.oscillator, self.settings.v, z, x_dot, mode, net, self.kinetic)


class Coulomb:
    """Coulomb's friction law."""

    interface = Own(
        model="StickSlip",
        description=(
            "A mass pulled over dry friction through a spring: sticks, breaks away, slips, sticks "
            "again. Solved exactly from event to event, so no result depends on the communication "
            "step."
        ),
        rows=(
            parameter(
                4, "mu_s", "FrictionCoefficient", "tunable", 0.5, "Static friction coefficient", 0.0
            ),
            parameter(
                5,
                "mu_k",
                "FrictionCoefficient",
                "tunable",
                0.3,
                "Kinetic friction coefficient; above mu_s it is clamped, see mu_k_used",
                0.0,
            ),
            calculated(
                33,
                "mu_k_used",
                "FrictionCoefficient",
                "Kinetic friction coefficient after the clamp",
                ("mu_s", "mu_k"),
                0.0,
                variability="discrete",
                held_at="state.friction.mu_k_used",
            ),
        ),
        at_rest=("mu_s",),
        in_slip=("mu_k",),
    )

    def warning(self, settings: Settings) -> Optional[str]:
        """Return that the kinetic coefficient is clamped; None if it is not."""
        return clamp_warning(settings.mu_s, settings.mu_k)

    def under(self, settings: Settings, before: Optional[Friction] = None) -> Friction:
        """Return the law under these settings."""
        return CoulombFriction(settings, before)


COULOMB = Coulomb()
