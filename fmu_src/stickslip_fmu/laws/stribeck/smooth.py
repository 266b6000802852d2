"""Friction that falls smoothly with speed, Stribeck's or hyperbolic: docs/theory.md (1), (4)."""

import math
from typing import Optional, Tuple, Union

from fmi.model import ModelError

from ...numerics.finite import finite
from ...settings import Settings
from ..coulomb.arcs import SlipArc
from ..coulomb.coefficients import kinetic_coefficient
from ..coulomb.oscillator import Oscillator, oscillator_of
from ..law import Arc, Friction
from ..sticking import SlipOfSticking, StickArc, Sticking
from .band import Band, BandSlip
from .piece import PieceSlip, Smooth
from .shapes import Hyperbolic, Stribeck

# Half width of the band about steady sliding in which friction is its tangent, relative to the
# speed over which its slope changes: the error of the friction is the square of it.
_NEAR = 2.0**-32
# What the neglected friction of a beginning may change the time by, relative to 1/w.
_SOON = 2.0**-58

HYPERBOLIC = 2


class SmoothFriction(Sticking):
    """Friction that falls smoothly with speed, under given settings.

    A slip is a chain of arcs. Where friction is a straight line to rounding they are in closed
    form: at speeds at which its fall is over, close to steady sliding, and at the beginning from
    rest where the exponent is not whole. Between they are power series.

    Parameters
    ----------
    settings
        The settings that hold.
    before
        The friction until now; where mass, spring and damping stay, it shares its oscillator.

    Attributes
    ----------
    mu_k_used
        Kinetic coefficient of high speeds, after the clamp.
    smooth
        The friction over speed.

    Raises
    ------
    ModelError
        If a force or a rate is beyond the range of double-precision numbers.
    """

    def __init__(self, settings: Settings, before: Optional[Friction]) -> None:
        super().__init__(settings)
        normal = settings.normal_force()
        mu_s = settings.mu_s
        self.mu_k_used = mu_k = kinetic_coefficient(mu_s, settings.mu_k)
        self.F_s = self.kinetic = finite(mu_s * normal)
        self.gap = 0.0
        self.oscillator = oscillator_of(settings, before)
        k, m, c = settings.k, settings.m, settings.c
        shape: Union[Hyperbolic, Stribeck]
        shape = Hyperbolic() if settings.shape == HYPERBOLIC else Stribeck(settings.delta)
        drop, rest = (mu_s - mu_k) * normal, mu_k * normal
        v_s = settings.v_s
        if not drop / v_s / m < math.inf:
            raise ModelError(
                f"v_s = {v_s!r} m/s is out of range: its rate (mu_s - mu_k) N/(m v_s) leaves the "
                "range of double-precision numbers"
            )
        self.smooth = Smooth(k, m, c, settings.v, shape, v_s, drop, rest)
        self._flat = Band(shape.flat_from * v_s, math.inf, -drop, 0.0, rest)
        self._tangent: Optional[Tuple[Band, Oscillator]] = None

    def slip_terms(self) -> Tuple[float, ...]:
        """Return what the equation of slip is made of, beside mass, shape and direction."""
        settings, smooth = self.settings, self.smooth
        forces = smooth.drop, smooth.rest, settings.v_s, settings.delta
        return (settings.k, settings.c, settings.v, settings.F_ext, *forces)

    def after(self, arc: Union[StickArc, SlipOfSticking], z: float) -> Arc:
        """Return what follows the end of an arc: in a slip that goes on, its next arc."""
        if isinstance(arc, (PieceSlip, BandSlip)) and arc.leaves != 0:
            net = arc.net_at_end(z - arc.z_start)
            return self.slip(arc.mode, z, arc.mode * arc.exit_speed, net)
        return super().after(arc, z)

    def slip(self, mode: int, z: float, x_dot: float, net: float) -> Arc:
        """Return the slip that starts so, or its first part."""
        smooth, oscillator = self.smooth, self.oscillator
        if smooth.drop == 0.0:
            return SlipArc(oscillator, smooth.v, z, x_dot, mode, net, self.kinetic)
        speed = mode * x_dot
        band: Optional[Band] = None
        if speed >= self._flat.low:
            band = self._flat
        elif self._is_steady(speed, mode * net, mode * smooth.v):
            band, oscillator = self._steady(mode * smooth.v)
        elif speed == 0.0 and not smooth.shape.analytic:
            band = self._beginning(mode * net, mode * smooth.v)
        if band is not None:
            return BandSlip(oscillator, smooth.v, z, x_dot, mode, net, self.kinetic, band)
        return PieceSlip(smooth, z, x_dot, mode, net)

    def _is_steady(self, speed: float, net: float, pull: float) -> bool:
        """Whether the motion is so close to steady sliding that friction is its tangent there."""
        smooth = self.smooth
        near = 0.5 * self._nearness(pull)
        if not abs(speed - pull) < near:
            return False
        force = net + smooth.drop * smooth.shape.fallen(speed / smooth.v_s) - smooth.c * speed
        return abs(force) < near * smooth.m * smooth.w

    def _nearness(self, pull: float) -> float:
        """Return the half width of the band about steady sliding [m/s]."""
        smooth = self.smooth
        if pull < 0.0:
            return 0.0
        breadth = smooth.v_s * smooth.shape.breadth
        if not smooth.shape.analytic:
            return _NEAR * min(breadth, pull)
        return _NEAR * (breadth + pull) if smooth.shape.flat_from == math.inf else _NEAR * breadth

    def _steady(self, pull: float) -> Tuple[Band, Oscillator]:
        """Return the band about steady sliding, and mass, spring and damping in it."""
        if self._tangent is None:
            smooth, shape = self.smooth, self.smooth.shape
            ratio, near = pull / smooth.v_s, self._nearness(pull)
            steep = shape.steepness(ratio)
            low = max(pull - near, 0.0)
            slope = -(smooth.drop / smooth.v_s) * steep
            rise = smooth.drop * (steep * ratio - shape.fallen(ratio))
            friction = smooth.friction(pull) + slope * (low - pull)
            band = Band(low, pull + near, rise, slope, friction)
            self._tangent = band, Oscillator(smooth.k, smooth.m, smooth.c + slope)
        return self._tangent

    def _beginning(self, net: float, pull: float) -> Band:
        """Return the band of speeds from 0 on in which friction has not begun to fall.

        The speed is ``A t + j t^2/2`` with A = net/m, j = k V/m. Friction ``D q^delta`` advances
        the time by its ratio to ``m A`` a time t, or to ``m j``.
        """
        smooth = self.smooth
        delta, share = smooth.shape.delta, _SOON / (smooth.w * smooth.drop)
        high = 0.0
        if pull > 0.0:
            high = smooth.v_s * math.pow(share * smooth.k * pull, 1.0 / delta)
        if net > 0.0:
            quick = share * net * (net / (smooth.m * smooth.v_s))
            high = max(high, smooth.v_s * math.pow(quick, 1.0 / (delta + 1.0)))
        high = min(high, smooth.v_s)
        return Band(0.0, high if high > 0.0 else smooth.v_s, 0.0, 0.0, self.kinetic)
