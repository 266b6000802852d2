"""Sliding without end: where the mass leaves its rest, and the arc that it follows.

Where no cycle exists the motion after a break-away is one arc for ever, and so is that of a mass
which was moving when the curve began. The spring need not turn, so that samples at rest tell the
break-away. The arc is linear in its steady extension and in the extension and its rate at the first
sample, so that least squares need no search, docs/theory.md (3).
"""

from dataclasses import dataclass

import numpy as np

from stickslip_score.fit import ON_THE_LAW, is_white
from stickslip_score.law import Law
from stickslip_score.motion import Motion
from stickslip_score.phases import VISIBLE, plateau

_DEVIATIONS = 3.0
"""Standard deviations of noise that a number of the arc may be off."""


@dataclass(frozen=True)
class Slide:
    """The arc of sliding that comes nearest to a curve.

    Attributes
    ----------
    z_steady
        Spring extension to which it tends [m]; up to a constant where the motion has it so.
    spread
        How far that may be off for the digits and the noise of the samples [m].
    on_the_law
        Whether all samples lie on the arc, to their digits or their noise.
    worst
        Largest distance of a sample from the arc [m].
    """

    z_steady: float
    spread: float
    on_the_law: bool
    worst: float


def fit_slide(motion: Motion, law: Law) -> Slide | None:
    """Fit an arc of sliding to all samples; None where that arc is none of the block's.

    The block's slides go forward. One that begins at rest begins with a spring that is stretched
    to break-away or farther.
    """
    after = motion.t - motion.t[0]
    by_extension, by_rate = law.response(after)
    z = motion.z - motion.z[0]
    basis = np.stack([np.ones_like(after), by_extension - 1.0, by_rate], axis=1)
    scale = np.max(np.abs(basis), axis=0)
    inverse = np.linalg.pinv(basis / scale) / scale[:, None]
    level, extension, rate = (float(number) for number in inverse @ z)
    noise = _DEVIATIONS * motion.noise * np.sqrt(np.sum(inverse**2, axis=1))
    reach = np.sum(np.abs(inverse), axis=1) * motion.digits + noise
    beyond, fastest = float(reach[1]), law.v + float(reach[2])
    r = z - basis @ np.array([level, extension, rate])
    worst = 0.5 * float(np.ptp(r))
    backward = rate > fastest
    from_rest = abs(rate - law.v) <= float(reach[2]) and extension < law.D - beyond
    if backward or from_rest:
        return None
    return Slide(
        z_steady=float(motion.z[0]) + level - extension,
        spread=float(reach[0]) + beyond,
        on_the_law=worst <= ON_THE_LAW * motion.digits
        or (motion.noise > 0.0 and is_white(motion.t, r)),
        worst=worst,
    )


@dataclass(frozen=True)
class Rest:
    """Samples `first` to `last` (indices), in which a mass is not seen to move."""

    first: int
    last: int

    def window(self, motion: Motion, law: Law) -> tuple[float, float] | None:
        """Return between which times the law breaks away [s]; None where the mass rests on.

        A sample out of the rest comes after the break-away; one still in it comes at most so long
        after as the slip needs for what the digits show. The band of a rest is `VISIBLE` wide, and
        so may be the distance of its level from the true one.
        """
        if self.last + 1 >= motion.t.size:
            return None
        hidden = law.time_to_move(2.0 * VISIBLE * motion.allowed)
        return float(motion.t[self.last]) - hidden, float(motion.t[self.last + 1])


def rests_of(motion: Motion) -> tuple[Rest, ...]:
    """Return the rest with which the curve begins, if only of one sample, and its longest."""
    band = VISIBLE * motion.allowed
    out = np.flatnonzero(np.abs(motion.y - motion.y[0]) > band)
    begin = Rest(0, int(out[0]) - 1 if out.size else motion.t.size - 1)
    first, last, _ = plateau(motion.t, motion.y, band)
    longest = Rest(first, last)
    return (begin, longest) if longest.first > begin.last else (begin,)
