"""Where a mass leaves its rest: what tells a break-away after which the spring need not turn.

In a slip that ends, the spring falls. In one that goes on for ever it may only rise, to the
extension of steady sliding (c v > (mu_s - mu_k) N, say), so that no turn of the spring shows the
break-away; the samples at rest before it do.
"""

from dataclasses import dataclass

import numpy as np

from stickslip_score.law import Law
from stickslip_score.motion import Motion
from stickslip_score.phases import VISIBLE, plateau


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
