"""All that is known of a curve when its cause is decided."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stickslip_score.fit import Fit
from stickslip_score.held import on_the_law
from stickslip_score.law import Law
from stickslip_score.measure import Measured
from stickslip_score.motion import Motion
from stickslip_score.phases import Phases
from stickslip_score.slide import Slide


@dataclass(frozen=True)
class Evidence:
    """All that is known of a curve when it is judged.

    Attributes
    ----------
    p
        All parameters, SI.
    exact
        period, t_stick, t_slip [s], delta_x [m] of a forward pull; None where no cycle exists.
    law
        The exact law.
    motion, phases, measured
        The curve and what was seen of it.
    fits
        The curve held against the law, by name: exact, one coefficient, gap, gap and mass.
    chatters
        Whether each sample is a step of a solver that chatters.
    slide
        The curve held against sliding without end, from any start; None where a cycle exists.
    """

    p: Mapping[str, float]
    exact: Mapping[str, float] | None
    law: Law
    motion: Motion
    phases: Phases
    measured: Measured
    fits: Mapping[str, Fit]
    chatters: bool
    slide: Slide | None

    def lies_on(self, name: str) -> bool:
        """Tell whether all samples lie on this law, to their digits or their noise."""
        return name in self.fits and on_the_law(self.fits[name], self.motion)

    @property
    def break_away(self) -> float:
        """Spring extension at which the mass breaks away, by the model [m]."""
        direction = math.copysign(1.0, self.p["v"])
        N = max(self.p["m"] * self.p["g"] + self.p["load"], 0.0)
        return (self.p["mu_s"] * N - direction * self.p["F_ext"]) / self.p["k"]

    @property
    def highest(self) -> float:
        """Highest extension of the spring, by the model [m]: a little beyond break-away."""
        law = self.law
        return self.break_away + math.hypot(max(law.D, 0.0), law.v / law.w) - max(law.D, 0.0)

    @property
    def swing(self) -> float:
        """Half the swing of the spring about its rest in sliding [m]."""
        return math.hypot(self.law.D, self.law.v / self.law.w)

    def gap_ratio(self, D: float) -> float:
        """Return the gap of the friction forces that belongs to a D, over the given one."""
        drag = 2.0 * self.law.zeta * self.law.v / self.law.w
        gap = self.law.D + drag
        return (D + drag) / gap if gap else math.inf

    @property
    def seen_gap(self) -> float:
        """The gap that the swing of the spring shows [m]; 0 for a swing of v/w alone."""
        if not self.phases.lows.size:
            return self.law.D
        swing = float(np.median(self.phases.highs[: self.phases.lows.size] - self.phases.lows))
        return math.sqrt(max((0.5 * swing) ** 2 - (self.law.v / self.law.w) ** 2, 0.0))
