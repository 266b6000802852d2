"""Friction over a curve of measured points, straight between them: docs/theory.md (1), (4)."""

from typing import List, Optional, Tuple, Union

from fmi.model import ModelError

from ...numerics.finite import finite
from ...settings import Settings
from ..coulomb.arcs import SlipArc
from ..coulomb.oscillator import Oscillator
from ..law import Arc, Friction
from ..sticking import SlipOfSticking, StickArc, Sticking
from .band import Band, BandSlip
from .points import Points, band_of, lines_of, points_of


class CurveFriction(Sticking):
    """Friction over a measured curve, under given settings.

    A slip is a chain of arcs, one for each band of speeds that it passes. A speed at an end of two
    bands belongs to the one into which it moves; a speed that stays there belongs to the lower.

    Parameters
    ----------
    settings
        The settings that hold.
    before
        The friction until now; where mass, spring, damping, normal force and curve stay, it shares
        its bands.

    Attributes
    ----------
    mu_k_used
        Friction coefficient of high speeds.
    points
        The points that count.
    bands
        The bands of speed, from 0 on.

    Raises
    ------
    ModelError
        If the speeds of the points do not rise, mu_1 is above mu_s, or a force or a rate is beyond
        the range of double-precision numbers.
    """

    def __init__(self, settings: Settings, before: Optional[Friction]) -> None:
        super().__init__(settings)
        mu_1, mu_s = settings.mu_1, settings.mu_s
        if mu_1 > mu_s:
            raise ModelError(f"mu_1 = {mu_1!r} is out of range: it must be at most mu_s = {mu_s!r}")
        self.points: Points = points_of(settings)
        self.normal = normal = settings.normal_force()
        self.mu_k_used = self.points[-1][1]
        self.F_s, self.kinetic = finite(mu_s * normal), mu_1 * normal
        self.gap = (mu_s - mu_1) * normal
        self.bands: Tuple[Band, ...]
        self._oscillators: List[Optional[Oscillator]]
        self._of_bands = settings.k, settings.m, settings.c, normal, self.points
        if isinstance(before, CurveFriction) and self._of_bands == before._of_bands:
            self.bands, self._oscillators = before.bands, before._oscillators
        else:
            self.bands = tuple(band_of(line, mu_1, normal) for line in lines_of(self.points))
            self._oscillators = [None] * len(self.bands)

    def slip_terms(self) -> Tuple[float, ...]:
        """Return what the equation of slip is made of, beside mass, direction and fixed points."""
        settings = self.settings
        return settings.k, settings.c, settings.v, settings.F_ext, self.normal

    def after(self, arc: Union[StickArc, SlipOfSticking], z: float) -> Arc:
        """Return what follows the end of an arc: in a slip that goes on, the next band's arc."""
        if isinstance(arc, BandSlip) and arc.leaves != 0:
            net = arc.net_at_end(z - arc.z_start)
            return self.slip(arc.mode, z, arc.mode * arc.exit_speed, net)
        return super().after(arc, z)

    def slip(self, mode: int, z: float, x_dot: float, net: float) -> Arc:
        """Return the slip that starts so, in the band of its speed."""
        v = self.settings.v
        position = self._position(mode * x_dot, mode * net, mode * v)
        band, oscillator = self.bands[position], self._oscillator(position)
        if len(self.bands) == 1:
            return SlipArc(oscillator, v, z, x_dot, mode, net, self.kinetic)
        return BandSlip(oscillator, v, z, x_dot, mode, net, self.kinetic, band)

    def _oscillator(self, position: int) -> Oscillator:
        """Return mass, spring and damping of a band, made when it is first entered."""
        oscillator = self._oscillators[position]
        if oscillator is None:
            settings = self.settings
            damping = settings.c + self.bands[position].slope
            oscillator = Oscillator(settings.k, settings.m, damping)
            self._oscillators[position] = oscillator
        return oscillator

    def _position(self, speed: float, net: float, pull: float) -> int:
        """Return the position of the band in which a motion from this speed goes on.

        `net` is the force along the slip but for the damping, with the friction at standstill.
        """
        position = 0
        while speed > self.bands[position].high:
            position += 1
        band = self.bands[position]
        if speed == band.high:
            force = (net - band.rise) - (self.settings.c + band.slope) * speed
            if force > 0.0 or (force == 0.0 and pull > speed):
                position += 1
        return position
