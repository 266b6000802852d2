"""A solver that chatters: friction that jumps forth and back in full from step to step.

A solver with fixed steps and friction by the sign of the velocity never finds the mass at rest. In
stick it is driven by full friction now one way, now the other, so that the friction force that its
samples imply has two values and none between; noise has all of them.
"""

from collections.abc import Mapping

import numpy as np

from stickslip_score.law import Law
from stickslip_score.motion import Motion
from stickslip_verification.truth.parameters import used_mu_k

_LOOKED_AT = 20_000
_LEAST_SAMPLES = 40

_EVEN = 1e-6
"""Of a step: how far steps may differ where each is one of a solver's."""

_NEAR, _MOST, _LEAST, _TURNS = 0.15, 0.9, 0.02, 0.1
"""Of the friction force: how far a value may be off static or kinetic friction; the part of the
samples that must be so near; the part that must be driven against the pull; and how often for
each of these the force must turn."""


def chatters(motion: Motion, law: Law, p: Mapping[str, float]) -> bool:
    """Tell whether each sample is a step of a solver that chatters.

    Parameters
    ----------
    motion
        The samples.
    law
        The exact law, for w.
    p
        All parameters, SI.
    """
    t, y, z = (column[:_LOOKED_AT] for column in (motion.t, motion.y, motion.z))
    steps = np.diff(t)
    step = float(np.mean(steps))
    if t.size < _LEAST_SAMPLES or float(np.ptp(steps)) > _EVEN * step + 2.0 * np.spacing(t[-1]):
        return False
    friction = z[1:-1] - np.diff(y, 2) / (law.w * step) ** 2
    per_force = max(p["m"] * p["g"] + p["load"], 0.0) / p["k"]
    full, kinetic = p["mu_s"] * per_force, used_mu_k(p["mu_s"], p["mu_k"]) * per_force
    low, high = np.quantile(friction, [0.01, 0.99])
    back = friction < 0.5 * (low + high)
    if not 0.0 < np.mean(back) < 1.0:
        return False
    turns = np.count_nonzero(np.diff(back))
    if np.mean(back) < _LEAST or turns < _TURNS * np.count_nonzero(back):
        return False
    # The spring is known up to a constant; either pair of values may be the two of one size.
    pairs = (low + high, np.median(friction[back]) + np.median(friction[~back]))
    for middle in (0.5 * pair for pair in pairs):
        size = np.abs(friction - middle)
        off = np.minimum(np.abs(size - full), np.abs(size - kinetic))
        if np.mean(off < _NEAR * full) > _MOST:
            return True
    return False
