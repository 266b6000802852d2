"""Coulomb friction with a static coefficient above the kinetic one: docs/theory.md (1), (4)."""

from typing import Optional, Tuple

# The gap that a kinetic coefficient above the static one is clamped to.
_CLAMP_GAP = 0.01


def kinetic_coefficient(mu_s: float, mu_k: float) -> float:
    """Return the kinetic coefficient in use: `mu_k`, or the clamp where it exceeds `mu_s`."""
    return mu_k if mu_k <= mu_s else max(mu_s - _CLAMP_GAP, 0.0)


def clamp_warning(mu_s: float, mu_k: float) -> Optional[str]:
    """Return that the kinetic coefficient is clamped, with both values; None if it is not."""
    if mu_k <= mu_s:
        return None
    return (
        f"mu_k = {mu_k!r} is above mu_s = {mu_s!r}: "
        "mu_k is clamped to max(mu_s - 0.01, 0), see mu_k_used"
    )


def friction_forces(mu_s: float, mu_k_used: float, normal: float) -> Tuple[float, float, float]:
    """Return break-away force, kinetic friction and their difference [N].

    The difference is formed from the coefficients, where it is exact when they are close.
    """
    return mu_s * normal, mu_k_used * normal, (mu_s - mu_k_used) * normal
