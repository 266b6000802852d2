"""What an invariant leaves over: the residual of each step, its scale and its unit."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stickslip_verification.judge.metrics.course import Course, Mask
from stickslip_verification.model.run import Series


@dataclass(frozen=True)
class Residual:
    """By how much an invariant is missed, step by step.

    Attributes
    ----------
    values
        The residual of each step in `unit`, shape ``(n,)``; zero where the invariant holds.
    where
        The steps that the invariant is about, shape ``(n,)``.
    scale
        What the residual is measured against, in `unit`, above zero.
    unit
        In the spelling of the interface.
    """

    values: Series
    where: Mask
    scale: Series | float
    unit: str

    @property
    def errors(self) -> Series:
        """Residual over scale at the steps that the invariant is about."""
        values = np.abs(self.values)
        with np.errstate(divide="ignore", invalid="ignore"):
            parts = np.where(values == 0.0, 0.0, values / np.asarray(self.scale))
        return np.asarray(parts[self.where])


Metric = Callable[[Course], Residual]
"""From a side's run to what an invariant leaves over in it. Raises `MissingOutputError`."""


def everywhere(course: Course) -> Mask:
    """Return all steps."""
    return np.ones(course.h.size, dtype=np.bool_)
