"""A curve held against sliding without end, from any start: for curves that begin in a slip.

Where no cycle exists the motion after a break-away is one arc for ever, and so is that of a mass
which was moving when the curve began. The arc is linear in its steady extension and in the
extension and its rate at the first sample, so that least squares need no search,
docs/theory.md (3).
"""

from dataclasses import dataclass

import numpy as np

from stickslip_score.law import Law
from stickslip_score.motion import Motion


@dataclass(frozen=True)
class Slide:
    """The arc of sliding that comes nearest to a curve.

    Attributes
    ----------
    z_steady
        Spring extension to which it tends [m]; up to a constant where the motion has it so.
    spread
        How far that may be off for the digits of the samples [m].
    excess, worst
        Largest distance of a sample from the arc, in units of what its digits allow and in metres.
    """

    z_steady: float
    spread: float
    excess: float
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
    reach = np.abs(inverse) @ np.full(after.size, motion.allowed)
    beyond, fastest = float(reach[1]), law.v + float(reach[2])
    r = z - basis @ np.array([level, extension, rate])
    r = r - 0.5 * (np.max(r) + np.min(r))
    backward = rate > fastest
    from_rest = abs(rate - law.v) <= float(reach[2]) and extension < law.D - beyond
    if backward or from_rest:
        return None
    return Slide(
        z_steady=float(motion.z[0]) + level - extension,
        spread=float(reach[0]) + beyond,
        excess=float(np.max(np.abs(r))) / motion.allowed,
        worst=float(np.max(np.abs(r))),
    )
