"""The refusal of values that left the range of double-precision numbers."""

import math

from fmi.model import ModelError

NOT_FINITE = "the motion or its forces leave the range of double-precision numbers"


def finite(value: float) -> float:
    """Return `value`; raises ModelError where it is infinite or not a number."""
    if not math.isfinite(value):
        raise ModelError(NOT_FINITE)
    return value
