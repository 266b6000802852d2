"""The simulation of the block with SciPy, for any friction law."""

from .inputs import Change
from .run import RTOL, simulate

__all__ = ["RTOL", "Change", "simulate"]
