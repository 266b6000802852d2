"""Numbers by nonlinear least squares, with intervals that stay true where noise has a memory."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Generic, TypeVar

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import t as student

from . import noise
from .cycles import Run
from .model import Floats

_CURVED: Final = 0.06
"""Half an interval over its number, from which it is one of the logarithm: numbers scale a motion.
"""
_GAIN: Final = 1e-9
"""Of the squares and the numbers: what a step gains at the end of a search."""
_LITTLE: Final = 4.0
"""Of the squares, for each number: what a search may have left."""
_UNKNOWN: Final = 3e6
"""Deviation of a number before the record, over one at which a change is as large as the noise."""

Columns = Sequence[Floats]
"""Residuals of unbroken runs of even samples, each in units of its noise."""


@dataclass(frozen=True, eq=False)
class Motion(ABC):
    """A motion over the samples of a run that hangs on numbers, shape (p,)."""

    run: Run
    noise: dict[str, float]
    """Standard deviations of x [m] and F [N], as far as there are."""

    @property
    @abstractmethod
    def steps(self) -> Floats:
        """Steps of the numbers for difference quotients."""

    @property
    def usual(self) -> Floats:
        """How far the numbers usually are from 0, standard deviations; infinite: anywhere."""
        return np.full(self.steps.size, math.inf)

    @abstractmethod
    def columns(self, n: Floats) -> Columns:
        """Return the residuals at some numbers, of each column over its noise."""


M = TypeVar("M", bound=Motion)


@dataclass(frozen=True)
class Fitted(Generic[M]):
    """Least squares at their minimum."""

    motion: M
    value: Floats

    @cached_property
    def residual(self) -> Columns:
        """Residuals at the minimum."""
        return self.motion.columns(self.value)

    @cached_property
    def jacobian(self) -> Floats:
        """Their derivatives, shape (n, p)."""
        return derivatives(
            lambda n: np.concatenate(self.motion.columns(n)), self.motion, self.value
        )

    @cached_property
    def estimate(self) -> noise.Estimate:
        """Of a whole step of Gauss and Newton from here: what the search has left to go."""
        lengths = np.maximum(np.sqrt(np.sum(self.jacobian**2, axis=0)), 1e-100)
        known = np.minimum(self.motion.usual, _UNKNOWN / lengths)
        names = [str(i) for i in range(self.value.size)]
        return noise.least_squares(
            dict(zip(names, -self.jacobian.T, strict=True)),
            np.concatenate(self.residual),
            np.repeat(np.arange(len(self.residual)), [r.size for r in self.residual]),
            known=dict(zip(names, known.tolist(), strict=True)),
        )

    @property
    def covariance(self) -> Floats:
        """Covariance of the numbers, shape (p, p): of noise, and of a search that has not ended."""
        estimate = self.estimate
        return estimate.covariance + np.outer(estimate.value, estimate.value)

    @property
    def ended(self) -> bool:
        """Whether what the search has left to go is within the noise."""
        fitted = self.estimate.fitted
        return float(fitted @ fitted) < _LITTLE * self.value.size

    def deviations(self, of: Callable[[Floats], Floats]) -> Floats:
        """Return the standard deviations of what follows from the numbers, shape (values,)."""
        slopes = derivatives(of, self.motion, self.value)
        return np.asarray(
            np.sqrt(np.einsum("ij,jk,ik->i", slopes, self.covariance, slopes).clip(0.0))
        )

    def ends(self, value: float, deviation: float) -> tuple[float, float]:
        """Return the interval of 95 % of a value with a standard deviation."""
        half = float(student.ppf(0.5 + 0.5 * noise.SURE, self.estimate.freedom)) * deviation
        if not _CURVED * value < half < value:
            return value - half, value + half
        return value * math.exp(-half / value), value * math.exp(half / value)


def derivatives(of: Callable[[Floats], Floats], motion: Motion, n: Floats) -> Floats:
    """Return the derivatives of what follows from numbers, shape (values, p)."""
    moves = np.diag(motion.steps)
    return np.stack([(of(n + by) - of(n - by)) / (2.0 * by.sum()) for by in moves], axis=1)


def fit(motion: M, start: Floats, most: int = 80, gain: float = _GAIN) -> Fitted[M]:
    """Return the least squares that are reached from a start, shape (p,), in so many trials."""

    def residual(n: Floats) -> Floats:
        return np.concatenate([*motion.columns(n), n / motion.usual])

    best = least_squares(
        residual,
        start,
        lambda n: derivatives(residual, motion, n),
        method="lm",
        x_scale="jac",
        ftol=gain,
        xtol=gain,
        gtol=gain,
        max_nfev=most,
    )
    return Fitted(motion, np.asarray(best.x))


def weighed(found: Fitted[M], most: int = 80, gain: float = _GAIN) -> Fitted[M]:
    """Return the fit with the noise that a residual shows, from there."""
    motion, sizes = found.motion, [float(np.sqrt(np.mean(r**2))) for r in found.residual]
    noise = {
        name: e * max(r, 1e-3) for (name, e), r in zip(motion.noise.items(), sizes, strict=True)
    }
    return fit(replace(motion, noise=noise), found.value, most, gain)
