"""The refusal of values that left the range of double-precision numbers."""

import math

from ..settings import BlockError

NOT_FINITE = "the motion or its forces leave the range of double-precision numbers"


def finite(value: float) -> float:
    """Return `value`; raises BlockError where it is infinite or not a number."""
    if not math.isfinite(value):
        raise BlockError(NOT_FINITE)
    return value
