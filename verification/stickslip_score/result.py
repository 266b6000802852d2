"""The verdict on a curve: four quantities beside the exact ones, the cause, what else was seen."""

import math
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any


class Cause(StrEnum):
    """What most likely made a curve what it is."""

    EXACT = "exact"
    FIXED_STEP = "fixed_step"
    REGULARISED = "regularised"
    SINGLE_COEFFICIENT = "single_coefficient"
    SOLVER_TOLERANCE = "solver_tolerance"
    NOISY = "noisy"
    OTHER = "other"


Judgement = tuple[Cause, str]
"""The cause, and the sentence that says why."""


def tolerance(off: float) -> Judgement:
    """Say that a curve is off by a part that a solver's tolerance explains."""
    return Cause.SOLVER_TOLERANCE, (
        f"solver tolerance, {power(off)}: the curve is off the exact solution by about this part, "
        "less than a wrong parameter or a fixed step would put it off"
    )


def power(part: float) -> str:
    """Return the power of ten next to a part."""
    return f"1e{round(math.log10(max(part, 1e-16)))}"


@dataclass(frozen=True)
class Compared:
    """A quantity of the cycle as the curve has it and as it is, SI.

    Attributes
    ----------
    got
        Mean over the complete cycles (or slips) of the curve; None where it shows none.
    exact
        Of the steady cycle; None where none exists.
    error
        ``got - exact``, in the unit of both; None where one of them is.
    resolution
        How far `got` may be from the curve's own value for want of samples and digits; None
        where there is no `got`. An `error` within it is no evidence against the curve.
    """

    got: float | None
    exact: float | None
    error: float | None
    resolution: float | None


@dataclass(frozen=True)
class Score:
    """What a curve came to.

    Attributes
    ----------
    period, t_stick, t_slip
        Durations [s]; the period from break-away to break-away.
    delta_x
        Jump of the mass [m], with the sign of v.
    cause
        What most likely made the curve what it is.
    explanation
        The same as a sentence with figures.
    findings
        What else was seen, one sentence each.
    cycles
        Complete cycles, from break-away to break-away, behind the figures.
    x_noise, F_noise
        Standard deviation of the noise of x [m] and F [N]; None where the column is not given.
    """

    period: Compared
    t_stick: Compared
    t_slip: Compared
    delta_x: Compared
    cause: Cause
    explanation: str
    findings: tuple[str, ...]
    cycles: int
    x_noise: float | None = None
    F_noise: float | None = None


_UNITS = {"period": "s", "t_stick": "s", "t_slip": "s", "delta_x": "m"}


def as_json(score: Score) -> dict[str, Any]:
    """Return the score as what JSON can hold; null where a figure is missing."""
    quantities = {name: asdict(getattr(score, name)) for name in _UNITS}
    return {
        **quantities,
        "cause": score.cause,
        "explanation": score.explanation,
        "findings": list(score.findings),
        "cycles": score.cycles,
        "noise": {"x": score.x_noise, "F": score.F_noise},
        "unit": {**_UNITS, "noise": {"x": "m", "F": "N"}},
    }
