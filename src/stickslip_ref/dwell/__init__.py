"""The steady cycles where static friction grows with the time at rest; docs/theory.md (19) to (23).

Lengths are forces over k. ``g(t)`` is what a stick of the age t holds beyond kinetic friction.
"""

from .attractors import Attractor, Attractors, dwell_attractors, last_break_away
from .cycles import critical_speed, cycle_ranges, dwell_cycle
from .family import LEAST_STICK

__all__ = [
    "LEAST_STICK",
    "Attractor",
    "Attractors",
    "critical_speed",
    "cycle_ranges",
    "dwell_attractors",
    "dwell_cycle",
    "last_break_away",
]
