"""Rising kinetic friction in the block: Coulomb's slip with the damping c + rise N.

This side travels in the FMU: Python 3.8, its standard library, and exact.
"""

from __future__ import annotations

from fmi.table import Quantity, Unit
from stickslip_fmu.interface import parameter
from stickslip_fmu.laws.coulomb.law import Coulomb, CoulombFriction
from stickslip_fmu.laws.coulomb.oscillator import Oscillator
from stickslip_fmu.laws.law import Friction
from stickslip_fmu.settings import Settings

_RISE = Quantity("Rise", "Real", "", "s/m", 0.1)


class RisingFriction(CoulombFriction):
    """The law under given settings."""

    def __init__(self, settings: Settings, before: Friction | None) -> None:
        super().__init__(settings, before)
        damping = settings.c + settings.rise * settings.normal_force()
        self.oscillator = Oscillator(settings.k, settings.m, damping)

    def slip_terms(self) -> tuple[float, ...]:
        """Return what the equation of slip is made of."""
        return (*super().slip_terms(), self.oscillator.c)


class Rising(Coulomb):
    """Kinetic friction that rises linearly with speed."""

    interface = Coulomb.interface._replace(
        model="RisingFriction",
        description="A mass pulled through a spring over friction that rises with speed.",
        rows=(
            *Coulomb.interface.rows,
            parameter(38, "rise", _RISE, "tunable", 0.01, "Rise of mu_k with speed", 0.0),
        ),
        in_slip=("rise",),
        units={"s/m": Unit({"s": 1, "m": -1})},
    )

    def under(self, settings: Settings, before: Friction | None = None) -> Friction:
        """Return the law under these settings."""
        return RisingFriction(settings, before)


LAW = Rising()
