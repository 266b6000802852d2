"""How much of its tolerance an error uses up, and how numbers are written for people."""

import math

from stickslip_verification.model.verdict import CheckResult


def margin(error: float | None, tolerance: float) -> float:
    """Return error over tolerance: 0 is exact, 1 the edge, infinity where nothing was comparable.

    A tolerance of 0 allows only an error of 0.
    """
    if error is None or not math.isfinite(error):
        return math.inf
    if tolerance == 0.0:
        return 0.0 if error == 0.0 else math.inf
    return error / tolerance


def margin_of(result: CheckResult) -> float | None:
    """Return the margin of a result, or None where its check does not apply."""
    if result.not_applicable is not None:
        return None
    return margin(result.error, result.tolerance)


def value_text(value: float | None, digits: int = 9) -> str:
    """Write a value with nine digits."""
    if value is None or math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0.0 else "−∞"
    # Rounded first, so that 480 is not written 4.8e2.
    text = format(float(format(value, f".{digits}g")), f".{max(digits, 6)}g")
    return "0" if value == 0.0 else text.replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


def error_text(value: float | None) -> str:
    """Write an error or a tolerance with two digits."""
    return value_text(value, 2)
