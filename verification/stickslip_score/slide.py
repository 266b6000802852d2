"""A curve held against sliding without end, from any start: for curves that begin in a slip.

Where no cycle exists the motion after a break-away is one arc for ever, and so is that of a mass
which was moving when the curve began. The arc is linear in its steady extension and in the
extension and its rate at the first sample, so that least squares need no search,
docs/theory.md (3).
"""

from dataclasses import dataclass

import numpy as np

from stickslip_score.fit import ON_THE_LAW, is_white
from stickslip_score.law import Law
from stickslip_score.motion import Motion

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
